"""``stribeck design``."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

from stribeck.cli import show
from stribeck.cli.text import say
from stribeck.loops import Design, design, loop_and_controller
from stribeck.loops.compensation import CompensationResult
from stribeck.loops.judge import judge
from stribeck.loops.loop import controller_of
from stribeck.loops.second import SecondOpinion, second_opinion
from stribeck.loops.starts import from_starts, starts_row
from stribeck.report.design import (
    MACHINES,
    excess_sentence,
    mixed_sentence,
    proof_sentence,
    second_lines,
    sentence,
    sentence_of,
    starts_sentence,
)
from stribeck.report.quantities import human

JOURNAL = "tune_so_far.json"  # in DIR, until the search is done
_KINDS = {
    "none": "none", "reference": "feedforward of the steady curve at the signal's speed",
    "measured": "the law as an observer at the measured speed",
    "inner_loop": "that with dF/dt, led by the lag of the drive", "dither": "dither",
}  # fmt: skip


def run(
    path: Path, assignments: list[str], options: dict[str, Any], out: Path | None, json: bool, trust: bool,
    on: str | None = None,
) -> int:  # fmt: skip
    """Judge the loop, print what was found, write the page."""
    scenario = show.load(path, assignments, trust)
    if out is not None:
        show.check_folder(out, [path], MACHINES)
    journal = out / JOURNAL if out is not None and options.get("tune") else None
    with show.lanes_on(on), show.stages(scenario.name) as tell:
        found = design(scenario, tell=tell, journal=journal, **options)
    summary, files = found.to_json(), list[str]()
    if out is not None:
        from stribeck.report.design import write_design

        summary["files"] = files = write_design(found, summary, out, show.command_line())
    if json:
        show.print_json(summary)
    else:
        _print(found)
        for file in files:
            print(f"  wrote {file}")
    if found.verdict == "failed":
        show.failed(scenario.name, found.judgement.note)
        return 1
    return 0


def hunt(path: Path, assignments: list[str], controller: str | None, json: bool, trust: bool) -> int:
    """The verdict on a loop, and what describing functions predict."""
    scenario = show.load(path, assignments, trust)
    with show.stages(scenario.name) as tell:
        loop, name = loop_and_controller(scenario, controller)
        j = judge(loop, tell=tell and partial(_told, tell))[0]
        starts = from_starts(loop, name, tell and partial(_told, tell))
        second = second_opinion(loop, name)
    rotary = loop.scenario.rig.machine.body[controller_of(loop.scenario, name).measures].rotary
    cycle = {"amplitude": j.amplitude, "period": j.period, "body": j.body}
    summary = {
        "status": "failed" if j.verdict == "failed" else "done", "scenario": scenario.name,
        "verdict": None if j.verdict == "failed" else j.verdict, "why": j.note or None,
        "limit_cycle": cycle if j.verdict == "hunting" else None, **starts_row(starts, j), "second_opinion": second,
    }  # fmt: skip
    if json:
        show.print_json(summary)
    else:
        say(f"{scenario.name}: {sentence_of(j, 'rad' if rotary else 'm')}", 4)
        say(starts_sentence(starts, j, "rad" if rotary else "m"), 4, "  ")
        _print_second(second, "rad" if rotary else "m")
    if j.verdict == "failed":
        show.failed(scenario.name, j.note)
        return 1
    return 0


def _told(tell: Callable[[float, str], None], share: float) -> None:
    tell(share, "the verdict")


def _print_second(second: SecondOpinion, unit: str) -> None:
    for line in second_lines(second, unit):
        say(line, 4, "  ")


def _print(found: Design) -> None:
    scenario, j = found.loop.scenario, found.judgement
    say(f"{scenario.name}: {sentence(found)}", 4)
    say(starts_sentence(found.starts, j, _unit_of(found)), 4, "  ")
    say(f"the loop's slowest time constant while it slides: {found.loop.slowest:.3g} s", 4, "  ")
    if found.second is not None:
        _print_second(found.second, _unit_of(found))
    if found.loop.held:
        say(f"held from t = {found.loop.rest:g} s on, to judge rest: {', '.join(found.loop.held)}", 4, "  ")
    unit = _unit_of(found)
    for name, row in found.errors.items():
        told = [
            f"{key} {human(x, 's' if key == 'settling' else unit)}"
            for key, x in row.items() if x is not None and key in ("peak", "rms", "reversal", "standstill", "settling")
        ]  # fmt: skip
        if row.get("settling", 0.0) is None:
            told.append(
                f"does not settle within {human(row.get('tolerance') or 0.0, unit)}"
                if "tolerance" in row
                else "does not settle"
            )
        say(f"{', '.join(told)}", 14, f"  {name:10s}  ")
    if (moves := found.moves) is not None:
        size = f"{human(moves.amplitude, unit)} to each side, at most {human(moves.speed, unit + '/s')}"
        say(f"the standard moves go {size}: a sine of {human(moves.period, 's')}", 4, "  ")
    for line in found.lines:
        if not line.boundaries and not line.mixed:
            whole = line.turned
            say(f"{whole.path}: {line.found[0].verdict} from {whole.low:g} to {whole.high:g}", 4, "  ")
        for b in line.boundaries:
            say(f"{b.path} = {b.value:.4g}: {b.below} below, {b.above} above", 4, "  ")
        for m in line.mixed:
            say(f"{m.path} = {mixed_sentence(m)}", 4, "  ")
    _print_compensations(found, unit)
    if found.excess is not None:
        say(excess_sentence(found), 4, "  ")
    say(f"proof: {proof_sentence(found)}", 4, "  ")
    if found.tuned is not None:
        gains = ", ".join(f"{path} = {x:g}" for path, x in found.tuned.gains.items())
        t = found.tuned
        say(
            f"gains: {gains}: worst error after a reversal {human(t.worst_error, unit)} instead of "
            f"{human(t.error_before, unit)} ({t.quiet} of {t.tried} tried were quiet)", 4, "  ",
        )  # fmt: skip
    if j.note and found.verdict != "failed":
        say(f"note: {j.note}", 4, "  ")


def _unit_of(found: Design) -> str:
    rig = found.loop.scenario.rig
    each = next(c for c in rig.machine.controllers if c.name == found.controller)
    return "rad" if rig.machine.body[each.measures].rotary else "m"


def _print_compensations(found: Design, unit: str) -> None:
    if found.why_not:
        say(f"compensations were not compared: {found.why_not}", 4, "  ")
        return
    print("  against friction, whatever it is within its intervals (simulated):")
    for c in found.compensations:
        of = f" of {c.dither['frequency']:g} Hz, its amplitude a share of the friction" if c.dither else ""
        say(
            f"{_KINDS[c.kind]}{of}: {_quiet(c)}; error after a reversal {human(c.reversal_error, unit)} at share {c.share:.2f}, "
            f"at worst {human(c.worst_error, unit)}", 6, "    ",
        )  # fmt: skip


def _quiet(c: CompensationResult) -> str:
    if c.kind == "none":
        return "quiet" if c.largest_quiet_share is not None else "not quiet"
    if c.dither is None:
        return "not quiet even without" if c.largest_quiet_share is None else f"quiet up to {c.largest_quiet_share:.2f}"
    if c.largest_quiet_share is None:
        return "quiet at no amplitude"
    return f"quiet from {c.dither['least_quiet_share']:.2f} to {c.largest_quiet_share:.2f}"

"""``stribeck design``."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from stribeck.cli import show
from stribeck.cli.text import say
from stribeck.loops import Design, design
from stribeck.loops.compensation import CompensationResult
from stribeck.report.design import (
    MACHINES,
    excess_sentence,
    mixed_sentence,
    sentence,
    starts_sentence,
)
from stribeck.report.quantities import human

_KINDS = {
    "none": "none", "reference": "feedforward of the steady curve at the signal's speed",
    "measured": "the law as an observer at the measured speed",
    "inner_loop": "that with dF/dt, led by the lag of the drive", "dither": "dither",
}  # fmt: skip


def run(path: Path, assignments: list[str], options: dict[str, Any], out: Path | None, json: bool, trust: bool) -> int:
    """Judge the loop, print what was found, write the page."""
    scenario = show.load(path, assignments, trust)
    if out is not None:
        show.check_folder(out, [path], MACHINES)
    with show.stages(scenario.name) as tell:
        found = design(scenario, tell=tell, **options)
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


def _print(found: Design) -> None:
    scenario, j = found.loop.scenario, found.judgement
    say(f"{scenario.name}: {sentence(found)}", 4)
    say(starts_sentence(found.starts, j, _unit_of(found)), 4, "  ")
    say(f"the loop's slowest time constant while it slides: {found.loop.slowest:.3g} s", 4, "  ")
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

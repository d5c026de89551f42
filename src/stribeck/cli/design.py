"""``stribeck design``."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from stribeck.cli.shared import Backend, ControllerName, Json, Out, ScenarioFile, Set, Trust, Undetermined, app
from stribeck.mouth.terminal import say

if TYPE_CHECKING:
    from stribeck.control.gains import Condition
    from stribeck.loops import Design
    from stribeck.loops.servo import ServoDesign
    from stribeck.scenario import Scenario


@app.command(epilog="Example: stribeck design machine.toml --vary controllers.axis.K_p=10:1000 --out design")
def design(
    scenario: ScenarioFile,
    vary: Annotated[
        list[str] | None,
        typer.Option(
            "--vary", metavar="PATH=LOW:HIGH", help="Find the values at which the verdict changes; may be repeated."
        ),
    ] = None,
    compensate: Annotated[
        bool, typer.Option("--compensate", help="Compare remedies: feedforward, observer, inner loop, dither.")
    ] = False,
    uncertainty: Annotated[
        Path | None,
        typer.Option(
            "--uncertainty",
            metavar="parameters.toml",
            help="Friction intervals for --compensate, from a fit; 10 % both ways unless given.",
        ),
    ] = None,
    controller: ControllerName = None,
    out: Out = None,
    json: Json = False,
    set_: Set = None,
    trust: Trust = False,
    v_max: Annotated[
        float | None,
        typer.Option(
            "--v-max",
            metavar="V",
            rich_help_panel="Advanced",
            help="Largest speed of a servo's proof (m/s); twice the largest simulated speed unless given.",
        ),
    ] = None,
    seed: Annotated[
        int,
        typer.Option("--seed", metavar="N", rich_help_panel="Advanced", help="Seed of the random friction samples."),
    ] = 0,
    _backend: Backend = None,
    _undetermined: Undetermined = False,
) -> int:
    """Report whether an axis hunts: by how much, from which gain on, and which remedy helps.

    For a pneumatic servo: report whether its Lyapunov function decreases.
    """
    from stribeck.cli import show
    from stribeck.loops import design as judge
    from stribeck.loops.said import MACHINES
    from stribeck.loops.servo import ServoDesign

    loaded = show.load(scenario, set_ or [], trust)
    if out is not None:
        show.check_folder(out, [scenario], MACHINES)
    with show.stages(loaded.name) as tell:
        found = judge(
            loaded,
            vary=vary or [],
            compensate=compensate,
            uncertainty=uncertainty,
            controller=controller,
            v_max=v_max,
            seed=seed,
            tell=tell,
        )
    summary, files = found.to_json(), list[str]()
    if out is not None:
        files = _write(found, summary, out, show.command_line())
        summary["files"] = files
    if json:
        show.print_json(summary)
    else:
        if isinstance(found, ServoDesign):
            _print_servo(loaded, found)
        else:
            _print(scenario, found, out)
        for file in files:
            print(f"  wrote {file}")
    if found.failed is not None:
        show.failed(loaded.name, found.failed)
        return 1
    return 0


def _write(found: Design | ServoDesign, summary: dict[str, object], out: Path, command: str) -> list[str]:
    from stribeck.loops.servo import ServoDesign

    if isinstance(found, ServoDesign):
        from stribeck.loops.servo_said import write_servo

        return write_servo(found, summary, out, command)
    from stribeck.loops.said import write_design

    return write_design(found, summary, out, command)


def _print(path: Path, found: Design, out: Path | None) -> None:
    from stribeck.loops.said import along_sentences, headline, position_unit, starts_sentence
    from stribeck.mouth.cells import human

    unit, own = position_unit(found), found.judgement
    say(f"{path.name}: {headline(own, unit)}  ({starts_sentence(found.starts, own, unit)})", 4)
    if found.loop.held:
        say(f"held at their value at t = {found.loop.rest:g} s, to judge rest: {', '.join(found.loop.held)}", 4, "  ")
    if own.note and found.failed is None:
        say(f"note: {own.note}", 4, "  ")
    print()
    _print_errors(found, unit)
    moves = found.moves
    size = f"{human(moves.amplitude, unit)} to each side, at most {human(moves.speed, unit + '/s')}"
    say(f"sine, slow ramp and step move {size}", 4, "  ")
    if found.lines:
        print()
    for line in found.lines:
        for sentence in along_sentences(line):
            say(sentence, 4, "  ")
    if found.compensations:
        print()
        _print_compensations(found, unit)
    elif found.why_not:
        say(f"compensations were not compared: {found.why_not}", 4, "  ")
    print(_next(path, found, out))


def _next(path: Path, found: Design, out: Path | None) -> str:
    """The next step."""
    if not found.compensations and not found.why_not:
        return f"\n  next: stribeck design {shlex.quote(str(path))} --compensate    compare remedies against friction"
    if out is None:
        return f"\n  next: stribeck design {shlex.quote(str(path))} --compensate --out design    write the page and the machine"
    machine = shlex.quote(str(out / "machine.toml"))
    return f"\n  next: stribeck export {machine} --part controller --target c --out c    the controller as C"


def _print_errors(found: Design, unit: str) -> None:
    from stribeck.mouth.cells import human

    rows: list[Sequence[str]] = [("move", "peak error", "rms", "after a reversal", "at rest", "settling")]
    for name, row in found.errors.items():
        cells = [
            human(x, unit) if (x := row.get(key)) is not None else "-"
            for key in ("peak", "rms", "reversal", "standstill")
        ]
        settled = row.get("settling", -1.0)
        last = "never" if settled is None else "-" if settled < 0 else human(settled, "s")
        rows.append((name.replace("_", " "), *cells, last))
    _print_table(rows)


def _print_compensations(found: Design, unit: str) -> None:
    from stribeck.loops.said import REMEDIES, excess_sentence, quiet_range
    from stribeck.mouth.cells import human

    rows: list[Sequence[str]] = [("remedy", "quiet", "share", "after a reversal", "worst friction")]
    for c in found.compensations:
        errors = human(c.reversal_error, unit), human(c.worst_error, unit)
        rows += [(REMEDIES[c.kind], quiet_range(c), f"{c.share:.2f}", *errors)]
    _print_table(rows)
    for c in found.compensations:
        if c.dither:
            text = f"dither: {c.dither['kind']}, {c.dither['frequency']:.4g} Hz; its share is amplitude over friction"
            say(text, 4, "  ")
    if found.excess is not None:
        say(excess_sentence(found), 4, "  ")


def _print_table(rows: Sequence[Sequence[str]]) -> None:
    """Rows of cells, the first the head, in columns two blanks apart."""
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    for row in rows:
        print(("  " + "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True))).rstrip())


def _print_servo(scenario: Scenario, found: ServoDesign) -> None:
    from stribeck.control.proof import derive
    from stribeck.scenario.cascade import gains_of

    d, v, proof = gains_of(scenario), found.gains, found.proof
    word = {True: "proved", False: "refuted", None: "not decided"}[proof.proven]
    say(f"{scenario.name}: V decreases for |v| <= {v.v_max:.4g} m/s: {word}", 4)
    if proof.reason:
        say(proof.reason, 4, "  ")
    say(f"K_D = {d['K_D']:g} N s/m, K = {d['K']:g} m/N, w <= {v.w_max:.4g} 1/s", 4, "  ")
    say(f"dV/dt = {derive().derivative}", 4, "  ")
    say(_condition("exact condition", v.exact), 4, "  ")
    say(_condition("corrected (21)", v.sufficient), 4, "  ")
    say(f"corrected (21) also needs K < {v.largest_K_sufficient:.4g} m/N", 4, "  ")
    if not v.exact.holds:
        text = f"gains that hold with a factor of two to spare: K_D = {v.proposed['K_D']:.4g}, or K = {v.proposed['K']:.4g}"
        say(text, 4, "  ")
    say("not covered: " + "; ".join(found.not_covered), 4, "  ")
    if found.along is not None:
        _print_along(found)


def _print_along(found: ServoDesign) -> None:
    assert found.along is not None
    along = found.along
    V, rises, rise = along.V, int(along.rises.sum()), along.largest_rise
    text = f"rises by more than 1e-9 V(0) after {rises} rows, by at most {rise:.3g} J"
    say(f"along the simulation V goes from {V[0]:.4g} to {V[-1]:.4g} J, {text}", 4, "  ")
    for what, spans in (
        ("V rises", along.rise_times),
        ("dV/dt above (19)", along.excess_times),
        ("valve saturates", along.saturated_times),
    ):
        if spans:
            more = f" and {len(spans) - 4} more" if len(spans) > 4 else ""
            say(f"{what}: t = " + ", ".join(f"{a:g} to {b:g}" for a, b in spans[:4]) + f" s{more}", 4, "  ")
    if (stays := found.staying) is not None:
        word = "stays" if stays.holds else "is not shown to stay"
        say(
            f"from this start |v| {word} below {found.gains.v_max:.4g} m/s (V falls, so |v| <= {stays.bound:.4g} m/s); so it "
            f"does from every start with V(0) < {stays.largest_V:.4g} J and lambda |e(0)| <= sqrt(2 V(0)/M)",
            4, "  ",
        )  # fmt: skip


def _condition(name: str, c: Condition) -> str:
    holds = "holds" if c.holds else "does not hold"
    speed = "any speed" if c.largest_speed is None else f"{c.largest_speed:.4g} m/s"
    return f"{name}: {holds}; needs K_D >= {c.least_K_D:.4g} (margin {c.margin:.4g}); dV/dt <= 0 up to {speed}"

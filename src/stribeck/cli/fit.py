"""``stribeck fit``."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from stribeck.cli import record, show
from stribeck.cli.record import (
    Acceleration,
    Command,
    Data,
    Force,
    GainOrName,
    Load,
    Position,
    Pressure,
    Run,
    Time,
    UnitOrSI,
    Velocity,
)  # fmt: skip
from stribeck.cli.shared import ADVANCED, Json, Out, app
from stribeck.errors import InputError
from stribeck.mouth.terminal import say

if TYPE_CHECKING:
    from stribeck.identify.log import Log
    from stribeck.identify.options import FitOptions
    from stribeck.identify.result import Estimate, Fit

_READ = 0.05  # of the work
_NOTES = 5  # on the screen; the page and --json have all
_LAWS = 3  # in the headline
Laws = Annotated[
    list[str] | None,
    typer.Option("--law", metavar="NAME", help="Law to fit; of several, or without it, the best is chosen."),
]
Mass = Annotated[
    float | None,
    typer.Option("--mass", rich_help_panel=ADVANCED, metavar="M", help="Mass (kg, or kg m^2); fitted unless given."),
]
Method = Annotated[
    str | None,
    typer.Option(
        "--method",
        rich_help_panel=ADVANCED,
        metavar="METHOD",
        help="static or dynamic (by simulation); dynamic for laws with bristles unless given.",
    ),
]
Given = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        rich_help_panel=ADVANCED,
        metavar="KEY=VALUE",
        help="Give a constant instead of fitting it, such as k_v=1e6; may be repeated.",
    ),
]
Free = Annotated[
    list[str] | None,
    typer.Option(
        "--free",
        rich_help_panel=ADVANCED,
        metavar="KEY",
        help="Fit a constant that has a default, such as k_v; may be repeated.",
    ),
]
Terms = Annotated[
    list[str] | None,
    typer.Option(
        "--term",
        metavar="TERM",
        help="Further term of the force, such as stiffness, or delay; may be repeated.",
    ),
]
Cutoff = Annotated[
    float | None,
    typer.Option(
        "--cutoff",
        rich_help_panel=ADVANCED,
        metavar="HZ",
        help="Cut-off frequency of the motion's filter (Hz); chosen from the data unless given; 0: no filter.",
    ),
]
Starts = Annotated[
    int, typer.Option("--starts", rich_help_panel=ADVANCED, min=1, help="Number of starts of a fit by simulation.")
]
Seed = Annotated[int, typer.Option("--seed", rich_help_panel=ADVANCED, min=0, help="Seed of the starts.")]
Output = Annotated[
    str,
    typer.Option(
        "--output",
        rich_help_panel=ADVANCED,
        metavar="WHAT",
        help="Measured signal that a simulation must match: force, velocity or position.",
    ),
]
Drive = Annotated[
    str | None,
    typer.Option(
        "--drive",
        rich_help_panel=ADVANCED,
        metavar="KIND[:KEY=VALUE,...]",
        help="What drives the body with --output velocity or position: force, pid or spring.",
    ),
]
Logs = Annotated[
    Path | None,
    typer.Option("--logs", metavar="LOGS.toml", help="Recordings and unknowns of the machine DATA."),
]
Sought = Annotated[
    list[str] | None,
    typer.Option(
        "--unknown",
        rich_help_panel=ADVANCED,
        metavar="PATH=LOW:HIGH",
        help="Further unknown beside [unknown] of LOGS.toml; may be repeated.",
    ),
]
Transfer = Annotated[
    Path | None,
    typer.Option(
        "--transfer",
        rich_help_panel=ADVANCED,
        metavar="LOGS.toml",
        help="Recordings of another unit or day; numbers that moved are listed.",
    ),
]

Plan = Annotated[
    str | None,
    typer.Option(
        "--plan",
        metavar="stroke=M,speed=M/S,force=N[,deflection=M]",
        help="Print what to measure within these limits of the rig. deflection: F_c/sigma_0, if known.",
    ),
]
Simulate = Annotated[
    bool,
    typer.Option(
        "--simulate",
        rich_help_panel=ADVANCED,
        help="With --plan and --out: also write a synthetic log (of --law, --set, --seed).",
    ),
]


NoForms = Annotated[
    bool,
    typer.Option(
        "--no-forms", rich_help_panel=ADVANCED, help="Fit the law alone, without forms for missing effects (static)."
    ),
]
NoWeight = Annotated[
    bool, typer.Option("--no-weight", rich_help_panel=ADVANCED, help="Leave out the weight of a rotary joint (static).")
]
Filter = Annotated[
    str | None,
    typer.Option(
        "--filter", metavar="published", rich_help_panel=ADVANCED,
        help="Use the published inverse-dynamics procedure: Butterworth filter, decimation, the law alone (static).",
    ),
]  # fmt: skip
Speeds = Annotated[
    list[float] | None,
    typer.Option(
        "--speed", metavar="M/S", rich_help_panel=ADVANCED, help="Also estimate the friction at this speed (static)."
    ),
]


@app.command(epilog="Example: stribeck fit log.csv --time t --position y --force F --out fit")
def fit(
    context: typer.Context,
    data: Data = None,
    law: Laws = None,
    time: Time = None,
    position: Position = None,
    velocity: Velocity = None,
    force: Force = None,
    force_gain: GainOrName = None,
    unit: UnitOrSI = None,
    term: Terms = None,
    logs: Logs = None,
    plan: Plan = None,
    acceleration: Acceleration = None,
    load: Load = None,
    pressure: Pressure = None,
    command: Command = None,
    run: Run = None,
    mass: Mass = None,
    method: Method = None,
    set_: Given = None,
    free: Free = None,
    no_forms: NoForms = False,
    no_weight: NoWeight = False,
    filter_: Filter = None,
    speed: Speeds = None,
    cutoff: Cutoff = None,
    starts: Starts = 20,
    seed: Seed = 0,
    output: Output = "force",
    drive: Drive = None,
    unknown: Sought = None,
    transfer: Transfer = None,
    simulate: Simulate = False,
    out: Out = None,
    json: Json = False,
) -> int:
    """Fit a law to a measured log, or a machine to its recordings (--logs), with a 95 % interval, a model
    range and a state for each."""
    if plan is not None:
        from stribeck.cli import plan as planning

        return planning.plan(
            context, plan, simulate=simulate, laws=law or [], assignments=set_ or [], seed=seed, out=out, json=json
        )
    if simulate:
        raise InputError("--simulate: goes with --plan, which is not given")
    if not data:
        raise InputError("DATA: missing: a log to fit, or --plan to learn what to measure")
    if logs is not None or transfer is not None or unknown:
        from stribeck.cli import actuator

        actuator.check_options(context)
        return actuator.fit(data, logs, law or [], set_ or [], unknown or [], transfer, starts, seed, out, json)
    from stribeck.identify.options import FitOptions

    columns = {
        "time": time, "position": position, "velocity": velocity, "acceleration": acceleration, "force": force,
        "load": load, "pressure": pressure, "run": run, "command": command,
    }  # fmt: skip
    options = FitOptions(
        mass, method, record.constants(set_ or []), tuple(free or ()), tuple(term or ()), starts, seed, output,
        record.drive(drive), not no_forms, filter_, not no_weight, tuple(speed or ()),
    )  # fmt: skip
    names = columns, unit or [], force_gain
    return _fit_log(data, law or [], names, cutoff=cutoff, options=options, out=out, json=json)


def _fit_log(
    data: list[Path], laws: list[str], names: tuple[dict[str, str | None], list[str], str | None], *,
    cutoff: float | None, options: FitOptions, out: Path | None, json: bool,
) -> int:  # fmt: skip
    """Read the log, fit, write what was asked for, print the estimates."""
    from stribeck.identify import api as fitting

    columns = record.columns(*names)
    how = fitting.preparation(laws, options, cutoff)
    if out is not None:
        show.check_folder(out)
    try:
        with show.progress("fit") as tell:
            log = fitting.log_of(data, columns, how)
            if tell is not None:
                tell(_READ)
            result = fitting.fit_log(log, laws, options, _rest_of(tell))
    except KeyboardInterrupt:
        print("stribeck: nothing was found yet", file=sys.stderr)
        raise
    written: list[str] = []
    summary = result.to_json()
    summary["data"] = {
        "files": [str(p) for p in data], "rows": len(log), "quality": list(log.quality), "sources": log.sources
    }  # fmt: skip
    try:
        if out is not None:
            from stribeck.files import seen_from, together
            from stribeck.identify.report.files import FITS, write_numbers, write_report

            reading = fitting.reading(data, columns, how, options) | {"files": [seen_from(out, path) for path in data]}
            named = show.command_line(), ", ".join(p.name for p in data)
            with together(out, last="parameters.toml", older={**FITS, "report.html": ""}) as place:
                written = [str(out / name) for name in write_numbers(result, place, *named, reading)]
            with together(out, last="report.html") as place:  # drawing takes seconds, and may be stopped
                written += [str(out / name) for name in write_report(result, place, *named)]
    except BaseException:  # while the page is drawn: what was found is said
        _tell(result, log, data, summary, written, json)
        raise
    _tell(result, log, data, summary, written, json)
    return 130 if result.status == "stopped" else 0


def _tell(result: Fit, log: Log, data: list[Path], summary: dict[str, object], written: list[str], json: bool) -> None:
    if json:
        show.print_json({**summary, "files": written})
        return
    print(_headline(result, data))
    print()
    print_estimates(result.parameters)
    if result.notes:
        print()
    for text in result.notes[:_NOTES]:
        say(text, 4, "  ")
    if log.quality and not written:
        say(f"{len(log.quality)} notes about the data: --out DIR writes them on the page, --json prints them.", 4, "  ")
    for file in written:
        print(f"  wrote {file}")
    if written:
        print(f"  next: stribeck predict other.csv --fit {Path(written[0]).parent}")


def _headline(result: Fit, data: list[Path]) -> str:
    """The file, the law, what it leaves, and what plainer models leave."""
    from stribeck.mouth.cells import percent

    name = data[0].name if len(data) == 1 else f"{len(data)} files"
    others = sorted((c for c in result.candidates if not c["chosen"]), key=lambda c: -c["relative_force_error"])
    told = ", ".join(f"{c['name']} {percent(c['relative_force_error'])}" for c in others[:_LAWS])
    left = f"{name}: {result.law_name}, relative residual {percent(result.relative_force_error)}"
    return f"{left}    ({told})" if told else left


def print_estimates(estimates: Mapping[str, Estimate]) -> None:
    """Every estimate with interval, range, unit and state; ``~`` marks those that are not identifiable."""
    rows = [["parameter", "estimate", "95 % interval", "model range", "unit", "state"]]
    for name, e in estimates.items():
        mark = "" if e.identifiable else "~"
        rows.append([name, mark + _number(e.value, e), _ends(e.interval, e), _ends(e.range, e), e.unit, str(e.state)])
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    for row in rows:
        print("  " + "   ".join(x.ljust(w) for x, w in zip(row, widths, strict=True)).rstrip())


def _ends(pair: tuple[float, float] | None, e: Estimate) -> str:
    """An interval in words: one that is open at an end as a bound."""
    if pair is None:
        return "-"
    low, high = pair
    if low == -float("inf") or high == float("inf"):
        told = [f"{word} {_number(x, e)}" for word, x in ((">", low), ("<", high)) if abs(x) != float("inf")]
        return " ".join(told) or "open"
    return f"{_number(low, e)} ... {_number(high, e)}"


def _number(x: float, e: Estimate) -> str:
    """With so many places as its interval tells: two digits of its half width."""
    from math import floor, isfinite, log10

    ends = [abs(e.value - end) for end in e.interval if isfinite(end) and end != e.value]
    half = min(ends, default=0.0)
    if not isfinite(x) or not half:
        return f"{x:.4g}"
    places = 1 - floor(log10(half))
    text = f"{round(x, places):.6g}"
    return f"{x:.{places}f}" if 0 <= places <= 5 and "e" not in text else text


def _rest_of(tell: Callable[[float], None] | None) -> Callable[[float], None] | None:
    """The progress of what follows the reading."""
    return None if tell is None else lambda share: tell(_READ + (1 - _READ) * share)

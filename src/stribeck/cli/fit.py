"""``stribeck fit``."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from stribeck.cli import record
from stribeck.cli.options import ADVANCED, Json, Out, command
from stribeck.cli.output import OutputFolder, command_line, print_json
from stribeck.cli.progress import progress
from stribeck.errors import InputError
from stribeck.mouth.terminal import say

if TYPE_CHECKING:
    from stribeck.identify.log import Log
    from stribeck.identify.options import FitOptions
    from stribeck.identify.result import Estimate, Fit

_READ = 0.05  # of the work
_NOTES = 5  # on the screen; the page and --json have all
_LAWS = 3  # in the headline


def _advanced(name: str, metavar: str, text: str) -> typer.models.OptionInfo:
    """An option that few need."""
    option: typer.models.OptionInfo = typer.Option(name, metavar=metavar, rich_help_panel=ADVANCED, help=text)
    return option


@dataclass(frozen=True)
class How:
    """How to fit a law to a log."""

    term: Annotated[
        list[str] | None,
        typer.Option(
            "--term", metavar="TERM", help="Further term of the force, such as stiffness, or delay; may be repeated."
        ),
    ] = None
    mass: Annotated[float | None, _advanced("--mass", "M", "Mass (kg, or kg m^2); fitted unless given.")] = None
    method: Annotated[
        str | None,
        _advanced(
            "--method", "METHOD", "static or dynamic (by simulation); dynamic for laws with bristles unless given."
        ),
    ] = None
    set_: Annotated[
        list[str] | None,
        _advanced("--set", "KEY=VALUE", "Give a constant instead of fitting it, such as k_v=1e6; may be repeated."),
    ] = None
    free: Annotated[
        list[str] | None,
        _advanced("--free", "KEY", "Fit a constant that has a default, such as k_v; may be repeated."),
    ] = None
    no_forms: Annotated[
        bool,
        typer.Option(
            "--no-forms",
            rich_help_panel=ADVANCED,
            help="Fit the law alone, without forms for missing effects (static).",
        ),
    ] = False
    no_weight: Annotated[
        bool,
        typer.Option("--no-weight", rich_help_panel=ADVANCED, help="Leave out the weight of a rotary joint (static)."),
    ] = False
    filter_: Annotated[
        str | None,
        _advanced(
            "--filter",
            "published",
            "Use the published inverse-dynamics procedure: Butterworth filter, decimation, the law alone (static).",
        ),
    ] = None
    speed: Annotated[
        list[float] | None, _advanced("--speed", "M/S", "Also estimate the friction at this speed (static).")
    ] = None
    cutoff: Annotated[
        float | None,
        _advanced(
            "--cutoff",
            "HZ",
            "Cut-off frequency of the motion's filter (Hz); chosen from the data unless given; 0: no filter.",
        ),
    ] = None
    starts: Annotated[
        int, typer.Option("--starts", rich_help_panel=ADVANCED, min=1, help="Number of starts of a fit by simulation.")
    ] = 20
    seed: Annotated[int, typer.Option("--seed", rich_help_panel=ADVANCED, min=0, help="Seed of the starts.")] = 0
    output: Annotated[
        str,
        _advanced("--output", "WHAT", "Measured signal that a simulation must match: force, velocity or position."),
    ] = "force"
    unknown: Annotated[
        list[str] | None,
        _advanced(
            "--unknown",
            "NAME=LOW:HIGH",
            "Bounds of a fitted number; with --logs a further unknown, by path; may be repeated.",
        ),
    ] = None

    def options(self) -> FitOptions:
        """The same as the library has it.

        Raises:
            InputError: a value is not allowed.
        """
        from stribeck.cli.actuator import sought
        from stribeck.identify.options import FitOptions

        return FitOptions(
            mass=self.mass,
            method=self.method,
            constants=record.constants(self.set_ or []),
            free=tuple(self.free or ()),
            terms=tuple(self.term or ()),
            starts=self.starts,
            seed=self.seed,
            output=self.output,
            forms=not self.no_forms,
            filter=self.filter_,
            weight=not self.no_weight,
            speeds=tuple(self.speed or ()),
            unknown=sought(self.unknown or []),
        )


@command("fit", "stribeck fit log.csv --time t --position y --force F --out fit")
def fit(
    context: typer.Context,
    columns: record.ColumnsOfALog,
    how: How,
    data: record.Data = None,
    law: Annotated[
        list[str] | None,
        typer.Option("--law", metavar="NAME", help="Law to fit; of several, or without it, the best is chosen."),
    ] = None,
    logs: Annotated[
        Path | None,
        typer.Option("--logs", metavar="LOGS.toml", help="Recordings and unknowns of the machine DATA."),
    ] = None,
    plan: Annotated[
        str | None,
        typer.Option(
            "--plan",
            metavar="stroke=M,speed=M/S,force=N[,deflection=M]",
            help="Print what to measure within these limits of the rig. deflection: F_c/sigma_0, if known.",
        ),
    ] = None,
    transfer: Annotated[
        Path | None,
        _advanced("--transfer", "LOGS.toml", "Recordings of another unit or day; numbers that moved are listed."),
    ] = None,
    simulate: Annotated[
        bool,
        typer.Option(
            "--simulate",
            rich_help_panel=ADVANCED,
            help="With --plan and --out: also write a synthetic log (of --law, --set, --seed).",
        ),
    ] = False,
    out: Out = None,
    json: Json = False,
) -> int:
    """Fit a law to a measured log, or a machine to its recordings (--logs), with a 95 % interval, a model
    range and a state for each."""
    laws, assignments = law or [], how.set_ or []
    if plan is not None:
        from stribeck.cli import plan as planning

        return planning.plan(
            context, plan, simulate=simulate, laws=laws, assignments=assignments, seed=how.seed, out=out, json=json
        )
    if simulate:
        raise InputError("--simulate: goes with --plan, which is not given")
    if not data:
        raise InputError("DATA: missing: a log to fit, or --plan to learn what to measure")
    if logs is not None or transfer is not None:
        from stribeck.cli import actuator

        actuator.check_options(context)
        sought = actuator.RecordingsOptions(data, logs, laws, assignments, how.unknown or [], transfer)
        return actuator.fit(sought, starts=how.starts, seed=how.seed, out=out, json=json)
    return _fit_log(data, laws, columns, how, out=out, json=json)


def _fit_log(
    data: list[Path], laws: list[str], columns: record.ColumnsOfALog, how: How, *, out: Path | None, json: bool
) -> int:
    """Read the log, fit, write what was asked for, print the estimates."""
    from stribeck.identify import api as fitting

    names, options = columns.read(), how.options()
    reading = fitting.preparation(laws, options, how.cutoff)
    with OutputFolder(out):
        try:
            with progress("fit") as share:
                log = fitting.log_of(data, names, reading)
                share(_READ)
                result = fitting.fit_log(log, laws, options, _rest_of(share))
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
                told = fitting.reading(data, names, reading, options)
                _write(result, data, told, out, written)
        finally:  # while the page is drawn, too: what was found is said
            _tell(result, log, data, summary, written, json)
    return 130 if result.status == "stopped" else 0


def _write(result: Fit, data: list[Path], reading: dict[str, object], out: Path, written: list[str]) -> None:
    """Write the numbers, then the page, whose drawing takes seconds and may be stopped; ``written`` gets the paths."""
    from stribeck.files import seen_from, together
    from stribeck.identify.report.files import FITS, write_numbers, write_report

    about = reading | {"files": [seen_from(out, path) for path in data]}
    named = command_line(), ", ".join(p.name for p in data)
    with together(out, last="parameters.toml", older={**FITS, "report.html": ""}) as place:
        names = write_numbers(result, place, *named, about)
    written += [str(out / name) for name in names]
    with together(out, last="report.html") as place:
        names = write_report(result, place, *named)
    written += [str(out / name) for name in names]


def _tell(result: Fit, log: Log, data: list[Path], summary: dict[str, object], written: list[str], json: bool) -> None:
    if json:
        print_json({**summary, "files": written})
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


def _rest_of(tell: Callable[[float], None]) -> Callable[[float], None]:
    """The progress of what follows the reading."""
    return lambda share: tell(_READ + (1 - _READ) * share)

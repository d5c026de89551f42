"""``stribeck fit``."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from stribeck.cli import show
from stribeck.cli.options import said
from stribeck.cli.text import say
from stribeck.constants import show as shown
from stribeck.errors import InputError, refuse_twice
from stribeck.identify import api as fitting
from stribeck.identify.data.prepare import Preparation
from stribeck.identify.data.read import ColumnNames
from stribeck.identify.details import Candidate
from stribeck.identify.log import Log
from stribeck.identify.options import FitOptions
from stribeck.identify.result import Estimate, Fit
from stribeck.identify.statistics.choose import Choice
from stribeck.report.cells import digits, percent
from stribeck.scenario import parse_assignment

_READ = 0.05  # of the work


def fit(
    data: list[Path],
    laws: list[str],
    columns: ColumnNames,
    cutoff: float | None,
    trim: int | None,
    options: FitOptions,
    out: Path | None,
    json: bool,
) -> int:
    """Read the log, fit, print the estimates, write what was asked for."""
    how = fitting.preparation(laws, options, cutoff, trim)
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
            from stribeck.files import together
            from stribeck.identify.report.files import FITS, write_fit

            with together(out, last="parameters.toml", older=FITS) as place:
                names = write_fit(result, log, place, show.command_line(), ", ".join(p.name for p in data))
                names.append(_save(result, data, columns, how, options, out, place))
            written = [str(out / name) for name in names]
    except KeyboardInterrupt:  # while the page is drawn: what was found is said
        _tell(result, log, summary, written, json)
        raise
    _tell(result, log, summary, written, json)
    stopped = (result.best if isinstance(result, Choice) else result).status == "stopped"
    return 130 if stopped else 0


def _tell(result: Fit | Choice, log: Log, summary: dict[str, object], written: list[str], json: bool) -> None:
    if json:
        show.print_json({**summary, "files": written})
    else:
        _print(result, log, written)


def _rest_of(tell: Callable[[float], None] | None) -> Callable[[float], None] | None:
    """The progress of what follows the reading."""
    return None if tell is None else lambda share: tell(_READ + (1 - _READ) * share)


def _save(
    result: Fit | Choice, data: list[Path], columns: ColumnNames, how: Preparation, options: FitOptions, out: Path,
    place: Path,
) -> str:  # fmt: skip
    """Write what ``stribeck predict`` and ``stribeck explore --report`` need from ``out`` to a place; the file's name."""
    from stribeck.files import seen_from, write_text
    from stribeck.identify import predict

    reading = {
        "files": [seen_from(out, path) for path in data], "columns": columns.names, "units": columns.units,
        "force_gain": columns.force_gain, "cutoff": how.cutoff, "output": options.output, "drive": options.drive,
        "published": how.published,
    }  # fmt: skip
    write_text(place / predict.FILE, predict.saved(result.best if isinstance(result, Choice) else result, reading))
    return predict.FILE


def drive(text: str | None) -> dict[str, object] | None:
    """``KIND:KEY=VALUE,...`` as the table [drive] of a scenario; None where none is given.

    Raises:
        InputError: it is something else.
    """
    if text is None:
        return None
    kind, _, rest = text.partition(":")
    found: dict[str, object] = {"kind": kind}
    given = ["kind"]
    for part in filter(None, rest.split(",")):
        if "=" not in part:
            raise InputError(f"--drive: {text!r}: must be KIND or KIND:KEY=VALUE,...")
        name, found_value = parse_assignment(part)
        given.append(name)
        found[name] = float(found_value) if type(found_value) is int else found_value
    refuse_twice(given, f"--drive: {text!r}:")
    return found


def constants(assignments: list[str]) -> dict[str, float | str]:
    """``KEY=VALUE`` as a mapping."""
    found: dict[str, float | str] = {}
    given = [
        (path.removeprefix("law.").removeprefix("parameters."), x) for path, x in map(parse_assignment, assignments)
    ]
    refuse_twice([name for name, _ in given], "--set")
    for name, value in given:
        if isinstance(value, bool) or not isinstance(value, int | float | str):
            raise InputError(f"--set {name}: {shown(value)}: must be a number or a word")
        found[name] = value if isinstance(value, str) else float(value)
    return found


def columns(names: dict[str, str | None], units: list[str], force_gain: str | None) -> ColumnNames:
    """The columns that options name, each by its role, and their units, each as ``COL=UNIT``."""
    given = []
    for text in units:
        column, equals, unit = text.rpartition("=")
        if not equals or not column or not unit:
            raise InputError(f"--unit: {text!r}: must be COL=UNIT, such as pos=mm")
        given.append((column.strip(), unit.strip()))
    refuse_twice([column for column, _ in given], "--unit")
    return ColumnNames({role: name for role, name in names.items() if name is not None}, dict(given), force_gain)


def _print(result: Fit | Choice, log: Log, files: list[str]) -> None:
    if isinstance(result, Choice):
        _print_choice(result)
    elif result.details.get("candidates"):
        _print_candidates(result.details["candidates"])
    best = result.best if isinstance(result, Choice) else result
    left_out = best.cross_validated_error
    beyond = "" if left_out is None else f", on data left out {percent(left_out, 3)}"
    error = f"relative force error {percent(best.relative_force_error, 3)}{beyond}"
    say(f"{best.law}, {best.method}: {len(log)} rows, {error}", 4)
    rows = {**best.estimates, **best.body}
    width = max(map(len, rows), default=4)
    print(f"  {'':{width}}  {'value':>12}  {'95 % interval':>27}  unit")
    for name, e in rows.items():
        if e.identifiable:
            print(f"  {name:{width}}  {digits(e.value):>12}  {_interval(e):>27}  {e.unit}")
    for name, e in rows.items():
        if not e.identifiable:
            say(f"{name}: not determined by the data: {e.doubt}", 6, "  ")
            if e.experiment:
                say(f"to determine it: {e.experiment}", 6, "      ")
    for r in best.details.get("levels", ()):
        at = "".join(f" at {n.removeprefix('F_c_by_')} {x:.4g}" for n, x in r["at"].items())
        told = f", predicted from the others {r['predicted']:.4g}" if "predicted" in r else ""
        say(f"{r['file']}{at}: F_c {r['level']:.4g} ({r['low']:.4g} ... {r['high']:.4g}) N{told}", 6, "  ")
    for text in (*log.quality, *best.notes):
        say(text, 6, "  note: ")
    for file in files:
        print(f"  wrote {file}")


def _print_candidates(candidates: Sequence[Candidate]) -> None:
    told = ", ".join(f"{c['name']} {percent(c['cross_validated_error'], 3)}" for c in candidates)
    print(f"error on data left out: {told}")


def _print_choice(choice: Choice) -> None:
    width = max(map(len, (*choice.fits, *choice.failed)))
    print(f"{'law':{width}}  {'left out':>9}  {'fitted':>9}  numbers")
    for row in choice.table():
        error, whole = row["cross_validated_error"], row["relative_force_error"]
        print(f"{row['law']:{width}}  {percent(error, 3):>9}  {percent(whole, 3):>9}  {row['numbers']}")
    for name, why in choice.failed.items():
        say(said(why, "fit"), 6, f"{name:{width}}  ")
    say(f"picked: {choice.picked}: {choice.reason}", 6)
    print()


def _interval(e: Estimate) -> str:
    return f"{digits(e.low)} ... {digits(e.high)}"

"""``stribeck predict``: a fitted model, or a machine file, against a measured record."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from stribeck.cli import record, show
from stribeck.cli.record import Force, Gain, Load, Position, Pressure, Unit, Velocity
from stribeck.cli.shared import ADVANCED, Json, Out, Trust, Undetermined, app, given_options
from stribeck.errors import InputError
from stribeck.mouth.terminal import say

if TYPE_CHECKING:
    from stribeck.arrays import Array
    from stribeck.identify.data.read import ColumnNames
    from stribeck.identify.predict import Predicted


@app.command(epilog="Example: stribeck predict another.csv --fit fit --out predicted")
def predict(
    context: typer.Context,
    data: Annotated[list[Path], typer.Argument(metavar="DATA...", help="Record that the fit has not used.")],
    fit: Annotated[
        Path | None, typer.Option("--fit", metavar="DIR", help="Folder that 'stribeck fit --out' wrote.")
    ] = None,
    machine: Annotated[
        Path | None,
        typer.Option("--machine", metavar="FILE.toml", help="Simulate this machine file instead of a fit."),
    ] = None,
    time: Annotated[
        str | None, typer.Option("--time", metavar="COL", help="Column of the time; columns are as in the fit unless given.")
    ] = None,
    position: Position = None,
    velocity: Velocity = None,
    force: Force = None,
    force_gain: Gain = None,
    load: Load = None,
    pressure: Pressure = None,
    unit: Unit = None,
    cutoff: Annotated[
        float | None,
        typer.Option(
            "--cutoff", metavar="HZ", rich_help_panel=ADVANCED,
            help="Cut-off frequency of the motion's filter (Hz); as in the fit unless given.",
        ),
    ] = None,
    command: Annotated[
        str | None,
        typer.Option(
            "--command", metavar="COL", rich_help_panel=ADVANCED,
            help="With --machine: column that drove the rig; replaces the file's signal.",
        ),
    ] = None,
    set_: Annotated[
        list[str] | None,
        typer.Option(
            "--set", metavar="PATH=VALUE", rich_help_panel=ADVANCED, help="With --machine: replace a value of the file."
        ),
    ] = None,
    trust: Trust = False,
    out: Out = None,
    json: Json = False,
    _undetermined: Undetermined = False,
) -> int:  # fmt: skip
    """Predict another record by a fit or a machine file: error, overlay and report."""
    _refuse_mixed(given_options(context), fit, machine)
    columns = {
        "time": time, "position": position, "velocity": velocity, "force": force, "load": load, "pressure": pressure,
        "command": command,
    }  # fmt: skip
    of_log = record.columns(columns, unit or [], force_gain)
    if fit is not None:
        return _by_fit(data, fit, of_log, cutoff, out=out, json=json, trust=trust)
    if machine is None or len(data) != 1:
        raise InputError(f"DATA: {len(data)} files: with --machine there must be one")
    return _by_machine(data[0], machine, of_log, set_ or [], out=out, json=json, trust=trust)


_OF_A_FIT = ("load", "pressure", "cutoff")  # options that the simulation of a machine file has no use for
_OF_A_MACHINE = ("command", "set_", "_undetermined")


def _refuse_mixed(given: dict[str, str], fit: Path | None, machine: Path | None) -> None:
    """Refuse options of the other way to predict.

    Raises:
        InputError: a line for each.
    """
    if (fit is None) == (machine is None):
        raise InputError("--fit, --machine: one must be given, and not both")
    other, way = (_OF_A_MACHINE, "--machine") if machine is None else (_OF_A_FIT, "--fit")
    if wrong := [f"{given[name]}: goes with {way}, which is not given" for name in other if name in given]:
        raise InputError(wrong)


def _by_fit(
    data: list[Path], fit: Path, of_log: ColumnNames, cutoff: float | None, *, out: Path | None, json: bool, trust: bool
) -> int:
    """Predict the force by the law that a fit found."""
    from stribeck.identify import api as fitting
    from stribeck.identify import predict as predicting
    from stribeck.identify.data.read import ColumnNames

    model = predicting.load(fit, trust)
    if out is not None:
        show.check_folder(out)
    names = {**model.columns, **of_log.names}
    units = {**{n: u for n, u in model.units.items() if n in names.values()}, **of_log.units}
    gain = of_log.force_gain if of_log.force_gain is not None else model.force_gain
    with show.progress("predict"):
        log = fitting.log_of(data, ColumnNames(names, units, gain), predicting.how_to_read(model, cutoff))
        found = predicting.predict(model, log)
    files = [_page(found, log.time, data, fit, out)] if out is not None else []
    if json:
        about = {"files": [str(p) for p in data], "rows": len(log)}
        show.print_json({**found.to_json(), "notes": found.notes(), "data": about, "files": files})
        return 0
    _tell(found, len(log), files)
    return 0


def _tell(found: Predicted, rows: int, files: list[str]) -> None:
    from stribeck.mouth.cells import percent

    print(f"{found.model.law}, {found.model.method}: {rows} rows, {found.rest:.0%} at rest")
    for name, x in _errors(found).items():
        print(f"  {name:44}{percent(x, 3):>10}")
    for text in found.notes():
        say(text, 4, "  ")
    for file in files:
        print(f"  wrote {file}")


def _errors(found: Predicted) -> dict[str, float | None]:
    rows: dict[str, float | None] = {
        "error of the force, every row in motion": found.force_error,
        "expected by the fit": found.model.expected,
        "the fit's own, on its record": found.model.known.get("relative_force_error"),
        "the fit's, on parts left out of its record": found.model.known.get("cross_validated_error"),
        "error against friction alone": found.friction_error,
        "error of the force, rows at rest too": found.all_rows_error,
        "error of a constant force": found.constant_error,
    }
    if found.beyond and found.beyond.rows:
        rows["error of the force, beyond what was fitted"] = found.beyond.error
        rows["error of the force, within it"] = found.beyond.within
    return {name: x for name, x in rows.items() if x is not None}


def _page(found: Predicted, time: Array, data: list[Path], folder: Path, out: Path) -> str:
    from stribeck.identify.report import overlay
    from stribeck.mouth.cells import percent

    traces = {
        "force": ("N", found.traces.measured, found.traces.fitted),
        "friction": ("N", found.friction.measured, found.friction.fitted),
    }
    law = found.model.law
    introduction = [
        f"The predicted force is off by {percent(found.force_error, 3)}. "
        f"{law}, {found.model.method}, fitted to another record ({folder}), on {len(time)} rows of this one.",
        *found.notes(),
    ]
    rows = [[name, percent(x, 3)] for name, x in _errors(found).items()]
    figures = overlay.figure("prediction", time, traces, ("measured", "predicted"))
    title = f"{law} on {', '.join(p.name for p in data)}"
    return overlay.write_overlay(out, "prediction.html", title, introduction, rows, figures, show.command_line())


def _by_machine(
    data: Path,
    machine: Path,
    columns: ColumnNames,
    assignments: list[str],
    *,
    out: Path | None,
    json: bool,
    trust: bool,
) -> int:
    """Simulate the file with the record's drive, print how far the motion is off."""
    from stribeck.identify import validate as validating
    from stribeck.mouth.cells import human, percent

    if out is not None:
        show.check_folder(out)
    loaded = show.load(machine, assignments, trust)
    with show.progress("predict"):
        found = validating.validate(loaded, data, columns.names, columns.units, columns.force_gain)
    summary = {**found.to_json(), "scenario": loaded.name, "data": str(data)}
    files: list[str] = []
    if out is not None:
        from stribeck.identify.report import overlay

        rows = [
            [name, f"{human(e['rms'], e['unit'])}, {percent(e['relative'], 3)}"] for name, e in found.errors.items()
        ]
        figures = overlay.figure("validation", found.time, found.traces, ("measured", "simulated"))
        off = [
            f"{name} by {human(e['rms'], e['unit'])} (rms), at most {human(e['largest'], e['unit'])}"
            for name, e in found.errors.items()
        ]
        introduction = [
            f"Off: {'; '.join(off)}. {len(found.time)} rows of {data.name} beside the scenario {loaded.name}."
        ]
        command = show.command_line()
        title = f"{loaded.name} against {data.name}"
        files = [overlay.write_overlay(out, "validation.html", title, introduction, rows, figures, command)]
    if json:
        show.print_json({**summary, "files": files})
    else:
        print(f"{loaded.name} against {data.name}: {found.status}, {len(found.time)} rows")
        for name, e in found.errors.items():
            rms, largest = (human(e[each], e["unit"]) for each in ("rms", "largest"))
            print(f"  {name:10} rms {rms}, largest {largest}, relative {percent(e['relative'], 3)}")
        for file in files:
            print(f"  wrote {file}")
    if found.status != "done":
        show.failed(loaded.name, found.reason)
        return 1
    return 0

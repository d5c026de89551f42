"""``stribeck predict``: a fitted model, or a machine file, against a measured record."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from stribeck.cli.options import (
    ADVANCED,
    Json,
    Out,
    Trust,
    Undetermined,
    command,
    given_options,
    load_scenario,
    setting,
)
from stribeck.cli.output import OutputFolder, command_line, failed, tell
from stribeck.cli.progress import progress
from stribeck.cli.record import ColumnsAsFitted, Keywords
from stribeck.errors import InputError, check_all

if TYPE_CHECKING:
    from stribeck.mouth.document import Document


@command("predict", "stribeck predict another.csv --fit fit --out predicted")
def predict(
    context: typer.Context,
    data: Annotated[list[Path], typer.Argument(metavar="DATA", help="Record that the fit has not used.")],
    columns: ColumnsAsFitted,
    fit: Annotated[Path | None, setting("--fit", "DIR", "Folder that 'stribeck fit --out' wrote.")] = None,
    machine: Annotated[
        Path | None,
        setting("--machine", "FILE.toml", "Simulate this machine file instead of a fit."),
    ] = None,
    cutoff: Annotated[
        float | None,
        setting(
            "--cutoff", "HZ", "Cut-off frequency of the motion's filter (Hz); as in the fit unless given.", ADVANCED
        ),
    ] = None,
    set_: Annotated[
        list[str] | None,
        setting("--set", "PATH=VALUE", "With --machine: replace a value of the file.", ADVANCED),
    ] = None,
    trust: Trust = False,
    out: Out = None,
    json: Json = False,
    _undetermined: Undetermined = False,
) -> int:
    """Predict another recording with a fit or a machine file. Print the error; with --out, also write an overlay and a report."""
    from stribeck.scenario import parse_assignments

    _refuse_mixed(given_options(context), fit, machine)
    check_all(columns.given, lambda: parse_assignments(set_ or []))
    given = columns.given()
    if fit is not None:
        return _by_fit(data, fit, given | {"cutoff": cutoff}, out=out, json=json, trust=trust)
    if machine is None or len(data) != 1:
        raise InputError(f"DATA: {len(data)} files: with --machine there must be one")
    return _by_machine(data[0], machine, given, set_ or [], out=out, json=json, trust=trust)


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


def _by_fit(data: list[Path], fit: Path, given: Keywords, *, out: Path | None, json: bool, trust: bool) -> int:
    """Predict the force by the law that a fit found."""
    from stribeck.identify.predict import Predicted
    from stribeck.identify.predict import predict as predicted

    with OutputFolder(out, writes=["prediction.html"]):
        with progress("predict"):
            prediction = predicted(data, fit, trust=trust, **given)
        assert isinstance(prediction, Predicted)
        document = prediction.document()
        files = [] if out is None else _write(document, out, "prediction.html")
    about = {"files": [str(p) for p in data], "rows": len(prediction.force.t)}
    tell(
        lambda: document, {**prediction.to_dict(), "notes": prediction.notes(), "data": about} if json else None, files
    )
    return 0


def _by_machine(
    data: Path,
    machine: Path,
    given: Keywords,
    assignments: list[str],
    *,
    out: Path | None,
    json: bool,
    trust: bool,
) -> int:
    """Simulate the file with the record's drive, print how far the motion is off."""
    from stribeck.identify.predict import predict as predicted
    from stribeck.identify.validate import Validated

    with OutputFolder(out, writes=["validation.html"]):
        loaded = load_scenario(machine, assignments, trust)
        with progress("predict"):
            comparison = predicted(data, machine=loaded, **given)
        assert isinstance(comparison, Validated)
        document = comparison.document()
        files = [] if out is None else _write(document, out, "validation.html")
    summary = {**comparison.to_dict(), "scenario": loaded.name, "data": str(data)}
    tell(lambda: document, summary if json else None, files)
    if not comparison.success:
        failed(loaded.name, comparison.reason)
        return 1
    return 0


def _write(document: Document, folder: Path, name: str) -> list[str]:
    """Write the page under a name; its path."""
    from stribeck.files import together
    from stribeck.mouth import page

    with together(folder, last=name) as place:
        page.write(document, place, command_line(), name, pictures=False)
    return [str(folder / name)]

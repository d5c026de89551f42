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
from stribeck.cli.output import command_line, failed, output_folder, tell
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
        Path | None, setting("--machine", "FILE.toml", "Simulate this machine file instead of a fit.")
    ] = None,
    cutoff: Annotated[
        float | None,
        setting(
            "--cutoff", "HZ", "Cut-off frequency of the motion's filter (Hz); as in the fit unless given.", ADVANCED
        ),
    ] = None,
    set_: Annotated[
        list[str] | None, setting("--set", "PATH=VALUE", "With --machine: replace a value of the file.", ADVANCED)
    ] = None,
    trust: Trust = False,
    out: Out = None,
    json: Json = False,
    _undetermined: Undetermined = False,
) -> int:
    """Predict another recording with a fit or a machine file. Print the error; with --out, also write an overlay and a report."""
    from stribeck.identify.predict import predict as predicted
    from stribeck.identify.validate import Validated
    from stribeck.scenario import parse_assignments

    _refuse_mixed(given_options(context), fit=fit, machine=machine)
    check_all(columns.given, lambda: parse_assignments(set_ or []))
    if machine is not None and len(data) != 1:
        raise InputError(f"DATA: {len(data)} files: with --machine there must be one")
    name = "prediction.html" if machine is None else "validation.html"
    with output_folder(out, writes=[name]):
        loaded = None if machine is None else load_scenario(machine, set_ or [], trust=trust)
        how: Keywords = {"fit": fit, "cutoff": cutoff, "trust": trust} if loaded is None else {"machine": loaded}
        with progress("predict"):
            result = predicted(data if loaded is None else data[0], **how, **columns.given())
        document = result.document()
        files = [] if out is None else _write(document, out, name)
    if isinstance(result, Validated):
        more = {"scenario": how["machine"].name, "data": str(data[0])}
    else:
        about = {"files": [str(p) for p in data], "rows": len(result.force.t)}
        more = {"notes": result.notes(), "data": about}
    tell(lambda: document, {**result.to_dict(), **more} if json else None, files)
    if isinstance(result, Validated) and result.reason is not None:
        failed(how["machine"].name, result.reason)
        return 1
    return 0


_OF_A_FIT = ("load", "pressure", "cutoff")  # options that the simulation of a machine file has no use for
_OF_A_MACHINE = ("command", "set_", "_undetermined")


def _refuse_mixed(given: dict[str, str], *, fit: Path | None, machine: Path | None) -> None:
    """Refuse options of the other way to predict.

    Raises:
        InputError: a line for each.
    """
    if (fit is None) == (machine is None):
        raise InputError("--fit, --machine: one must be given, and not both")
    other, way = (_OF_A_MACHINE, "--machine") if machine is None else (_OF_A_FIT, "--fit")
    if wrong := [f"{given[name]}: goes with {way}, which is not given" for name in other if name in given]:
        raise InputError(wrong)


def _write(document: Document, folder: Path, name: str) -> list[str]:
    """Write the page under a name; its path."""
    from stribeck.files import together
    from stribeck.mouth import page

    with together(folder, last=name) as place:
        page.write(document, place, command_line(), name, pictures=False)
    return [str(folder / name)]

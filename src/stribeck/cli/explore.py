"""``stribeck explore``."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from stribeck.cli.options import Json, Set, Trust, Undetermined, command, place
from stribeck.cli.output import check_file, command_line, tell
from stribeck.cli.progress import progress
from stribeck.errors import InputError

if TYPE_CHECKING:
    from stribeck.mouth.document import Document


@command("explore", "stribeck explore my_rig.toml --out my_rig.html")
def explore(
    what: Annotated[
        str | None,
        typer.Argument(
            metavar="[SCENARIO.toml | LAW]", help="Scenario file, or a law for the built-in stick-slip run."
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="FILE.html", parser=place, help="Page to write; NAME.html unless given."),
    ] = None,
    law: Annotated[
        list[str] | None,
        typer.Option("--law", metavar="NAME", help="Law to offer beside the scenario's own; every law unless given."),
    ] = None,
    report: Annotated[
        Path | None, typer.Option("--report", metavar="DIR", help="Folder of a run or fit that gets the page.")
    ] = None,
    set_: Set = None,
    trust: Trust = False,
    json: Json = False,
    _undetermined: Undetermined = False,
) -> int:
    """Write a page that simulates the scenario in a browser while you turn its numbers."""
    from stribeck.explore import explore as write
    from stribeck.explore.beside import Report
    from stribeck.explore.report import of_folder
    from stribeck.explore.variants import subject
    from stribeck.scenario import parse_assignments

    changes = parse_assignments(set_ or [])
    if report is not None and what is not None:
        raise InputError(
            f"--report: {str(report)!r}: must stand alone: the folder holds the scenario ({what} is given too)"
        )
    made = Report(subject(what, changes, trust)) if report is None else of_folder(report, changes, trust)
    scenario = made.scenario
    if out is None:
        out = report / "explore.html" if report is not None else Path(f"{_file_name(scenario.name)}.html")
    if out.is_dir():
        raise InputError(f"--out: {str(out)!r}: is a folder; must be a file, such as {out / 'explore.html'}")
    check_file("--out", out, *([Path(what)] if what is not None else []))
    with progress("writing the page") as share:
        write(scenario, out, law, command_line(), share, made.intervals, made.measured)
    page = out
    data = {"status": "done", "scenario": scenario.name}
    tell(lambda: _document(scenario.name, page), data if json else None, [str(out)])
    return 0


def _document(name: str, page: Path) -> Document:
    from stribeck.mouth.document import Document

    return Document(name, f"a page of {page.stat().st_size / 1e6:.2f} MB that needs no network; open it in a browser")


def _file_name(name: str) -> str:
    return re.sub(r"[^\w.-]+", "_", name).strip("._") or "explore"

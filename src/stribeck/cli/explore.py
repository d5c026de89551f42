"""``stribeck explore``."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated

import typer

from stribeck.cli import show
from stribeck.cli.shared import Json, Set, Trust, Undetermined, app, place
from stribeck.errors import InputError


@app.command(epilog="Example: stribeck explore my_rig.toml --out my_rig.html")
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
    show.check_file("--out", out, *([Path(what)] if what is not None else []))
    with show.progress("writing the page") as tell:
        write(scenario, out, law, show.command_line(), tell, made.intervals, made.measured)
    if json:
        show.print_json({"status": "done", "scenario": scenario.name, "files": [str(out)]})
    else:
        print(f"{scenario.name}: open {out} in a browser ({out.stat().st_size / 1e6:.2f} MB, it needs no network)")
    return 0


def _file_name(name: str) -> str:
    return re.sub(r"[^\w.-]+", "_", name).strip("._") or "explore"

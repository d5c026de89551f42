"""``stribeck explore``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from stribeck.cli.options import Json, Set, Trust, Undetermined, command, output_path, setting
from stribeck.cli.output import check_file, command_line, tell
from stribeck.cli.progress import progress

if TYPE_CHECKING:
    from stribeck.mouth.document import Document


@command("explore", "stribeck explore my_rig.toml --out my_rig.html")
def explore(
    what: Annotated[
        str | None,
        typer.Argument(metavar="SCENARIO.toml|LAW", help="Scenario file, or a law for the built-in stick-slip run."),
    ] = None,
    out: Annotated[
        Path | None, setting("--out", "FILE.html", "Page to write; NAME.html unless given.", parser=output_path)
    ] = None,
    law: Annotated[
        list[str] | None, setting("--law", "NAME", "Law to offer beside the scenario's own; every law unless given.")
    ] = None,
    set_: Set = None,
    trust: Trust = False,
    json: Json = False,
    _undetermined: Undetermined = False,
) -> int:
    """Write a page that simulates a scenario in the browser. Sliders change its parameters."""
    from stribeck.explorer import explore as write
    from stribeck.explorer.variants import subject
    from stribeck.scenario import parse_assignments

    scenario = subject(what, parse_assignments(set_ or []), trust=trust)
    if out is not None:
        check_file("--out", out, *([Path(what)] if what is not None else []))
    with progress("writing the page") as share:
        page = write(scenario, out=out, law=law, command=command_line(), progress=share)
    data = {"status": "done", "scenario": scenario.name}
    tell(lambda: _document(scenario.name, page), data if json else None, [str(page)])
    return 0


def _document(name: str, page: Path) -> Document:
    from stribeck.mouth.document import Document

    return Document(name, f"a page of {page.stat().st_size / 1e6:.2f} MB that needs no network; open it in a browser")

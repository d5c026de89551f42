"""The commands that simulate or show a scenario, or write one to start from."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from stribeck.cli.shared import Json, Set, Trust, Undetermined, app, place


@app.command(epilog="Example: stribeck new my_rig")
def new(
    name: Annotated[
        str, typer.Argument(metavar="[NAME]", help="A name for it, or that of a built-in example.")
    ] = "my_rig",
    out: Annotated[
        Path | None, typer.Option("--out", metavar="FILE", parser=place, help="Where to; NAME.toml unless given.")
    ] = None,
    examples: Annotated[bool, typer.Option("--list", help="List the built-in examples.")] = False,
    schema: Annotated[
        bool, typer.Option("--schema", help="Write the JSON Schema with which editors complete and check such files.")
    ] = False,
) -> int:
    """Write a commented scenario file to start from."""
    from stribeck.cli import new as command

    return command.new(name, out, examples, schema)


@app.command(epilog="Example: stribeck explore my_rig.toml --out my_rig.html")
def explore(
    what: Annotated[
        str | None,
        typer.Argument(
            metavar="[SCENARIO.toml | LAW]", help="A scenario file, or a law in the built-in stick-slip run."
        ),
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="FILE.html", parser=place, help="The page; NAME.html unless given.")
    ] = None,
    law: Annotated[
        list[str] | None,
        typer.Option("--law", metavar="NAME", help="Offer this law beside the scenario's own; every law unless given."),
    ] = None,
    report: Annotated[
        Path | None, typer.Option("--report", metavar="DIR", help="Add the page to a run's or fit's folder.")
    ] = None,
    set_: Set = None,
    trust: Trust = False,
    json: Json = False,
    _undetermined: Undetermined = False,
) -> int:
    """Write a page that simulates the scenario in a browser while its numbers are turned; it needs no network."""
    from stribeck.cli import explore as command

    return command.explore(what, out, law, report, set_ or [], trust, json)

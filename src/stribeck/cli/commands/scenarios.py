"""``stribeck new`` and its options."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from stribeck.cli.shared import app, place


@app.command(epilog="Example: stribeck new my_rig")
def new(
    name: Annotated[
        str, typer.Argument(metavar="[NAME]", help="Name of the file, or of a built-in example.")
    ] = "my_rig",
    out: Annotated[
        Path | None, typer.Option("--out", metavar="FILE", parser=place, help="File to write; NAME.toml unless given.")
    ] = None,
    examples: Annotated[bool, typer.Option("--list", help="List the built-in examples.")] = False,
    schema: Annotated[
        bool,
        typer.Option("--schema", help="Write the JSON Schema, with which editors complete and check scenario files."),
    ] = False,
) -> int:
    """Write a commented scenario file to start from."""
    from stribeck.cli import new as command

    return command.new(name, out, examples, schema)

"""``stribeck import``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from stribeck.cli.options import command, output_path, setting
from stribeck.cli.output import check_file, wrote
from stribeck.constants import show
from stribeck.errors import InputError


@command("import", "stribeck import bam m4.json --out servo.toml")
def import_(
    kind: Annotated[str, typer.Argument(metavar="KIND", help="Format of FILE: bam, friction models m1 to m6 as JSON.")],
    file: Annotated[Path, typer.Argument(metavar="FILE", help="File to read.")],
    out: Annotated[
        Path | None, setting("--out", "FILE", "File to write; printed unless given.", parser=output_path)
    ] = None,
) -> int:
    """Convert a machine from another program's file."""
    import tomli_w

    from stribeck.errors import printable
    from stribeck.exports import exchange
    from stribeck.files import write_text
    from stribeck.scenario import Scenario

    if kind != "bam":
        raise InputError(f"KIND: {show(kind)}: must be bam")
    if out is not None:
        check_file("--out", out, file)
    tables = exchange.from_bam(file)
    Scenario(tables)  # what is written is valid
    text = f"# From {printable(file.name)}, by stribeck import {kind}\n" + tomli_w.dumps(tables)
    if out is None:
        print(text, end="")
    else:
        write_text(out, text)
        wrote([out])
    return 0

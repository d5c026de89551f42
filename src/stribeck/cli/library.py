"""``stribeck library``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from stribeck.cli.options import Json, command, output_path, setting
from stribeck.cli.output import check_file, print_json
from stribeck.errors import InputError

if TYPE_CHECKING:
    from stribeck.laws.library import Library


@command("library", "stribeck library mx106 --out mx106.toml")
def library(
    name: Annotated[
        list[str] | None, typer.Argument(metavar="NAME", help="Law, FILE.py:NAME, parameter set or machine.")
    ] = None,
    out: Annotated[
        Path | None, setting("--out", "FILE.toml", "Write the named machine as a scenario file.", parser=output_path)
    ] = None,
    json: Json = False,
) -> int:
    """List friction laws, parameter sets and machines. With a NAME, show its details and source."""
    from stribeck.laws import library as shelf

    selection = shelf.library(*(name or ()))
    files = [] if out is None else [_write(selection, name or [], out)]
    if json:
        print_json(selection.to_dict())
        return 0
    documents = selection.documents() if name else [selection.document()]
    from stribeck.mouth import terminal

    for i, document in enumerate(documents):
        if i:
            print()
        terminal.tell(document, files if i == len(documents) - 1 else ())
    return 0


def _write(selection: Library, names: list[str], out: Path) -> str:
    """Write the machine as a scenario file, with its source above; its path.

    Raises:
        InputError: not exactly one machine is named, or the file cannot be written.
    """
    import tomli_w

    from stribeck.files import write_text
    from stribeck.scenario import Scenario

    if len(names) != 1 or len(selection.machines) != 1:
        raise InputError(f"--out: needs the NAME of one machine, not {', '.join(names) or 'none'}")
    check_file("--out", out, new=True)
    (machine,) = selection.machines.values()
    Scenario(dict(machine.machine))  # a file that is written can be run
    words = ("title", "source", "record", "license", "date")
    about = "".join(f"# {word}: {getattr(machine, word)}\n" for word in words)
    write_text(out, about + tomli_w.dumps(dict(machine.machine)))
    return str(out)

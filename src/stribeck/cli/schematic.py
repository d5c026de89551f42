"""``stribeck show``."""

from __future__ import annotations

from pathlib import Path

from stribeck.cli import show
from stribeck.errors import InputError
from stribeck.scenario.counterpart import as_machine


def draw(path: Path, out: Path | None, assignments: list[str], json: bool, trust: bool) -> int:
    """Draw the machine as text, and as a picture with --out."""
    from stribeck.files import write_text
    from stribeck.report import schematic

    scenario = as_machine(show.load(path, assignments, trust))
    files = []
    if out is not None:
        if out.suffix != ".svg":
            raise InputError(f"--out: {str(out)!r}: must end in .svg")
        show.check_file("--out", out, path)
        write_text(out, schematic.svg(scenario.rig, scenario.name))
        files.append(str(out))
    if json:
        show.print_json({"scenario": scenario.name, **schematic.describe(scenario.rig), "files": files})
        return 0
    print(schematic.text(scenario.rig, scenario.name))
    for file in files:
        print(f"wrote {file}")
    return 0

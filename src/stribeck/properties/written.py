"""The files of ``stribeck check --out``: counterexamples as scenarios, a page and its pictures."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from stribeck.errors import left_out, unbroken
from stribeck.files import together, write_text
from stribeck.mouth import page
from stribeck.properties.verdicts import Verdicts

if TYPE_CHECKING:
    from stribeck.properties.ports import MachineVerdicts

# Files of an older check: scenarios that begin as in _scenarios, and pictures, which have known names.
_OLDER = {"*.toml": r"# \S+ is not \w+: ", "*not_*.svg": ""}


def write_check(verdicts: Verdicts | MachineVerdicts, folder: Path, command: str = "") -> list[str]:
    """Write the counterexamples, the pictures and, last, the page; returns the paths."""
    with together(folder, last="report.html", older=_OLDER) as place:
        if isinstance(verdicts, Verdicts):
            files = _scenarios(verdicts, place)
        else:
            files = [path for name, v in verdicts.contacts.items() for path in _scenarios(v, place, f"{name}_")]
        with left_out("the page"):
            files += page.write(verdicts.document(), place, command)
    return [str(folder / file.name) for file in files]


def _scenarios(verdicts: Verdicts, place: Path, prefix: str = "") -> list[Path]:
    """A scenario for each counterexample that can be simulated."""
    from tomli_w import dumps

    files = []
    for name, verdict in verdicts.properties.items():
        if verdict.holds is False and verdict.scenario is not None:
            files.append(place / f"{prefix}{name}.toml")
            lines = [unbroken(f"# {verdicts.law.name} is not {name}: {verdict.method}")]
            lines += [f"# at the end: {n} = {value!r}" for n, value in verdict.evidence.get("replay", {}).items()]
            write_text(files[-1], "\n".join([*lines, dumps(verdict.scenario)]))
    return files

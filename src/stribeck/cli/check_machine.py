"""``stribeck check --scenario``."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite
from pathlib import Path

from stribeck.cli import show
from stribeck.cli.check import FilesWritten, print_verdicts, refuse_v_max, write_scenarios
from stribeck.cli.text import say
from stribeck.constants import SHOWN
from stribeck.errors import InputError, left_out
from stribeck.properties.ports import MachineVerdicts, check_machine

_BESIDE = 13


def check(
    file: Path, assignments: list[str], v_max: float | None, forces: list[str], json: bool, trust: bool, verify: bool,
    out: Path | None, certificate: Path | None, alien: Mapping[str, object],
) -> int:  # fmt: skip
    """Check every contact of a machine and print what follows; 0 whatever the verdicts are."""
    if problems := [f"{name}: must be left out: --scenario says it" for name, x in alien.items() if x]:
        raise InputError(problems)
    refuse_v_max(v_max)
    stated = _forces(forces)
    scenario = show.load(file, assignments, trust)
    if out is not None:
        show.check_folder(out)
    if certificate is not None:
        show.check_file("--certificate", certificate, file)
    found = check_machine(scenario, v_max, stated)
    if verify:
        found.verify()
    data = found.to_json()
    data["forces"] = stated
    written = FilesWritten()
    if out is not None:
        with written.whole(out) as place:
            written.files = [
                path
                for name, verdicts in found.contacts.items()
                for path in write_scenarios(verdicts, place, f"{name}_")
            ]
            with left_out("the page"):
                from stribeck.report import check_machine as report

                written.pages = report.write_machine_check(found, scenario, place, show.command_line())
    if certificate is not None:
        written.certify(certificate, found.certificates())
    if json:
        show.print_json(data | written.to_json())
    else:
        _print(found)
        written.tell()
    return 0


def _forces(texts: list[str]) -> dict[str, float]:
    """NAME=MAX as numbers."""
    found: dict[str, float] = {}
    for text in texts:
        name, sign, size = text.partition("=")
        try:
            value = float(size)
        except ValueError:
            value = float("nan")
        if not (name and sign and isfinite(value) and value >= 0):
            raise InputError(f"--force: {text!r}: must be NAME=MAX, a link, load or motor and a finite number >= 0")
        found[name] = value
    return found


def _print(found: MachineVerdicts) -> None:
    for name, verdicts in found.contacts.items():
        print_verdicts(verdicts, f"{name}: ")
    say(f"passive at its ports: {SHOWN[found.passive]}: {found.why}", 4, f"{found.name}: ")
    for path, what in found.ports.items():
        say(f"{path}: {what}", _BESIDE, "  port       ")

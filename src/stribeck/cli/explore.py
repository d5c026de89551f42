"""``stribeck explore``."""

from __future__ import annotations

import re
from pathlib import Path

from stribeck.cli import show
from stribeck.errors import InputError
from stribeck.explore import explore as write
from stribeck.explore.beside import Report
from stribeck.explore.report import of_folder
from stribeck.explore.variants import subject
from stribeck.scenario import parse_assignments


def explore(
    what: str | None, out: Path | None, laws: list[str] | None, report: Path | None, assignments: list[str],
    trust: bool, json: bool,
) -> int:  # fmt: skip
    """Write the page, say where it is."""
    changes = parse_assignments(assignments)
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
        write(scenario, out, laws, show.command_line(), tell, made.intervals, made.measured)
    if json:
        show.print_json({"status": "done", "scenario": scenario.name, "files": [str(out)]})
    else:
        print(f"{scenario.name}: open {out} in a browser ({out.stat().st_size / 1e6:.2f} MB, it needs no network)")
    return 0


def _file_name(name: str) -> str:
    return re.sub(r"[^\w.-]+", "_", name).strip("._") or "explore"

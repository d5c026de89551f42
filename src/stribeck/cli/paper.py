"""``stribeck paper``."""

from __future__ import annotations

from pathlib import Path

from stribeck import paper as report
from stribeck.cli import show


def paper(out: Path, json: bool) -> int:
    """Write the report and say which file to open."""
    show.check_folder(out)
    with show.stages("report") as tell:
        summary = report.write(out, tell, show.command_line())
    if json:
        show.print_json(summary)
    else:
        print(f"open {summary['files'][0]}")
    return 0

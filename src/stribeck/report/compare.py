"""The files of ``stribeck compare --out``."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from stribeck.analysis.comparison import Comparison
from stribeck.files import together, write_json, write_text
from stribeck.report import plots
from stribeck.report.files import write_table

_LONGEST = 100  # characters of a label in a file's name


def write(comparison: Comparison, folder: Path, summary: dict[str, Any]) -> list[str]:
    """Write a trajectory for each law, compare.svg and, last, summary.json with the deviations; the paths."""
    paths: list[Path] = []
    with together(folder) as place:
        for i, (label, solution) in enumerate(comparison.solutions.items()):
            name = re.sub(r"[^A-Za-z0-9_.=+-]+", "_", label).strip("_")
            paths += write_table(solution, place, f"{i}_{name[:_LONGEST]}")
        paths.append(place / "compare.svg")
        write_text(paths[-1], plots.overview(comparison.solutions))
        paths.append(place / "summary.json")
        files = [str(folder / path.name) for path in paths]
        write_json(paths[-1], {**summary, "files": files})
    return files

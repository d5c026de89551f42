"""The files of ``stribeck compare --out``."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from stribeck.analysis.comparison import Comparison
from stribeck.files import write_json, write_text
from stribeck.report import plots
from stribeck.report.files import write_table


def write(comparison: Comparison, folder: Path, summary: dict[str, Any]) -> list[str]:
    """Write a trajectory for each law, compare.svg and, last, summary.json with the deviations; the paths."""
    paths: list[Path] = []
    for i, (label, solution) in enumerate(comparison.solutions.items()):
        paths += write_table(solution, folder, f"{i}_{re.sub(r'[^A-Za-z0-9_.=+-]+', '_', label).strip('_')}")
    paths.append(folder / "compare.svg")
    write_text(paths[-1], plots.overview(comparison.solutions))
    paths.append(folder / "summary.json")
    files = [str(path) for path in paths]
    write_json(paths[-1], {**summary, "files": files})
    return files

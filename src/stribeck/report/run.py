"""The files of ``stribeck run --out``."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from stribeck.files import together, write_json, write_text
from stribeck.report import plots
from stribeck.report.files import write_table
from stribeck.simulation import Solution


def write(solution: Solution, folder: Path, summary: dict[str, Any]) -> list[str]:
    """Write trajectory.csv and .parquet, plot.svg and, last, summary.json; the paths."""
    with together(folder) as place:
        paths = write_table(solution, place, "trajectory")
        paths.append(place / "plot.svg")
        write_text(paths[-1], plots.overview({solution.scenario.law.name: solution}))
        paths.append(place / "summary.json")
        files = [str(folder / path.name) for path in paths]
        write_json(paths[-1], {**summary, "files": [*summary["files"], *files]})
    return files

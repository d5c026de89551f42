"""The files of ``stribeck run --out``."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from stribeck.errors import left_out
from stribeck.files import together, write_json
from stribeck.report import chapters
from stribeck.report.files import write_figure, write_table
from stribeck.report.overview import overview
from stribeck.report.page import FigureSvg
from stribeck.simulation import Solution


def write(solution: Solution, folder: Path, summary: dict[str, Any], command: str = "") -> list[str]:
    """Write trajectory.csv and .parquet, plot.svg, .png and .pdf, report.html and, last, summary.json; the paths."""
    with together(folder) as place:
        paths = write_table(solution, place, "trajectory")
        with left_out("the plot and the page"):
            figure = overview({solution.scenario.label: solution})
            paths += write_figure(figure, place)
            paths.append(_page(solution, figure, place, command))
        paths.append(place / "summary.json")
        files = [str(folder / path.name) for path in paths]
        write_json(paths[-1], {**summary, "files": [*summary["files"], *files]})
    return files


def _page(solution: Solution, figure: FigureSvg, folder: Path, command: str) -> Path:
    scenario = solution.scenario
    about = f"Law {scenario.law.name}, drive {scenario.drive.kind}" if scenario.rig is None else scenario.subject
    found = [
        chapters.result(solution), *chapters.plots([figure]), *chapters.of_laws(scenario), chapters.of_scenario(scenario),
    ]  # fmt: skip
    return chapters.write_page(
        folder, scenario.name, [f"{about[0].upper()}{about[1:]}: {solution.status}."], found, command
    )

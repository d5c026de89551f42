"""The files of ``stribeck run --out``."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from stribeck.errors import left_out
from stribeck.files import write_json
from stribeck.report import chapters
from stribeck.report.files import write_figure, write_table
from stribeck.report.overview import overview
from stribeck.report.page import FigureSvg
from stribeck.simulation import Solution


def write(solution: Solution, folder: Path, summary: dict[str, Any], command: str = "") -> list[str]:
    """Write trajectory.csv and .parquet, plot.svg, .png and .pdf, report.html and, last, summary.json; the paths."""
    paths = write_table(solution, folder, "trajectory")
    with left_out("the plot and the page"):
        rig = solution.scenario.rig
        figure = overview({solution.scenario.name if rig is not None else solution.scenario.law.name: solution})
        paths += write_figure(figure, folder)
        paths.append(_page(solution, figure, folder, command))
    paths.append(folder / "summary.json")
    files = [str(path) for path in paths]
    write_json(paths[-1], {**summary, "files": [*summary["files"], *files]})
    return files


def _page(solution: Solution, figure: FigureSvg, folder: Path, command: str) -> Path:
    scenario = solution.scenario
    if scenario.rig is None:
        introduction = [f"Law {scenario.law.name}, drive {scenario.drive.kind}: {solution.status}."]
        laws = [chapters.of_law(scenario.law)]
    else:
        contacts = scenario.rig.machine.contacts
        introduction = [f"{len(contacts)} contacts with friction: {solution.status}."]
        laws = [
            chapters.of_law(scenario.rig.laws[c.law_path], f"law-{i}", f" of {c.name}") for i, c in enumerate(contacts)
        ]
    found = [chapters.result(solution), *chapters.plots([figure]), *laws, chapters.of_scenario(scenario)]
    return chapters.write_page(folder, scenario.name, introduction, found, command)

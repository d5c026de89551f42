"""The files of ``stribeck run --out``."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from stribeck.errors import left_out
from stribeck.files import finite, seen_from, together, write_json
from stribeck.report import chapters
from stribeck.report.files import write_figure, write_table
from stribeck.report.overview import overview
from stribeck.report.page import FigureSvg
from stribeck.report.quantities import human
from stribeck.simulation import Solution


def write_run(solution: Solution, folder: Path, summary: dict[str, Any], command: str = "") -> list[str]:
    """Write trajectory.csv and .parquet, plot.svg, .png and .pdf, report.html and, last, summary.json; the paths."""
    with together(folder) as place:
        paths = write_table(solution, place, "trajectory")
        with left_out("the plot and the page"):
            figure = overview({solution.scenario.label: solution})
            paths += write_figure(figure, place)
            paths.append(_page(solution, figure, place, command))
        paths.append(place / "summary.json")
        files = [str(folder / path.name) for path in paths]
        tables = {"tables": finite(solution.scenario.data), "folder": seen_from(folder, solution.scenario.folder)}
        write_json(paths[-1], {**summary, "files": [*summary["files"], *files], **tables})
    return files


def _in_short(solution: Solution) -> str:
    """What happened, in one line and in units that a person would use."""
    if not solution.scenario.rig.single:
        told = ", ".join(f"{c.name} up to {human(solution.peaks[c.name], c.unit)}" for c in solution.columns[:4])
        return f"Largest magnitudes: {told}."
    slips = solution.events["slip"]
    moves = f"{'Turns' if solution.scenario.rotary else 'Moves'} up to {human(solution.peaks['y'], solution.columns[0].unit)}"
    if len(slips) > 3:
        last = np.diff(slips[-21:])
        return f"Sticks and slips {len(slips)} times, lately every {human(float(np.mean(last)), 's')}. {moves}."
    if len(slips):
        times = "once, at" if len(slips) == 1 else f"{len(slips)} times, first at"
        return f"Slips {times} t = {human(float(slips[0]), 's')}. {moves}."
    return f"{moves}; |v| never passes v_s."


def _page(solution: Solution, figure: FigureSvg, folder: Path, command: str) -> Path:
    scenario = solution.scenario
    about = f"Law {scenario.law.name}, drive {scenario.drive.kind}" if scenario.rig.single else scenario.subject
    found = [
        chapters.result(solution), *chapters.plots([figure]), *chapters.of_laws(scenario), chapters.of_scenario(scenario),
    ]  # fmt: skip
    return chapters.write_page(
        folder,
        scenario.name,
        [_in_short(solution), f"{about[0].upper()}{about[1:]}: {solution.status}."],
        found,
        command,
    )

"""The files of ``stribeck run --out`` under several laws."""

from __future__ import annotations

import re
from pathlib import Path

from stribeck.errors import left_out
from stribeck.files import together
from stribeck.report import chapters, overview
from stribeck.report.cells import percent
from stribeck.report.files import write_figure, write_summary, write_table
from stribeck.report.page import Chapter, FigureSvg, Table
from stribeck.report.quantities import human
from stribeck.simulation.comparison import Comparison, compared

_LONGEST = 100  # characters of a label in a file's name


def write_comparison(comparison: Comparison, folder: Path, summary: dict[str, object], command: str = "") -> list[str]:
    """Write a trajectory for each law, compare.svg, .png and .pdf, report.html and, last, summary.json with the
    deviations; the paths."""
    paths: list[Path] = []
    with together(folder) as place:
        for i, (label, solution) in enumerate(comparison.solutions.items()):
            name = re.sub(r"[^A-Za-z0-9_.=+-]+", "_", label).strip("_")
            paths += write_table(solution, place, f"{i}_{name[:_LONGEST]}")
        with left_out("the plot and the page"):
            figure = overview.comparison(comparison.solutions)
            paths += write_figure(figure, place)
            paths.append(_page(comparison, figure, place, command))
        return write_summary(paths, place, folder, summary)


def _page(comparison: Comparison, figure: FigureSvg, folder: Path, command: str) -> Path:
    reference = next(iter(comparison.solutions))
    names = compared(comparison.solutions[reference].scenario)
    units = {c.name: c.unit for c in comparison.solutions[reference].columns}
    rows = [
        [label, *(cell for n in names for cell in (f"{d[n]['max']:.4g}", percent(d[n]["max_relative"])))]
        for label, d in comparison.deviations.items()
    ]
    head = ["law", *(cell for n in names for cell in (f"{n} ({units[n]})", "of its peak"))]
    text = [f"The largest deviation from {reference} over the rows that both reached."]
    if failed := [f"{label} failed: {s.reason}." for label, s in comparison.solutions.items() if s.reason]:
        text += failed
    slips = [
        [label, str(chapters.slips(s)), *(f"{s.peaks[n]:.6g}" for n in names), str(s.stats["accepted"])]
        for label, s in comparison.solutions.items()
    ]
    about = Table(["law", "slips", *(f"largest {n} ({units[n]})" for n in names), "steps"], slips)
    found = [Chapter("deviations", "Deviations", text, [Table(head, rows), about]), *chapters.plots([figure])]
    if comparison.solutions[reference].scenario.rig.single:
        found += [chapters.of_law(s.scenario.law, f"law-{i}") for i, s in enumerate(comparison.solutions.values())]
    else:
        found += chapters.of_laws(comparison.solutions[reference].scenario)
    introduction = [_in_short(comparison, reference, names[0], units[names[0]])]
    return chapters.write_page(
        folder, f"{comparison.name}: {len(comparison.solutions)} laws", introduction,
        [*found, chapters.of_scenario(comparison.solutions[reference].scenario)], command,
    )  # fmt: skip


def _in_short(comparison: Comparison, reference: str, name: str, unit: str) -> str:
    """How far the others are from the reference, in one line and in units that a person would use."""
    told = []
    for label, columns in comparison.deviations.items():
        largest, share = columns[name]["max"], columns[name]["max_relative"]
        told.append(
            f"{label} by up to {'?' if largest is None else human(largest, unit)} ({percent(share)} of its peak)"
        )
    return f"From {reference}, {name} differs: {', '.join(told)}." if told else f"{reference} alone."

"""Runs as files: tables of their columns, the page, and summary.json."""

from __future__ import annotations

import re
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from stribeck.errors import left_out
from stribeck.files import arrow_array, finite, parquet_of, seen_from, together, write_summary, write_with
from stribeck.mouth import page
from stribeck.simulation.solution import Solution

if TYPE_CHECKING:
    from stribeck.simulation.comparison import Comparison

RUN = ("trajectory.csv", "trajectory.parquet", "plot.svg", "report.html", "summary.json")
COMPARISON = ("compare.svg", "report.html", "summary.json")
_LONGEST = 100  # characters of a label in a file's name, which file systems limit to 255 bytes


def write_run(solution: Solution, folder: Path, summary: dict[str, Any], command: str = "") -> list[str]:
    """Write trajectory.csv and .parquet, plot.svg, report.html and, last, summary.json; returns the paths."""
    with together(folder) as place:
        paths = write_table(solution, place, "trajectory")
        with left_out("the plot and the page"):
            paths += page.write(solution.document(), place, command)
        tables = {"tables": finite(solution.scenario.data), "folder": seen_from(folder, solution.scenario.folder)}
        return write_summary(paths, place, folder, summary, tables)


def write_comparison(comparison: Comparison, folder: Path, summary: dict[str, Any], command: str = "") -> list[str]:
    """Write a trajectory for each law, compare.svg, report.html and, last, summary.json with the
    deviations; returns the paths."""
    paths: list[Path] = []
    with together(folder) as place:
        for i, (label, solution) in enumerate(comparison.solutions.items()):
            name = re.sub(r"[^A-Za-z0-9_.=+-]+", "_", label).strip("_")
            paths += write_table(solution, place, f"{i}_{name[:_LONGEST]}")
        with left_out("the plot and the page"):
            paths += page.write(comparison.document(), place, command)
        return write_summary(paths, place, folder, summary)


def write_table(solution: Solution, folder: Path, stem: str) -> list[Path]:
    """Write the columns as ``stem.csv`` (full double precision) and ``stem.parquet`` (units in the metadata).

    Without pyarrow there is no Parquet file, and a note reports it. Returns the paths.
    """
    paths = [folder / f"{stem}.csv", folder / f"{stem}.parquet"]
    names = ["t", *(column.name for column in solution.columns)]
    write_with(paths[0], lambda beside: write_csv(beside, {name: solution[name] for name in names}))
    with left_out(paths[1].name):
        scenario = solution.scenario
        about = {
            "scenario": scenario.name, "law": scenario.subject.removeprefix("law "), "status": solution.status,
            "reason": solution.reason or "",
        }  # fmt: skip
        columns = [("t", "s", "time"), *((c.name, c.unit, c.meaning) for c in solution.columns)]
        content = parquet_of(((*column, solution[column[0]]) for column in columns), about)
        write_with(paths[1], lambda beside: beside.write_bytes(content))
        return paths
    return paths[:1]


def write_csv(path: Path, columns: dict[str, object]) -> None:
    """Write columns of equal length as CSV, numbers with all digits."""
    with path.open("wb") as file:
        file.write((",".join(columns) + "\n").encode())
        if find_spec("pyarrow") is not None:  # some twenty times faster, with the same numbers
            import pyarrow
            from pyarrow import csv

            arrays = [arrow_array(values) for values in columns.values()]
            table = pyarrow.Table.from_arrays(arrays, names=list(columns))
            csv.write_csv(table, file, csv.WriteOptions(include_header=False, quoting_style="needed"))
        else:
            rows = zip(*(np.asarray(values).tolist() for values in columns.values()), strict=True)
            file.writelines((",".join(map(repr, row)) + "\n").encode() for row in rows)

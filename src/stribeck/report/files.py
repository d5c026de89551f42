"""A solution as files."""

from __future__ import annotations

from collections.abc import Mapping
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from stribeck.errors import left_out, needed
from stribeck.files import arrow_array, write_json, write_parquet, write_text, write_with
from stribeck.report.page import FigureSvg
from stribeck.simulation import Solution


def write_table(solution: Solution, folder: Path, stem: str) -> list[Path]:
    """The solution's columns as ``stem.csv`` (full double precision) and ``stem.parquet`` (units in the metadata).

    Without pyarrow there is no Parquet file, which a note says.
    """
    paths = [folder / f"{stem}.csv", folder / f"{stem}.parquet"]
    names = ["t", *(column.name for column in solution.columns)]
    write_with(paths[0], lambda beside: write_csv(beside, {name: solution[name] for name in names}))
    with left_out(paths[1].name):
        _write_parquet(solution, paths[1])
        return paths
    return paths[:1]


def write_figure(figure: FigureSvg, folder: Path) -> list[Path]:
    """The figure as SVG, PNG and PDF under its name."""
    paths = [folder / f"{figure.name}.{kind}" for kind in ("svg", "png", "pdf")]
    write_text(paths[0], figure.svg)
    for path, data in zip(paths[1:], (figure.png, figure.pdf), strict=True):
        write_with(path, lambda beside, data=data: beside.write_bytes(data))  # type: ignore[misc]
    return paths


def write_summary(paths: list[Path], place: Path, folder: Path, summary: Mapping[str, object]) -> list[str]:
    """Write summary.json in ``place`` beside these files, and with their paths as they will be in ``folder``; the paths."""
    paths.append(place / "summary.json")
    files = [str(folder / path.name) for path in paths]
    write_json(paths[-1], {**summary, "files": files})
    return files


def write_csv(path: Path, columns: dict[str, object]) -> None:
    """Columns of equal length as CSV: numbers with every digit, nothing where there is no number."""
    with path.open("wb") as file:
        file.write((",".join(columns) + "\n").encode())
        if find_spec("pyarrow") is not None:  # some twenty times faster, with the same numbers
            import pyarrow
            from pyarrow import csv

            arrays = [arrow_array(values) for values in columns.values()]
            table = pyarrow.Table.from_arrays(arrays, names=list(columns))
            csv.write_csv(table, file, csv.WriteOptions(include_header=False, quoting_style="needed"))
        else:
            cells = [list(map(_cell, np.asarray(values).tolist())) for values in columns.values()]
            file.writelines((",".join(row) + "\n").encode() for row in zip(*cells, strict=True))


def _cell(value: object) -> str:
    if isinstance(value, str):
        return '"' + value.replace('"', '""') + '"' if any(c in value for c in ',"\n') else value
    return "nan" if value != value else repr(value)


def _write_parquet(solution: Solution, path: Path) -> None:
    with needed("a Parquet file"):
        import pyarrow

    fields = [pyarrow.field("t", pyarrow.float64(), metadata={"unit": "s", "meaning": "time"})]
    fields += [
        pyarrow.field(c.name, pyarrow.float64(), metadata={"unit": c.unit, "meaning": c.meaning})
        for c in solution.columns
    ]
    about = {
        "scenario": solution.scenario.name,
        "law": solution.scenario.subject.removeprefix("law "),
        "status": solution.status,
        "reason": solution.reason or "",
    }
    columns = [arrow_array(solution[field.name]) for field in fields]
    table = pyarrow.Table.from_arrays(columns, schema=pyarrow.schema(fields, metadata=about))
    write_with(path, lambda beside: write_parquet(table, beside))

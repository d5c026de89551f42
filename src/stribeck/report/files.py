"""A solution as files."""

from __future__ import annotations

from pathlib import Path

from stribeck.files import arrow_array, write_parquet, write_with
from stribeck.simulation import Solution


def write_table(solution: Solution, folder: Path, stem: str) -> list[Path]:
    """The solution's columns as ``stem.csv`` (full double precision) and ``stem.parquet`` (units in the metadata)."""
    import pyarrow
    from pyarrow import csv

    fields = [pyarrow.field("t", pyarrow.float64(), metadata={"unit": "s", "meaning": "time"})]
    fields += [
        pyarrow.field(c.name, pyarrow.float64(), metadata={"unit": c.unit, "meaning": c.meaning})
        for c in solution.columns
    ]
    about = {
        "scenario": solution.scenario.name,
        "law": solution.scenario.law.name,
        "status": solution.status,
        "reason": solution.reason or "",
    }
    columns = [arrow_array(solution[field.name]) for field in fields]
    table = pyarrow.Table.from_arrays(columns, schema=pyarrow.schema(fields, metadata=about))
    paths = [folder / f"{stem}.csv", folder / f"{stem}.parquet"]

    def write_csv(beside: Path) -> None:
        with beside.open("wb") as file:  # pyarrow would put the names in quotes
            file.write(",".join(table.column_names).encode() + b"\n")
            csv.write_csv(table, file, csv.WriteOptions(include_header=False))

    write_with(paths[0], write_csv)
    write_with(paths[1], lambda beside: write_parquet(table, beside))
    return paths

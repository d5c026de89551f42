"""The tables of a sweep's parts: a row a lane, or the lanes' trajectories."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from stribeck.files import write_parquet
from stribeck.loops.oscillation import amplitude_and_period
from stribeck.report.files import write_csv
from stribeck.simulation import Ensemble

Column = tuple[str, str, str, NDArray[Any]]  # name, unit, meaning, values


def _about_lanes(e: Ensemble, first: int, lanes: NDArray[np.int64]) -> list[Column]:
    """The first columns: which lane, its values, what became of it."""
    reasons = np.array([reason or "" for reason in e.reason])[lanes]
    varied = [(path, "", "varied", values[lanes]) for path, values in e.values.items()]
    status = [("status", "", "done or failed", np.where(reasons == "", "done", "failed"))]
    return [
        ("lane", "", "number of the lane", first + lanes),
        *varied,
        *status,
        ("reason", "", "why it failed", reasons),
    ]


def trajectories(e: Ensemble, first: int) -> list[Column]:
    """A row for each time that each lane reached; a lane that never began has one row without a time."""
    reached = np.isfinite(e[e.columns[0].name])
    begun = reached.copy()
    begun[:, 0] = True
    lanes, rows = np.nonzero(begun)
    t = np.where(reached[lanes, rows], e.t[rows], np.nan)
    columns = [(c.name, c.unit, c.meaning, e[c.name][lanes, rows]) for c in e.columns]
    return [*_about_lanes(e, first, lanes), ("t", "s", "time", t), *columns]


def summary(e: Ensemble, first: int) -> list[Column]:
    """A row for each lane; peaks and final values over the rows that it reached."""
    lanes = np.arange(len(e))
    found = _about_lanes(e, first, lanes)
    found += [("slips", "", "|v| rises through v_s", e.slips), ("sticks", "", "|v| falls through v_s", e.sticks)]
    last = np.maximum(np.isfinite(e[e.columns[0].name]).sum(axis=1) - 1, 0)
    for c in e.columns:
        largest = np.where(np.isnan(e[c.name]), -np.inf, np.abs(e[c.name])).max(axis=1)
        peak = np.where(np.isinf(largest), np.nan, largest)
        found.append((f"peak_{c.name}", c.unit, f"largest magnitude: {c.meaning}", peak))
        found.append((f"final_{c.name}", c.unit, f"at the end: {c.meaning}", e[c.name][lanes, last]))
    late = e.t >= 0.5 * e.t[-1]
    y = next(column for column in e.columns if column.name.split(".")[-1] == "y")  # of a machine, the first body's
    amplitude, period = amplitude_and_period(e.t[late], e[y.name][:, late])
    found.append(("amplitude", y.unit, f"half of peak to peak of {y.name} in the second half", amplitude))
    return [
        *found,
        ("period", "s", f"mean time between upward crossings of {y.name}'s middle in the second half", period),
    ]


def write_table(path: Path, columns: Sequence[Column], as_csv: bool) -> None:
    """Write columns as Parquet or CSV."""
    if as_csv:
        write_csv(path, {name: values for name, _, _, values in columns})
        return
    import pyarrow

    fields, arrays = [], []
    for name, unit, meaning, values in columns:
        # nan says "not reached" in NumPy; a table has nulls for that
        array = pyarrow.array(values, from_pandas=values.dtype.kind == "f")
        arrays.append(array)
        fields.append(pyarrow.field(name, array.type, metadata={"unit": unit, "meaning": meaning}))
    table = pyarrow.Table.from_arrays(arrays, schema=pyarrow.schema(fields))
    write_parquet(table, path, compression="zstd")


def failed_lanes(file: IO[bytes], as_csv: bool) -> int:
    """How many lanes of a part failed; of a Parquet file only two columns are read."""
    if as_csv:
        rows = csv.DictReader(line.decode() for line in file)
        return len({row["lane"] for row in rows if row["status"] == "failed"})
    from pyarrow import parquet

    table = parquet.read_table(file, columns=["lane"], filters=[("status", "=", "failed")])
    return len(table.column("lane").unique())

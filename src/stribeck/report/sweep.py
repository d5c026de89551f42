"""A sweep: an ensemble in parts on disk, which goes on where it was stopped and ends with the same bytes."""

from __future__ import annotations

import csv
import json
import math
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stribeck.analysis.oscillation import amplitude_and_period
from stribeck.arrays import Array
from stribeck.codegen import source
from stribeck.errors import InputError, arg, needed
from stribeck.files import sha256_of, write_json, write_parquet, write_with
from stribeck.report.files import write_csv
from stribeck.scenario import Scenario
from stribeck.scenario.objects import Machine, VariedMachine, scenario_of
from stribeck.simulation import Ensemble, simulate_ensemble
from stribeck.simulation.native import step_share
from stribeck.simulation.variations import arrays, vary
from stribeck.version import __version__

Progress = Callable[[float, float], None]

_PART_BYTES = 64e6  # of the columns of one part: what is lost at most when a sweep is killed, some seconds of work
_MOST_LANES = 10**8


@dataclass(frozen=True)
class Range:
    """A range of one number: ``count`` values from first to last, evenly or logarithmically spaced."""

    path: str
    first: float
    last: float
    count: int
    log: bool = False

    @classmethod
    def parse(cls, text: str, drawn: bool = False) -> Range:
        """``PATH=FIRST:LAST:COUNT[:log]``; for a drawn sample ``COUNT`` may be left out.

        Raises:
            InputError: it is no such range.
        """
        form = "PATH=FIRST:LAST[:log]" if drawn else "PATH=FIRST:LAST:COUNT[:log]"
        path, sign, rest = text.partition("=")
        words = rest.split(":")
        log = words[-1] == "log"
        words = words[:-1] if log else words
        try:
            first, last = float(words[0]), float(words[1])
            count = int(words[2]) if len(words) > 2 or not drawn else 1
        except (ValueError, IndexError):
            raise InputError(f"{arg('ranges')} {text!r}: must be {form}, such as law.k_v=1e6:1e8:5:log") from None
        if not sign or not path.strip() or len(words) > 3:
            raise InputError(f"{arg('ranges')} {text!r}: must be {form}, such as law.k_v=1e6:1e8:5:log")
        if not (math.isfinite(first) and math.isfinite(last)):
            raise InputError(f"{arg('ranges')} {text!r}: FIRST and LAST must be finite numbers")
        if not 1 <= count <= _MOST_LANES:
            raise InputError(f"{arg('ranges')} {text!r}: COUNT must be a whole number from 1 to {_MOST_LANES}")
        if log and not (first > 0 and last > 0):
            raise InputError(f"{arg('ranges')} {text!r}: FIRST and LAST must be > 0 for log")
        return cls(path.strip(), first, last, count, log)

    @property
    def values(self) -> Array:
        """The values, both ends included."""
        return self._scaled(np.linspace(0.0, 1.0, self.count) if self.count > 1 else np.zeros(1))

    def drawn(self, random: np.random.Generator, count: int) -> Array:
        """Values drawn between the ends, uniformly (in the logarithm for ``log``)."""
        return self._scaled(random.random(count))

    def _scaled(self, share: Array) -> Array:
        if self.log:
            found = 10 ** (math.log10(self.first) + math.log10(self.last / self.first) * share)
        else:
            found = self.first + (self.last - self.first) * share
        return np.where(share == 0, self.first, np.where(share == 1, self.last, found))


def lanes_of(ranges: Sequence[Range], samples: int | None = None, seed: int = 0) -> dict[str, Array]:
    """The values of every lane by path: the grid of the ranges, the last one fastest, or ``samples`` random points.

    Raises:
        InputError: no range, two of one path, or more lanes than a sweep can have.
    """
    paths = [r.path for r in ranges]
    if not ranges:
        raise InputError(f"{arg('ranges')}: missing: must be given at least once, such as law.k_v=1e6:1e8:5:log")
    if twice := [path for path in dict.fromkeys(paths) if paths.count(path) > 1]:
        raise InputError(
            [f"{arg('ranges')} {path}: given {paths.count(path)} times; must be given once" for path in twice]
        )
    count = math.prod(r.count for r in ranges) if samples is None else samples
    if not 1 <= count <= _MOST_LANES:
        what = "the grid has" if samples is None else arg("samples")
        raise InputError(f"{what} {count} lanes: must be from 1 to {_MOST_LANES}")
    if samples is not None:
        random = np.random.default_rng(seed)
        return {r.path: r.drawn(random, samples) for r in ranges}
    grid = np.meshgrid(*(r.values for r in ranges), indexing="ij")
    return {path: values.reshape(-1) for path, values in zip(paths, grid, strict=True)}


class Sweep:
    """A sweep in a folder: parts of some lanes each, and ``_manifest.json``, which says what it is and has the SHA-256
    of each part that is done.

    Readers of a folder of Parquet files pass over names that begin with an underscore.

    Args:
        scenario: what the lanes share.
        values: the values of every lane by path.
        folder: where the files go.
        summary: keep one row a lane (peaks, slips, amplitude, period) in place of its trajectory.
        as_csv: write CSV in the place of Parquet.

    Raises:
        InputError: a path cannot be varied.
    """

    def __init__(
        self, scenario: Scenario, values: Mapping[str, Array], folder: Path, summary: bool, as_csv: bool = False
    ) -> None:
        if not as_csv:
            with needed(f"a sweep into Parquet files ({arg('as_csv')} writes CSV)"):
                import pyarrow  # noqa: F401  (before hours of work, not after)
        self.lanes, self.folder, self.summary, self.as_csv = vary(scenario, values), folder, summary, as_csv
        self._read: set[tuple[str, str, int, int]] = set()  # parts that have been found to be whole
        row = 8.0 * (1 + len(scenario.system.columns))
        self.part_size = max(1, min(len(self.lanes), int(_PART_BYTES / (row * scenario.rows))))
        self.parts = math.ceil(len(self.lanes) / self.part_size)
        self.manifest: dict[str, Any] = {
            "format": 1,
            "stribeck": __version__,
            "scenario": scenario.name,
            "law": scenario.subject.removeprefix("law "),
            "varied": list(self.lanes.values),
            "summary": summary,
            "lanes": len(self.lanes),
            "lanes_per_part": self.part_size,
            "parts": [self.path(i).name for i in range(self.parts)],
            "digest": self._digest(),
        }

    def path(self, part: int) -> Path:
        """The file of a part."""
        return self.folder / f"part-{part:06d}.{'csv' if self.as_csv else 'parquet'}"

    def _digest(self) -> str:
        """Of all that decides the numbers: the equations and solver as C, every constant, the signal, the values."""
        s, lanes = self.lanes.scenario, self.lanes
        table = s.pieces()
        pieces = [table.start, table.rows, table.restart]
        about = s.data.get("drive", [each["seed"] for each in s.sampling()])
        numbers = [
            sorted((*key, x) for key, x in s.values().items()),
            s.initial,
            s.atol(),
            s.thresholds(),
            s.end,
        ]
        settings = [
            s.solve.rtol, step_share(s), s.solve.max_steps, s.output.step, s.rows, list(lanes.values), about,
        ]  # fmt: skip
        text = json.dumps([source(s.system, lanes=True), numbers, settings])
        arrays = b"".join(np.ascontiguousarray(x).tobytes() for x in [*pieces, *lanes.values.values()])
        return sha256(text.encode() + arrays).hexdigest()

    def missing(self) -> list[int]:
        """The parts that are not there yet, or are not what was written."""
        done = self._kept().get("sha256", {})
        return [i for i in range(self.parts) if not self._whole(self.path(i), done.get(self.path(i).name))]

    def _whole(self, path: Path, digest: str | None) -> bool:
        try:
            state = path.stat()
            now = (path.name, str(digest), state.st_size, state.st_mtime_ns)
            if now not in self._read and sha256_of(path) == digest:
                self._read.add(now)
        except OSError:
            return False
        return now in self._read

    def _kept(self) -> dict[str, Any]:
        """The manifest in the folder; empty where there is none that can be read."""
        try:
            found = json.loads((self.folder / "_manifest.json").read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return {}
        return found if isinstance(found, dict) and isinstance(found.get("sha256", {}), dict) else {}

    def _done(self, part: int) -> None:
        """Note that a part is written."""
        digests = {**self._kept().get("sha256", {}), self.path(part).name: sha256_of(self.path(part))}
        write_json(self.folder / "_manifest.json", {**self.manifest, "sha256": dict(sorted(digests.items()))})

    def run(self, threads: int | None = None, progress: Progress | None = None) -> int:
        """Write the parts that are missing; how many lanes failed in all.

        ``progress`` is called with the share of the lanes done and how many of them were done in this run.

        Raises:
            InputError: the folder holds another sweep, or another process is at work in it.
        """
        with _alone(self.folder):
            self._claim()
            todo = self.missing()
            before = len(self.lanes) - sum(len(range(*self._lanes_of(i))) for i in todo)
            done = before
            for part in todo:
                first, end = self._lanes_of(part)

                def tell(share: float, done: int = done, size: int = end - first) -> None:
                    if progress is not None:
                        progress((done + share * size) / len(self.lanes), done - before + share * size)

                values = {path: x[first:end] for path, x in self.lanes.values.items()}
                found = simulate_ensemble(self.lanes.scenario, values, threads=threads, progress=tell)
                _write(self.path(part), _summary(found, first) if self.summary else _trajectories(found, first))
                self._done(part)
                done += end - first
            return sum(_failed_lanes(self.path(i)) for i in range(self.parts))

    def _lanes_of(self, part: int) -> tuple[int, int]:
        return part * self.part_size, min((part + 1) * self.part_size, len(self.lanes))

    def _claim(self) -> None:
        """Make the folder this sweep's: write its manifest, or find the same one there."""
        place = self.folder / "_manifest.json"
        for pattern in (".[0-9]*-????????.tmp", ".part-*.tmp", "._manifest*.tmp"):
            for left in self.folder.glob(pattern):  # of a killed process: nobody else is at work here
                left.unlink()
        if place.exists():
            if {key: x for key, x in self._kept().items() if key != "sha256"} != self.manifest:
                text = "holds another sweep (another scenario, range or version): must be another folder, or emptied"
                raise InputError(f"{arg('folder')}: {str(self.folder)!r}: {text}")
        elif any(self.folder.glob("part-*.*")):
            raise InputError(
                f"{arg('folder')}: {str(self.folder)!r}: holds parts of an unknown sweep: must be another folder"
            )
        else:
            write_json(place, {**self.manifest, "sha256": {}})


def sweep(
    scenario: Scenario | Machine | VariedMachine | str | Path | Mapping[str, object],
    values: Mapping[str, ArrayLike] | None = None,
    out: str | Path = "sweep",
    *,
    t_end: float | None = None,
    step: float | None = None,
    summary: bool = False,
    as_csv: bool = False,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Sweep:
    """Simulate every lane into a folder, in parts; go on where an earlier sweep into it was stopped.

    Args:
        scenario: what the lanes share; or ``machine.vary({...})``.
        values: the values of every lane by path, arrays of one length (``np.meshgrid`` makes grids).
        out: the folder.
        t_end, step: as for :func:`stribeck.simulate`.
        summary: keep one row a lane (peaks, events, amplitude, period) in place of its trajectory.
        as_csv: write CSV in the place of Parquet.
        threads: of the processor; all unless given.
        progress: called with the share of the lanes done, and how many were done in this run.

    Returns:
        The sweep: ``path(i)`` is the file of part i of ``parts``.

    Raises:
        InputError: a path cannot be varied, or the folder holds another sweep.
    """
    if isinstance(scenario, VariedMachine):
        values = {**scenario.values, **(values or {})}
    shared = scenario.machine if isinstance(scenario, VariedMachine) else scenario
    found = Sweep(scenario_of(shared, t_end, step), arrays(values or {}), Path(out), summary, as_csv)
    found.folder.mkdir(parents=True, exist_ok=True)
    found.run(threads, progress)
    return found


@contextmanager
def _alone(folder: Path) -> Iterator[None]:
    """Keep other processes out of the folder for a while, where the system knows how."""
    try:
        import fcntl
    except ImportError:
        yield
        return
    handle = os.open(folder, os.O_RDONLY)
    try:
        with suppress(OSError):
            try:
                fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                text = "another process is at work there: must be another folder, or wait"
                raise InputError(f"{arg('folder')}: {str(folder)!r}: {text}") from None
        yield
    finally:
        os.close(handle)


# -- the tables of a part ----------------------------------------------------------------------------------------------

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


def _trajectories(e: Ensemble, first: int) -> list[Column]:
    """A row for each time that each lane reached; a lane that never began has one row without a time."""
    reached = np.isfinite(e[e.columns[0].name])
    begun = reached.copy()
    begun[:, 0] = True
    lanes, rows = np.nonzero(begun)
    t = np.where(reached[lanes, rows], e.t[rows], np.nan)
    columns = [(c.name, c.unit, c.meaning, e[c.name][lanes, rows]) for c in e.columns]
    return [*_about_lanes(e, first, lanes), ("t", "s", "time", t), *columns]


def _summary(e: Ensemble, first: int) -> list[Column]:
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


def _write(path: Path, columns: Sequence[Column]) -> None:
    if path.suffix == ".csv":
        write_with(path, lambda beside: write_csv(beside, {name: values for name, _, _, values in columns}))
        return
    import pyarrow

    fields, arrays = [], []
    for name, unit, meaning, values in columns:
        # nan says "not reached" in NumPy; a table has nulls for that
        array = pyarrow.array(values, from_pandas=values.dtype.kind == "f")
        arrays.append(array)
        fields.append(pyarrow.field(name, array.type, metadata={"unit": unit, "meaning": meaning}))
    table = pyarrow.Table.from_arrays(arrays, schema=pyarrow.schema(fields))
    write_with(path, lambda beside: write_parquet(table, beside, compression="zstd"))


def _failed_lanes(path: Path) -> int:
    if path.suffix == ".csv":
        with path.open(encoding="utf-8", newline="") as file:
            return len({row["lane"] for row in csv.DictReader(file) if row["status"] == "failed"})
    from pyarrow import parquet

    table = parquet.read_table(path, columns=["lane"], filters=[("status", "=", "failed")])
    return len(table.column("lane").unique())

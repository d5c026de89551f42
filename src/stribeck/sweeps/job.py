"""A sweep: an ensemble stored as parts in a folder. An interrupted sweep continues, and ends with the same bytes."""

from __future__ import annotations

import json
import math
import shutil
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from fnmatch import fnmatch
from hashlib import sha256
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from stribeck.arrays import Array
from stribeck.codegen import source
from stribeck.errors import InputError, arg, needed
from stribeck.files import finite, parquet_of, read_file, write_with
from stribeck.mouth.document import Document
from stribeck.platforms import Occupied, locked
from stribeck.scenario import Scenario
from stribeck.scenario.objects import Machine, scenario_of
from stribeck.simulation import variations
from stribeck.simulation.ensemble import simulate_ensemble
from stribeck.sweeps import tables
from stribeck.version import __version__

Progress = Callable[[float, float], None]

_PART_BYTES = 64e6  # of the columns of one part: some seconds of work, the most that is lost if a sweep is killed
_LEFT = ".[0-9]*-????????.tmp"  # temporary files of files.write_with and files.together that kill -9 leaves
_MANIFEST = "_manifest.json"  # readers of a folder of Parquet files skip names that begin with an underscore


class Finished(NamedTuple):
    """What the manifest has of a finished part: the SHA-256 of its file, its failed lanes, and those that do not reach the
    promised accuracy."""

    sha256: str
    failed: int
    inaccurate: int


class Sweep:
    """A sweep in a folder: parts of some lanes each, and a manifest.

    The manifest describes the sweep and each finished part.

    Args:
        scenario: the scenario that the lanes vary.
        values: the values of every lane by path.
        out: the folder of the files.
        summary: keep one row for each lane (peaks, slips, amplitude, period) instead of its trajectory.

    Raises:
        InputError: if a path cannot be varied.
        MissingExtra: if pyarrow is not installed.
    """

    def __init__(self, scenario: Scenario, values: Mapping[str, Array], out: Path | str, summary: bool) -> None:
        with needed("a sweep"):
            import pyarrow  # noqa: F401  (before hours of work, not after)
        self.lanes, self.folder = variations.vary(scenario, values), Path(out)
        self.summary = summary
        row = 8.0 * (1 + len(scenario.system.columns))
        self.part_size = max(1, min(len(self.lanes), int(_PART_BYTES / (row * scenario.rows))))
        self.parts = math.ceil(len(self.lanes) / self.part_size)
        self.found = 0  # number of parts from an earlier run
        self._finished: dict[str, Finished] = {}  # by name
        self._about: dict[str, object] = {
            "format": 1,
            "stribeck": __version__,
            "scenario": scenario.name,
            "law": scenario.subject.removeprefix("law "),
            "varied": list(self.lanes.values),
            "summary": summary,
            "lanes": len(self.lanes),
            "lanes_per_part": self.part_size,
            "parts": [self.name(i) for i in range(self.parts)],
            "digest": self._digest(),
        }

    def document(self, seconds: float) -> Document:
        """The sweep as a document, with its duration in seconds."""
        existing = f", {self.found} of them there already" if self.found else ""
        parts = f"{self.parts} part{'s' if self.parts != 1 else ''}"
        lead = f"{len(self.lanes)} lanes in {parts}{existing}, {seconds:.1f} s"
        return Document(self.lanes.scenario.name, lead)

    @staticmethod
    def name(part: int) -> str:
        """The name of a part's file."""
        return f"part-{part:06d}.parquet"

    @property
    def files(self) -> list[str]:
        """The paths of the manifest and the parts."""
        return [str(self.folder / name) for name in (_MANIFEST, *map(self.name, range(self.parts)))]

    @property
    def failed(self) -> int:
        """The number of failed lanes in the finished parts."""
        return sum(part.failed for part in self._finished.values())

    @property
    def inaccurate(self) -> int:
        """The number of lanes in the finished parts that do not reach the promised accuracy."""
        return sum(part.inaccurate for part in self._finished.values())

    def lanes_of(self, part: int) -> range:
        """The lanes of a part."""
        return range(part * self.part_size, min((part + 1) * self.part_size, len(self.lanes)))

    def run(self, threads: int | None = None, progress: Progress | None = None) -> None:
        """Compute the missing parts.

        Args:
            threads: number of threads; all cores unless given.
            progress: called with the share of the lanes done, and the number of lanes done in this run.

        Raises:
            InputError: if the folder contains another sweep, or another process works in it.
        """
        with _alone(self.folder):
            todo = self._missing_parts()
            existing = len(self.lanes) - sum(len(self.lanes_of(part)) for part in todo)
            done = 0
            self._write_manifest()
            for part in todo:
                size = len(self.lanes_of(part))

                def tell(share: float, done: int = done, size: int = size) -> None:
                    if progress is not None:
                        lanes = done + share * size
                        progress((existing + lanes) / len(self.lanes), lanes)

                self._make(part, threads, tell)
                self._write_manifest()
                done += size
                tell(1.0)

    def _make(self, part: int, threads: int | None, progress: Callable[[float], None]) -> None:
        """Simulate the lanes of a part into its file."""
        lanes = self.lanes_of(part)
        values = {path: x[lanes.start : lanes.stop] for path, x in self.lanes.values.items()}
        ensemble = simulate_ensemble(self.lanes.scenario, values, threads=threads, progress=progress)
        columns = (tables.summary if self.summary else tables.trajectories)(ensemble, lanes.start)
        content = parquet_of(columns)
        _put(self.folder / self.name(part), content)
        failed = sum(reason is not None for reason in ensemble.reason)
        self._finished[self.name(part)] = Finished(sha256(content).hexdigest(), failed, int(ensemble.inaccurate.sum()))

    def _missing_parts(self) -> list[int]:
        """The parts that are missing or whose content changed.

        Raises:
            InputError: if the folder contains another sweep, or a part of another sweep.
        """
        here = f"{arg('out')}: {str(self.folder)!r}"
        names = [path.name for path in self.folder.iterdir()]
        parts = {name for name in names if fnmatch(name, "part-*.*")}
        if _MANIFEST not in names:
            if parts:
                raise InputError(f"{here}: holds parts of an unknown sweep: must be another folder")
            return list(range(self.parts))
        about, finished = self._manifest(here)
        if about != self._about:
            text = "holds another sweep (another scenario, range or version): must be another folder, or emptied"
            raise InputError(f"{here}: {text}")
        if others := sorted(parts.difference(map(self.name, range(self.parts)))):
            text = "which is no part of this sweep: must be another folder, or one without it"
            raise InputError(f"{here}: holds {others[0]}, {text}")
        todo = []
        for part in range(self.parts):
            name = self.name(part)
            known = finished.get(name) if name in parts else None
            if known is not None and known.sha256 == self._digest_of(name):
                self._finished[name] = known
            else:
                todo.append(part)
        self.found = self.parts - len(todo)
        return todo

    def _manifest(self, here: str) -> tuple[dict[str, object], dict[str, Finished]]:
        """The manifest: description of the sweep, and its finished parts by name."""
        try:
            manifest = json.loads(read_file(self.folder / _MANIFEST))
            digests, *counts = (dict(manifest.pop(field)) for field in Finished._fields)
            known = [name for name in digests if all(name in each for each in counts)]
            finished = {name: Finished(digests[name], *(each[name] for each in counts)) for name in known}
            if not all(type(x) is int and x >= 0 for part in finished.values() for x in part[1:]):
                raise ValueError
            return dict(manifest), finished
        except OSError as error:
            raise InputError(f"{here}: {_MANIFEST} in it cannot be read: {error.strerror or error}") from None
        except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
            raise InputError(f"{here}: {_MANIFEST} in it is damaged: must be another folder, or emptied") from None

    def _digest_of(self, name: str) -> str | None:
        try:
            return sha256(read_file(self.folder / name)).hexdigest()
        except OSError:  # a folder or a pipe in its place
            return None

    def _write_manifest(self) -> None:
        parts = sorted(self._finished.items())
        about = {**self._about, **{n: {name: part[i] for name, part in parts} for i, n in enumerate(Finished._fields)}}
        _put(self.folder / _MANIFEST, (json.dumps(about, indent=2, allow_nan=False) + "\n").encode())

    def _digest(self) -> str:
        """SHA-256 of all inputs of the numbers: equations and solver as C, all constants, the signal, the values."""
        s, lanes = self.lanes.scenario, self.lanes
        table = s.pieces
        constants = sorted((*key, x) for key, x in s.elements.values.items())
        text = json.dumps([source(s.system, lanes=True), constants, s.atol(), finite(s.data), list(lanes.values)])
        arrays = [table.start, table.rows, table.restart, *lanes.values.values()]
        return sha256(text.encode() + b"".join(np.ascontiguousarray(x).tobytes() for x in arrays)).hexdigest()


def _put(path: Path, content: bytes) -> None:
    """Write a file atomically. A link, a pipe or a device in its place is removed, not followed."""
    if path.is_symlink() or (path.exists() and not path.is_file()):
        path.unlink()
    write_with(path, lambda beside: beside.write_bytes(content))


@contextmanager
def _alone(folder: Path) -> Iterator[None]:
    """Lock the folder against other sweeps, and remove the temporary files of killed processes.

    Raises:
        InputError: if another process works in the folder.
    """
    folder.mkdir(parents=True, exist_ok=True)
    try:
        with locked(folder, wait=False):
            for left in folder.glob(_LEFT):
                shutil.rmtree(left) if left.is_dir() and not left.is_symlink() else left.unlink()
            yield
    except Occupied:
        text = "another process is at work there: must be another folder, or wait"
        raise InputError(f"{arg('out')}: {str(folder)!r}: {text}") from None


def sweep(
    scenario: Scenario | Machine | str | Path | Mapping[str, object],
    vary: Mapping[str, ArrayLike] | None = None,
    out: str | Path = "sweep",
    *,
    t_end: float | None = None,
    step: float | None = None,
    summary: bool = False,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Sweep:
    """Simulate every lane into a folder of Parquet files; continue an earlier sweep that was interrupted.

    A lane is one simulation of a batch.

    Args:
        scenario: the scenario or machine that the lanes vary.
        vary: values of every lane by path, arrays of one length (``np.meshgrid`` makes grids).
        out: folder of the files.
        t_end, step: as in :func:`stribeck.simulate`.
        summary: keep one row for each lane (peaks, events, amplitude, period) instead of its trajectory.
        threads: number of threads; all cores unless given.
        progress: called with the share of the lanes done, and the number of lanes done in this run.

    Returns:
        The sweep; ``files`` lists the manifest and the parts, ``failed`` and ``inaccurate`` count lanes.

    Raises:
        InputError: if a path cannot be varied, or the folder contains another sweep.
    """
    job = Sweep(scenario_of(scenario, t_end, step), variations.arrays(dict(vary or {})), out, summary)
    job.run(threads, progress)
    return job

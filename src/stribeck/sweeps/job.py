"""A sweep: an ensemble stored as parts in a folder. An interrupted sweep continues, and ends with the same bytes."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from fnmatch import fnmatch
from hashlib import sha256
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from stribeck.arrays import Array
from stribeck.codegen import source
from stribeck.errors import InputError, arg, needed
from stribeck.mouth.document import Document
from stribeck.scenario import Scenario
from stribeck.scenario.objects import Machine, scenario_of
from stribeck.simulation import variations
from stribeck.simulation.ensemble import simulate_ensemble
from stribeck.simulation.native import step_share
from stribeck.sweeps import tables
from stribeck.sweeps.folder import Folder
from stribeck.version import __version__

Progress = Callable[[float, float], None]

_PART_BYTES = 64e6  # of the columns of one part: some seconds of work, the most that is lost if a sweep is killed
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
        self.lanes, self.folder = variations.vary(scenario, values), Folder(Path(out))
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
        return [self.folder.path(name) for name in (_MANIFEST, *map(self.name, range(self.parts)))]

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

    def values_of(self, part: int) -> dict[str, Array]:
        """The values of a part's lanes by path."""
        lanes = self.lanes_of(part)
        return {path: x[lanes.start : lanes.stop] for path, x in self.lanes.values.items()}

    def run(self, threads: int | None = None, progress: Progress | None = None) -> None:
        """Compute the missing parts.

        Args:
            threads: number of threads; all cores unless given.
            progress: called with the share of the lanes done, and the number of lanes done in this run.

        Raises:
            InputError: if the folder contains another sweep, or another process works in it.
        """
        with self.folder.alone():
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
        first = self.lanes_of(part).start
        ensemble = simulate_ensemble(self.lanes.scenario, self.values_of(part), threads=threads, progress=progress)
        columns = tables.summary(ensemble, first) if self.summary else tables.trajectories(ensemble, first)
        content = tables.as_parquet(columns)
        self.folder.put(self.name(part), content)
        failed = sum(reason is not None for reason in ensemble.reason)
        self._finished[self.name(part)] = Finished(sha256(content).hexdigest(), failed, int(ensemble.inaccurate.sum()))

    def _missing_parts(self) -> list[int]:
        """The parts that are missing or whose content changed.

        Raises:
            InputError: if the folder contains another sweep, or a part of another sweep.
        """
        here = f"{arg('out')}: {str(self.folder)!r}"
        names = self.folder.names()
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
            manifest = json.loads(self.folder.get(_MANIFEST))
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
            return sha256(self.folder.get(name)).hexdigest()
        except OSError:  # a folder or a pipe in its place
            return None

    def _write_manifest(self) -> None:
        parts = sorted(self._finished.items())
        about = {**self._about, **{n: {name: part[i] for name, part in parts} for i, n in enumerate(Finished._fields)}}
        self.folder.put(_MANIFEST, (json.dumps(about, indent=2, allow_nan=False) + "\n").encode())

    def _digest(self) -> str:
        """SHA-256 of all inputs of the numbers: equations and solver as C, all constants, the signal, the values."""
        s, lanes = self.lanes.scenario, self.lanes
        table = s.pieces()
        pieces = [table.start, table.rows, table.restart]
        about = s.data.get("drive", [each["seed"] for each in s.elements.sampling()])
        numbers = [
            sorted((*key, x) for key, x in s.elements.values.items()),
            s.initial,
            s.atol(),
            s.elements.thresholds(),
            s.end,
        ]
        settings = [
            s.solve.rtol, step_share(s), s.solve.max_steps, s.output.step, s.rows, list(lanes.values), about,
        ]  # fmt: skip
        text = json.dumps([source(s.system, lanes=True), numbers, settings])
        arrays = b"".join(np.ascontiguousarray(x).tobytes() for x in [*pieces, *lanes.values.values()])
        return sha256(text.encode() + arrays).hexdigest()


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

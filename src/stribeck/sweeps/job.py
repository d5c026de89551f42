"""A sweep: an ensemble in parts on disk, which goes on where it was stopped and ends with the same bytes."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager, nullcontext, suppress
from fnmatch import fnmatch
from functools import partial
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from stribeck.arrays import Array
from stribeck.codegen import source
from stribeck.errors import InputError, StribeckError, arg, needed
from stribeck.scenario import Scenario
from stribeck.scenario.objects import Machine, VariedMachine, scenario_of
from stribeck.simulation.ensemble import check_device
from stribeck.simulation.native import step_share
from stribeck.simulation.variations import arrays, vary
from stribeck.sweeps import tables
from stribeck.sweeps.places import Folder, Store, digest, place_of, put_json, read_json
from stribeck.sweeps.worker import Order
from stribeck.version import __version__

if TYPE_CHECKING:
    from stribeck.sweeps.cluster import Workers

Progress = Callable[[float, float], None]

_PART_BYTES = 64e6  # of the columns of one part: what is lost at most when a sweep is killed, some seconds of work
_MANIFEST = "_manifest.json"


class Sweep:
    """A sweep in a folder: parts of some lanes each, and ``_manifest.json``, which says what it is and has the SHA-256
    of each part that is done.

    Readers of a folder of Parquet files pass over names that begin with an underscore.

    Args:
        scenario: what the lanes share.
        values: the values of every lane by path.
        folder: where the files go: a folder, or the URL of an object store.
        summary: keep one row a lane (peaks, slips, amplitude, period) in place of its trajectory.
        as_csv: write CSV in the place of Parquet.
        device: ``"cuda"`` for a GPU, as for :func:`stribeck.simulate_ensemble`.

    Raises:
        InputError: a path cannot be varied, or no library knows the URL.
        StribeckError: ``device="cuda"`` where there is no GPU.
    """

    def __init__(
        self,
        scenario: Scenario,
        values: Mapping[str, Array],
        folder: Path | str,
        summary: bool,
        as_csv: bool = False,
        device: str = "cpu",
    ) -> None:
        if not as_csv:
            with needed(f"a sweep into Parquet files ({arg('as_csv')} writes CSV)"):
                import pyarrow  # noqa: F401  (before hours of work, not after)
        self.lanes, self.place = vary(scenario, values), place_of(folder)
        self.summary, self.as_csv, self.device = summary, as_csv, device
        check_device(device)  # before hours of work, not after
        self._read: set[tuple[object, ...]] = set()  # parts that have been found to be whole
        self._made: dict[str, str] = {}
        row = 8.0 * (1 + len(scenario.system.columns))
        self.part_size = max(1, min(len(self.lanes), int(_PART_BYTES / (row * scenario.rows))))
        self.parts = math.ceil(len(self.lanes) / self.part_size)
        self.manifest: dict[str, object] = {
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
        if device != "cpu":  # its last bits are others
            self.manifest["device"] = device

    def name(self, part: int) -> str:
        """The name of a part's file."""
        return f"part-{part:06d}.{'csv' if self.as_csv else 'parquet'}"

    def path(self, part: int) -> Path | str:
        """The file of a part; of an object store its URL."""
        return (
            self.place.folder / self.name(part) if isinstance(self.place, Folder) else f"{self.place}/{self.name(part)}"
        )

    @property
    def order(self) -> Order:
        """How a part is made, here or elsewhere."""
        url = str(self.place) if isinstance(self.place, Store) else None
        return Order(self.lanes.scenario, self.summary, self.as_csv, url, self.device)

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
        done = self._digests()
        return [i for i in range(self.parts) if not self._whole(self.name(i), done.get(self.name(i)))]

    def _whole(self, name: str, wanted: str | None) -> bool:
        try:
            now = (name, wanted, *self.place.state(name))
            if now not in self._read and digest(self.place, name) == wanted:
                self._read.add(now)
        except OSError:
            return False
        return now in self._read

    def _digests(self) -> dict[str, str]:
        """Those of its parts that the manifest in the folder holds."""
        found = read_json(self.place, _MANIFEST).get("sha256")
        if not isinstance(found, dict):
            return {}
        return {name: x for name in map(self.name, range(self.parts)) if isinstance(x := found.get(name), str)}

    def run(self, threads: int | None = None, progress: Progress | None = None, on: str | None = None) -> int:
        """Write the parts that are missing; how many lanes failed in all.

        Args:
            threads: of this machine; all unless given.
            progress: called with the share of the lanes done and how many of them were done in this run.
            on: a cluster, as for :func:`sweep`.

        Raises:
            InputError: the folder holds another sweep, or another process is at work in it.
            StribeckError: the cluster went away, none of its workers can do it, or somebody changed a part meanwhile; what
                was written stays.
        """
        with self.place.alone(), self._workers(on) as workers:
            self._claim()
            todo = self.missing()
            before = len(self.lanes) - sum(len(range(*self.lanes_of_part(i))) for i in todo)

            def tell(lanes: float) -> None:
                if progress is not None:
                    progress((before + lanes) / len(self.lanes), lanes)

            if workers is not None:
                from stribeck.sweeps.cluster import run_on

                run_on(workers, self, todo, tell)
            else:
                self._here(todo, threads, tell)
            self._note({})  # of two clients of a store that began at once one may have lost what the other noted
            if changed := self.missing():
                text = f"{self.name(changed[0])} was changed meanwhile; the same command makes it again"
                raise StribeckError(f"{arg('folder')}: {str(self.place)!r}: {text}")
            return sum(self._failed(part) for part in range(self.parts))

    def _workers(self, on: str | None) -> AbstractContextManager[Workers | None]:
        """Those of a cluster, asked for before anything is written, and only where a part is missing."""
        if on is None or not self.missing():
            return nullcontext()
        from stribeck.sweeps.cluster import connected

        return connected(on, "; the same command goes on from there")

    def _here(self, todo: list[int], threads: int | None, tell: Callable[[float], None]) -> None:
        """On this machine, part by part."""
        done = 0
        for part in todo:
            first, end = self.lanes_of_part(part)

            def share(x: float, done: int = done, size: int = end - first) -> None:
                tell(done + x * size)

            write = partial(self.order.write, values=self.values_of(part), first=first, threads=threads, progress=share)
            self.written(part, self.place.put(self.name(part), write))
            done += end - first
            tell(done)

    def written(self, part: int, known: str) -> None:
        """Note that a part is written, with the SHA-256 of its file."""
        self._note({self.name(part): known})
        with suppress(OSError):  # gone already
            self._read.add((self.name(part), known, *self.place.state(self.name(part))))

    def _note(self, digests: Mapping[str, str]) -> None:
        self._made |= digests
        now = self._digests()
        if digests or not self._made.keys() <= now.keys():
            put_json(self.place, _MANIFEST, {**self.manifest, "sha256": dict(sorted({**now, **self._made}.items()))})

    def lanes_of_part(self, part: int) -> tuple[int, int]:
        """Its first lane and the one behind its last."""
        return part * self.part_size, min((part + 1) * self.part_size, len(self.lanes))

    def values_of(self, part: int) -> dict[str, Array]:
        """The values of its lanes by path."""
        first, end = self.lanes_of_part(part)
        return {path: x[first:end] for path, x in self.lanes.values.items()}

    def _failed(self, part: int) -> int:
        with self.place.open(self.name(part)) as file:
            return tables.failed_lanes(file, self.as_csv)

    def _claim(self) -> None:
        """Make the folder this sweep's: write its manifest, or find the same one there."""
        self.place.tidy()
        here = f"{arg('folder')}: {str(self.place)!r}"
        names = self.place.names()
        parts = {name for name in names if fnmatch(name, "part-*.*")}
        if _MANIFEST in names:
            if not (found := read_json(self.place, _MANIFEST)):
                raise InputError(
                    f"{here}: {_MANIFEST} in it is damaged or cannot be read: must be another folder, or emptied"
                )
            if {key: x for key, x in found.items() if key != "sha256"} != self.manifest:
                text = "holds another sweep (another scenario, range or version): must be another folder, or emptied"
                raise InputError(f"{here}: {text}")
            if others := sorted(parts.difference(map(self.name, range(self.parts)))):
                text = "which is no part of this sweep: must be another folder, or one without it"
                raise InputError(f"{here}: holds {others[0]}, {text}")
        elif parts:
            raise InputError(f"{here}: holds parts of an unknown sweep: must be another folder")
        else:
            put_json(self.place, _MANIFEST, {**self.manifest, "sha256": {}})


def check_cluster(on: str | None, threads: int | None, device: str) -> None:
    """Refuse what a cluster cannot be told.

    Raises:
        InputError: threads, or another device than processors.
    """
    if on is not None and threads is not None:
        text = f"does not go with {arg('on')}: a cluster's workers have their own"
        raise InputError(f"{arg('threads')}: {threads}: {text}")
    if on is not None and device != "cpu":
        raise InputError(f"{arg('device')}: {device!r}: does not go with {arg('on')}: workers use their processors")


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
    device: str = "cpu",
    progress: Progress | None = None,
    on: str | None = None,
) -> Sweep:
    """Simulate every lane into a folder, in parts; go on where an earlier sweep into it was stopped.

    Args:
        scenario: what the lanes share; or ``machine.vary({...})``.
        values: the values of every lane by path, arrays of one length (``np.meshgrid`` makes grids).
        out: the folder, or the URL of an object store (``"s3://bucket/name"``).
        t_end, step: as for :func:`stribeck.simulate`.
        summary: keep one row a lane (peaks, events, amplitude, period) in place of its trajectory.
        as_csv: write CSV in the place of Parquet.
        threads: of the processor; all unless given.
        device: ``"cuda"`` for a GPU, as for :func:`stribeck.simulate_ensemble`.
        progress: called with the share of the lanes done, and how many were done in this run.
        on: ``"dask://HOST:PORT"``, the scheduler of a Dask cluster; ``"dask"`` starts one of processes on this machine
            (``pip install 'stribeck[cluster]'``). The files are the same to the last byte.

    Returns:
        The sweep: ``path(i)`` is the file of part i of ``parts``.

    Raises:
        InputError: a path cannot be varied, or the folder holds another sweep.
        StribeckError: the cluster went away, or none of its workers can do it (what was written stays); or no GPU.
    """
    check_cluster(on, threads, device)
    if isinstance(scenario, VariedMachine):
        values = {**scenario.values, **(values or {})}
    shared = scenario.machine if isinstance(scenario, VariedMachine) else scenario
    found = Sweep(scenario_of(shared, t_end, step), arrays(values or {}), out, summary, as_csv, device)
    if isinstance(found.place, Folder):
        found.place.folder.mkdir(parents=True, exist_ok=True)
    found.run(threads, progress, on)
    return found

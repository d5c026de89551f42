"""One part of a sweep: some lanes as the bytes of a Parquet file, computed on this machine or by a worker of a cluster.

A worker receives the scenario as text, the files that it refers to, and numbers. Its files must equal those of this
machine to the last bit. To check this, it first computes the file of the sweep's first lane and compares the digest.
"""

from __future__ import annotations

import base64
import json
import tempfile
import threading
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from dataclasses import dataclass
from functools import lru_cache
from hashlib import sha256
from pathlib import Path

import numpy as np

from stribeck.arrays import Array
from stribeck.errors import StribeckError, error_text, one_line
from stribeck.scenario import Scenario
from stribeck.scenario.moved import with_files
from stribeck.simulation import backend
from stribeck.simulation.ensemble import simulate_ensemble
from stribeck.sweeps import tables
from stribeck.version import __version__

_building = threading.Lock()  # the threads of a worker build an order once
_files: list[ExitStack] = []  # files of scenarios: they may be read again, and are removed with the process


@dataclass(frozen=True)
class MadePart:
    """A computed part.

    Attributes:
        content: the bytes of its Parquet file.
        failed: the number of its lanes that failed.
        inaccurate: the number of its lanes that do not reach the promised accuracy.
    """

    content: bytes
    failed: int
    inaccurate: int


@dataclass(frozen=True)
class Refusal:
    """The reason why a worker cannot compute a part, and the worker's address."""

    worker: str
    reason: str


@dataclass(frozen=True)
class Order:
    """The work order that is the same for all parts of a sweep.

    Attributes:
        scenario: the scenario that the lanes vary.
        summary: one row for each lane instead of its trajectory.
    """

    scenario: Scenario
    summary: bool

    def part(
        self,
        values: Mapping[str, Array],
        first: int,
        threads: int | None = None,
        progress: Callable[[float], None] | None = None,
    ) -> MadePart:
        """Simulate some lanes; ``first`` is the number of the first one."""
        ensemble = simulate_ensemble(self.scenario, values, threads=threads, progress=progress)
        columns = tables.summary(ensemble, first) if self.summary else tables.trajectories(ensemble, first)
        failed = sum(reason is not None for reason in ensemble.reason)
        return MadePart(tables.as_parquet(columns), failed, int(ensemble.inaccurate.sum()))

    def probe(self, values: Mapping[str, Array]) -> str:
        """The SHA-256 of the first lane's file, which depends on all bits and on how they are written."""
        return sha256(self.part({path: x[:1] for path, x in values.items()}, 0, threads=1).content).hexdigest()

    def to_text(self, probe: str) -> str:
        """The order as JSON, with the scenario's files and the digest ``probe`` of the first lane's file."""
        data, files = with_files(self.scenario.data, self.scenario.folder)
        contents = {name: base64.b64encode(content).decode() for name, content in files.items()}
        about = {
            "stribeck": __version__,
            "backend": backend.chosen(),
            "data": data,
            "files": contents,
            "summary": self.summary,
            "probe": probe,
        }
        return json.dumps(about)


def make_part(text: str, first_lane: dict[str, bytes], numbers: dict[str, bytes], first: int) -> MadePart | Refusal:
    """Compute a part, on a worker of a cluster.

    Args:
        text: the order, by :meth:`Order.to_text`.
        first_lane: the values of the sweep's first lane by path, as bytes of float64, in the order of the columns.
        numbers: the values of this part's lanes, likewise.
        first: the number of the part's first lane.
    """
    from distributed import get_worker

    try:
        with _building:
            order = _order(text, tuple(first_lane.items()))
        return order.part(_values(numbers), first, threads=1)
    except (StribeckError, OSError, MemoryError) as error:  # a full disk, no memory: another worker may have them
        reason = str(error) if isinstance(error, StribeckError) else error_text(error)
        return Refusal(str(get_worker().address), one_line(reason))


_NAMES = {"c": "a C compiler", "wasm": "WebAssembly"}


@lru_cache(maxsize=8)
def _order(text: str, first_lane: tuple[tuple[str, bytes], ...]) -> Order:
    """The order of a text, built and checked once for each process.

    Raises:
        StribeckError: if this worker's numbers would not be the same.
    """
    given = json.loads(text)
    if given["stribeck"] != __version__:
        raise StribeckError(f"has Stribeck {__version__}, not {given['stribeck']}")
    if (chosen := backend.chosen()) != given["backend"]:
        raise StribeckError(f"solves by {_NAMES[chosen]}, not by {_NAMES[given['backend']]}")
    with ExitStack() as files:
        folder = Path(files.enter_context(tempfile.TemporaryDirectory(prefix="stribeck-")))
        for name, content in given["files"].items():
            (folder / name).write_bytes(base64.b64decode(content))
        order = Order(Scenario(given["data"], folder=folder, trust=True), given["summary"])
        if order.probe(_values(dict(first_lane))) != given["probe"]:
            raise StribeckError("computes other bits than this machine (another processor, compiler or pyarrow)")
        _files.append(files.pop_all())
    return order


def _values(numbers: Mapping[str, bytes]) -> dict[str, Array]:
    return {path: np.frombuffer(x, np.float64) for path, x in numbers.items()}

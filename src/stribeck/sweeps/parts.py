"""One part of a sweep: some lanes as the bytes of a Parquet file, made on this machine or by a worker of a cluster.

A worker is sent the scenario as text, the files that it names, and numbers. Its files must be those of the machine that
asks, to the last bit: it first makes the file of the sweep's first lane and compares its digest with the one it was sent.
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
from stribeck.errors import StribeckError, one_line, said_by
from stribeck.scenario import Scenario
from stribeck.scenario.moved import with_files
from stribeck.simulation import backend
from stribeck.simulation.ensemble import simulate_ensemble
from stribeck.sweeps import tables
from stribeck.version import __version__

_building = threading.Lock()  # the threads of a worker build an order once
_files: list[ExitStack] = []  # that scenarios name: they may be read again, and go with the process


@dataclass(frozen=True)
class MadePart:
    """A part that is made.

    Attributes:
        content: of its Parquet file.
        failed: how many of its lanes failed.
    """

    content: bytes
    failed: int


@dataclass(frozen=True)
class Refusal:
    """Why a worker cannot make a part, and the worker's address."""

    worker: str
    reason: str


@dataclass(frozen=True)
class Order:
    """What all parts of a sweep share.

    Attributes:
        scenario: what the lanes share.
        summary: a row a lane in place of its trajectory.
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
        """Simulate some lanes, the first of which has the number ``first``."""
        found = simulate_ensemble(self.scenario, values, threads=threads, progress=progress)
        columns = tables.summary(found, first) if self.summary else tables.trajectories(found, first)
        return MadePart(tables.as_parquet(columns), sum(reason is not None for reason in found.reason))

    def probe(self, values: Mapping[str, Array]) -> str:
        """The digest of the first lane's file: of its numbers' bits, and of how they are written."""
        return sha256(self.part({path: x[:1] for path, x in values.items()}, 0, threads=1).content).hexdigest()

    def to_text(self, probe: str) -> str:
        """As JSON, with the files that the scenario names and the digest of the first lane's file."""
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


def made_by_worker(
    text: str, first_lane: dict[str, bytes], numbers: dict[str, bytes], first: int
) -> MadePart | Refusal:
    """Make a part, on a worker of a cluster.

    Args:
        text: of :meth:`Order.to_text`.
        first_lane: the values of the sweep's first lane by path, float64, in the order of the columns.
        numbers: those of this part's lanes.
        first: the number of its first lane.
    """
    from distributed import get_worker

    try:
        with _building:
            order = _order(text, tuple(first_lane.items()))
        return order.part(_values(numbers), first, threads=1)
    except (StribeckError, OSError, MemoryError) as error:  # a full disk, no memory: another worker may have them
        reason = str(error) if isinstance(error, StribeckError) else said_by(error)
        return Refusal(str(get_worker().address), one_line(reason))


_NAMES = {"c": "a C compiler", "wasm": "WebAssembly"}


@lru_cache(maxsize=8)
def _order(text: str, first_lane: tuple[tuple[str, bytes], ...]) -> Order:
    """The order of a text, built and compared once a process.

    Raises:
        StribeckError: this worker's numbers would not be the same.
    """
    given = json.loads(text)
    if given["stribeck"] != __version__:
        raise StribeckError(f"has Stribeck {__version__}, not {given['stribeck']}")
    if (own := backend.chosen()) != given["backend"]:
        raise StribeckError(f"solves by {_NAMES[own]}, not by {_NAMES[given['backend']]}")
    with ExitStack() as files:
        folder = Path(files.enter_context(tempfile.TemporaryDirectory(prefix="stribeck-")))
        for name, content in given["files"].items():
            (folder / name).write_bytes(base64.b64decode(content))
        order = Order(Scenario(given["data"], folder=folder, trust=True), given["summary"])
        if order.probe(_values(dict(first_lane))) != given["probe"]:
            raise StribeckError("makes other bits than this machine (another processor, compiler or pyarrow)")
        _files.append(files.pop_all())
    return order


def _values(numbers: Mapping[str, bytes]) -> dict[str, Array]:
    return {path: np.frombuffer(x, np.float64) for path, x in numbers.items()}

"""What a worker of a cluster does: it is sent a scenario as text and numbers, builds it once, and makes parts of a sweep.

Its numbers must be those of the machine that asks, to the last bit: each worker first makes the first lane's file and
compares its digest with the one that it was sent.
"""

from __future__ import annotations

import base64
import json
import tempfile
import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache, partial
from pathlib import Path
from typing import TypedDict

import numpy as np

from stribeck.arrays import Array
from stribeck.errors import StribeckError, one_line
from stribeck.files import sha256_of
from stribeck.scenario import Scenario
from stribeck.scenario.moved import with_files
from stribeck.simulation import compiler, simulate_ensemble
from stribeck.sweeps import tables
from stribeck.sweeps.places import Store
from stribeck.version import __version__

_building = threading.Lock()
_folders: list[tempfile.TemporaryDirectory[str]] = []  # of files that scenarios name: read again, gone with the process


class _Told(TypedDict):
    """The keys of an order's text (:meth:`Order.to_text`)."""

    stribeck: str
    data: dict[str, object]
    files: dict[str, str]
    summary: bool
    as_csv: bool
    url: str | None
    probe: str


class Refused(Exception):
    """This worker cannot make the numbers that are asked for."""


class Made(TypedDict, total=False):
    """What comes back of a part: its digest, and its bytes where the worker did not put them in place itself; or why this
    worker, by its address, cannot make it."""

    sha256: str
    data: bytes | None
    refused: str
    worker: str


@dataclass(frozen=True)
class Order:
    """What all parts of a sweep share.

    Attributes:
        scenario: what the lanes share.
        summary, as_csv: as for :class:`stribeck.sweeps.job.Sweep`.
        url: the object store that workers write to; None where the bytes go back.
        device: as for :func:`stribeck.simulate_ensemble`; workers of a cluster have none but their processors.
    """

    scenario: Scenario
    summary: bool
    as_csv: bool
    url: str | None = None
    device: str = "cpu"

    def to_text(self, probe: str) -> str:
        """As JSON, with the digest of the first lane's file."""
        data, files = with_files(self.scenario.data, self.scenario.folder)
        contents = {name: base64.b64encode(content).decode() for name, content in files.items()}
        return json.dumps({
            "stribeck": __version__, "data": data, "files": contents, "summary": self.summary, "as_csv": self.as_csv,
            "url": self.url, "probe": probe,
        })  # fmt: skip

    def write(
        self,
        path: Path,
        values: Mapping[str, Array],
        first: int,
        threads: int | None = None,
        progress: Callable[[float], None] | None = None,
    ) -> None:
        """Simulate some lanes into a file."""
        found = simulate_ensemble(self.scenario, values, threads=threads, device=self.device, progress=progress)
        columns = tables.summary(found, first) if self.summary else tables.trajectories(found, first)
        tables.write_table(path, columns, self.as_csv)

    def probe(self, values: Mapping[str, Array]) -> str:
        """The digest of the first lane's file: of its numbers' bits, and of how they are written."""
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "probe"
            self.write(path, {name: x[:1] for name, x in values.items()}, 0, threads=1)
            return sha256_of(path)


def part(text: str, first_lane: dict[str, bytes], numbers: dict[str, bytes], first: int, name: str) -> Made:
    """Make one part of a sweep.

    Args:
        text: of :meth:`Order.to_text`.
        first_lane: the values of the sweep's first lane by path, float64, in the order of the columns.
        numbers: those of this part's lanes.
        first: the number of its first lane.
        name: of its file.
    """
    try:
        with _building:
            order = _built(text, tuple(first_lane.items()))
    except Refused as why:
        from distributed import get_worker

        return {"refused": str(why), "worker": str(get_worker().address)}
    write = partial(order.write, values=_values(numbers), first=first, threads=1)
    if order.url is not None:
        return {"sha256": Store(order.url).put(name, write), "data": None}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / name
        write(path)
        return {"sha256": sha256_of(path), "data": path.read_bytes()}


def _values(numbers: Mapping[str, bytes]) -> dict[str, Array]:
    return {path: np.frombuffer(x, np.float64) for path, x in numbers.items()}


@lru_cache(maxsize=8)
def _built(text: str, first_lane: tuple[tuple[str, bytes], ...]) -> Order:
    """The order of a text, once a process.

    Raises:
        Refused: this worker's numbers would not be the same.
    """
    given: _Told = json.loads(text)
    if given["stribeck"] != __version__:
        raise Refused(f"has Stribeck {__version__}, not {given['stribeck']}")
    if compiler.find() is None:
        raise Refused("has no C compiler")
    kept = tempfile.TemporaryDirectory(prefix="stribeck-")
    try:
        order = _checked(given, Path(kept.name), _values(dict(first_lane)))
    except BaseException:
        kept.cleanup()
        raise
    _folders.append(kept)
    return order


def _checked(given: _Told, folder: Path, first_lane: dict[str, Array]) -> Order:
    """The order of a text, with the files that it names in a folder, once it makes the bits that are asked for."""
    for name, content in given["files"].items():
        (folder / name).write_bytes(base64.b64decode(content))
    try:
        scenario = Scenario(given["data"], folder=folder, trust=True)
        order = Order(scenario, given["summary"], given["as_csv"], given["url"])
        probe = order.probe(first_lane)
    except (StribeckError, OSError) as error:
        raise Refused(f"cannot build it: {one_line(str(error))}") from None
    if probe != given["probe"]:
        raise Refused("makes other bits than this machine (another processor, compiler or pyarrow)")
    return order

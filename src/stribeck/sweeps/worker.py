"""What a worker of a cluster does: it is sent a scenario as text and numbers, builds it once, and makes parts of a sweep or
solves lanes of a fit or a design, or a law along a log.

Its numbers must be those of the machine that asks, to the last bit: each worker first makes the first lane (of a sweep its
file) and compares its digest with the one that it was sent.
"""

from __future__ import annotations

import base64
import json
import tempfile
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
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
from stribeck.simulation import compiler, lanes, response, simulate_ensemble
from stribeck.simulation.lanes import Integers, Outcome
from stribeck.simulation.variations import Variations
from stribeck.sweeps import tables
from stribeck.sweeps.places import Store
from stribeck.version import __version__

_building = threading.Lock()
_folders: list[tempfile.TemporaryDirectory[str]] = []  # of files that scenarios name: read again, gone with the process


class _Told(TypedDict):
    """The keys of every text: a scenario with its files, and the digest that the first lane must have."""

    stribeck: str
    data: dict[str, object]
    files: dict[str, str]
    probe: str


class _ToldOrder(_Told):
    """Those of :meth:`Order.to_text`."""

    summary: bool
    as_csv: bool
    url: str | None


class _ToldLaw(TypedDict):
    """The keys of :func:`law_text`."""

    stribeck: str
    function: str
    source: str
    probe: str
    numbers: dict[str, tuple[str, list[int], str]]


class Refused(Exception):
    """This worker cannot make the numbers that are asked for."""


class Answer(TypedDict, total=False):
    """What comes back of a part, or why this worker, by its address, cannot make it."""

    refused: str
    worker: str


class Made(Answer, total=False):
    """The digest of a part's file, and its bytes where the worker did not put them in place itself."""

    sha256: str
    data: bytes | None


class SolvedLanes(Answer, total=False):
    """What became of some lanes: the fields of :class:`stribeck.simulation.lanes.Outcome`."""

    states: Array
    t_reached: Array
    counts: dict[str, Integers]


class Answered(Answer, total=False):
    """What a compiled law answers; no arrays where the integration failed."""

    found: tuple[Array, ...] | None


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
        how = {"summary": self.summary, "as_csv": self.as_csv, "url": self.url}
        return _text(self.scenario, probe, how)

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
        return {"refused": str(why), "worker": _address()}
    write = partial(order.write, values=_values(numbers), first=first, threads=1)
    if order.url is not None:
        return {"sha256": Store(order.url).put(name, write), "data": None}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / name
        write(path)
        return {"sha256": sha256_of(path), "data": path.read_bytes()}


def lanes_text(scenario: Scenario, probe: str) -> str:
    """What some lanes share, as JSON, with the digest of what becomes of the first."""
    return _text(scenario, probe, {})


def some_lanes(text: str, first_lane: dict[str, bytes], numbers: dict[str, bytes]) -> SolvedLanes:
    """Solve some lanes.

    Args:
        text: of :func:`lanes_text`.
        first_lane: the values by path, float64, of the lane whose digest the text has.
        numbers: those of the lanes.
    """
    try:
        with _building:
            solve = _solver(text, tuple(first_lane.items()))
    except Refused as why:
        return {"refused": str(why), "worker": _address()}
    found = solve(_values(numbers))
    return {"states": found.states, "t_reached": found.t_reached, "counts": found.counts}


def law_text(probe: response.Question, digest: str) -> str:
    """A compiled law as JSON: its equations in C, and a short question with the digest of its answer."""
    packed = {
        name: (x.dtype.str, x.shape, base64.b64encode(np.ascontiguousarray(x).tobytes()).decode())
        for name, x in probe.numbers.items()
    }
    told = {
        "stribeck": __version__,
        "function": probe.function,
        "source": probe.text,
        "probe": digest,
        "numbers": packed,
    }
    return json.dumps(told)


def some_answers(text: str, numbers: response.Numbers) -> Answered:
    """Ask a compiled law.

    Args:
        text: of :func:`law_text`.
        numbers: of the question.
    """
    try:
        with _building:
            function, source = _law(text)
    except Refused as why:
        return {"refused": str(why), "worker": _address()}
    return {"found": response.answer_here(response.Question(function, source, numbers))}


@lru_cache(maxsize=64)
def _law(text: str) -> tuple[str, str]:
    """The function and the source of a text, built and compared once a process.

    Raises:
        Refused: this worker's numbers would not be the same.
    """
    given: _ToldLaw = json.loads(text)
    _of_this_version(given["stribeck"])
    numbers: response.Numbers = {
        name: np.frombuffer(base64.b64decode(x), kind).reshape(shape)
        for name, (kind, shape, x) in given["numbers"].items()
    }
    try:
        found = response.answer_here(response.Question(given["function"], given["source"], numbers))
    except StribeckError as error:
        raise Refused(f"cannot build it: {one_line(str(error))}") from None
    _compare(response.digest(found), given["probe"])
    return given["function"], given["source"]


def _of_this_version(version: str) -> None:
    """Raises: Refused: this worker is another Stribeck's, or has no compiler."""
    if version != __version__:
        raise Refused(f"has Stribeck {__version__}, not {version}")
    if compiler.find() is None:
        raise Refused("has no C compiler")


def _address() -> str:
    from distributed import get_worker

    return str(get_worker().address)


def _values(numbers: Mapping[str, bytes]) -> dict[str, Array]:
    return {path: np.frombuffer(x, np.float64) for path, x in numbers.items()}


def _text(scenario: Scenario, probe: str, how: Mapping[str, object]) -> str:
    """A scenario with the files that it names, the version of its equations, a digest, and what is to be done, as JSON."""
    data, files = with_files(scenario.data, scenario.folder)
    contents = {name: base64.b64encode(content).decode() for name, content in files.items()}
    return json.dumps({"stribeck": __version__, "data": data, "files": contents, "probe": probe, **how})


@contextmanager
def _scenario_of(given: _Told) -> Iterator[Scenario]:
    """The scenario of a text. Where what is done with it fails, the text is refused; otherwise the files that it names stay
    while the process lives.

    Raises:
        Refused: this worker's numbers would not be the same.
    """
    _of_this_version(given["stribeck"])
    kept = tempfile.TemporaryDirectory(prefix="stribeck-")
    try:
        for name, content in given["files"].items():
            (Path(kept.name) / name).write_bytes(base64.b64decode(content))
        yield Scenario(given["data"], folder=Path(kept.name), trust=True)
    except (StribeckError, OSError) as error:
        kept.cleanup()
        raise Refused(f"cannot build it: {one_line(str(error))}") from None
    except BaseException:
        kept.cleanup()
        raise
    _folders.append(kept)


@lru_cache(maxsize=8)
def _built(text: str, first_lane: tuple[tuple[str, bytes], ...]) -> Order:
    """The order of a text, once a process.

    Raises:
        Refused: this worker's numbers would not be the same.
    """
    given: _ToldOrder = json.loads(text)
    with _scenario_of(given) as scenario:
        order = Order(scenario, given["summary"], given["as_csv"], given["url"])
        _compare(order.probe(_values(dict(first_lane))), given["probe"])
    return order


@lru_cache(maxsize=256)  # of a fit, one for each recording and stretch
def _solver(text: str, first_lane: tuple[tuple[str, bytes], ...]) -> Callable[[Mapping[str, Array]], Outcome]:
    """What solves lanes of a text, once a process.

    Raises:
        Refused: this worker's numbers would not be the same.
    """
    given: _Told = json.loads(text)
    with _scenario_of(given) as scenario:
        library = lanes.compiled(scenario.system)

        def solve(values: Mapping[str, Array]) -> Outcome:
            return lanes.solve_here(library, Variations(scenario, values), 1)

        _compare(solve(_values(dict(first_lane))).digest, given["probe"])
    return solve


def _compare(found: str, probe: str) -> None:
    if found != probe:
        raise Refused("makes other bits than this machine (another processor, compiler or pyarrow)")

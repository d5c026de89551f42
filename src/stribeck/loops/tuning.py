"""Gains by search: the best worst error after reversals among those that stay quiet whatever the friction is."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass, replace
from hashlib import sha256
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array
from stribeck.constants import show
from stribeck.errors import InputError, StribeckError, arg, refuse_twice
from stribeck.files import json_of, write_sealed
from stribeck.loops.boundary import known_path
from stribeck.loops.judge import judge
from stribeck.loops.loop import Loop, time_constant
from stribeck.loops.moves import reversal_errors
from stribeck.version import __version__

_GENERATIONS = 5
_TRIED = 24  # a generation
_KEPT = 6
_FACTOR = 8.0  # of each gain, both ways, at first


@dataclass(frozen=True)
class Tuned:
    """Gains by path, the worst error after a reversal with them, and that with the file's; how many were tried, and how
    many of these were quiet."""

    gains: dict[str, float]
    worst_error: float
    error_before: float
    tried: int
    quiet: int


@dataclass
class _Search:
    """How far a search has come; ``journal`` keeps it, for the search that ``key`` tells."""

    journal: Path | None
    key: str
    random: np.random.Generator
    mean: Array
    spread: Array
    error: float = np.inf
    best: Array | None = None
    generation: int = 0
    tried: int = 0
    quiet: int = 0

    @classmethod
    def begun(cls, journal: Path | None, key: str, start: Array, seed: int) -> _Search:
        """A new one, or the one that the journal has."""
        made = cls(journal, key, np.random.default_rng(seed), np.log(start), np.full(len(start), np.log(_FACTOR) / 2))
        kept = None if journal is None else json_of(journal, sealed=True)
        if kept is None or kept["key"] != key:
            return made
        made.random.bit_generator.state = kept["random"]
        made.mean, made.spread = np.array(kept["mean"]), np.array(kept["spread"])
        made.best = None if kept["best"] is None else np.array(kept["best"])
        made.error = np.inf if kept["best"] is None else kept["error"]
        made.generation, made.tried, made.quiet = kept["generation"], kept["tried"], kept["quiet"]
        return made

    def keep(self) -> None:
        """Write the journal."""
        if self.journal is None:
            return
        numbers = {name: getattr(self, name) for name in ("generation", "tried", "quiet")}
        lists = {n: None if (x := getattr(self, n)) is None else x.tolist() for n in ("mean", "spread", "best")}
        state = {"key": self.key, **numbers, **lists, "random": self.random.bit_generator.state}
        self.journal.parent.mkdir(parents=True, exist_ok=True)
        write_sealed(self.journal, state | {"error": self.error if self.best is not None else None})

    def done(self) -> None:
        """The result takes the journal's place."""
        if self.journal is not None:
            self.journal.unlink(missing_ok=True)


def _key(loop: Loop, controller: str, paths: list[str], samples: dict[str, Array], seed: int) -> str:
    """What a search is for: another machine, other samples, another seed or version begin anew."""
    what = [__version__, loop.scenario.data, controller, paths, {p: x.tolist() for p, x in samples.items()}, seed]
    return sha256(json.dumps(what, sort_keys=True, default=str).encode()).hexdigest()


def paths_of(loop: Loop, controller: str, names: list[str]) -> list[str]:
    """The full path of each name: ``K_p`` is the controller's.

    Raises:
        InputError: there is no such number, or one is named twice.
    """
    if "" in names:
        raise InputError(f"{arg('tune')}: '': must be the name of a number, such as K_p")
    found = [name if "." in name else f"controllers.{controller}.{name}" for name in names]
    for path in found:
        known_path(loop, path, "tune")
    refuse_twice(found, arg("tune"))
    return found


def tune(
    loop: Loop, controller: str, names: list[str], samples: dict[str, Array], seed: int = 0,
    tell: Callable[[float], None] | None = None, journal: Path | None = None,
) -> Tuned:  # fmt: skip
    """Search gains, by the cross-entropy method on their logarithms; the same seed finds the same.

    Each trial is simulated on the standard sine with every sample of the friction; those whose error is best are then
    judged for quietness with every sample, and only quiet ones lead the search. After each generation the search is kept in
    ``journal``: one that was stopped goes on from there, and ends with the same gains.

    Raises:
        InputError: a name is no number of the machine, or one that is not positive.
        StribeckError: no gains that were tried are quiet with every sample.
    """
    paths = paths_of(loop, controller, names)
    start = np.array([_value(loop, path) for path in paths])
    if (start <= 0).any():
        at = int(np.argmax(start <= 0))
        raise InputError(
            f"{arg('tune')}: {paths[at]} = {show(float(start[at]))}: must be above 0 to be tuned: the search is by factors"
        )
    few = {path: x[:3] for path, x in samples.items()}  # the middle and both ends lead; all of them decide
    search = _Search.begun(journal, _key(loop, controller, paths, samples, seed), start, seed)
    for generation in range(search.generation, _GENERATIONS):
        if tell is not None:
            tell(generation / _GENERATIONS)
        trials = np.exp(search.mean + search.spread * search.random.standard_normal((_TRIED, len(start))))
        trials = np.clip(trials, start / _FACTOR, start * _FACTOR)
        if generation == 0:
            trials[0] = start
        error = worst_errors(loop, controller, paths, trials, few)
        order = np.argsort(np.where(np.isfinite(error), error, np.inf))[: 2 * _KEPT]
        quiet = _all_quiet(loop, paths, trials[order], few)
        search.tried, search.quiet = search.tried + len(trials), search.quiet + int(quiet.sum())
        kept = order[quiet][:_KEPT]
        for i in kept:
            if error[i] < search.error and _all_quiet(loop, paths, trials[i : i + 1], samples)[0]:
                search.error, search.best = float(error[i]), trials[i]
        if len(kept):
            logs = np.log(trials[kept])
            search.mean, search.spread = logs.mean(axis=0), np.maximum(logs.std(axis=0) * 1.2, 0.02)
        else:
            search.spread = search.spread * 1.3
        search.generation = generation + 1
        search.keep()
    if search.best is None:
        raise StribeckError(
            f"{arg('tune')}: none of {search.tried} sets of gains is quiet with every friction within its interval"
        )
    gains = {path: float(f"{x:.4g}") for path, x in zip(paths, search.best, strict=True)}
    final = np.array([list(gains.values()), start])
    errors = worst_errors(loop, controller, paths, final, samples)
    search.done()
    return Tuned(gains, float(errors[0]), float(errors[1]), search.tried, search.quiet)


def worst_errors(loop: Loop, controller: str, paths: list[str], trials: Array, samples: dict[str, Array]) -> Array:
    """The largest error after reversals over the samples, for each set of gains."""
    errors = reversal_errors(loop, controller, _lanes(paths, trials, samples)).reshape(len(trials), -1)
    return np.asarray(errors.max(axis=1))


def _all_quiet(loop: Loop, paths: list[str], trials: Array, samples: dict[str, Array]) -> NDArray[np.bool_]:
    if not len(trials):
        return np.zeros(0, bool)
    slowest = [time_constant(loop.scenario.with_changes(dict(zip(paths, x.tolist(), strict=True))))[0] for x in trials]
    longer = replace(loop, slowest=max(loop.slowest, *slowest))
    quiet = np.array([j.quiet for j in judge(longer, _lanes(paths, trials, samples))])
    return np.asarray(quiet.reshape(len(trials), -1).all(axis=1))


def _lanes(paths: list[str], trials: Array, samples: dict[str, Array]) -> dict[str, Array]:
    count = len(next(iter(samples.values())))
    lanes = {path: np.tile(x, len(trials)) for path, x in samples.items()}
    return lanes | {path: np.repeat(trials[:, i], count) for i, path in enumerate(paths)}


def _value(loop: Loop, path: str) -> float:
    from stribeck.simulation.places import machine_places

    rig = loop.scenario.rig
    at = machine_places(loop.scenario)[path]
    return rig.values.get(at, 0.0)

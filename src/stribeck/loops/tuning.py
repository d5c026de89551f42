"""Gains by search: the best worst error after reversals among those that stay quiet whatever the friction is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array
from stribeck.constants import show
from stribeck.errors import InputError, StribeckError
from stribeck.loops.boundary import known_path
from stribeck.loops.judge import judge
from stribeck.loops.loop import Loop, time_constant
from stribeck.loops.moves import reversal_errors

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


def paths_of(loop: Loop, controller: str, names: list[str]) -> list[str]:
    """The full path of each name: ``K_p`` is the controller's.

    Raises:
        InputError: there is no such number, or it is 0, which nothing can be a multiple of.
    """
    found = [name if "." in name else f"controllers.{controller}.{name}" for name in names]
    for path in found:
        known_path(loop, path)
    return found


def tune(
    loop: Loop, controller: str, names: list[str], samples: dict[str, Array], seed: int = 0,
    tell: Callable[[float], None] | None = None,
) -> Tuned:  # fmt: skip
    """Search gains, by the cross-entropy method on their logarithms; the same seed finds the same.

    Each trial is simulated on the standard sine with every sample of the friction; those whose error is best are then
    judged for quietness with every sample, and only quiet ones lead the search.

    Raises:
        InputError: a name is no number of the machine, or one that is not positive.
        StribeckError: no gains that were tried are quiet with every sample.
    """
    paths = paths_of(loop, controller, names)
    start = np.array([_value(loop, path) for path in paths])
    if (start <= 0).any():
        at = int(np.argmax(start <= 0))
        raise InputError(
            f"tune: {paths[at]} = {show(float(start[at]))}: must be above 0 to be tuned: the search is by factors"
        )
    few = {path: x[:3] for path, x in samples.items()}  # the middle and both ends lead; all of them decide
    random = np.random.default_rng(seed)
    mean, spread = np.log(start), np.full(len(start), np.log(_FACTOR) / 2)
    best: tuple[float, Array] | None = None
    tried = quiet_count = 0
    for generation in range(_GENERATIONS):
        trials = np.exp(mean + spread * random.standard_normal((_TRIED, len(start))))
        trials = np.clip(trials, start / _FACTOR, start * _FACTOR)
        if generation == 0:
            trials[0] = start
        error = worst_errors(loop, controller, paths, trials, few)
        order = np.argsort(np.where(np.isfinite(error), error, np.inf))[: 2 * _KEPT]
        quiet = _all_quiet(loop, paths, trials[order], few)
        tried, quiet_count = tried + len(trials), quiet_count + int(quiet.sum())
        kept = order[quiet][:_KEPT]
        for i in kept:
            if (best is None or error[i] < best[0]) and _all_quiet(loop, paths, trials[i : i + 1], samples)[0]:
                best = (float(error[i]), trials[i])
        if len(kept):
            logs = np.log(trials[kept])
            mean, spread = logs.mean(axis=0), np.maximum(logs.std(axis=0) * 1.2, 0.02)
        else:
            spread = spread * 1.3
        if tell is not None:
            tell((generation + 1) / _GENERATIONS)
    if best is None:
        raise StribeckError(f"tune: none of {tried} sets of gains is quiet with every friction within its interval")
    gains = {path: float(f"{x:.4g}") for path, x in zip(paths, best[1], strict=True)}
    final = np.array([list(gains.values()), start])
    errors = worst_errors(loop, controller, paths, final, samples)
    return Tuned(gains, float(errors[0]), float(errors[1]), tried, quiet_count)


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
    assert rig is not None
    at = machine_places(loop.scenario)[path]
    return rig.values.get(at, 0.0)

"""By how much the interval of a parameter would shrink with the experiment that is advised for it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.data.filters import SETTLED
from stribeck.identify.features.experiments import advised
from stribeck.identify.features.guess import Sizes
from stribeck.identify.features.what_to_measure import Reach
from stribeck.identify.log import Log
from stribeck.identify.models.columns import Columns
from stribeck.identify.models.dynamic_problem import VelocityProblem
from stribeck.identify.models.separable import Minimum, Separable
from stribeck.identify.models.terms import TERMS
from stribeck.identify.statistics.linear import linearised

_NORMAL = 1.959964
_WORTH = 1.5
_SAMPLED = 0.05  # of the sampling rate: 20 samples in a cycle
_KNOWN = 0.7
# What a filter keeps of half intervals by loops of 20 samples, with a resolution of a hundredth of presliding: measured.
_KEPT = {"sigma_0": 0.02, "sigma_1": 0.3}
_MOST = 100.0  # what is more is not told in numbers: the curvature there is not that far away
_RESOLVED = 1e-12  # of a variance, in the information


@dataclass(frozen=True)
class Effect:
    """The standard deviation that the noise would leave with so many samples of the advised motion, inner coordinates, and
    their own noise, N; ``alone``: fitted without the record, what a position of the resolution that is advised keeps of half
    an interval; ``dropped``: how much of each run the motion's filter takes, s."""

    deviation: float
    samples: int
    noise: float
    alone: float | None = None
    dropped: float = 0.0

    def told(self, half: float | None, stays: float) -> str:
        """In words, for half an interval now, None where none is told, and what of it no further sample takes away: the
        sensor's and the model's part. Inner coordinates are logarithms where there is no interval."""
        after = _NORMAL * self.deviation + (stays if self.alone is None else self.alone)
        how = "beside this record, with" if self.alone is None else "alone, with such a position and"
        behind = (
            f", behind the {self.dropped:.2g} s of each run that the motion's filter drops," if self.dropped else ""
        )
        with_it = f"by {self.samples} samples of it{behind} {how} {self.noise:.2g} N of force noise"
        if half is None:
            # beside a record that shows no curve all hangs on numbers that are nowhere
            within = self.alone is not None and after < _KNOWN
            return f" ({with_it}, it would be known to {after:.2g} of its value)" if within else ""
        if half <= _WORTH * after:
            return ""
        times = f"{half / after:.2g}" if half < _MOST * after else f"more than {_MOST:g}"
        return f" ({with_it}, the interval would be {times} times narrower)"


def by_simulation(
    problem: VelocityProblem, values: dict[str, float], now: Array, names: Sequence[str], name: str, noise: float,
    at: Reach, sizes: Sizes,
) -> Effect | None:  # fmt: skip
    """The effect on a number of a fit by simulation: from the Fisher information of the advised motion at the fitted constants.

    Args:
        now: the covariance of ``names``, inner coordinates.
        noise: of the force, N.
    """
    log = _motion(name, problem.log, at, sizes, values.get("mass", 0.0), False)
    own = [c for c in problem.coordinates if c.name in names]
    beside = [*problem.body, *problem.levels]
    if log is None or noise <= 0 or not np.isfinite(now).all() or problem.late or any(TERMS[n].needs for n in beside):
        return None
    coordinates = [replace(c, rows=None) for c in own]
    if any(c.name not in values for c in coordinates):
        return None
    other = VelocityProblem(log, problem.law, coordinates, problem.fixed, problem.tied, beside)
    slopes = other.sensitivities(other.point(values))
    if slopes is None:
        return None
    names_of = [c.name for c in coordinates]
    order = [list(names).index(n) for n in names_of]
    found = _effect(None if name in _KEPT else now[np.ix_(order, order)], slopes, names_of.index(name), noise)
    return replace(found, alone=_KEPT.get(name)) if found else None


def at_held_speeds(
    model: Separable,
    solution: Minimum,
    now: Array,
    names: Sequence[str],
    name: str,
    noise: float,
    at: Reach,
    sizes: Sizes,
    slopes: Array,
) -> Effect | None:
    """The same of a static fit; ``now`` as its own coordinates are. New rows err together as the record's do: by as much as its
    parts make an interval wider than white noise would."""
    log = _motion(name, model.columns.log, at, sizes, solution.values.get("mass", 0.0), True)
    if log is None or name not in names or noise <= 0 or any(TERMS[n].needs for n in model.terms):
        return None
    found = linearised(model.on(Columns(log, model.columns.sliding, lambda x: x)), solution)
    if found.names != tuple(names):
        return None
    own, k = model.columns.log.bandwidth, list(names).index(name)
    white = noise * float(np.sqrt(np.linalg.pinv(slopes.T @ slopes, hermitian=True)[k, k]))
    together = max(float(np.sqrt(now[k, k])) / white, 1.0) if white > 0 else 1.0
    effect = _effect(now, found.slopes, k, noise, together)
    return replace(effect, dropped=SETTLED / own) if effect and own else effect


def _motion(name: str, log: Log, at: Reach, sizes: Sizes, mass: float, apart: bool) -> Log | None:
    middle = 0.5 * (float(np.max(log.position)) + float(np.min(log.position)))
    found = advised(name, at, sizes, middle, mass, apart)
    if name == "mass" and found is not None:  # a sine that no filter takes away, and that has samples enough
        highest = min(0.5 * (log.bandwidth or np.inf), _SAMPLED / log.step if log.step else np.inf)
        if np.max(abs(found.acceleration)) > 2 * np.pi * highest * np.max(abs(found.velocity)):
            return None
    return found


def _effect(now: Array | None, slopes: Array, k: int, noise: float, together: float = 1.0) -> Effect | None:
    """Of the information of new rows on a covariance; on none, of the rows alone. ``together``: times the noise that rows which
    err together come to."""
    if now is None:
        now = np.diag(1e12 / np.maximum(np.sum(slopes**2, axis=0), 1e-300) * noise**2)
    with np.errstate(invalid="ignore"):
        size = np.sqrt(np.diag(now))
    if not (np.isfinite(size) & (size > 0)).all() or not np.isfinite(slopes).all():
        return None
    value, vector = np.linalg.eigh(now / np.outer(size, size))
    told = vector / np.maximum(value, _RESOLVED * value[-1]) @ vector.T
    information = told + (slopes * size).T @ (slopes * size) / (noise * together) ** 2
    after = float(np.linalg.pinv(information, hermitian=True)[k, k] * size[k] ** 2)
    return Effect(float(np.sqrt(after)), len(slopes), noise) if after > 0 else None

"""A static model as an optimiser sees it: linear in its coefficients, so that a search is left over a few shapes only.

Variable projection (Golub and Pereyra, SIAM J. Numer. Anal. 10(2):413-432, 1973), with the coefficients that cannot be
negative kept so: for given shapes (v_s, k_v, a delay) the best coefficients are found exactly. A wider model that begins
at the shapes of a narrower one can therefore never fit worse.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares, nnls
from scipy.stats import qmc

from stribeck.arrays import Array
from stribeck.errors import InputError
from stribeck.identify.models import delay, play, ripple
from stribeck.identify.models.columns import Columns
from stribeck.identify.models.memory import rows_together
from stribeck.identify.models.terms import TERMS

_GRID, _DRAWS = 25, 6  # points of one shape; 2**draws of several
_REFINED, _APART = 4, 0.15  # starts, which differ so much in the share of one shape: neighbours lead to one minimum
_HIGHEST = 3.0  # of the largest force: what the curve rises above F_c at most, as more was nowhere measured
_END = 1.1  # times the lower end of a search: what lies below is the end itself
_TOLD = 3.841459  # twice the logarithm of a likelihood: what one record in 20 gains by chance
_APART_FROM_CURVE = ("delay", "ripple_waves", "play")
_LITTLE = 1e-7  # of the force: the least that Coulomb friction is
_BEYOND = 1e100  # in a column: squares of what a law of the user's own gives must be numbers


@dataclass(frozen=True)
class Shape:
    """A number that the force is not linear in, and where it is looked for; ``log``: on a logarithmic scale.

    ``seen``, above ``low``, is how far down the record shows it: a place below counts only if it is no end of the search, and
    leaves so many times less (``worth``) of the squares than one above.
    ``usual``: its value in the narrower model in which it is not free, which may lie beyond the search.
    """

    name: str
    low: float
    high: float
    log: bool = True
    seen: float | None = None
    usual: float | None = None
    worth: float = 1.0

    def at(self, share: float) -> float:
        """The value at a share of the way from the low end to the high one."""
        return self.low * (self.high / self.low) ** share if self.log else self.low + share * (self.high - self.low)

    def share(self, value: float) -> float:
        """The share of the way that a value has gone, within 0 and 1."""
        if self.log:
            found = np.log(max(value, 1e-300) / self.low) / np.log(self.high / self.low)
        else:
            found = (value - self.low) / (self.high - self.low)
        return float(np.clip(found, 0.0, 1.0))


@dataclass(frozen=True)
class Minimum:
    """Values of everything that is fitted, and the sum of weighted squares that they leave."""

    values: dict[str, float]
    cost: float


class Separable:
    """The model with its free coefficients and shapes.

    Args:
        columns: of the record.
        held: constants and terms that are given.
        wanted: the law's constants that are free and linear.
        terms: free terms of the body; ``shapes``: what is free and not linear.
        weight: of the rows; 0 leaves one out.
        beside: further columns at the rows that are compared, whose coefficients may have any sign.
    """

    def __init__(
        self,
        columns: Columns,
        held: Mapping[str, float],
        wanted: Sequence[str],
        terms: Sequence[str],
        shapes: Sequence[Shape],
        weight: Array | None = None,
        beside: Mapping[str, Array] | None = None,
    ) -> None:
        self.beside = dict(beside or {})
        self.columns, self.held, self.wanted, self.shapes = columns, dict(held), tuple(wanted), tuple(shapes)
        self.free = tuple(n for n in terms if TERMS[n].column is not None)
        self.terms = tuple(
            dict.fromkeys((*self.free, *(n for n in held if n in TERMS and TERMS[n].column is not None)))
        )
        self.weight = np.ones(len(columns.force)) if weight is None else weight
        self.force = columns.force
        self.highest = _HIGHEST * float(np.max(abs(self.force)))
        self.least = _LITTLE * float(np.sqrt(np.mean(self.force**2)))

    def weighted(self, weight: Array) -> Separable:
        """The same with other weights."""
        return Separable(self.columns, self.held, self.wanted, self.free, self.shapes, weight, self.beside)

    def on(self, columns: Columns) -> Separable:
        """The same on another record."""
        return Separable(columns, self.held, self.wanted, self.free, self.shapes)

    # -- linear ------------------------------------------------------------------------------------------------------

    def matrix(self, shape: Mapping[str, float]) -> tuple[list[str], Array, Array]:
        """The free coefficients, their columns, and what of the force is theirs; F_s stands for its rise above F_c."""
        columns = dict(self.columns.at({**self.held, **shape}, self.terms))
        rest = self.force.copy()
        if "F_s" in columns and "F_c" in columns:
            c, s = columns["F_c"], columns["F_s"]
            if "F_c" in self.wanted or "F_s" in self.wanted:
                if "F_s" in self.wanted:  # F_c (c + s) + (F_s - F_c) s
                    columns["F_c"] = c + s
                    if "F_c" not in self.wanted:
                        rest -= self.held["F_c"] * columns.pop("F_c")
                else:  # F_s (c + s) - (F_s - F_c) c
                    rest -= self.held["F_s"] * (c + s)
                    columns["F_c"] = -c
                    columns.pop("F_s")
        if "F_c" in self.wanted and "F_c" in columns and "F_s" not in self.held:
            rest -= self.least * columns["F_c"]
        names = [n for n in columns if n in self.wanted or n in self.free]
        for name in [n for n in columns if n not in names]:
            rest -= (1.0 if name == "" else {**self.held, **shape}[name]) * columns[name]
        columns, names = {**columns, **self.beside}, [*names, *self.beside]
        matrix = np.column_stack([columns[n] for n in names]) if names else np.zeros((len(rest), 0))
        return names, matrix, rest

    def solve(self, shape: Mapping[str, float]) -> Minimum:
        """The best coefficients for given shapes."""
        return self._solve(shape)[0]

    def _solve(self, shape: Mapping[str, float]) -> tuple[Minimum, Array]:
        names, matrix, rest = self.matrix(shape)
        if not max(np.max(abs(matrix), initial=0.0), np.max(abs(rest), initial=0.0)) < _BEYOND:
            nothing = self._named(names, np.zeros(len(names)))
            return Minimum({**self.held, **shape, **nothing}, np.inf), np.full(len(rest), self.highest * 1e3)
        positive = np.array([TERMS[n].positive if n in TERMS else n not in self.beside for n in names], bool)
        w = self.weight
        x = bounded(matrix * w[:, None], rest * w, positive)
        rise, most = self._limited(names, shape, x)
        if rise is not None and x[rise] > most:
            others = np.arange(len(names)) != rise
            less = rest - most * matrix[:, rise]
            x[others] = bounded(matrix[:, others] * w[:, None], less * w, positive[others])
            x[rise] = most
        missed = w * (matrix @ x - rest)
        return Minimum({**self.held, **shape, **self._named(names, x)}, float(missed @ missed)), missed

    def _limited(self, names: Sequence[str], shape: Mapping[str, float], x: Array) -> tuple[int | None, float]:
        """The coefficient that is F_s - F_c, and the most that it may be: where F_s is given, F_c must stay positive."""
        if "F_s" in names:
            rise = names.index("F_s")
            return rise, self._highest_rise(shape, float(x[rise]))
        if "F_c" in names and "F_s" in self.held:
            return names.index("F_c"), max(self.held["F_s"] - self.least, 0.0)
        return None, 0.0

    def _highest_rise(self, shape: Mapping[str, float], rise: float) -> float:
        """The most that F_s may be above F_c, so that the curve's peak is no more than was ever measured."""
        if rise <= self.highest:
            return self.highest
        own = {n: v for n, v in {**self.held, **shape}.items() if n in self.columns.sliding.law.constants()}
        own = {n: v for n, v in own.items() if n not in self.columns.names}
        bend = self.columns.sliding.table(own, self.columns.fastest, self.columns.names)[1]["F_s"]
        return self.highest / max(float(np.max(abs(bend))), 1e-300)

    def _named(self, names: Sequence[str], x: Array) -> dict[str, float]:
        found = dict(zip(names, x.tolist(), strict=True))
        if "F_c" in found and "F_s" in self.held:
            found["F_c"] = max(self.held["F_s"] - found["F_c"], self.least)
        elif "F_c" in found:
            found["F_c"] += self.least
        if "F_s" in found:
            found["F_s"] += found.get("F_c", self.held.get("F_c", 0.0))
        return found

    def force_at(self, values: Mapping[str, float]) -> Array:
        """The model's force for given values."""
        columns = {**self.columns.at(values, self.terms), **self.beside}
        return np.asarray(sum((values.get(name, 1.0) if name else 1.0) * x for name, x in columns.items()))

    # -- shapes ------------------------------------------------------------------------------------------------------

    def search(self, warm: Sequence[Mapping[str, float]] = (), everywhere: bool = True) -> Minimum:
        """The best of a grid of shapes, refined.

        Args:
            warm: shapes of narrower models; those missing in them begin where they matter least.
            everywhere: look over the whole grid; else only over shapes that are not in the first of ``warm``.

        Raises:
            InputError: the law's force is not finite at the record's speeds.
        """
        if not self.shapes:
            return self._told(self.solve({}))
        starts = self._apart(self.grid()) if everywhere or not warm else self._around(warm[0])
        known = [w for w in warm if "ripple_waves" in w or all(s.name != "ripple_waves" for s in self.shapes)]
        starts += [{s.name: w.get(s.name, self._harmless(s)) for s in self.shapes} for w in known]
        found = min((self.refined(start) for start in starts), key=self._rank)
        narrower = [] if warm else self._narrower()  # a model that is chosen among many is chosen by data left out
        return self._told(min((found, *narrower), key=self._rank))

    def _narrower(self) -> list[Minimum]:
        """The optima of the models in which a shape has its usual value, and what is refined from there: freeing it never fits
        worse."""
        others = []
        for shape in (s for s in self.shapes if s.usual is not None):
            rest, held = (
                [s for s in self.shapes if s is not shape],
                {**self.held, shape.name: float(shape.usual or 0.0)},
            )
            narrow = Separable(self.columns, held, self.wanted, self.free, rest, self.weight, self.beside)
            others.append(narrow.search() if rest else narrow.solve({}))
            if shape.low < held[shape.name] < shape.high:
                others.append(self.refined(others[-1].values))
        return others

    def _told(self, found: Minimum) -> Minimum:
        """What was found, where the law has a force at the record's speeds."""
        if np.isfinite(found.cost):
            return found
        v = self.columns.log.velocity
        text = f"gives no force within 1e100 in size at the speeds of this record ({np.min(v):.3g} to {np.max(v):.3g})"
        raise InputError(f"law '{self.columns.sliding.law.name}': {text}")

    def as_seen(
        self, found: Minimum, warm: Sequence[Mapping[str, float]] = (), everywhere: bool = True
    ) -> tuple[Separable, Minimum]:
        """The same with the search no farther down than the record shows, where a place below that is not told: the search
        ends there, or the likelihood gains little. Otherwise as it is."""
        below = [s for s in self.shapes if s.seen and found.values[s.name] < s.seen]
        if not below:
            return self, found
        at_end = [s for s in below if found.values[s.name] <= _END * s.low]
        if doubtful := at_end or [s for s in below if s.worth > 1]:
            narrow = self._as_far_as_seen(doubtful)
            near = narrow.search(warm, everywhere)
            if at_end or near.cost < max(s.worth for s in doubtful) * found.cost:
                return narrow.as_seen(near, warm, everywhere)
        narrow = self._as_far_as_seen(self.shapes)
        near = narrow.search(warm, everywhere)
        counted = self.weight > 0  # neighbouring rows err alike: they tell a thing once
        rows = np.count_nonzero(counted) / rows_together((self.force - self.force_at(found.values))[counted])
        gain = rows * np.log(near.cost / max(found.cost, 1e-300))
        return (self, found) if gain > _TOLD else (narrow, near)

    def _as_far_as_seen(self, which: Sequence[Shape]) -> Separable:
        shapes = [replace(s, low=s.seen or s.low, seen=None) if s in which else s for s in self.shapes]
        return Separable(self.columns, self.held, self.wanted, self.free, shapes, self.weight, self.beside)

    def _apart(self, found: Sequence[Minimum]) -> list[dict[str, float]]:
        """The best of solutions that lie apart."""
        starts: list[dict[str, float]] = []
        for shape in (self._shape_of(s.values) for s in found):
            if all(max(abs(s.share(shape[s.name]) - s.share(x[s.name])) for s in self.shapes) > _APART for x in starts):
                starts.append(shape)
        return starts[:_REFINED]

    def _around(self, known: Mapping[str, float]) -> list[dict[str, float]]:
        """The best places of the shapes that are not known yet, the others where they are known to be."""
        missing = [s for s in self.shapes if s.name not in known]
        if not missing:
            return []
        held = {**self.held, **{s.name: known[s.name] for s in self.shapes if s.name in known}}
        narrow = Separable(self.columns, held, self.wanted, self.free, missing, self.weight, self.beside)
        return [{**known, **narrow._shape_of(s.values)} for s in narrow.grid()[:1]]

    def grid(self) -> list[Minimum]:
        """Solutions over a grid of shapes, the best first; a delay and a ripple are looked for at the best of the others."""
        curve = [s for s in self.shapes if s.name not in _APART_FROM_CURVE]
        late = [s for s in self.shapes if s.name == "delay"]
        if not curve:
            trials = np.zeros((1, 0))
        elif len(curve) == 1:
            trials = np.linspace(0, 1, _GRID)[:, None]
        else:
            trials = np.vstack([qmc.Sobol(len(curve), seed=0).random_base2(_DRAWS), _corners(len(curve))])
        still = {s.name: self._harmless(s) for s in self.shapes if s not in curve}
        found = [
            self.solve({**still, **{s.name: s.at(x) for s, x in zip(curve, t, strict=True)}}) for t in trials.tolist()
        ]
        found.sort(key=self._rank)
        for shape in late:
            step = self.columns.log.step
            delays = [sign * x * step for x in delay.STEPS for sign in (1, -1)]
            delays = [d for d in delays if shape.low <= d <= shape.high]
            more = [self.solve({**self._shape_of(s.values), "delay": d}) for s in found[:2] for d in delays]
            found = sorted([*found, *more], key=self._rank)
        for shape in (s for s in self.shapes if s.name == "ripple_waves"):
            at = self._shape_of(found[0].values)
            more = [self.solve({**at, shape.name: x}) for x in self._waves(found[0], shape)]
            found = sorted([*found, *more], key=self._rank)
        for shape in (s for s in self.shapes if s.name == "play"):
            more = [
                self.solve({**at, shape.name: x})
                for at in self._sharp(found[0])
                for x in play.places(shape.low, shape.high)
            ]
            found = sorted([*found, *more], key=self._rank)
        return found

    def _sharp(self, found: Minimum) -> list[dict[str, float]]:
        """The shapes of a solution, and with a sign that jumps: a smooth one may have stood in for play."""
        at = self._shape_of(found.values)
        return [at, *({**at, s.name: s.high} for s in self.shapes if s.name == "k_v")]

    def _waves(self, found: Minimum, shape: Shape) -> list[float]:
        """How many waves the residual of a solution without a ripple shows."""
        plain = {**found.values, "ripple_sin": 0.0, "ripple_cos": 0.0}
        counted = self.weight > 0
        left = (self.force - self.force_at(plain))[counted]
        return ripple.peaks(self.columns.position[counted], left, shape.low, shape.high)

    def _rank(self, solution: Minimum) -> float:
        """The cost; a bend that takes the whole level is none."""
        whole = "F_c" in self.wanted and solution.values["F_c"] <= 2 * self.least and "F_s" in self.wanted
        return solution.cost * (1e6 if whole else 1.0)

    def refined(self, start: Mapping[str, float], evaluations: int = 15) -> Minimum:
        """A minimum near given shapes, never worse than them."""
        shape = self._shape_of(start)
        first = self._solve(shape)[0]
        if not np.isfinite(first.cost):
            return first
        inside = np.clip([s.share(shape[s.name]) for s in self.shapes], 1e-6, 1 - 1e-6)
        scale = np.sqrt(max(first.cost, 1e-300))

        def missed(shares: Array) -> Array:
            return np.asarray(self._solve(self._at(shares))[1] / scale)

        found = least_squares(
            missed,
            inside,
            bounds=(0, 1),
            x_scale=0.1,
            diff_step=np.array(1e-5),
            max_nfev=evaluations,
            ftol=1e-8,
            xtol=1e-7,
        )
        last = self.solve(self._at(found.x))
        return last if self._rank(last) <= self._rank(first) else first

    def _at(self, shares: Array) -> dict[str, float]:
        return {s.name: s.at(x) for s, x in zip(self.shapes, shares.tolist(), strict=True)}

    def _shape_of(self, values: Mapping[str, float]) -> dict[str, float]:
        return {s.name: float(np.clip(values[s.name], s.low, s.high)) for s in self.shapes}

    def _harmless(self, shape: Shape) -> float:
        """Where a shape changes the curve least: a steep sign, no delay, the shortest play."""
        ends = {"delay": 0.0, "k_v": shape.high, "play": shape.low}
        return ends.get(shape.name, shape.at(0.5))


def bounded(matrix: Array, rest: Array, positive: NDArray[np.bool_]) -> Array:
    """Least squares with some of the coefficients at least 0."""
    count = matrix.shape[1]
    if not count:
        return np.zeros(0)
    size = np.sqrt(np.mean(matrix**2, axis=0))
    size = np.where(size > 0, size, 1.0)
    order = np.concatenate([np.flatnonzero(~positive), np.flatnonzero(positive)])
    triangle = np.asarray(np.linalg.qr(np.column_stack([matrix[:, order] / size[order], rest]), mode="r"))
    triangle, right = triangle[:count, :count], triangle[:count, count]
    x = np.linalg.lstsq(triangle, right, rcond=1e-12)[0]
    first = int((~positive).sum())
    if np.any(x[first:] < 0):
        held = nnls(triangle[first:, first:], right[first:])[0]
        top = right[:first] - triangle[:first, first:] @ held
        x = np.concatenate([np.linalg.lstsq(triangle[:first, :first], top, rcond=1e-12)[0] if first else [], held])
    out = np.zeros(count)
    out[order] = x
    return np.asarray(out / size)


def _corners(count: int) -> Array:
    """The ends of each shape with the others in the middle."""
    points = np.full((2 * count, count), 0.5)
    for i in range(count):
        points[2 * i, i], points[2 * i + 1, i] = 0.02, 0.98
    return points

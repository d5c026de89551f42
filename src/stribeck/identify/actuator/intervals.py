"""How well each number is told: the residuals' memory, profiles of the likelihood, groups that go together."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import chi2, f

from stribeck.arrays import Array
from stribeck.identify.actuator.problem import MachineProblem
from stribeck.identify.actuator.result import Group
from stribeck.identify.actuator.solve import direction, half_squares

THRESHOLD = float(chi2.ppf(0.95, 1))
WHITE = 1.5  # samples in which residuals forget, up to which they are taken as white
_CLOSE = 0.01  # of the threshold's root
_TRIES = 12
_DAMPINGS = (1e-6, 1e-2)
_RELATED = 0.95
_LOST = 3.0  # times the height of an end: the others may not have followed yet
_HALF, _ON = 0.5, 1.3
_NEARER = 0.7  # of the height before: they do


@dataclass(frozen=True)
class Spread:
    """The slopes at the optimum, the covariance there, and by how much each variance is greater than for white residuals."""

    J: Array
    covariance: Array
    inflation: Array
    memory: dict[str, float]  # by column: samples in which the residuals forget
    freedom: float
    moved: Array | None = None  # residuals as noise of the inputs moves them, a row for each draw

    @property
    def deviations(self) -> Array:
        """The standard deviation of each coordinate, with the inflation."""
        return np.sqrt(np.maximum(np.diag(self.covariance) * self.inflation, 0.0))

    def moved_by(self, off: Array) -> Array:
        """How far each coordinate would move, in its deviations, if these residuals were off by so much."""
        with np.errstate(all="ignore"):
            return np.asarray(abs(self.covariance @ (self.J.T @ off)) / self.deviations)


def widened(s: Spread, moved: Array, explained: bool) -> Spread:
    """The spread with noise of the inputs, which moves the residuals so, a row for each draw; where it has ``explained`` what
    is left, its size is known from the inputs, and the residuals need not tell it."""
    plain = np.diag(s.covariance)
    more = np.mean((moved @ s.J @ s.covariance) ** 2, axis=0)
    with np.errstate(all="ignore"):
        inflation = np.where(plain > 0, np.maximum(s.inflation, 1 + more / np.where(plain > 0, plain, 1.0)), 1.0)
    return replace(s, inflation=inflation, freedom=float(len(s.J)) if explained else s.freedom, moved=moved)


def spread(problem: MachineProblem, u: Array) -> Spread:
    """The covariance at the optimum, and its inflation by what the residuals remember."""
    r = problem.residuals(u[None])[0]
    J = problem.slopes(u[None], np.full(len(u), problem.step))[1][0]
    rough = inverse(J)
    step = np.clip(0.3 * np.sqrt(np.diag(rough)), 1e-5, 2e-2)
    J = problem.central(u, step)
    covariance = inverse(J)
    lags, memory, independent = remembered(problem, r)
    inflation = np.ones(len(u))
    meat = scores(problem, r, J, lags)
    sandwich = covariance @ meat @ covariance
    plain = np.diag(covariance)
    with np.errstate(all="ignore"):
        inflation = np.where(plain > 0, np.maximum(np.diag(sandwich) / np.where(plain > 0, plain, 1.0), 1.0), 1.0)
    free = max(independent - len(u), 1.0)
    return Spread(J, covariance, inflation, memory, free)


def inverse(J: Array) -> Array:
    """(J^T J)^-1, large where the slopes tell nothing."""
    A = J.T @ J
    size = np.sqrt(np.maximum(np.diag(A), 1e-30))
    values, vectors = np.linalg.eigh(A / np.outer(size, size))
    values = np.maximum(values, 1e-12)
    return np.asarray((vectors / values) @ vectors.T / np.outer(size, size))


def remembered(problem: MachineProblem, r: Array) -> tuple[dict[int, int], dict[str, float], float]:
    """For each target, by its first number, the lags over which its residuals are correlated; the time (in samples) in
    which each column forgets, its integrated autocorrelation; and how many independent residuals there are."""
    lags: dict[int, int] = {}
    times: dict[str, list[float]] = {}
    independent = 0.0
    for at, size, column in places(problem):
        x = r[at : at + size]
        x = x - x.mean()
        n = len(x)
        power = np.abs(np.fft.rfft(x, 2 * n)) ** 2
        rho = np.fft.irfft(power)[:n]
        rho = rho / rho[0] if rho[0] > 0 else np.eye(1, n)[0]
        limit = 2.0 / np.sqrt(n)
        last = int(np.argmax(rho[1:] < limit)) + 1 if (rho[1:] < limit).any() else n - 1
        whole = max(1.0 + 2.0 * float(np.sum(rho[1:last])), 1.0)
        lags[at] = min(int(3 * last), n - 1) if last > 1 else 0
        times.setdefault(column, []).append(whole)
        independent += n / whole
    return lags, {name: float(np.mean(x)) for name, x in times.items()}, independent


def places(problem: MachineProblem) -> list[tuple[int, int, str]]:
    """Where the residuals of each target stand: their first, how many, and the column."""
    found = []
    for k, run in enumerate(problem.runs):
        at = int(problem.first[k])
        for target in run.targets:
            found.append((at, len(target.t), target.column))
            at += len(target.t)
    return found


def scores(problem: MachineProblem, r: Array, J: Array, lags: dict[int, int]) -> Array:
    """The covariance of the slopes times the residuals: Newey and West's, with Bartlett's window over each memory."""
    total = np.zeros((J.shape[1], J.shape[1]))
    for at, size, _ in places(problem):
        g = J[at : at + size] * r[at : at + size, None]
        own = g.T @ g
        reach = lags[at]
        if reach:
            n = 2 * size
            window = np.zeros(n)
            weights = 1 - np.arange(reach + 1) / (reach + 1)
            window[: reach + 1] = weights
            window[-reach:] = weights[1:][::-1]
            spectrum = np.fft.rfft(g, n, axis=0)
            smooth = np.fft.irfft(spectrum * np.fft.rfft(window).real[:, None], n, axis=0)[:size]
            own = g.T @ smooth
        total += 0.5 * (own + own.T)
    rest = J[problem.first[-1] :]
    return np.asarray(total + rest.T @ rest)


def threshold(freedom: float) -> float:
    """How far twice the log-likelihood falls at the ends of a 95 % interval, with the noise estimated from so many."""
    return THRESHOLD if freedom > 1000 else float(f.ppf(0.95, 1, max(freedom, 1.0)))


@dataclass(frozen=True)
class Ends:
    """The ends of an interval (coordinates; None: open), the profile and, where one came out lower, that point."""

    low: float | None
    high: float | None
    curve: list[tuple[float, float]]
    lower: Array | None = None


def profiles(problem: MachineProblem, u: Array, s: Spread, wanted: list[int]) -> dict[int, Ends]:
    """The 95 % profile intervals of the coordinates ``wanted``; all sides of all of them advance together in lanes."""
    base = float(half_squares(problem.residuals(u[None]))[0])
    root = np.sqrt(threshold(s.freedom))
    sides = [_Side(problem, u, s, k, sign, root) for k in wanted for sign in (-1, 1)]
    for _ in range(_TRIES):
        for some in (
            [x for x in sides if not x.done and not x.doubted],
            [x for x in sides if not x.done and x.doubted],
        ):
            if some:
                _advance(problem, some, base)
    found = {}
    for k in wanted:
        pair = [x for x in sides if x.k == k]
        curve = sorted([*pair[0].curve, (float(u[k]), 0.0), *pair[1].curve])
        lower = next((x.lower for x in pair if x.lower is not None), None)
        found[k] = Ends(pair[0].end, pair[1].end, curve, lower)
    return found


def _advance(problem: MachineProblem, sides: list[_Side], base: float) -> None:
    """One step of these sides, all doubted or none: the other coordinates follow by the slopes that each side has, which
    are kept up by Broyden's formula; doubted ones get new slopes."""
    points = np.array([x.point() for x in sides])
    if sides[0].doubted:
        r, J = problem.slopes(points, np.full(points.shape[1], problem.step))
        for side, own in zip(sides, J, strict=True):
            side.J = own if np.isfinite(own).all() else side.J
    else:
        r = problem.residuals(points)
    trials = []
    for side, x, left in zip(sides, points, r, strict=True):
        rest = side.J.copy()
        rest[:, side.k] = 0.0
        for damping in _DAMPINGS:
            step = direction(np.nan_to_num(left), rest, x, problem, damping)
            step[side.k] = 0.0
            trials.append(x + step)
    tried = np.clip(np.array(trials), problem.low, problem.high).reshape(len(sides), len(_DAMPINGS), -1)
    new = problem.residuals(tried.reshape(-1, points.shape[1])).reshape(len(sides), len(_DAMPINGS), -1)
    for i, side in enumerate(sides):
        costs, x, cost = half_squares(new[i]), points[i], half_squares(r[i : i + 1])[0]
        j = int(np.argmin(costs))
        move = tried[i, j] - x
        if not side.doubted and np.isfinite(new[i, j]).all() and np.isfinite(r[i]).all() and move @ move > 0:
            side.J = side.J + np.outer(new[i, j] - r[i] - side.J @ move, move) / (move @ move)
        if costs[j] < cost:
            x, cost = tried[i, j], costs[j]
        side.take(x, 2 * (float(cost) - base))


class _Side:
    """One side of a profile on its way to where the cost has risen by the threshold."""

    def __init__(self, problem: MachineProblem, u: Array, s: Spread, k: int, sign: int, root: float) -> None:
        self.k, self.sign, self.u, self.root, self.problem = k, sign, u, root, problem
        self.unit = float(s.inflation[k])
        self.edge = float(abs((problem.high if sign > 0 else problem.low)[k] - u[k]))
        c = s.covariance
        self.along = c[:, k] / c[k, k] if c[k, k] > 0 else np.eye(len(u))[k]
        self.distance = min(max(root * float(s.deviations[k]), 1e-7), self.edge)
        self.near, self.far = (0.0, 0.0), None  # type: tuple[float, float], tuple[float, float] | None
        self.best = u
        self.done, self.end, self.curve = self.edge <= 1e-9, None, []  # type: bool, float | None, list[tuple[float, float]]
        self.lower: Array | None = None
        self.J, self.doubted, self.at, self.before = s.J, False, u, np.inf
        self.last, self.slope = u, self.along * sign  # where it was followed to, and how the others went there

    def point(self) -> Array:
        """Where to look next."""
        if self.doubted:
            return self.at
        found = self.last + self.slope * (self.distance - self.near[0])
        found[self.k] = self.u[self.k] + self.sign * self.distance
        return np.asarray(np.clip(found, self.problem.low, self.problem.high))

    def take(self, point: Array, rise: float) -> None:
        """What was found there."""
        if rise < -0.05 * self.unit:
            self.lower, self.done = point, True
            return
        height = float(np.sqrt(max(rise, 0.0) / self.unit))
        last = abs(height - self.root) < _CLOSE * self.root or (
            height < self.root and self.distance >= self.edge * (1 - 1e-9)
        )
        lost = height > _LOST * self.root and height < _NEARER * self.before
        if (last and not self.doubted) or lost:  # an end must hold with slopes of its own
            self.doubted, self.at, self.before = True, point, height
            return
        if self.doubted and self.far is not None and height < self.root and self.far[0] <= self.distance:
            self.far, self.end = None, None
        self.doubted, self.before = False, np.inf
        self.curve.append((float(point[self.k]), height**2))
        here = (self.distance, height)
        if abs(height - self.root) < _CLOSE * self.root:
            self._stop_at(self.distance)
            return
        if height < self.root:
            if self.distance > self.near[0]:
                self.slope = (point - self.last) / (self.distance - self.near[0])
            self.near, self.last = here, point
            if self.distance >= self.edge * (1 - 1e-9):
                self.done = True
                return
        else:
            self.far = here
        if self.far is None:
            self.distance = min(self.distance * min(max(self.root / max(height, 1e-3), 1.05), 3.0), self.edge)
        else:
            share = (self.root - self.near[1]) / max(self.far[1] - self.near[1], 1e-12)
            share = 0.5 if self.far[1] > _LOST * self.root else share
            self.distance = self.near[0] + min(max(share, 0.05), 0.95) * (self.far[0] - self.near[0])
            rose = self.near[1] > _HALF * self.root  # else it is the others that did not follow there
            self.end = float(self.u[self.k] + self.sign * self.far[0]) if rose else None  # if the tries run out
            if self.far[0] - self.near[0] < 1e-3 * self.far[0]:
                self.done = rose
                self.far, self.distance = None, min(_ON * self.near[0], self.edge)

    def _stop_at(self, distance: float) -> None:
        self.end, self.done = float(self.u[self.k] + self.sign * distance), True


def groups(s: Spread, names: list[str], told: list[int]) -> list[Group]:
    """Groups of coordinates that can stand for each other, with the direction that the recordings tell least."""
    c = s.covariance[np.ix_(told, told)]
    size = np.sqrt(np.maximum(np.diag(c), 1e-300))
    relation = c / np.outer(size, size)
    left = set(range(len(told)))
    found: list[Group] = []
    while left:
        group, todo = set(), [left.pop()]
        while todo:
            i = todo.pop()
            group.add(i)
            near = {j for j in left if abs(relation[i, j]) > _RELATED}
            left -= near
            todo += list(near)
        if len(group) > 1:
            order = sorted(group)
            pairs = {f"{names[a]} ~ {names[b]}": float(relation[a, b]) for a in order for b in order
                     if a < b and abs(relation[a, b]) > _RELATED}  # fmt: skip
            found.append({"names": [names[i] for i in order], "correlation": pairs})
    return found

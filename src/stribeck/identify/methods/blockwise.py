"""Least squares whose unknowns are constants of all rows and, beside them, numbers that only the rows of one window hang on.

The derivatives are a block arrow. Each window's own numbers are eliminated by a QR of its rows, so that a step costs what
the constants alone would (Björck, Numerical Methods for Least Squares Problems, SIAM 1996, section 6.3); the steps are
damped by Levenberg and Marquardt, in units of the derivatives' size (Moré, The Levenberg-Marquardt algorithm, 1978).
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array
from stribeck.identify.models.problem import Coordinate

_FIRST, _LEAST, _MOST = 1e-4, 1e-12, 1e12  # of the damping, beside the squared size of the derivatives
_SOFTER, _HARDER = 0.1, 8.0
_STILL = 1e-9  # of the point: a step that goes nowhere
_TRUSTED, _POOR = 0.75, 0.25  # of what a step was to gain: less damping from here on, more below


class Blocks(Protocol):
    """What is solved: a :class:`stribeck.identify.models.problem.Problem`, or what watches over one."""

    @property
    def coordinates(self) -> tuple[Coordinate, ...]:
        """What is free."""

    @property
    def bounds(self) -> tuple[Array, Array]:
        """Lowest and highest point."""

    @property
    def lanes(self) -> list[list[int]]:
        """The coordinates whose derivatives stand in one column of :meth:`slopes`."""

    def residual(self, u: Array) -> Array:
        """Scaled misfits, then the wall's residuals: how far it is passed."""

    def slopes(self, u: Array) -> Array | None:
        """The derivatives of the scaled misfits, (rows, lanes); None where the simulation fails."""

    def wall(self, u: Array) -> Array:
        """The derivatives of the length of the wall's residuals by each coordinate; 0 on this side of it."""


@dataclass(frozen=True)
class Solved:
    """Where the descent ended, half the sum of squares there, and why; ``converged``: its last step met a tolerance."""

    point: Array
    cost: float
    converged: bool
    reason: str


def solve_blocks(
    problem: Blocks, start: Array, tolerance: float, evaluations: int, held: Collection[int] = ()
) -> Solved:
    """The point of least squares that is reached from a start, within the bounds.

    Args:
        problem: gives residuals and derivatives.
        start: the first point.
        tolerance: it ends where a step lowers the cost by less than this share.
        evaluations: of the residuals, at most.
        held: the coordinates that stay as they are.
    """
    low, high = problem.bounds
    arrow = _Arrow(problem)
    free = np.ones(len(start), bool)
    free[list(held)] = False
    u = np.clip(start, low, high)
    residual = problem.residual(u)
    cost, tried, damping = 0.5 * float(residual @ residual), 1, _FIRST
    size = np.zeros(len(u))
    while tried < evaluations:
        slopes, wall, faced = problem.slopes(u), problem.wall(u), False
        if slopes is None:
            return Solved(u, cost, False, "the simulation fails beside this point")
        arrow.take(slopes, residual, wall)
        size = np.maximum(size, arrow.size)
        pushed = ((u <= low) & (arrow.gradient > 0)) | ((u >= high) & (arrow.gradient < 0))
        moves = free & ~pushed
        while tried < evaluations:
            step, due = arrow.step(damping, size, moves)
            there = np.clip(u + step, low, high)
            went = float(np.linalg.norm((there - u) * size))
            after = problem.residual(there)
            lower, tried = 0.5 * float(after @ after), tried + 1
            gain = (cost - lower) / due if due > 0 else -1.0
            small = went <= _STILL * float(np.linalg.norm(u * size))
            slight = due <= tolerance * cost and cost - lower <= tolerance * cost
            passed = float(np.linalg.norm(after[len(slopes) :]))
            if lower >= cost and passed > 0 and not faced:  # along the wall, not through it
                faced = True
                arrow.face(problem.wall(there), passed, step)
                continue
            damping *= _SOFTER if gain > _TRUSTED else 1.0 if gain > _POOR else _HARDER
            damping = max(damping, _LEAST)
            if lower < cost:
                u, cost, residual = there, lower, after
                if small or slight:
                    return Solved(u, cost, True, "the last step changed little")
                break
            if small or slight or damping > _MOST:
                return Solved(u, cost, True, "no step leads lower")
    return Solved(u, cost, False, f"ended after {tried} evaluations")


class _Arrow:
    """The derivatives at a point, each window's rows reduced to a triangle of its own numbers, the constants and the
    residual."""

    def __init__(self, problem: Blocks) -> None:
        of = problem.coordinates
        lane_of = {i: lane for lane, some in enumerate(problem.lanes) for i in some}
        self.many = len(of)
        self.shared = np.array([i for i, c in enumerate(of) if c.rows is None], int)
        self.shared_lanes = [lane_of[i] for i in self.shared.tolist()]
        windows: dict[tuple[int, int], list[int]] = {}
        for i, c in enumerate(of):
            if c.rows is not None:
                windows.setdefault((c.rows.start, c.rows.stop), []).append(i)
        self.windows = [(slice(a, b), own, [lane_of[i] for i in own]) for (a, b), own in windows.items()]
        self.own = max((len(own) for _, own, _ in self.windows), default=0)
        # a window with fewer numbers than another has a place that nobody fills
        self.places = np.full((len(self.windows), self.own), self.many)
        for k, (_, own, _) in enumerate(self.windows):
            self.places[k, : len(own)] = own

    def take(self, slopes: Array, residual: Array, wall: Array) -> None:
        """The derivatives and residual at another point."""
        rows, own, n = len(slopes), self.own, len(self.shared)
        width = own + n + 1
        self.triangles = np.zeros((len(self.windows), width, width))
        alone = np.ones(rows, bool)
        self.gradient, self.size = np.zeros(self.many), np.zeros(self.many)
        shared = slopes[:, self.shared_lanes]
        self.gradient[self.shared] = shared.T @ residual[:rows]
        self.size[self.shared] = np.einsum("ij,ij->j", shared, shared)
        for k, (part, numbers, lanes) in enumerate(self.windows):
            alone[part] = False
            block = np.zeros((part.stop - part.start, width))
            block[:, : len(lanes)] = slopes[part][:, lanes]
            block[:, own:-1], block[:, -1] = shared[part], residual[:rows][part]
            self.gradient[numbers] = block[:, : len(lanes)].T @ block[:, -1]
            self.size[numbers] = np.einsum("ij,ij->j", block[:, : len(lanes)], block[:, : len(lanes)])
            if len(block):
                triangle = _triangle(block)
                self.triangles[k, : len(triangle)] = triangle
        distance = float(np.linalg.norm(residual[rows:]))
        others = np.column_stack([shared[alone], residual[:rows][alone]])
        self.others = _triangle(np.vstack([others, np.append(wall[self.shared], distance)]))
        self.size = np.sqrt(self.size)
        self.size[self.size <= 0] = 1.0
        self.gradient += wall * distance

    def face(self, wall: Array, passed: float, step: Array) -> None:
        """A step leads through a wall: its derivatives there, and by how much it is passed."""
        self.others = np.vstack([self.others, np.append(wall[self.shared], passed - float(wall @ step))])

    def step(self, damping: float, size: Array, moves: NDArray[np.bool_]) -> tuple[Array, float]:
        """The damped step of the coordinates that move, and by how much it would lower the cost of a linear model."""
        own, n = self.own, len(self.shared)
        weight = np.append(np.where(moves, np.sqrt(damping) * size, 1.0), 1.0)
        moving = np.append(moves, False)
        columns = np.ones((len(self.windows), 1, own + n + 1))
        columns[:, 0, :own], columns[:, 0, own:-1] = moving[self.places], moves[self.shared]
        top = self.triangles * columns
        blocks = np.concatenate([top, _diagonal(weight[self.places], own + n + 1)], axis=1)
        reduced = _triangle(blocks) if own and len(blocks) else np.zeros((0, 1, n + 1))
        rest = reduced[:, own:, own:].reshape(-1, n + 1)
        others = self.others * np.append(moves[self.shared], 1.0)
        last = np.vstack([rest, others, _diagonal(weight[self.shared][None, :], n + 1)[0]])
        found = np.zeros(self.many + 1)
        if n:
            triangle = _triangle(last)
            found[self.shared] = np.linalg.solve(triangle[:n, :n], -triangle[:n, n])
        if own and len(blocks):
            right = -reduced[:, :own, -1] - reduced[:, :own, own:-1] @ found[self.shared]
            found[self.places] = np.linalg.solve(reduced[:, :own, :own], right[..., None])[..., 0]
        step = np.where(moves, found[:-1], 0.0)
        # of the damped normal equations: half of step'J'J step is -(gradient + damping size^2 step)'step/2
        due = -0.5 * float(self.gradient @ step) + 0.5 * damping * float(np.sum((size * step) ** 2))
        return step, due


def _triangle(matrix: Array) -> Array:
    """R of QR, of each matrix of a stack."""
    return np.asarray(np.linalg.qr(matrix, mode="r"))


def _diagonal(values: Array, width: int) -> Array:
    """For each row of values a diagonal of them, with columns of zeros up to a width."""
    count, n = values.shape
    found = np.zeros((count, n, width))
    found[:, np.arange(n), np.arange(n)] = values
    return found

"""Least squares with numbers of windows' own, against SciPy on the same residuals written apart."""

import numpy as np
import pytest
from scipy.optimize import least_squares

from stribeck.identify.methods.blockwise import solve_blocks
from stribeck.identify.models.dynamic_problem import velocity_problem
from stribeck.identify.models.problem import Coordinate, linear_step
from tests.identify import rig

WINDOWS = (slice(0, 30), slice(30, 70), slice(70, 75))
WALL = 1e3


class Decays:
    """y = a exp(-b t) of all rows, an offset of the first two windows and a slope of the second beside it; rows 75 to 90
    belong to no window. ``most``: the highest a; a number of the law's may not pass ``wall``."""

    lanes = [[0], [1], [2, 3], [4]]

    def __init__(self, most=10.0, wall=np.inf):
        draw = np.random.default_rng(1)
        self.t = np.linspace(0, 3, 90)
        self.highest, whole = wall, Coordinate("a", "", -10.0, most, log=False)
        own = [Coordinate("o", "", -5.0, 5.0, log=False, rows=WINDOWS[i]) for i in (0, 1, 1)]
        self.coordinates = (whole, Coordinate("b", "", 0.01, 10.0, log=False), *own)
        self.bounds = np.array([c.low for c in self.coordinates]), np.array([c.high for c in self.coordinates])
        self.measured = 3 * np.exp(-0.7 * self.t) + 0.3 * draw.standard_normal(90)
        self.measured[WINDOWS[0]] += 1.0
        self.measured[WINDOWS[1]] += 0.5 - 0.8 * np.arange(40) / 40

    def residual(self, u):
        inside = np.append(min(u[0], self.highest), u[1:])
        y = inside[0] * np.exp(-inside[1] * self.t)
        y[WINDOWS[0]] += u[2]
        y[WINDOWS[1]] += u[3] + u[4] * np.arange(40) / 40
        return np.concatenate([y - self.measured, WALL * (u - inside)])

    def slopes(self, u):
        a, e = min(u[0], self.highest), np.exp(-u[1] * self.t)
        slope = np.zeros(90)
        slope[WINDOWS[1]] = np.arange(40) / 40
        return np.column_stack([e * (u[0] <= self.highest), -a * self.t * e, np.ones(90), slope])

    def wall(self, u):
        return np.array([WALL * (u[0] > self.highest), 0, 0, 0, 0])


def reference(problem, held=None, value=0.0):
    """The same by differences, all unknowns alike."""
    free = [i for i in range(5) if i != held]

    def whole(x):
        u = np.full(5, value)
        u[free] = x
        return u

    low, high = problem.bounds
    found = least_squares(
        lambda x: problem.residual(whole(x)), np.array([1.0, 1.0, 0.0, 0.0, 0.0])[free],
        bounds=(low[free], high[free]), xtol=1e-14, ftol=1e-14, gtol=1e-14,
    )  # fmt: skip
    return whole(found.x), found.cost


START = np.array([1.0, 1.0, 0.0, 0.0, 0.0])


@pytest.mark.parametrize("most", [10.0, 2.0])
def test_the_optimum_is_that_of_all_unknowns_together(most):
    problem = Decays(most)
    point, cost = reference(problem)
    found = solve_blocks(problem, START, 1e-12, 100)
    assert found.converged
    assert found.cost == pytest.approx(cost, rel=1e-9)
    assert found.point == pytest.approx(point, abs=1e-4)
    assert (found.point[0] == most) == (most == 2.0)


@pytest.mark.parametrize("held", range(5))
def test_a_number_that_is_held_stays_and_the_others_adapt(held):
    problem, start = Decays(), START.copy()
    start[held] = 0.9
    point, cost = reference(problem, held, 0.9)
    found = solve_blocks(problem, start, 1e-12, 100, held=[held])
    assert found.point[held] == 0.9
    assert found.cost == pytest.approx(cost, rel=1e-9)
    assert found.point == pytest.approx(point, abs=1e-4)


def test_a_wall_is_met_and_hardly_passed():
    found = solve_blocks(Decays(wall=2.0), START, 1e-12, 100)
    assert 2.0 <= found.point[0] < 2.001
    assert found.cost == pytest.approx(reference(Decays(most=2.0))[1], rel=1e-3)


def test_derivatives_beyond_what_a_law_allows_are_those_of_the_residuals():
    """F_s below F_c: the misfits are those of the nearest allowed point, which moves when the point does."""
    problem, first, _, _ = velocity_problem(rig.measured(rig.LOOPS), "lugre", mass=0.0)
    names, u = [c.name for c in problem.coordinates], first.copy()
    u[names.index("F_s")] = u[names.index("F_c")] - 1e-3
    assert not problem.allowed(u)
    found = problem.jacobian(u)
    for k in range(len(u)):
        step = 1e-5 * np.eye(len(u))[k]
        slope = (problem.residual(u + step) - problem.residual(u - step)) / 2e-5
        assert found[:, k] == pytest.approx(slope, rel=0.02, abs=5e-3 * np.max(abs(found)))


def test_it_ends_when_the_evaluations_do():
    assert not solve_blocks(Decays(), START, 1e-12, 2).converged


def test_what_the_output_does_not_hang_on_is_not_moved():
    x = np.linspace(0, 1, 50)
    slopes = np.column_stack([np.ones(50), 1e-20 * x, np.zeros(50)])
    assert linear_step(slopes, 2 + 3 * x) == pytest.approx([2, 3e20, 0], rel=1e-9)

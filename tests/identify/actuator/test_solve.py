"""The search of a least-squares problem, on problems with a formula for residuals."""

from types import SimpleNamespace

import numpy as np
import pytest

from stribeck.identify.actuator.problem import MachineProblem
from stribeck.identify.actuator.solve import moved_over, search, settled
from stribeck.identify.work import Work


class Problem:
    """Residuals from a formula of two coordinates between -5 and 5."""

    step, size, threads = 1e-3, 2, 1
    low, high = np.full(2, -5.0), np.full(2, 5.0)
    keep, slopes, central = None, MachineProblem.slopes, MachineProblem.central

    def __init__(self, formula):
        self.formula, self.work, self.asked = formula, Work(), 0
        self.sought = [SimpleNamespace(nuisance=False, output=None, bends=bends) for bends in (False, True)]
        self._relations = SimpleNamespace(lower=list)

    def start(self):
        return np.array([-1.2, 1.0])

    def repaired(self, U):
        return np.clip(U, self.low, self.high)

    def residuals(self, U):
        U = np.atleast_2d(U)
        self.asked += len(U)
        return np.stack(self.formula(*U.T), axis=1)


def valley(steep):
    """Rosenbrock's: from (-1.2, 1) along a parabola to (1, 1)."""
    return Problem(lambda x, y: (1 - x, steep * (y - x**2)))


def test_a_bent_valley_is_followed_in_a_few_steps():
    """Steps of Levenberg and Marquardt alone creep along it, and are not through after 300."""
    found = search(valley(1e2), steps=5)
    assert found.u == pytest.approx([1.0, 1.0], abs=1e-3)


def test_the_last_steps_go_to_the_end_of_a_steep_valley():
    assert settled(valley(1e4), np.array([0.0, 0.0])) == pytest.approx([1.0, 1.0], abs=0.25)


def test_where_a_bend_vanishes_its_place_is_tried_anew():
    """Without height a bump's place says nothing: starts along it find the bump."""
    t = np.linspace(-5, 5, 101)
    bump = lambda h, at: h * np.exp(-(((t - at) / 0.3) ** 2))  # noqa: E731
    problem = Problem(lambda h, at: tuple(bump(h[:, None], at[:, None]).T - bump(2.0, 3.0)[:, None]))
    problem.size = len(t)
    flat = np.array([0.0, -2.0])
    assert np.linalg.norm(problem.residuals(search(problem, flat).u[None])) > 1.0
    found = search(problem, moved_over(problem, flat))
    assert found.u == pytest.approx([2.0, 3.0], abs=1e-3)

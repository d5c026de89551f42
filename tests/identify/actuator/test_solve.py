"""The search of a least-squares problem, on problems with a formula for residuals."""

import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from stribeck.identify.actuator import Logs
from stribeck.identify.actuator.coordinates import coordinates
from stribeck.identify.actuator.problem import MachineProblem
from stribeck.identify.actuator.recordings import Channel, Recording, Sought
from stribeck.identify.actuator.solve import fine_slopes, left_step, moved_over, search, settled, spread
from stribeck.identify.actuator.starts import problem_of
from stribeck.identify.work import Work
from stribeck.scenario import Scenario
from tests.identify.actuator.recorded import NOISE, body, played


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


def test_a_bent_valley_is_followed_in_a_few_steps_to_its_end():
    """Steps of Levenberg and Marquardt alone creep along it, and are not through after 300."""
    assert search(valley(1e2), steps=5).u == pytest.approx([1.0, 1.0], abs=1e-3)
    assert settled(valley(1e4), np.array([0.0, 0.0])) == pytest.approx([1.0, 1.0], abs=0.25)


def test_where_a_bend_vanishes_its_place_is_tried_anew():
    """Without height a bump's place says nothing: starts along it find the bump."""
    t = np.linspace(-5, 5, 101)
    bump = lambda h, at: h * np.exp(-(((t - at) / 0.3) ** 2))  # noqa: E731
    problem = Problem(lambda h, at: tuple(bump(h[:, None], at[:, None]).T - bump(2.0, 3.0)[:, None]))
    problem.size = len(t)
    flat = np.array([0.0, -2.0])
    assert np.linalg.norm(problem.residuals(search(problem, flat).u[None])) > 1.0
    result = search(problem, moved_over(problem, flat))
    assert result.u == pytest.approx([2.0, 3.0], abs=1e-3)


def test_exact_slopes_would_move_no_number():
    """Differences of simulations, against their limit at a tight tolerance: deviations and the optimum stay where they are."""
    data = body()
    y = played(json.dumps(data))["a.y"]
    t, push = 0.01 * np.arange(len(y)), np.array(data["loads"]["push"]["signal"]["value"])
    y = y + NOISE * np.random.default_rng(4).standard_normal(len(y))
    run = Recording("run", t, {"a.y": Channel("y", t, y)}, {"loads.push.signal": Channel("u", t, push)})
    law = "contacts.guide.law.parameters."
    truth = {"bodies.a.mass": 1.0, f"{law}F_c": 1.0, f"{law}F_s": 1.3, f"{law}sigma_2": 4.0, f"{law}v_s": 0.02}
    logs = Logs((run,), tuple(Sought(name, 0.1 * x, 10 * x) for name, x in truth.items()))
    scenario = Scenario(data)
    problem = problem_of(scenario, [(0, run)], coordinates(scenario, logs), {"a.y": NOISE})
    u, width = settled(problem, problem.point(truth)), problem.high - problem.low
    J, r = fine_slopes(problem, u), problem.residuals(u[None])[0]
    tight = [replace(run, scenario=run.scenario.with_changes({"solve.rtol": 1e-11})) for run in problem.runs]
    near, nearer = (replace(problem, runs=tight).central(u, np.full(len(u), step)) for step in (1e-3, 5e-4))
    exact = (4 * nearer - near) / 3
    assert spread(J, width) == pytest.approx(spread(exact, width), rel=1e-3)
    assert np.all(abs(left_step(problem, u, r, J) - left_step(problem, u, r, exact)) < 0.02 * spread(exact, width))


def test_jumps_of_a_rounded_encoder_are_no_slopes():
    t = np.linspace(0, 6, 400)[:, None]
    problem = Problem(lambda x, y: tuple(np.sin(t) * x + np.cos(t) * y + 0.03 * np.sign(np.sin(1e7 * x + t))))
    problem.size = len(t)
    assert np.linalg.norm(fine_slopes(problem, np.ones(2))[:, 0]) < 2 * np.linalg.norm(np.sin(t))


@pytest.mark.parametrize("by", [(), [1]])
def test_slopes_go_the_other_way_at_bounds_and_where_nothing_can_be_simulated(by):
    A = np.array([[1.0, 2.0], [3.0, -1.0], [0.5, 4.0]])

    def residuals(U):
        return np.where(U[:, :1] > 0.5, np.nan, U @ A.T)

    relations = SimpleNamespace(lower=lambda: np.zeros(0, int))
    problem = SimpleNamespace(residuals=residuals, low=np.zeros(2), high=np.ones(2), size=3, _relations=relations)
    U = np.array([[0.5, 0.2], [0.1, 1.0], [0.5, 0.0], [0.495, 0.4]])
    base, J = MachineProblem.slopes(problem, U, np.full(2, 0.01), by)
    np.testing.assert_allclose(base, U @ A.T)
    np.testing.assert_allclose(J, np.repeat(A[None, :, by or [0, 1]], 4, axis=0), rtol=1e-9)

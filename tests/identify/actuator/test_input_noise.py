"""Noise of what drove a machine: said to be the reason where it is much, and last where it is tiny."""

import numpy as np
import pytest

from stribeck.identify.actuator import read_logs
from stribeck.identify.actuator.coordinates import coordinates
from stribeck.identify.actuator.driven import MUCH, by_noise
from stribeck.identify.actuator.estimate import prepared
from stribeck.identify.actuator.problem import MachineProblem
from stribeck.scenario import Scenario
from tests.identify.actuator.recorded import body, logs, record


@pytest.mark.parametrize(("noise", "first"), [(1e-4, False), (0.05, True)])
def test_tiny_noise_is_the_last_reason(tmp_path, noise, first):
    """At a point where errors grow, noise of any size moves the outputs as far as they are missed."""
    rng = np.random.default_rng(0)
    record(
        tmp_path / "run.csv", body(), noise=0.0, change=lambda x: {**x, "u": x["u"] + noise * rng.standard_normal(101)}
    )
    start = {"bodies.a.initial.y": 0.0, "bodies.a.initial.v": 0.0}
    given = read_logs(
        logs(tmp_path, [{"file": "run.csv", "known": start}], {"bodies.a.mass": {"low": 0.2, "high": 5.0}})
    )
    machine = Scenario(body())
    runs, own = prepared(machine, [(0, given.recordings[0])], set())
    problem = MachineProblem(runs, [*coordinates(machine, given), *own], {"a.y": 1e-4})
    assert bool(by_noise(problem, problem.start(), MUCH)) == first
    (told,) = by_noise(problem, problem.start())
    assert "loads.push.signal" in told

"""Contacts that are hardly damped, against the damped oscillator that they are; tolerances below rounding; servos that
oscillate."""

import math
import warnings

import numpy as np
import pytest

from stribeck import Scenario, examples, simulate
from stribeck.errors import StribeckNote
from tests.simulation.rig import rig


def elastic(sigma_1, t_end=2.0):
    """A force step on a contact that stays elastic: below z_ba F = sigma_0 y + (sigma_1 + sigma_2) v exactly."""
    scenario = Scenario(
        rig("elastoplastic_majorant", "force", {"kind": "step", "value": 0.3, "time": 0.0}, t_end, rows=400)
    )
    return scenario.with_changes({"law.parameters.sigma_1": sigma_1})


def oscillator(scenario, t):
    """Position and velocity of mass, spring and damper after a step of the force, in closed form."""
    p = scenario.law.p
    rate = (p.sigma_1 + p.sigma_2) / (2 * scenario.elements.mass)
    omega = math.sqrt(p.sigma_0 / scenario.elements.mass - rate**2)
    swing = np.exp(-rate * t)
    y = 0.3 / p.sigma_0 * (1 - swing * (np.cos(omega * t) + rate / omega * np.sin(omega * t)))
    return y, 0.3 / (scenario.elements.mass * omega) * swing * np.sin(omega * t)


def off(scenario):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        solution = simulate(scenario)
    y, v = oscillator(scenario, solution.t)
    return max(np.max(abs(solution["y"] - y)) / np.max(abs(y)), np.max(abs(solution["v"] - v)) / np.max(abs(v)))


@pytest.mark.parametrize("sigma_1", [316.0, 30.0, 10.0, 3.0, 1.0])
def test_a_contact_that_rings(sigma_1):
    assert off(elastic(sigma_1)) < 1e-6


def test_what_rounding_forbids_is_said():
    with pytest.warns(StribeckNote, match="hardly damped .damping ratio 0.00063. and rings"):
        simulate(elastic(0.0, 0.1))
    with pytest.warns(StribeckNote, match="solve.rtol: 1e-12: rounding is the larger error below 5e-12"):
        simulate(elastic(316.0, 0.1).with_changes({"solve.rtol": 1e-12}))


def servo(**changes):
    scenario = Scenario.load(examples.path("servo"))
    changes = {name.replace("__", "."): x for name, x in changes.items()}
    return scenario.with_changes({"solve.t_end": 12.0, "drive.sample_time": 1e-3, **changes})


@pytest.mark.parametrize("changes", [{"drive__delay": 0.04}, {"drive__sample_time": 0.05}], ids=["delay", "coarse"])
def test_a_servo_that_oscillates_says_so(changes):
    with pytest.warns(StribeckNote, match="the valve swings"):
        assert simulate(servo(**changes)).status == "done"


def test_one_that_does_not_is_left_alone():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert simulate(servo()).status == "done"

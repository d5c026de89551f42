"""Rough values of a law's constants from a log."""

import numpy as np
import pytest

from stribeck.identify.features.guess import rises, steady_curve
from stribeck.identify.log import Log

T = np.arange(0, 10, 2e-3)
V = 0.2 * np.sin(2 * np.pi * 0.5 * T) + 0.1 * np.sin(2 * np.pi * 1.3 * T)
A = np.gradient(V, T)


@pytest.mark.parametrize("v_s", [2e-3, 0.02, 0.1])
def test_a_stribeck_curve_is_found_beside_inertia_and_offset(v_s):
    sign = np.tanh(V / 1e-3)
    force = 2 * A + 0.5 + (5 + 3 * np.exp(-((V / v_s) ** 2))) * sign + 10 * V
    force += 0.05 * np.random.default_rng(7).standard_normal(len(T))
    beside, curve, _ = steady_curve(V, [A, np.ones(len(T))], force)
    assert beside == pytest.approx([2, 0.5], rel=0.05, abs=0.05)
    assert curve["F_c"] == pytest.approx(5, rel=0.25)
    assert 5 < curve["sigma_2"] < 20
    assert v_s / 2.5 < curve["v_s"] < 2.5 * v_s
    assert curve["F_c"] * 1.2 < curve["F_s"] < 11


def test_no_curve_rises_from_rest():
    """A law with F_s below F_c was refused, and with it the fit of a log that hardly slides."""
    curve = steady_curve(V, [A], (5 - 3 * np.exp(-((V / 0.05) ** 2))) * np.tanh(V / 1e-3))[1]
    assert curve["F_s"] >= curve["F_c"] > 0


def test_a_curve_that_falls_and_then_rises_begins_on_its_fall():
    """At rest it is 5 + 0.5 - 1.5 = 4, and 3.57 at 0.02 m/s."""
    level = 5 + 0.5 * np.exp(-((V / 0.01) ** 2)) - 1.5 * np.exp(-((V / 0.1) ** 2))
    curve = steady_curve(V, [A], level * np.tanh(V / 1e-3))[1]
    assert curve["F_s"] == pytest.approx(4, rel=0.01)
    assert curve["F_c"] == pytest.approx(3.57, rel=0.05)


def test_a_rise_reaches_to_the_row_of_the_next_reversal():
    v = np.array([-1.0, 1.0, 1.0, 1.0, 1.0, -1.0])
    y, force = np.cumsum(v), np.array([0.0, 1.0, 2.0, 3.0, 8.0, 0.0])
    log = Log(y, y, v, v, force, np.zeros(6, np.int32), step=1.0)
    assert list(rises(log, 8.0, 1)) == [(4, 8.0, 4.0)]
    assert not list(rises(log, 1e3, 1))

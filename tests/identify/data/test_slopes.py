"""Velocity and acceleration of a log that is simulated: slopes of a spline."""

import numpy as np
import pytest

from stribeck.identify.data.filters import spline_derivative
from stribeck.identify.data.prepare import Preparation, load_log
from stribeck.identify.data.read import ColumnNames


def test_a_simulation_follows_what_moves_at_a_tenth_of_the_sampling_rate():
    t, rate = np.arange(400) * 2e-3, 2 * np.pi * 50
    table = {"t": t, "x": np.sin(rate * t), "F": np.cos(rate * t)}
    log = load_log([table], ColumnNames({"time": "t", "position": "x", "force": "F"}), Preparation(0.0, True))
    inside = slice(50, -50)
    assert log.velocity[inside] == pytest.approx(rate * np.cos(rate * t[inside]), abs=2e-3 * rate)
    assert log.acceleration[inside] == pytest.approx(-(rate**2) * np.sin(rate * t[inside]), abs=4e-3 * rate**2)


def test_the_slope_of_a_long_column_is_taken_in_pieces_that_nobody_sees(monkeypatch):
    x = np.cumsum(np.random.default_rng(3).normal(size=1030))
    whole = spline_derivative(x, 1e-3)
    monkeypatch.setattr("stribeck.identify.data.filters.MANY_ROWS", 100)
    assert spline_derivative(x, 1e-3) == pytest.approx(whole, rel=1e-9, abs=1e-9 * np.ptp(whole))

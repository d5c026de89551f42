"""A slope by direction is one of fast motion: what only looks like it at low speed is not taken."""

from __future__ import annotations

import numpy as np

from stribeck import fit
from stribeck.identify.result import Fit


def _fitted(forwards: float, level: float, slope: float) -> Fit:
    """The default terms of a record of two sines; ``forwards``: its largest speed there, as a share of that backwards."""
    draw, t = np.random.default_rng(4), np.arange(0, 6, 4e-3)
    v = 0.5 * (np.sin(2 * np.pi * 0.4 * t) + 0.6 * np.sin(2 * np.pi * 1.3 * t + 1))
    v = np.where(v > 0, forwards * v, v)
    friction = 11 * (1 + level * (v > 0)) * np.tanh(v / 0.025) + 2 * (1 + slope * (v > 0)) * v
    force = 1.7 * np.gradient(v, t) + friction + 0.05 * draw.standard_normal(len(t))
    columns = {"t": t, "v": v + 1e-4 * draw.standard_normal(len(t)), "F": force}
    found = fit(columns, "stribeck_tanh", columns={"time": "t", "velocity": "v", "force": "F"})
    assert isinstance(found, Fit)
    return found


def test_a_level_by_direction_is_no_slope_by_direction() -> None:
    """With a smooth sign it is no offset either: a motion three times as fast was missed by twice as much with a slope."""
    found = _fitted(1.0, 0.23, 0.0)
    assert "sigma_2_by_direction" not in found.body
    told = {**found.estimates, **found.body}
    for name, true in {
        "F_c_by_direction": 11 * 0.115,
        "offset": 0.0,
        "F_c_forwards": 11 * 1.23,
        "F_c_backwards": 11,
    }.items():
        assert told[name].identifiable
        assert told[name].low <= true <= told[name].high


def test_a_direction_that_is_slow_has_no_slope_of_its_own() -> None:
    """A slope of 1 N s/m was taken from speeds up to half of those of the other direction."""
    assert "sigma_2_by_direction" not in _fitted(0.5, 0.0, 0.5).body


def test_with_a_sign_that_changes_at_once_a_level_by_direction_is_an_offset() -> None:
    t = np.arange(0, 6, 4e-3)
    v = np.sin(3 * t)
    force = np.where(v > 0, 12.0, -8.0) + 2 * v + 0.05 * np.random.default_rng(1).standard_normal(len(t))
    columns = {"time": "t", "velocity": "v", "force": "F"}
    found = fit({"t": t, "v": v, "F": force}, "coulomb_viscous", columns=columns, terms=["F_c_by_direction"])
    assert isinstance(found, Fit)
    assert found.body["offset"].low <= 2.0 <= found.body["offset"].high
    assert "k_v must be fitted too" in found.body["F_c_by_direction"].why


def test_a_slope_by_direction_is_found() -> None:
    told = _fitted(1.0, 0.0, 0.5).body["sigma_2_by_direction"]
    assert told.low <= 0.5 <= told.high

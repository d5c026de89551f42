"""A static fit that misses much more of the force than its noise tells no number; noise alone withholds none."""

from __future__ import annotations

import numpy as np

from stribeck import fit
from stribeck.identify.api import read_log
from stribeck.identify.result import Fit
from stribeck.identify.statistics.suspects import builds_up

_STEP, _ROWS = 4e-3, 4000


def _motion() -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Time, position, speed, acceleration: two sines."""
    t = np.arange(_ROWS) * _STEP
    w, size = 2 * np.pi * np.array([0.31, 0.83]), np.array([0.3, 0.2])
    angle = np.outer(t, w) + np.array([0.4, 2.0])
    return t, -np.cos(angle) @ (size / w), np.sin(angle) @ size, np.cos(angle) @ (size * w)


def _fitted(beside: np.ndarray | float, noise: float) -> Fit:
    t, y, v, a = _motion()
    force = 2 * a + 5 * np.sign(v) + 4 * v + beside + noise * np.random.default_rng(3).standard_normal(_ROWS)
    found = fit({"t": t, "y": y, "F": force}, "coulomb_viscous", columns={"time": "t", "position": "y", "force": "F"})
    assert isinstance(found, Fit)
    return found


def test_a_fit_that_misses_half_of_the_force_tells_no_number() -> None:
    """A stop of rubber, which the law lacks: F_c had been told as 5.4 N [3.3, 8.3], the offset as 0.2 N [-2.3, 2.5]."""
    y = _motion()[1]
    found = _fitted(18 * (y / np.max(abs(y))) ** 3, 0.05)
    assert found.relative_force_error > 0.3
    told = {**found.estimates, **found.body}
    assert {"F_c", "sigma_2", "mass", "offset"} <= set(told)
    for number in told.values():
        assert not number.identifiable
        assert number.low is number.high is None
        assert number.best is not None
        assert "of what was measured" in number.why
    assert np.isnan(found.covariance).all()
    assert any("misses" in note and "say little" not in note for note in found.notes)


def test_a_force_of_much_noise_keeps_its_intervals() -> None:
    found = _fitted(0.0, 8.0)
    assert found.relative_force_error > 0.5
    for name, true in {"F_c": 5.0, "sigma_2": 4.0, "mass": 2.0, "offset": 0.0}.items():
        number = {**found.estimates, **found.body}[name]
        assert number.identifiable, number.why
        assert number.low is not None
        assert number.high is not None
        assert number.low <= true <= number.high


def test_friction_builds_up_over_a_share_of_the_strokes_and_not_of_the_jitter_between_them() -> None:
    """Most reversals are those of a body at rest: 8.4e-13 m was named."""
    t, y, _, _ = _motion()
    still = t > 8.0
    y = np.where(still, y[np.argmax(still)] + 1e-9 * np.random.default_rng(1).standard_normal(_ROWS), y)
    log = read_log({"t": t, "y": y, "F": y}, columns={"time": "t", "position": "y", "force": "F"}, cutoff=0, trim=0)
    ways = [float(name.split(" over ")[1].split()[0]) for name in builds_up(log)]
    assert 0.02 < max(ways) < 0.07  # a tenth of the strokes, which are 0.2 to 0.6 m

"""Intervals where the model lacks something: a delay, a direction, the right law; and a delay that only stops tell."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d

from stribeck import fit
from stribeck.identify.data.filters import shifted
from stribeck.identify.result import Fit
from stribeck.identify.statistics import static_intervals

_COLUMNS = {"time": "t", "position": "y", "force": "F"}


def _friction(v: np.ndarray, soft: float) -> np.ndarray:
    return (10 + 3 * np.exp(-((v / 0.05) ** 2))) * np.tanh(v / soft) + 6 * v


def _fitted(data: object, law: str, **how: object) -> Fit:
    found = fit(data, law, columns=_COLUMNS, **how)
    assert isinstance(found, Fit)
    return found


def _run(seed: int, speed: float, delay: float, length: float, step: float) -> dict[str, np.ndarray]:
    """A move from rest to rest at a held speed; the measured motion lags by the delay."""
    draw, fine = np.random.default_rng(seed), 5e-5
    t = np.arange(-0.1, length + 0.1, fine)
    v = gaussian_filter1d(speed * np.clip(np.minimum(t, length - t) / 0.3, 0, 1), 0.006 / fine)
    y, f = np.cumsum(v) * fine, 2 * np.gradient(v, fine) + _friction(v, 0.002)
    at = np.arange(0, length, step)
    return {
        "t": at,
        "y": np.interp(at - delay, t, y) + 1e-6 * draw.standard_normal(len(at)),
        "F": np.interp(at, t, f) + 0.2 * draw.standard_normal(len(at)),
    }


def test_a_delay_is_not_told_by_stops_alone() -> None:
    runs = [_run(k, s, 1e-3, 1.5, 2e-3) for k, s in enumerate((0.02, -0.05, 0.15, -0.5))]
    late = _fitted(runs, "stribeck_tanh", terms=["delay"], trim=200).body["delay"]
    assert not late.identifiable
    assert "speed falls" in late.why


def test_a_delay_of_runs_from_rest_to_rest_is_not_told() -> None:
    """Their first rows are dropped, so that stops tell more: -0.7 ms was told as [-1.3, -0.2], where there is none."""
    runs = [_run(10 + k, s, 0.0, 1.5, 2e-3) for k, s in enumerate((0.02, -0.05, 0.15, -0.5))]
    late = _fitted(runs, "stribeck_tanh", terms=["delay"]).body["delay"]
    assert not late.identifiable or late.low <= 0.0 <= late.high


def test_a_delay_of_motion_to_and_fro_is_told_whichever_way_the_speed_goes() -> None:
    """It was withheld, as more than three quarters of its slopes' squares lie where the speed falls."""
    late = _fitted(_swings(3, 8e-3, 0.0, curve=True), "stribeck_tanh", terms=["delay"]).body["delay"]
    assert late.identifiable
    assert late.low <= 8e-3 <= late.high < 8.2e-3


def test_a_shift_by_half_a_sample_keeps_fast_motion() -> None:
    rows = np.arange(400)
    w = 0.44 * np.pi
    moved = shifted(np.sin(w * rows), 0.5)[20:-20]
    assert np.max(abs(moved - np.sin(w * (rows + 0.5))[20:-20])) < 0.01


def _swings(
    seed: int, delay: float, direction: float, step: float = 2e-3, curve: bool = False
) -> dict[str, np.ndarray]:
    draw, w, size = np.random.default_rng(seed), 2 * np.pi * np.array([0.4, 1.1, 2.3]), np.array([0.3, 0.1, 0.03])
    phase, t = draw.uniform(0, 6, 3), np.arange(0, 16, step)
    v = np.cos(np.outer(t, w) + phase) @ (size * w)
    a = -np.sin(np.outer(t, w) + phase) @ (size * w**2)
    y = np.sin(np.outer(t - delay, w) + phase) @ size + 1e-6 * draw.standard_normal(len(t))
    friction = _friction(v, 0.02) if curve else 10 * np.tanh(v / 0.01) + 4 * v
    force = (2 if curve else 5) * a + friction + direction * abs(v) + 0.2 * draw.standard_normal(len(t))
    return {"t": t, "y": y, "F": force}


@pytest.mark.parametrize(("delay", "direction"), [(4e-3, 0.0), (1e-3, 1.5)])
def test_intervals_are_wider_for_terms_that_were_not_fitted(delay: float, direction: float) -> None:
    found = _fitted(_swings(5, delay, direction), "coulomb_viscous", select=False)
    assert any("would shift" in note for note in found.notes)
    for name, truth in (("F_c", 10.0), ("sigma_2", 4.0)):
        told = found.estimates[name]
        assert not told.identifiable or told.low <= truth <= told.high


def test_a_term_that_takes_a_hundredth_of_the_residual_away_counts() -> None:
    """The offset was [0.006, 0.020] N where it is 0: terms that took less than a fiftieth away were left alone."""
    told = _fitted(_swings(5, 0.0, 0.02), "stribeck_tanh", select=False).body["offset"]
    assert told.low <= 0.0 <= told.high


def test_intervals_reach_to_the_side_to_which_a_term_would_shift() -> None:
    """The offset was [-0.010, 0.075] N about 0.033: as far to the other side, where nothing draws it."""
    told = _fitted(_swings(5, 0.0, 0.05), "stribeck_tanh", select=False).body["offset"]
    assert told.low <= 0.0
    assert told.high - told.value < 0.3 * (told.value - told.low)


def test_the_filter_of_the_motion_and_noise_do_not_add_up(monkeypatch: pytest.MonkeyPatch) -> None:
    """They have nothing to do with each other: together they are the root of the sum of squares, and were the sum."""

    def half(found: Fit) -> float:
        told = found.body["mass"]
        return float(np.log(told.high / told.low) / 2)

    whole = _fitted(_swings(5, 0.0, 0.0), "stribeck_tanh", select=False)
    by_filter = whole.details["filter_bias"]["mass"]
    monkeypatch.setattr(static_intervals, "_filter_bias", lambda rows, model, solution, at: np.zeros(len(at.names)))
    without = half(_fitted(_swings(5, 0.0, 0.0), "stribeck_tanh", select=False))
    assert by_filter > 0.2 * without
    assert half(whole) == pytest.approx(np.sqrt(without**2 + by_filter**2), rel=1e-9)


def test_intervals_of_a_complete_model_are_not_wider() -> None:
    found = _fitted(_swings(5, 0.0, 0.0), "stribeck_tanh", select=False)
    assert not any("would shift" in note for note in found.notes)


def test_a_law_that_another_beats_has_wider_intervals() -> None:
    """The arctan for the sign comes to its end slowly: its levels are too high where the truth is a tanh."""
    runs = [_run(k, s, 0.0, 1.5, 2e-3) for k, s in enumerate(np.geomspace(0.005, 0.6, 6).tolist())]
    found = _fitted(runs, "stribeck", free=["k_v"])
    for name, truth in (("F_s", 13.0), ("v_s", 0.05), ("sigma_2", 6.0), ("mass", 2.0)):
        told = {**found.estimates, **found.body}[name]
        assert not told.identifiable or told.low <= truth <= told.high
    assert any("beyond chance" in note for note in found.notes)


def test_a_bend_over_all_speeds_does_not_tell_the_friction_near_rest() -> None:
    """Friction falls over the whole range; it rises to 2.5 N only below 1 mm/s, between the samples."""
    t = np.arange(0, 20, 2e-3)
    v = 1.3 * np.sin(1.6 * t)
    level = 1 + np.exp(-((v / 1.5) ** 2)) + 0.5 * np.exp(-((v / 1e-3) ** 2)) + 0.6 * abs(v)
    force = level * np.sign(v) + 0.01 * np.random.default_rng(3).standard_normal(len(t))
    found = fit(
        {"t": t, "v": v, "F": force}, "stribeck", columns={"time": "t", "velocity": "v", "force": "F"}, mass=0.0
    )
    assert isinstance(found, Fit)
    told = found.estimates["F_s"]
    assert not told.identifiable
    assert "highest speed" in told.why


def test_a_level_that_hangs_on_an_area_that_nothing_tells_is_not_told() -> None:
    """A pressure that hardly varies, and goes with the direction: where both lag, its area came out twice as large, and a
    level of 5.7 N was told as 3.5 N [3.0, 4.2]."""
    draw, t = np.random.default_rng(4), np.arange(0, 40, 0.01)

    def speed(lag: float) -> np.ndarray:
        return 0.016 * np.sin(np.pi * (t - lag))

    pressure = 3e5 + 4500 * np.tanh(speed(0.05) / 0.005) + 500 * draw.standard_normal(len(t))
    force = 5.2e-4 * pressure + 5.7 * np.tanh(speed(0.02) / 0.001) + 0.3 * draw.standard_normal(len(t))
    found = fit(
        {"t": t, "y": -0.016 / np.pi * np.cos(np.pi * t), "F": force, "p": pressure}, "coulomb_viscous",
        columns={**_COLUMNS, "pressure": "p"}, terms=["area"], mass=0.0, constants={"sigma_2": 0.0}, select=False,
    )  # fmt: skip
    assert isinstance(found, Fit)
    level = found.estimates["F_c"]
    assert not level.identifiable
    assert "area" in level.why


def _bent(bend: float) -> dict[str, np.ndarray]:
    """A curve that bends upwards with the speed, with a Stribeck bend at 1 mm/s that hardly a row shows."""
    draw, t = np.random.default_rng(0), np.arange(0, 20, 2e-3)
    v = 1.3 * np.sin(1.6 * t)
    curve = 1 + 0.5 * np.exp(-((v / 1e-3) ** 2)) + 0.1 * abs(v) + bend * v**2
    return {"t": t, "v": v, "F": curve * np.sign(v) + 0.01 * draw.standard_normal(len(t))}


@pytest.mark.parametrize("bend", [0.1, 0.2, 0.4])
@pytest.mark.parametrize("law", ["stribeck", "stribeck_tanh"])
def test_a_bend_that_is_used_up_by_another_power_of_the_speed_is_not_told(law: str, bend: float) -> None:
    """F_s = 0.986 [0.984, 0.987] and v_s = 0.43 were told as known, with a misfit of 6 % of the squared residual."""
    found = fit(_bent(bend), law, columns={"time": "t", "velocity": "v", "force": "F"}, select=False)
    assert any("drag" in note for note in found.notes)
    for name, truth in (("F_c", 1.0), ("F_s", 1.5), ("v_s", 1e-3), ("sigma_2", 0.1)):
        told = found.estimates[name]
        assert not told.identifiable or told.low <= truth <= told.high


@pytest.mark.parametrize("law", ["stribeck", "stribeck_tanh"])
def test_a_stribeck_curve_of_another_exponent_tells_no_wrong_level(law: str) -> None:
    """F_c was told as 1.009 [1.007, 1.035] and F_s as 1.392 [1.389, 1.403], where 1 and 1.5 are true."""
    draw, t = np.random.default_rng(0), np.arange(0, 20, 2e-3)
    v = 1.3 * np.sin(1.6 * t)
    curve = 1 + 0.5 * np.exp(-abs(v / 0.05)) + 0.1 * abs(v)
    data = {"t": t, "v": v, "F": curve * np.sign(v) + 0.01 * draw.standard_normal(len(t))}
    found = fit(data, law, columns={"time": "t", "velocity": "v", "force": "F"}, select=False)
    assert any("delta" in note for note in found.notes)
    for name, truth in (("F_c", 1.0), ("F_s", 1.5), ("sigma_2", 0.1)):
        told = found.estimates[name]
        assert not told.identifiable or told.low <= truth <= told.high
    known = fit(
        data,
        law,
        columns={"time": "t", "velocity": "v", "force": "F"},
        select=False,
        constants={"delta": 1.0},
        mass=0.0,
    )
    assert not any("delta" in note for note in known.notes)
    assert known.estimates["F_c"].low <= 1.0 <= known.estimates["F_c"].high < 1.02


_OWN = """
from stribeck.constants import Constant
from stribeck.laws.static import Stribeck
from stribeck.laws.terms import S_0
from stribeck.expressions.ops import exp
class Own(Stribeck):
    name = "own"
    delta = Constant("m", "a length, not an exponent", above=0, default=0.5)
    @staticmethod
    def friction(p, v, z, dz_dt):
        return S_0(p, v) * (p.F_c + (p.F_s - p.F_c) * exp(-abs(v / p.v_s) * (1.5 + p.delta))) + p.sigma_2 * v
"""


def test_what_a_law_of_ones_own_calls_delta_is_no_exponent(tmp_path: Path) -> None:
    """It was varied from 0.5 to 4, whatever it was, and said to lack."""
    (tmp_path / "own.py").write_text(_OWN)
    draw, t = np.random.default_rng(0), np.arange(0, 20, 2e-3)
    v = 1.3 * np.sin(1.6 * t)
    curve = 1 + 0.5 * np.exp(-((v / 0.05) ** 2)) + 0.1 * abs(v)
    data = {"t": t, "v": v, "F": curve * np.sign(v) + 0.01 * draw.standard_normal(len(t))}
    found = fit(
        data, f"{tmp_path / 'own.py'}:Own", columns={"time": "t", "velocity": "v", "force": "F"}, select=False,
        constants={"k_v": 1e4},
    )  # fmt: skip
    assert not any("delta would" in note or "delta and" in note for note in found.notes)


def test_drag_is_a_term() -> None:
    found = fit(_bent(0.2), "coulomb_viscous", columns={"time": "t", "velocity": "v", "force": "F"}, terms=["drag"])
    told = found.body["drag"]
    assert told.low <= 0.2 <= told.high < 0.21


def _along(way: np.ndarray, seed: int, friction: np.ndarray, mass: float = 1.0) -> dict[str, np.ndarray]:
    """A record every 2 ms of a motion and a friction that are given every 0.2 ms."""
    draw, v = np.random.default_rng(seed), np.gradient(way, 2e-4)
    force = (mass * np.gradient(v, 2e-4) + friction)[::10]
    y = way[::10] + 1e-6 * draw.standard_normal(len(force))
    return {"t": np.arange(len(y)) * 2e-3, "y": y, "F": force + 0.02 * draw.standard_normal(len(y))}


def _to_and_fro() -> tuple[np.ndarray, np.ndarray]:
    """Two sines: position and speed."""
    t = np.arange(0, 12, 2e-4)
    return 0.08 * np.sin(2.2 * t) + 0.03 * np.sin(5.1 * t), 0.176 * np.cos(2.2 * t) + 0.153 * np.cos(5.1 * t)


def _holds(found: Fit, truth: dict[str, float], told: int) -> None:
    numbers = {**found.estimates, **found.body}
    known = [n for n in truth if numbers[n].identifiable]
    assert len(known) >= told
    for n in known:
        assert numbers[n].low <= truth[n] <= numbers[n].high, n


def test_friction_that_grows_by_the_root_of_the_speed_gives_no_wrong_level() -> None:
    """A straight line through such a curve begins too high, and rises too fast."""
    y, v = _to_and_fro()
    friction = (8 + 3 * np.sqrt(abs(v))) * np.sign(v) + 6 * v
    found = _fitted(_along(y, 0, friction), "coulomb_viscous")
    _holds(found, {"F_c": 8.0, "sigma_2": 6.0, "mass": 1.0}, 2)
    assert any("thinning" in note for note in found.notes)


def test_bristles_that_bend_far_give_no_wrong_numbers() -> None:
    """A Dahl contact that slides after some 1 mm: its lag behind reversals went into mass and level."""
    y, v = _to_and_fro()
    z, friction = 0.0, np.empty(len(v))
    for i, speed in enumerate(v):
        z = np.sign(speed) + (z - np.sign(speed)) * np.exp(-abs(speed) * 2e-4 / 3e-4)
        friction[i] = 8 * z
    found = _fitted(_along(y, 0, friction + 6 * v), "coulomb_viscous")
    _holds(found, {"F_c": 8.0, "sigma_2": 6.0, "mass": 1.0}, 1)
    assert any("builds up" in note for note in found.notes)


def test_a_bend_that_lags_behind_the_speed_is_not_told() -> None:
    """Frictional memory of 10 ms: the rows behind reversals are those that tell F_s and v_s."""
    y, v = _to_and_fro()
    before = np.concatenate([np.full(50, v[0]), v[:-50]])
    friction = (8 + 4 * np.exp(-((before / 0.015) ** 2))) * np.sign(v) + 6 * v
    found = _fitted(_along(y, 0, friction), "stribeck", select=False)
    _holds(found, {"F_c": 8.0, "F_s": 12.0, "v_s": 0.015}, 1)
    assert any("friction that" in note for note in found.notes)


def test_a_gear_whose_friction_grows_with_its_load_gives_no_wrong_level() -> None:
    y, v = _to_and_fro()
    a = np.gradient(v, 2e-4)
    friction = (8 + 0.3 * abs(4 * a)) * np.sign(v) + 6 * v
    found = _fitted(_along(y, 0, friction, 4.0), "coulomb_viscous")
    _holds(found, {"F_c": 8.0, "mass": 4.0}, 2)
    assert any("grows with the load" in note for note in found.notes)


def test_a_number_at_0_is_told_only_as_far_as_further_terms_leave_it_there() -> None:
    """A body on a spring, whose force goes against its inertia."""
    y, v = _to_and_fro()
    friction = 8 * np.sign(v) + 6 * v + 40 * y
    found = _fitted(_along(y, 0, friction, 0.5), "coulomb_viscous")
    mass = found.body["mass"]
    assert mass.best == 0.0 or mass.value == 0.0
    assert mass.high is not None
    assert mass.high >= 0.5


def test_complete_friction_is_not_said_to_lack_anything() -> None:
    y, v = _to_and_fro()
    found = _fitted(_along(y, 0, 8 * np.sign(v) + 6 * v), "coulomb_viscous")
    _holds(found, {"F_c": 8.0, "sigma_2": 6.0, "mass": 1.0, "offset": 0.0}, 4)
    assert not any("away: intervals" in note for note in found.notes)

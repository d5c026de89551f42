"""A force that ripples over the position: cogging, of which nobody says how many waves it has."""

import numpy as np
import pytest

import stribeck
from stribeck.errors import InputError
from stribeck.identify.api import read_log
from stribeck.identify.models import ripple
from stribeck.identify.predict import load, predict, saved

NAMES = {"time": "t", "position": "y", "force": "F"}
WAVES, SIN, COS = 23.0, 0.9, -0.6


def axis(seed: int, cogs: float = 1.0, seconds: float = 12.0) -> dict[str, np.ndarray]:
    """A direct drive that cogs, moved by two sines, with an encoder of a micrometre."""
    draw = np.random.default_rng(seed)
    t = np.arange(0, seconds, 2e-3)
    w, phase, speed = 2 * np.pi * draw.uniform(0.15, 0.8, 2), draw.uniform(0, 6, 2), np.array([0.6, 0.4])
    v, a = np.sin(np.outer(t, w) + phase) @ speed, np.cos(np.outer(t, w) + phase) @ (speed * w)
    y = -np.cos(np.outer(t, w) + phase) @ (speed / w)
    force = 0.4 * a + 3 * np.tanh(v / 0.02) + 1.2 * v + 0.2 + cogs * (SIN * np.sin(WAVES * y) + COS * np.cos(WAVES * y))
    return {"t": t, "y": y + 1e-6 * draw.standard_normal(len(t)), "F": force + 0.03 * draw.standard_normal(len(t))}


def test_cogging_is_found_and_predicted(tmp_path):
    """Its force had been missed by a third, as no term was of the position's waves."""
    fit = stribeck.fit(axis(1), columns=NAMES).best
    for name, truth in (("ripple_waves", WAVES), ("ripple_sin", SIN), ("ripple_cos", COS)):
        told = fit.body[name]
        assert told.identifiable
        assert told.low <= truth <= told.high
    (tmp_path / "fit.json").write_text(saved(fit), encoding="utf-8")
    assert predict(load(tmp_path), read_log(axis(2), columns=NAMES)).force_error < 0.03


def test_no_ripple_is_taken_where_there_is_none():
    assert not any("ripple" in name for name in stribeck.fit(axis(3, cogs=0.0), columns=NAMES).best.body)


def test_waves_that_are_known_are_given():
    fit = stribeck.fit(axis(1), "coulomb_viscous", columns=NAMES, constants={"ripple_waves": WAVES})
    assert {"ripple_sin", "ripple_cos"} <= set(fit.body)
    assert "ripple_waves" not in fit.body
    assert fit.body["ripple_sin"].low <= SIN <= fit.body["ripple_sin"].high < SIN + 0.1


@pytest.mark.parametrize(
    ("name", "value"), [("ripple_waves", 0.0), ("ripple_waves", -9.0), ("drag", -1.0), ("mass", -1.0)]
)
def test_what_a_term_cannot_be_is_refused(name, value):
    with pytest.raises(InputError, match=rf"{name}.*: must be a number (above|from) 0, and at most 1e\+30"):
        stribeck.fit(axis(1, seconds=2.0), "coulomb_viscous", columns=NAMES, constants={name: value})


def test_a_simulation_does_not_look_for_waves():
    log = read_log(axis(1, seconds=2.0), columns=NAMES)
    constants = {"sigma_0": 1e4, "sigma_1": 10.0, "F_c": 3.0, "F_s": 3.0, "v_s": 0.1}
    with pytest.raises(InputError, match=r"ripple_waves: .*must be given"):
        stribeck.fit(log, "lugre", constants=constants, terms=["ripple_sin"])


def test_a_model_of_a_ripple_without_its_waves_is_refused(tmp_path):
    text = saved(stribeck.fit(axis(1), "coulomb_viscous", columns=NAMES, constants={"ripple_waves": WAVES}))
    (tmp_path / "fit.json").write_text(text.replace('"ripple_waves"', '"drag"'), encoding="utf-8")
    with pytest.raises(InputError, match="needs ripple_waves"):
        load(tmp_path)


def test_the_largest_peaks_are_those_of_the_residual():
    draw = np.random.default_rng(4)
    y = np.cumsum(draw.uniform(0, 2e-3, 5000))
    left = np.sin(31.0 * y) + 0.5 * np.sin(77.0 * y + 1) + 0.2 * draw.standard_normal(len(y))
    found = ripple.peaks(y, left, 5.0, 200.0)
    assert found[0] == pytest.approx(31.0, abs=np.pi / np.ptp(y))
    assert found[1] == pytest.approx(77.0, abs=np.pi / np.ptp(y))

"""Friction that turns round over a way behind a reversal: backlash, or a contact that yields."""

import numpy as np
import pytest

import stribeck
from stribeck.errors import InputError
from stribeck.identify.api import read_log
from stribeck.identify.log import Log
from stribeck.identify.models.play import turned
from stribeck.identify.predict import load, predict, saved

NAMES = {"time": "t", "position": "y", "force": "F"}
WAY, LEVEL = 0.04, 3.0


def joint(seed: int, way: float = WAY, seconds: float = 6.0) -> dict[str, np.ndarray]:
    """A joint whose friction turns round over a way, row by row, and an encoder of a micrometre."""
    draw = np.random.default_rng(seed)
    t = np.arange(0, seconds, 2e-3)
    w, phase, speed = 2 * np.pi * draw.uniform(0.15, 0.8, 2), draw.uniform(0, 6, 2), np.array([0.3, 0.2])
    v, a = np.sin(np.outer(t, w) + phase) @ speed, np.cos(np.outer(t, w) + phase) @ (speed * w)
    y = -np.cos(np.outer(t, w) + phase) @ (speed / w)
    part = np.sign(v)
    for i in range(1, len(t)) if way else ():
        part[i] = min(max(part[i - 1] + (y[i] - y[i - 1]) / (way / 2), -1.0), 1.0)
    force = 0.4 * a + LEVEL * part + 1.2 * v + 0.2 + 0.03 * draw.standard_normal(len(t))
    return {"t": t, "y": y + 1e-6 * draw.standard_normal(len(t)), "F": force}


def test_play_is_found_and_predicted(tmp_path):
    """The force had been missed by a third or more, and backlash on a short way was taken for a weight or a spring."""
    fit = stribeck.fit(joint(1), "coulomb_viscous", select=True, columns=NAMES)
    for told, truth in ((fit.body["play"], WAY), (fit.estimates["F_c"], LEVEL), (fit.body["mass"], 0.4)):
        assert told.identifiable
        assert told.low <= truth <= told.high < 1.2 * truth
    assert not {"stiffness", "gravity_sin", "delay"} & set(fit.body)
    assert any("turns round over 0.04 m" in note for note in fit.notes)
    (tmp_path / "fit.json").write_text(saved(fit), encoding="utf-8")
    assert predict(load(tmp_path), read_log(joint(2), columns=NAMES)).force_error < 0.02


def test_no_play_is_taken_where_there_is_none():
    assert "play" not in stribeck.fit(joint(3, way=0.0), "coulomb_viscous", select=True, columns=NAMES).body


def test_a_law_that_is_named_says_what_its_residual_looks_like():
    fit = stribeck.fit(joint(1), "coulomb_viscous", columns=NAMES)
    assert "play" not in fit.body
    assert any("behind each reversal" in note and "0.04 m" in note for note in fit.notes)
    plain = stribeck.fit(joint(3, way=0.0), "coulomb_viscous", columns=NAMES)
    assert not any("reversal" in note for note in plain.notes)


def test_the_state_between_reversals_is_that_of_going_row_by_row():
    draw = np.random.default_rng(0)
    y = np.concatenate([np.cumsum(draw.standard_normal(500)), np.zeros(20), np.cumsum(draw.standard_normal(480))])
    v, run = np.gradient(y), np.repeat([0, 1], [600, 400]).astype(np.int32)
    v[0], v[600] = 1.0, -1.0
    log = Log(np.arange(1000.0), y, v, np.zeros(1000), np.zeros(1000), run, step=1.0)
    want = np.empty(1000)
    for first, last in ((0, 600), (600, 1000)):
        want[first] = np.sign(v[first])
        for i in range(first + 1, last):
            want[i] = min(max(want[i - 1] + 2 * (y[i] - y[i - 1]) / 3.0, -1.0), 1.0)
    assert turned(log, 3.0) == pytest.approx(want, abs=1e-12)


@pytest.mark.parametrize("first", [0.05, 0.15, 0.6, 1.1, 1.55, 1.75, 2.4, 2.9])
def test_a_run_that_begins_behind_a_reversal_begins_as_friction_stands_there(first):
    """A record that began 0.5 mm behind a reversal was taken to begin with friction all turned round: it made half of what was
    missed, and the mass came out as 0 [0, 0.016], called known, where it is 0.068."""
    t = np.arange(-20, 20, 1e-3)
    v, a, y = np.cos(t * np.pi), -np.pi * np.sin(t * np.pi), np.sin(t * np.pi) / np.pi
    log = Log(t, y, v, a, 0 * t, np.zeros(len(t), np.int32), step=1e-3)
    later = t >= first
    state, begun = turned(log, 0.05)[later], turned(log.rows(later), 0.05)
    assert begun == pytest.approx(state, abs=0.15)
    assert begun[0] == pytest.approx(state[0], abs=0.05)


@pytest.mark.parametrize("what", [{"terms": ["play"]}, {"constants": {"play": 0.01}}])
def test_bristles_have_no_play_beside_them(what):
    with pytest.raises(InputError, match=r"'play': belongs to method static, not dynamic"):
        stribeck.fit(joint(1, seconds=2.0), "lugre", columns=NAMES, **what)


def test_play_shows_behind_reversals_only():
    one_way = joint(1)
    one_way["y"] = one_way["y"] + 3.0 * one_way["t"]
    with pytest.raises(InputError, match="'play': needs motion in both directions"):
        stribeck.fit(one_way, "coulomb_viscous", columns=NAMES, terms=["play"])

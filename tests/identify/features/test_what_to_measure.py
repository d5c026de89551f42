"""What is advised where the data leave a number open: its numbers, and its effect once it is carried out."""

import re

import numpy as np
import pytest

import stribeck
from stribeck.identify.features.guess import Sizes
from stribeck.identify.features.what_to_measure import experiment_for, reachable
from stribeck.identify.statistics import effects
from stribeck.identify.statistics.effects import Effect

SIZES = Sizes(force=1.0, offset=0.0, fast=0.5, slow=1e-3, stiffness=1e5, travel=0.1, step=2e-3)
VALUES = {"sigma_0": 1e5, "F_c": 1.0, "F_s": 8.0, "v_s": 1e-3}


def test_a_level_that_is_open_is_no_scale_of_reversals():
    """With F_s = 8, open, where 1 is true they were advised 8 times too long."""
    assert reachable(VALUES, SIZES, {"F_s"}).large == pytest.approx(5e-5)
    assert reachable(VALUES, SIZES, {"F_s", "F_c"}).large == pytest.approx(5e-5)  # the force that was applied
    assert reachable(VALUES, SIZES).large == pytest.approx(4e-4)
    assert "5e-05 m (total way)" in experiment_for("sigma_0", VALUES, SIZES, {"F_s", "sigma_0"})


def test_fast_reversals_have_samples_enough():
    """A speed of 0.01 m/s was advised for reversals of 50 um, which are over in three samples."""
    at = reachable(VALUES, SIZES, {"F_s"})
    seconds = np.pi * at.large / at.loop_fast
    assert seconds / SIZES.step >= 20 - 1e-9
    assert reachable(VALUES, Sizes(1.0, 0.0, 0.5, 1e-3, 1e5, 0.1, 1e-6), {"F_s"}).loop_fast > at.loop_fast
    assert at.loop < at.loop_fast


def test_the_smallest_speed_does_not_follow_a_v_s_that_is_nowhere():
    assert reachable({**VALUES, "v_s": 1e-9}, SIZES, {"v_s"}).slowest == pytest.approx(1e-3 * SIZES.fast)
    assert reachable(VALUES, SIZES, {"v_s"}).slowest == pytest.approx(1e-4)


def test_what_the_sensor_keeps_of_an_interval_is_no_gain():
    """68 times narrower was told of a sigma_1 that hung on the filter, and carrying it out narrowed nothing."""
    assert Effect(0.01, 480, 0.1).told(1.4, 1.2) == ""
    assert "7.7 times narrower" in Effect(0.01, 480, 0.1).told(0.15 + 1e-9, 0.0)
    assert "alone, with such a position" in Effect(0.01, 480, 0.1, alone=0.15).told(1.4, 1.2)
    assert "8.3 times narrower" in Effect(0.01, 480, 0.1, alone=0.15).told(1.4, 1.2)
    assert "known to 0.17 of its value" in Effect(0.01, 480, 0.1, alone=0.15).told(None, 1.2)
    assert Effect(0.01, 480, 0.1).told(None, 0.0) == ""  # where nothing is known there is nothing to compare with


# -- static fits: played, and fitted again ---------------------------------------------------------------------------

STEP = 1e-3


def record(v, run=0, noise=0.2, F_c=4.0, F_s=7.0, v_s=0.003, sigma_2=5.0):
    """Speed and force of 2 kg, by equations written here."""
    draw = np.random.default_rng(run + 1)
    force = (F_c + (F_s - F_c) * np.exp(-((v / v_s) ** 2))) * np.sign(v) + sigma_2 * v + 2 * np.gradient(v, STEP)
    errors = draw.standard_normal((2, len(v)))
    return {
        "t": np.arange(len(v)) * STEP, "v": v + 1e-6 * errors[0], "F": force + noise * errors[1],
        "run": np.full(len(v), float(run)),
    }  # fmt: skip


def fitted(*records):
    log = {name: np.concatenate([r[name] for r in records]) for name in records[0]}
    columns = {"time": "t", "velocity": "v", "force": "F", "run": "run"}
    return stribeck.fit(log, "stribeck", columns=columns, select=False, cutoff=0).estimates


def test_a_static_fit_tells_by_how_much_the_advised_strokes_narrow_an_interval(monkeypatch):
    """It told no effect."""
    monkeypatch.setattr(effects, "_WORTH", 1.2)  # what is below 1.5 is computed, and not told
    wave = 0.015 * (0.55 + 0.45 * np.sin(2 * np.pi * 1.1 * np.arange(0, 2.5, STEP)))
    both = [record(sign * wave, i) for i, sign in enumerate((1, -1))]
    before = fitted(*both)["sigma_2"]
    told = re.search(r"by (\d+) samples of it .* would be ([\d.]+) times narrower", before.experiment)
    assert told, before.experiment
    fast = float(re.search(r"up to ([\d.e-]+) m/s", before.experiment)[1])
    held = [np.full(int(told[1]) // 20, sign * v) for v in np.geomspace(fast / 3, fast, 10) for sign in (1, -1)]
    after = fitted(*both, *(record(v, i + 2) for i, v in enumerate(held)))["sigma_2"]
    shrunk = np.log(before.high / before.low) / np.log(after.high / after.low)
    assert shrunk > 1
    assert 0.5 < shrunk / float(told[2]) < 2


def by_position(speed, run, draw, **truth):
    """The same by an encoder of a micrometre."""
    found = record(speed, run, **truth)
    y = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * STEP)])
    del found["v"]
    return found | {"y": y + 1e-6 * draw.standard_normal(len(y))}


def test_the_advice_counts_what_the_filter_of_the_motion_drops():
    """With a measured position 15 times narrower was told of 100 samples a stroke, all of which the filter's start took: the
    interval stayed what it was. And F_s was told as 6.68 N [6.66, 6.71] where 11.2 is true, beside a v_s that is nowhere."""
    draw, truth = np.random.default_rng(3), {"F_c": 6.7, "F_s": 11.2, "v_s": 0.02}

    def estimates(*records):
        log = {name: np.concatenate([r[name] for r in records]) for name in records[0]}
        columns = {"time": "t", "position": "y", "force": "F", "run": "run"}
        return stribeck.fit(log, "stribeck", columns=columns, select=False).estimates

    wave = 0.05 + 0.175 * (1 + np.sin(2 * np.pi * 1.1 * np.arange(0, 2.5, STEP)))
    both = [by_position(sign * wave, i, draw, **truth) for i, sign in enumerate((1, -1))]
    before = estimates(*both)
    assert not before["F_s"].identifiable
    told = re.search(
        r"from ([\d.e-]+) m/s to ([\d.e-]+) m/s.*by (\d+) samples of it, behind the ([\d.]+) s of each run .* ([\d.]+) times",
        before["v_s"].experiment,
    )
    assert told, before["v_s"].experiment
    slow, fast, count, dropped, times = map(float, told.groups())
    rows = int(count / 20 + dropped / STEP) + 1
    held = [np.full(rows, sign * v) for v in np.geomspace(slow, fast, 10) for sign in (1, -1)]
    after = estimates(*both, *(by_position(v, i + 2, draw, **truth) for i, v in enumerate(held)))
    narrower = np.log(before["v_s"].high / before["v_s"].low) / np.log(after["v_s"].high / after["v_s"].low)
    assert narrower > 0.5 * times
    for name in ("F_s", "v_s"):
        assert after[name].identifiable
        assert after[name].low <= truth[name] <= after[name].high


def test_no_effect_is_told_of_a_bend_at_the_highest_speed():
    """9.3 times narrower was told of an F_s whose v_s stood at the end of its search, and no interval was left once the
    strokes were there: there is no optimum whose slopes could tell."""
    t = np.arange(0, 4, STEP)
    wave = 0.02 * np.sin(2 * np.pi * 1.1 * t) * (0.75 + 0.25 * np.sin(2.6 * t))
    found = fitted(record(wave, F_c=7.4, F_s=9.0, v_s=0.0253, sigma_2=7.0))
    assert found["F_s"].why.startswith("v_s comes out at the highest speed")
    assert all("times narrower" not in e.experiment for e in found.values())


def test_what_comes_out_as_0_has_an_interval_with_the_others_freedom():
    """sigma_2 was told as 0 [0, 0.22] N s/m where 3.1 is true, beside a v_s at the end of its search."""
    t = np.arange(0, 20, STEP)
    v = 0.02 * np.sin(2 * np.pi * 0.2 * t)
    for seed in (1, 2):
        made = record(v, seed, 0.05, 5.4, 7.4, 0.0196, 3.1)
        del made["v"]
        draw = np.random.default_rng(seed)
        y = 0.02 / (0.4 * np.pi) * (1 - np.cos(2 * np.pi * 0.2 * t)) + 1e-7 * draw.standard_normal(len(t))
        fit = stribeck.fit(
            made | {"y": y}, "stribeck", columns={"time": "t", "position": "y", "force": "F"}, free=["k_v"]
        )
        e = fit.estimates["sigma_2"]
        assert not e.identifiable or e.high >= 3.1

"""Rest is found and left out; long records are thinned to where they move."""

import numpy as np
import pytest

import stribeck
from stribeck.identify.data.filters import low_pass, spline_derivative
from stribeck.identify.features.rest import at_rest
from stribeck.identify.log import Log
from stribeck.identify.models.record import rows_of, shortened

STEP = 2e-3


def log_of(v, force, run=None, **more):
    t = np.arange(len(v)) * STEP
    y = np.concatenate([[0.0], np.cumsum((v[1:] + v[:-1]) / 2) * STEP])
    a = np.gradient(v, STEP)
    run = np.zeros(len(t), np.int32) if run is None else run
    return Log(t, y, v, a, force(t, y, v, a), run, step=STEP, **more)


def standing(seconds=12.0, held=0.0, seed=0):
    rng = np.random.default_rng(seed)
    t = np.arange(0, seconds, STEP)
    true = np.where(t % 4 < 2, 0.0, np.sin(2 * np.pi * (t % 4)))
    v = true + 0.004 * rng.standard_normal(len(t))

    def force(t, y, v, a):
        rest = np.where(t % 4 < 2, held, 0.0)
        return 0.5 * np.gradient(true, STEP) + 5 * np.sign(true) + 2 * true + rest + 0.1 * rng.standard_normal(len(t))

    return log_of(v, force), t % 4 < 2


@pytest.mark.parametrize("held", [0.0, -8.0, 4.0])
def test_rest_is_found_and_left_out(held):
    log, rests = standing(held=held)
    assert np.mean(at_rest(log) == rests) > 0.97
    fit = stribeck.fit(log, "coulomb_viscous", forms=False)
    assert fit.estimates["F_c"].value == pytest.approx(5, rel=0.03)


def test_slow_motion_and_reversals_are_no_rest():
    t = np.arange(0, 8, STEP)
    rng = np.random.default_rng(0)
    to_and_fro, fast = np.sign(np.sin(t)), (t > 4) * np.sin(9 * t)
    for v, noise in (
        (0.002 * to_and_fro + fast, 1e-5), (0.01 * to_and_fro + fast, 4e-3), (0.01 * to_and_fro + fast, 2e-2),
        (np.sin(2 * t), 1e-5), (0.3 * (t - 4), 4e-3),
    ):  # fmt: skip
        log = log_of(v + noise * rng.standard_normal(len(t)), lambda t, y, v, a: np.sign(v))
        assert np.mean(at_rest(log)) < 0.005


def test_short_stops_are_found():
    """Where nothing is noise, as in a simulation."""
    stops = np.arange(0, 4, STEP) % 1 < 0.07
    np.testing.assert_array_equal(at_rest(log_of(np.where(stops, 0.0, 1.0), lambda t, y, v, a: v)), stops)


@pytest.mark.parametrize(("of", "noise", "cutoff"), [("velocity", 0.05, 5.0), ("position", 2e-3, 5.0)])
def test_noise_that_a_filter_has_smoothed_is_noise(of, noise, cutoff):
    """It changes little from row to row; the noise of the measured motion, a speed or a position, tells how large it is."""
    t = np.arange(0, 12, STEP)
    rests, off = t % 4 < 2, low_pass(noise * np.random.default_rng(0).standard_normal(len(t)), cutoff, STEP)
    off = spline_derivative(off, STEP) if of == "position" else off
    reported = {"bandwidth": cutoff, "noise": 2 * STEP * noise**2, "sources": {"unfiltered": of}}
    log = log_of(np.where(rests, 0.0, np.sin(2 * np.pi * t)) + off, lambda t, y, v, a: np.sign(v), **reported)
    assert np.mean(at_rest(log) == rests) > 0.99


def from_rest_to_rest(files, seconds=6.0, seed=0):
    """Constant speeds, at rest for a second before and after, held there by a torque that has nothing to do with friction."""
    rng = np.random.default_rng(seed)
    t = np.arange(0, seconds, STEP)
    shape = np.clip((t - 1) / 0.4, 0, 1) - np.clip((t - seconds + 1.4) / 0.4, 0, 1)
    speeds = np.repeat(np.geomspace(0.05, 3, files // 2), 2) * np.tile([1, -1], files // 2)
    true = np.concatenate([s * shape for s in speeds])
    held = np.repeat(rng.uniform(-4, 4, files), len(t))
    law = stribeck.law("stribeck", {"F_c": 8, "F_s": 13, "v_s": 0.3, "sigma_2": 2})

    def force(t, y, v, a):
        noise = 0.3 * rng.standard_normal(len(t))
        return 0.3 * np.gradient(true, STEP) + np.where(true == 0, held, law.steady_force(true)) + noise

    run = np.repeat(np.arange(files, dtype=np.int32), len(t))
    log = log_of(true + 2e-4 * rng.standard_normal(len(true)), force, run, files=tuple(f"f{k}" for k in range(files)))
    return log.with_columns(bandwidth=12.5), true == 0


def test_rest_up_to_the_end_of_a_run_is_found():
    """Whatever is left behind the last whole look, and at either end of a rest."""
    log, rests = from_rest_to_rest(4)
    result = at_rest(log)
    assert np.mean(result[rests]) > 0.99
    assert np.mean(result[~rests]) < 0.005


def test_a_rest_of_which_little_is_left_at_an_edge_is_found():
    """Of 54 files from rest to rest the filter's settling left 16 ms of rest at the start: the torque that held the body there
    stood against a fit of its motion (6.1 % of it missed where 2 is noise, F_s 13.2 [13.05, 13.4] where 13 is true)."""
    rng = np.random.default_rng(1)
    moving = np.concatenate([np.zeros(8, bool), np.ones(1200, bool), np.zeros(150, bool)])
    v = np.concatenate([np.where(moving, speed, 0.0) for speed in (0.3, -0.3, 0.02, -0.02)])
    v += 1e-5 * rng.standard_normal(len(v))
    v[np.flatnonzero(~np.tile(moving, 4))[157::158]] = 0.01  # what the filter makes of the end
    log = log_of(v, lambda t, y, v, a: np.sign(v), np.repeat(np.arange(4, dtype=np.int32), len(moving)), bandwidth=17.5)
    np.testing.assert_array_equal(at_rest(log), ~np.tile(moving, 4))


def test_a_long_record_is_thinned_to_where_it_moves():
    log, _ = from_rest_to_rest(12)
    rows = rows_of(shortened(log, 12 * 1500))
    assert np.mean(rows.rest) < 0.2  # a third of the record is rest
    within = rows.log.time % 6.0  # each file's start and stop, which tell the mass, are there
    assert all(np.any(abs(within - moment) < STEP) for moment in (1.05, 1.35, 4.65))


def test_few_rows_are_not_thinned():
    t = np.arange(3000) * 2e-3
    v = 1.8 + np.sin(2 * t)
    log = Log(t, np.cumsum(v) * 2e-3, v, 2 * np.cos(2 * t), 5.0 + 3.0 * v, np.zeros(3000, np.int32), step=2e-3)
    assert len(rows_of(log).kept) >= 400

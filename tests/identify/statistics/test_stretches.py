"""What windows of a record differ by, and residuals that drift."""

import numpy as np
import pytest

from stribeck.identify.methods.horizons import moving, windows
from stribeck.identify.statistics.stretches import drifts, jackknife
from tests.identify import rig


def test_a_drift_far_below_the_noise_is_seen_and_white_noise_is_none():
    parts = [slice(0, 2000), slice(2000, 4000)]
    draw = np.random.default_rng(0)
    found = [drifts(draw.standard_normal(4000), parts) for _ in range(200)]
    assert np.mean(found) == pytest.approx(0.05, abs=0.04)
    slow = 0.4 * np.tile(np.sin(np.pi * np.arange(2000) / 2000), 2)  # adds less than 1 % to the residual
    assert all(drifts(slow + draw.standard_normal(4000), parts) for _ in range(20))


def test_few_windows_that_tell_the_most_make_wide_intervals():
    """Steep windows and flat ones, each with an error of its own that grows with the slope: 95 % are due."""
    draw, rows, count = np.random.default_rng(1), 20, 24
    parts = [slice(rows * k, rows * (k + 1)) for k in range(count)]
    steep = np.where(np.arange(count) < 3, 5.0, 1.0)
    held = 0
    for _ in range(200):
        x = np.repeat(steep, rows) * draw.standard_normal(rows * count)
        slopes = np.column_stack([x, np.ones_like(x)])
        error = draw.standard_normal(len(x)) + np.repeat(draw.standard_normal(count), rows) * x
        found = np.linalg.lstsq(slopes, error, rcond=None)[0]
        spread = np.sqrt(np.diag(jackknife(slopes, error - slopes @ found, parts)))
        held += abs(found[0]) < 1.96 * spread[0]
    assert 0.92 <= held / 200 <= 0.99


def test_a_window_s_own_numbers_do_not_disturb_what_the_others_tell():
    draw = np.random.default_rng(2)
    parts = [slice(30 * k, 30 * (k + 1)) for k in range(16)]
    x, own = draw.standard_normal(480), np.zeros((480, 16))
    for k, part in enumerate(parts):
        own[part, k] = 1.0
    slopes = np.column_stack([x, own])
    misfit = draw.standard_normal(480)
    misfit -= slopes @ np.linalg.lstsq(slopes, misfit, rcond=None)[0]
    found = jackknife(slopes, misfit, parts)
    assert np.isfinite(found).all()
    assert np.sqrt(found[0, 0]) == pytest.approx(1 / np.sqrt(480), rel=0.4)


def test_the_search_begins_in_windows_that_move():
    log = rig.measured(rig.LOOPS[:1] + rig.STROKES)
    every = windows(log, len(log) // 12, 24)
    some = moving(log, every)
    assert 6 <= len(some) < len(every)
    assert abs(log.velocity[[w.start for w in some]]).min() > 0.05 * abs(log.velocity).max()
    assert moving(log, every[:5]) == every[:5]  # too few to choose

"""What is advised where the data leave a number open: its numbers, and its effect once it is carried out."""

from dataclasses import replace

import numpy as np
import pytest

from stribeck.identify.features.guess import Sizes
from stribeck.identify.features.what_to_measure import experiment_for, reachable

SIZES = Sizes(force=1.0, fast=0.5, stiffness=1e5, travel=0.1, step=2e-3)
VALUES = {"sigma_0": 1e5, "F_c": 1.0, "F_s": 8.0, "v_s": 1e-3}


def test_a_level_that_is_open_is_no_scale_of_reversals():
    """With F_s = 8, open, where 1 is true they were advised 8 times too long."""
    assert reachable(VALUES, SIZES, {"F_s"})["large"] == pytest.approx(5e-5)
    assert reachable(VALUES, SIZES, {"F_s", "F_c"})["large"] == pytest.approx(5e-5)  # the force that was applied
    assert reachable(VALUES, SIZES)["large"] == pytest.approx(4e-4)
    assert "5e-05 m (peak to peak)" in experiment_for("sigma_0", VALUES, SIZES, {"F_s", "sigma_0"})


def test_reversals_stay_within_a_tenth_of_the_travel_where_it_is_known():
    assert reachable(VALUES, replace(SIZES, travel=1e-4))["large"] == pytest.approx(5e-5)
    assert reachable(VALUES, replace(SIZES, travel=0.0)) == reachable(VALUES, SIZES)


def test_fast_reversals_have_samples_enough():
    """A speed of 0.01 m/s was advised for reversals of 50 um, which are over in three samples."""
    at = reachable(VALUES, SIZES, {"F_s"})
    seconds = np.pi * at["large"] / at["loop_fast"]
    assert seconds / SIZES.step >= 20 - 1e-9
    assert reachable(VALUES, Sizes(1.0, 0.5, 1e5, 0.1, 1e-6), {"F_s"})["loop_fast"] > at["loop_fast"]
    assert at["loop"] < at["loop_fast"]


@pytest.mark.parametrize(("v_s", "middle"), [(1e-3, 0.015), (1e-2, 0.1), (0.1, 0.15), (0.2, 0.05), (0.0, 0.05)])
def test_the_middle_speed_lies_beyond_the_bend_and_below_the_fastest(v_s, middle):
    assert reachable({**VALUES, "v_s": v_s}, SIZES)["middle"] == pytest.approx(middle)


def test_the_smallest_speed_does_not_follow_a_v_s_that_is_nowhere():
    assert reachable({**VALUES, "v_s": 1e-9}, SIZES, {"v_s"})["slowest"] == pytest.approx(1e-3 * SIZES.fast)
    assert reachable(VALUES, SIZES, {"v_s"})["slowest"] == pytest.approx(1e-4)

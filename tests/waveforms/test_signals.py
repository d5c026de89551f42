"""Signals: values, pieces, and where they pass a level."""

import numpy as np
import pyarrow
import pytest
from pyarrow import csv, parquet

from stribeck.waveforms import (
    FileSignal,
    PointsSignal,
    PointToPointSignal,
    RampSignal,
    SineSignal,
    SplineSignal,
    StepSignal,
    SumSignal,
)
from stribeck.waveforms.pieces import JUMP, pieces
from stribeck.waveforms.piecewise import KINDS
from stribeck.waveforms.sums import least_of


def points(t, value):
    return PointsSignal(np.array(t, float), np.array(value, float))


def test_a_slope_that_is_no_number_warns_of_nothing_before_it_is_reached():
    with np.errstate(over="raise"):
        assert np.isinf(points([0, 1, 1 + 1e-3], [0, 1, -1.7e308]).segments.slope).any()


def test_points_are_lines_that_jump_where_two_times_are_equal():
    signal = points([1, 2, 2, 3], [0, 4, -1, 1])
    t = [0, 1, 1.5, 2 - 1e-9, 2, 2.5, 3, 9]
    np.testing.assert_allclose(signal.at(t), [0, 0, 2, 4, -1, 0, 1, 1], atol=1e-8)


def test_points_before_the_start_count():
    signal = points([-2, -1, 1], [5, 0, 2])
    np.testing.assert_allclose(signal.at([0, 0.5, 2]), [1, 1.5, 2])


@pytest.mark.parametrize(("t", "value"), [([0, 0], [1, 2]), ([0, 0, 1], [1, 2, 2]), ([-1, 0, 0], [7, 7, 2])])
def test_a_jump_at_the_start_is_over_at_once(t, value):
    assert points(t, value).at(0.0) == 2


def test_of_three_equal_times_the_last_counts():
    signal = points([0, 1, 1, 1, 2], [0, 1, 9, 5, 5])
    np.testing.assert_allclose(signal.at([1, 1.5]), 5)


def test_one_point_is_a_constant():
    np.testing.assert_array_equal(points([3], [0.5]).at([0, 3, 7]), 0.5)


def test_ramp_step_and_sine():
    np.testing.assert_array_equal(RampSignal({"rate": 2.0}).at([0, 1.5]), [0, 3])
    step = StepSignal({"value": -3.0, "time": 1.0})
    np.testing.assert_array_equal(step.at([0, np.nextafter(1, 0), 1, 2]), [0, 0, -3, -3])
    np.testing.assert_array_equal(StepSignal({"value": 2.0, "time": -1.0}).at([0, 1]), 2)
    sine = SineSignal({"amplitude": 2.0, "frequency": 0.25, "offset": 1.0, "phase": np.pi / 2})
    np.testing.assert_allclose(sine.at([0, 1, 2]), [3, 1, -1], atol=1e-14)


def test_each_kind_says_what_it_needs():
    for kind, signal in KINDS.items():
        assert signal.kind == kind
        assert signal.meaning
        assert all(constant.meaning for constant in signal.constants.values())


def test_a_step_cannot_miss_a_wave():
    signal = SineSignal({"amplitude": 1.0, "frequency": 50.0, "offset": 0.0, "phase": 0.0})
    assert signal.longest_step <= 0.125 / 50
    assert RampSignal({"rate": 1.0}).longest_step == np.inf


def crossings(signal, level=1.0, t_end=10.0):
    """Those of the signal, which are also those of a sum of it and nothing."""
    found, of_sum = (
        [(round(t, 12), rises) for t, rises in each.crossings(level, t_end)]
        for each in (signal, SumSignal.flattened([signal, RampSignal({"rate": 0.0})]))
    )
    assert of_sum == found
    return found


def test_crossings_inside_pieces():
    assert crossings(points([0, 4, 8], [0, 4, 0])) == [(1, True), (7, False)]
    assert crossings(points([0, 4, 8], [-2, 2, -2])) == [(1, False), (3, True), (5, False), (7, True)]


def test_crossings_at_points_and_jumps():
    assert crossings(points([0, 1, 2], [0, 1, 2])) == [(1, True)]
    assert crossings(points([0, 1, 2, 3, 4], [0, -1, -2, -1, 0])) == [(1, True), (3, False)]
    assert crossings(points([0, 1, 1, 2], [0.5, 0.5, 3, 3])) == [(1, True)]
    assert crossings(points([0, 1, 1, 2, 2], [2, 2, -2, -2, 0])) == [(2, False)]
    assert crossings(StepSignal({"value": 2.0, "time": 3.0})) == [(3, True)]


def test_a_level_that_is_only_touched_is_not_passed():
    assert crossings(points([0, 1, 2], [0, 1, 0])) == []
    assert crossings(points([0, 1, 2], [2, 1, 2])) == []
    assert crossings(points([0, 0.1, 0.3], [0, 0.1, 0]), level=0.1) == []


def test_crossings_before_the_start_and_behind_the_end_do_not_count():
    assert crossings(points([-1, 3], [0, 4])) == []
    assert crossings(RampSignal({"rate": 0.05})) == []
    assert crossings(RampSignal({"rate": -0.5})) == [(2, True)]


CORNERS = points([0, 2, 5, 5, 7], [0, 3, -2, 1, 1.5])
SINE = SineSignal({"amplitude": -1.5, "frequency": 0.7, "offset": 0.2, "phase": 0.4})
CURVES = [
    kind(np.array([0.5, 2.0, 4.5, 8.0]), np.array([0.3, 2.0, -2.0, 0.3])) for kind in (PointToPointSignal, SplineSignal)
]
MOVING = [SINE, CORNERS, *CURVES, SumSignal.flattened([SINE, CORNERS]), SumSignal.flattened([SINE, CURVES[1]])]


@pytest.mark.parametrize("signal", MOVING)
def test_crossings_are_those_of_samples(signal):
    t = np.linspace(0, 10, 400_001)
    above = np.abs(signal.at(t)) >= 1
    expected = [(t[i + 1], bool(above[i + 1])) for i in np.flatnonzero(above[1:] != above[:-1])]
    found = signal.crossings(1.0, 10.0)
    assert [rises for _, rises in found] == [rises for _, rises in expected]
    np.testing.assert_allclose([t for t, _ in found], [t for t, _ in expected], rtol=0, atol=3e-5)


@pytest.mark.parametrize("signal", MOVING)
def test_pieces_cut_at_turns_have_the_sign_of_the_rate(signal):
    whole, cut = pieces(signal), pieces(signal, turns=True, t_end=10.0)
    t = np.linspace(1e-3, 10 - 1e-3, 20_001)
    rate = (signal.at(t + 1e-6) - signal.at(t - 1e-6)) / 2e-6
    clear = (abs(rate) > 1e-3) & (np.min(abs(t - whole.start[:, None]), axis=0) > 1e-5)
    np.testing.assert_array_equal(cut.at(t)[clear, -1], np.sign(rate[clear]))
    changes = np.append(True, np.diff(cut.rows[:, -1]) != 0)
    assert changes[~np.isin(cut.start, whole.start)].all()  # no more cuts than reversals
    assert (cut.restart[changes] == JUMP).all()
    assert (cut.restart[~changes] == whole.restart[np.isin(whole.start, cut.start[~changes])]).all()


@pytest.mark.parametrize("signal", MOVING)
def test_a_lower_bound(signal):
    least = np.min(signal.at(np.linspace(0, 10, 100_001)))
    assert least_of(signal) <= least + 1e-4
    if not isinstance(signal, SumSignal):  # of a sum the parts' bounds are added
        assert least_of(signal) == pytest.approx(least, abs=1e-3)


def test_a_sine_that_stays_on_one_side_has_no_crossings():
    for amplitude, offset in ((0.0, 5.0), (0.5, 0.0), (0.5, 2.0)):
        assert crossings(SineSignal({"amplitude": amplitude, "frequency": 1.0, "offset": offset, "phase": 0.0})) == []


def test_files_are_read_as_points(tmp_path):
    table = pyarrow.table({"t": [0.0, 1.0, 1.0], "v": [0, 2, 5], "text": ["a", "b", "c"]})
    csv.write_csv(table, tmp_path / "log.csv")
    parquet.write_table(table, tmp_path / "log.parquet")
    for name in ("log.csv", "log.parquet"):
        np.testing.assert_array_equal(FileSignal.read(tmp_path / name, "t", "v").at([0.5, 1, 3]), [1, 5, 5])


def test_constants_have_the_unit_of_what_the_signal_is():
    assert RampSignal.constants["rate"].in_unit("m").unit == "m/s"
    assert SineSignal.constants["amplitude"].in_unit("N").unit == "N"

"""Signals: values and pieces."""

import numpy as np
import pytest

from stribeck.waveforms import PointsSignal, PointToPointSignal, SineSignal, SplineSignal, SumSignal
from stribeck.waveforms.pieces import JUMP, pieces


def points(t, value):
    return PointsSignal(np.array(t, float), np.array(value, float))


def test_a_slope_that_is_no_number_warns_of_nothing_before_it_is_reached():
    with np.errstate(over="raise"):
        assert np.isinf(points([0, 1, 1 + 1e-3], [0, 1, -1.7e308]).segments.slope).any()


CORNERS = points([0, 2, 5, 5, 7], [0, 3, -2, 1, 1.5])
SINE = SineSignal({"amplitude": -1.5, "frequency": 0.7, "offset": 0.2, "phase": 0.4})
CURVES = [
    kind(np.array([0.5, 2.0, 4.5, 8.0]), np.array([0.3, 2.0, -2.0, 0.3])) for kind in (PointToPointSignal, SplineSignal)
]
MOVING = [SINE, CORNERS, *CURVES, SumSignal.flattened([SINE, CORNERS]), SumSignal.flattened([SINE, CURVES[1]])]


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

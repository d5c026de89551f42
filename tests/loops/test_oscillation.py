"""Amplitude and period of known signals."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stribeck.loops.oscillation import amplitude_and_period


@given(st.floats(0.1, 10.0), st.floats(0.5, 5.0), st.floats(-3.0, 3.0), st.floats(0.0, 6.0))
def test_a_sine_is_measured(amplitude, period, offset, phase):
    t = np.linspace(0, 20 * period, 20001)
    result = amplitude_and_period(t, offset + amplitude * np.sin(2 * np.pi * t / period + phase))
    assert result == pytest.approx((amplitude, period), rel=1e-4)


def test_no_period_without_two_crossings():
    amplitude, period = amplitude_and_period(np.arange(3.0), np.array([0.0, 1.0, 2.0]))
    assert amplitude == 1.0
    assert np.isnan(period)

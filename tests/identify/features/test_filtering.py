"""The motion as it might be as well."""

import numpy as np
import pytest

from stribeck.identify.features.filtering import noise, other_motions
from tests.identify.core.records import record


def measured(position, bandwidth=20.0):
    log = record()
    return log.with_columns(unfiltered=position(log.position), sources={"unfiltered": "position"}, bandwidth=bandwidth)


def test_noise_is_at_least_that_of_rounding():
    """A slow body stays within one count, where differences show none."""
    counts = measured(lambda y: 0.05 * np.round(y / 0.05))
    assert noise(counts) == pytest.approx(0.05 / np.sqrt(12))


def test_noise_is_that_of_third_differences():
    draw = np.random.default_rng(0)
    white = measured(lambda y: y + 1e-4 * draw.standard_normal(len(y)))
    assert noise(white) == pytest.approx(1e-4, rel=0.05)


def test_other_motions_have_the_noise_once_more_or_a_lower_cut_off():
    log = measured(lambda y: 0.01 * np.round(y / 0.01))
    found = other_motions(log)
    off = np.std(found["noise of the motion"][0].position - log.position)
    assert 0 < off < 0.01 / np.sqrt(12)  # behind the filter
    assert found["filter of the motion"][0].bandwidth < log.bandwidth
    assert other_motions(log.with_columns(bandwidth=None)) == {}

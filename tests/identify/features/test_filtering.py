"""The motion as it might be as well."""

import numpy as np

from stribeck.identify.features.filtering import other_motions
from tests.identify.core.records import record


def measured(position, bandwidth=20.0):
    log = record()
    return log.with_columns(
        unfiltered=position(log.position),
        sources={"unfiltered": "position"},
        bandwidth=bandwidth,
        spectrum=(np.ones(1), np.ones(1), 2 * log.step * 0.01**2 / 12),
    )


def test_other_motions_have_the_noise_once_more_or_a_lower_cut_off():
    log = measured(lambda y: 0.01 * np.round(y / 0.01))
    found = other_motions(log)
    off = np.std(found["noise of the motion"][0].position - log.position)
    assert 0 < off < 0.01 / np.sqrt(12)  # behind the filter
    assert found["filter of the motion"][0].bandwidth < log.bandwidth
    assert other_motions(log.with_columns(bandwidth=None)) == {}

"""The motion as it might be as well."""

import numpy as np

from stribeck.identify.features.filtering import other_motions, smoother_log
from tests.identify.core.records import joined, record


def measured(position, bandwidth=20.0):
    log = record()
    return log.with_columns(
        unfiltered=position(log.position),
        sources={"unfiltered": "position"},
        bandwidth=bandwidth,
        noise=2 * log.step * 0.01**2 / 12,
    )


def test_other_motions_have_the_noise_once_more_or_a_lower_cut_off():
    log = measured(lambda y: 0.01 * np.round(y / 0.01))
    result = other_motions(log)
    off = np.std(result["noise of the motion"][0].position - log.position)
    assert 0 < off < 0.01 / np.sqrt(12)  # behind the filter
    assert result["filter of the motion"][0].bandwidth < log.bandwidth
    assert other_motions(log.with_columns(bandwidth=None)) == {}


def test_ends_of_runs_and_short_runs_stay_as_they_are():
    log = joined(record(0, end=1.0), record(1, end=0.12)).with_columns(bandwidth=20.0)
    edge, smooth = 25, smoother_log(log)
    changed = smooth.force != log.force, smooth.acceleration != log.acceleration
    assert not changed[0].any()
    assert changed[1][edge : 500 - edge].all()
    assert not changed[1][:edge].any()
    assert not changed[1][500 - edge :].any()
    assert smooth.bandwidth < log.bandwidth

"""The ends of runs, in which the motion's filter is wrong."""

import numpy as np

from stribeck.identify.data.prepare import _without_ends


def test_the_end_of_a_run_is_left_out_where_it_ends_in_motion():
    v = np.concatenate([np.sin(3e-3 * np.arange(2000)), np.clip(np.linspace(2, -1, 2000), 0, 1)])
    rows, (text,) = _without_ends({"velocity": v}, [2000, 2000], 100)
    assert np.flatnonzero(~rows).tolist() == [*range(1900, 2000)]
    assert "the last 100 rows were left out" in text
    assert _without_ends({"velocity": v[2000:]}, [2000], 100) == (slice(None), [])

"""The ends of runs, in which the motion's filter goes astray."""

import numpy as np

from stribeck.identify.data.prepare import Preparation, _without_ends


def columns(spoilt: float):
    """Four seconds of sliding; the acceleration of the last rows is wrong by so much, and below its largest."""
    t = np.arange(2000) * 2e-3
    draw = np.random.default_rng(1)
    v, a = np.sin(3 * t), 3 * np.cos(3 * t)
    force = 2 * a + 5 * np.sign(v) + 1.0 * v + 0.05 * draw.standard_normal(len(t))
    end = np.maximum(np.arange(len(t)) - 1900, 0) / 100
    return {"time": t, "position": np.cumsum(v) * 2e-3, "velocity": v, "acceleration": a - spoilt * end, "force": force}


def test_an_end_in_which_the_filter_goes_astray_is_left_out():
    for spoilt, kept in ((0.0, 2000), (1.0, 1900)):
        given = columns(spoilt)
        rows, said = _without_ends(given, [2000], 100, Preparation())
        assert len(given["time"][rows]) == kept
        assert bool(said) == (kept < 2000)


def test_the_published_procedure_keeps_a_short_end_and_says_so():
    given = columns(0.0)
    given["acceleration"][-15:] -= np.linspace(0.2, 1.0, 15)
    rows, (said,) = _without_ends(given, [2000], 15, Preparation(published=True))
    assert len(given["time"][rows]) == 2000
    assert "kept, as in the published procedure" in said
    rows, (said,) = _without_ends(given, [2000], 15, Preparation())
    assert len(given["time"][rows]) == 1985
    assert "the last 15 rows are left out" in said

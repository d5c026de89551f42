"""What made fits worse than plain least squares on records that they had not seen."""

import numpy as np

from stribeck.identify.api import read_log
from stribeck.identify.data.prepare import _without_ends
from stribeck.identify.methods.static import Setting, settle
from stribeck.identify.models.static_problem import rows_of

NAMES = {"time": "t", "velocity": "v", "force": "F"}


def columns(spoilt: float):
    """Four seconds of sliding; the acceleration of the last rows is wrong by so much, and below its largest."""
    t = np.arange(2000) * 2e-3
    draw = np.random.default_rng(1)
    v, a = np.sin(3 * t), 3 * np.cos(3 * t)
    force = 2 * a + 5 * np.sign(v) + 1.0 * v + 0.05 * draw.standard_normal(len(t))
    end = np.maximum(np.arange(len(t)) - 1900, 0) / 100
    return {"time": t, "position": np.cumsum(v) * 2e-3, "velocity": v, "acceleration": a - spoilt * end, "force": force}


def test_an_end_in_which_the_filter_goes_astray_is_left_out():
    assert len(_without_ends(columns(0.0), [2000], 100, False)["time"]) == 2000
    assert len(_without_ends(columns(1.0), [2000], 100, False)["time"]) == 1900


def test_no_bend_of_the_curve_lies_where_nothing_was_measured(tmp_path):
    draw = np.random.default_rng(3)
    t = np.arange(3000) * 2e-3
    v = 1.8 + np.sin(4 * t) + 0.4 * np.sin(2.3 * t)
    force = 1.6 * np.gradient(v, 2e-3) + 7.9 + 3.0 * v + 0.3 * draw.standard_normal(len(t))
    np.savez(tmp_path / "log.npz", t=t, v=v + 1e-4 * draw.standard_normal(len(t)), F=force)
    log = read_log(tmp_path / "log.npz", columns=NAMES)
    found = settle(rows_of(log), "stribeck", Setting({}))
    shape = next(s for s in found.model.whole.shapes if s.name == "v_s")
    assert shape.low >= float(np.min(abs(log.velocity)))
    assert found.solution.values["v_s"] >= shape.low

"""Stretches of a recording: what drives the machine in them, and how they meet."""

import numpy as np
import pytest

from stribeck.identify.actuator.runs import later


@pytest.mark.parametrize(
    ("signal", "value"),
    [
        ({"kind": "sine", "amplitude": 2.0, "frequency": 0.7, "phase": 0.3, "offset": 0.1},
         lambda t: 0.1 + 2.0 * np.sin(2 * np.pi * 0.7 * t + 0.3)),
        ({"kind": "step", "time": 2.0, "value": 3.0}, lambda t: 3.0 * (t >= 2.0)),
        ({"kind": "points", "t": [0.0, 1.0, 4.0], "value": [0.0, 2.0, -1.0]},
         lambda t: np.interp(t, [0.0, 1.0, 4.0], [0.0, 2.0, -1.0])),
    ],
)  # fmt: skip
@pytest.mark.parametrize("by", [0.6, 1.7, 3.9, 5.5])
def test_a_signal_goes_on_where_a_stretch_begins(signal, value, by):
    s = later(signal, by)
    t = np.linspace(0.0, 1.0, 50)
    if s["kind"] == "sine":
        now = s["offset"] + s["amplitude"] * np.sin(2 * np.pi * s["frequency"] * t + s["phase"])
    elif s["kind"] == "step":
        now = s["value"] * (t >= s["time"])
    else:
        now = np.interp(t, s["t"], s["value"])
    np.testing.assert_allclose(now, value(t + by), atol=1e-12)


def test_a_signal_that_cannot_be_cut_is_none():
    assert later({"kind": "point_to_point", "t": [0.0, 1.0], "value": [0.0, 1.0]}, 0.5) is None

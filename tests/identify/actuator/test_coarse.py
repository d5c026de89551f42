"""A coarse recording has fewer samples, and inputs that are the nearest ones with these."""

import numpy as np
import pytest

from stribeck.identify.actuator.guided import coarser
from stribeck.identify.actuator.recordings import Channel, Recording

T = 1e-3 * np.arange(8001)
FORCE = np.sin(2 * np.pi * 3.0 * T)
NOISE = 0.1 * np.random.default_rng(0).standard_normal(len(T))


def made(**kinds):
    """A recording of a position with one input."""
    return Recording(
        "run", T, {"a.y": Channel("y", T, T**2)}, {"loads.f.signal": Channel("f", T, FORCE + NOISE, **kinds)}
    )


@pytest.mark.parametrize("kinds", [{"smooth": True}, {}, {"held": True}])
def test_a_coarse_input_follows_the_signal_and_not_its_noise(kinds):
    coarse = coarser(made(**kinds), 8)
    drive = coarse.inputs["loads.f.signal"]
    middle = drive.t + (3.5e-3 if kinds.get("held") else 0.0)
    off = drive.x[2:-2] - np.sin(2 * np.pi * 3.0 * middle[2:-2])
    assert np.sqrt(np.mean(off**2)) < 0.6 * np.std(NOISE)
    assert abs(np.mean(off * np.sin(2 * np.pi * 3.0 * middle[2:-2]))) < 0.003


def test_outputs_keep_every_so_many_samples():
    coarse = coarser(made(), 4)
    np.testing.assert_array_equal(coarse.outputs["a.y"].t, T[::4])
    np.testing.assert_array_equal(coarse.outputs["a.y"].x, T[::4] ** 2)
    np.testing.assert_array_equal(coarse.t, T[::4])


def test_uneven_and_short_recordings_stay_as_they_are():
    assert coarser(made(), 32) is None
    t = T**1.001
    assert coarser(Recording("run", t, {"a.y": Channel("y", t, t)}), 2) is None

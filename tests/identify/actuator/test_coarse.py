"""A coarse recording has fewer samples, and inputs that are the nearest ones with these."""

import numpy as np
import pytest

from stribeck import Scenario
from stribeck.identify.actuator.coordinates import MachineCoordinate
from stribeck.identify.actuator.guided import GuidedSearch, coarser
from stribeck.identify.actuator.recordings import Channel, Recording
from stribeck.identify.work import Work
from tests.identify.actuator.recorded import body
from tests.reference.apart import solve

F_C = "contacts.guide.law.parameters.F_c"

T = 1e-3 * np.arange(8001)
FORCE = np.sin(2 * np.pi * 3.0 * T)
NOISE = 0.1 * np.random.default_rng(0).standard_normal(len(T))


def built(**kinds):
    """A recording of a position with one input."""
    return Recording(
        "run", T, {"a.y": Channel("y", T, T**2)}, {"loads.f.signal": Channel("f", T - 1e-9, FORCE + NOISE, **kinds)}
    )


@pytest.mark.parametrize("kinds", [{"smooth": True}, {}, {"held": True}])
def test_a_coarse_input_follows_the_signal_and_not_its_noise(kinds):
    coarse = coarser(built(**kinds), 8)
    drive = coarse.inputs["loads.f.signal"]
    middle = drive.t + (3.5e-3 if kinds.get("held") else 0.0)
    off = drive.x[2:-2] - np.sin(2 * np.pi * 3.0 * middle[2:-2])
    assert np.sqrt(np.mean(off**2)) < 0.6 * np.std(NOISE)
    assert abs(np.mean(off * np.sin(2 * np.pi * 3.0 * middle[2:-2]))) < 0.003


def test_outputs_keep_every_so_many_samples_and_a_held_input_their_means():
    coarse = coarser(built(held=True), 4)
    np.testing.assert_array_equal([coarse.t, coarse.outputs["a.y"].t], [T[::4]] * 2)
    np.testing.assert_array_equal(coarse.outputs["a.y"].x, T[::4] ** 2)
    np.testing.assert_allclose(coarse.inputs["loads.f.signal"].x[:-1], (FORCE + NOISE)[:-1].reshape(-1, 4).mean(1))


def test_uneven_and_short_recordings_stay_as_they_are():
    assert coarser(built(), 32) is None
    t = T**1.001
    assert coarser(Recording("run", t, {"a.y": Channel("y", t, t)}), 2) is None


@pytest.mark.parametrize(("noise", "factor"), [(2e-3, 4), (0.0, 2)])
def test_a_search_is_as_coarse_as_no_output_shows(noise, factor):
    """The push has a fast part, which moves the body by less than the noise of its position, or by more."""
    data = body(amplitude=5.0, t_end=4.0, step=2e-3)
    t, push = 4.0 * np.arange(2001) / 2000, data["loads"]["push"]["signal"]
    fast = np.array(push["value"]) + 3.0 * np.sin(2 * np.pi * 180 * t)
    push["value"] = fast.tolist()
    y = solve(data, rtol=1e-9)["a.y"] + noise * np.random.default_rng(0).standard_normal(len(t))
    recording = Recording("run", t, {"a.y": Channel("y", t, y)}, {"loads.push.signal": Channel("f", t, fast)})
    level = MachineCoordinate(F_C, 0.5, 1.3, 1.0, targets={F_C: 1.0})
    search = GuidedSearch(Scenario(data), [(0, recording)], [level], {"a.y": 1e-3}, Work())
    assert search._coarsest(0, {}) == factor

"""Oscillations beyond floating point: where the phase is lost, a note says which columns are wrong."""

import warnings

import numpy as np
import pytest

import stribeck
from stribeck import examples

LAW = {
    "name": "lugre",
    "parameters": {"sigma_0": 1e5, "sigma_1": 300.0, "sigma_2": 0.4, "F_c": 1.0, "F_s": 1.5, "v_s": 1e-3},
}
EPS = np.finfo(float).eps
SLOW_END = {"signal": {"kind": "ramp", "rate": 1e-3}}


def solved(**machine):
    data = {"schema": 2, "bodies": {"a": {"mass": 1.0}}, "solve": {"t_end": 1.0}, "output": {"step": 0.1}, **machine}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return stribeck.simulate(data)


def drawn_by(stiffness, damping=0.0, **more):
    """A mass of 1 kg that a spring draws: v = v_0 (1 - cos w t), with w = sqrt(stiffness)."""
    more_of_link = {"damping": damping} if damping else {}
    link = {"from": SLOW_END, "to": "a", "stiffness": stiffness, **more_of_link}
    return solved(links={"spring": link}, **more)


def load(signal):
    return {"push": {"on": "a", "kind": "signal", "signal": signal}}


def reaches(found, peak):
    """Whether the motion reaches the promised accuracy of its true peak, or the run says that it does not."""
    said = found.status == "failed" or "accuracy not reached" in found.message
    return said or np.max(abs(found["a.v"])) >= 0.99 * peak


def test_a_spring_that_swings_a_thousand_times_is_right():
    found = drawn_by((2 * np.pi * 1000.25) ** 2)
    w = 2 * np.pi * 1000.25
    assert np.max(abs(found["a.v"] - 1e-3 * (1 - np.cos(w * found.t)))) <= 1e-6 * 2e-3
    assert "accuracy" not in found.message


@pytest.mark.parametrize("stiffness", [1e37, 1e45, 1e60, 1e100])
def test_an_undamped_spring_beyond_floating_point_is_said(stiffness):
    """The phase eps w t is off by more than the promised 1e-6 from 4.5e9 rad/s on; here v lacks the whole oscillation."""
    assert EPS * stiffness**0.5 > 1e-6
    found = drawn_by(stiffness)
    assert found.message.count("a.v to 1e-06 of the peak; it oscillates at")
    assert f"{stiffness**0.5 / (2 * np.pi):.3g} Hz" in found.message


@pytest.mark.parametrize("more", [{}, {"contacts": {"guide": {"from": "a", "law": LAW}}}])
@pytest.mark.parametrize("stiffness", [1e37, 1e60])
def test_no_motion_lacks_its_oscillation_in_silence(stiffness, more):
    """A ramp of the load, a sine of it, and a break of its slope within the run."""
    link = {"links": {"spring": {"from": "a", "to": "ground", "stiffness": stiffness}}}
    late = {"kind": "points", "t": [0.0, 0.55, 1.0], "value": [0.0, 0.0, 1.0]}
    for signal in ({"kind": "ramp", "rate": 1.0}, {"kind": "sine", "amplitude": 1.0, "frequency": 1.0}, late):
        assert reaches(solved(loads=load(signal), **link, **more), 2.0 / stiffness)


def test_a_damped_oscillation_does_not_last_until_its_phase_is_lost():
    found = drawn_by(1e37, damping=0.2 * 1e37**0.5)
    assert "oscillates" not in found.message
    assert np.max(abs(found["a.v"][1:] - 1e-3)) <= 1e-9


@pytest.mark.thorough
def test_a_stiff_coupling_that_nothing_excites_is_not_reported():
    """Two masses of 1 kg on a coupling of 1e37 N/m move as one: the oscillation between them has 1e-37 of the motion."""
    bodies = {"a": {"mass": 1.0}, "b": {"mass": 1.0}}
    links = {
        "coupling": {"from": "a", "to": "b", "stiffness": 1e37},
        "soft": {"from": "b", "to": "ground", "stiffness": 1.0},
    }
    found = solved(bodies=bodies, links=links, loads=load({"kind": "ramp", "rate": 1.0}))
    assert "oscillates" not in found.message
    if found.status == "done":
        w = 0.5**0.5  # of 2 kg on 1 N/m, drawn by t N
        assert np.max(abs(found["a.v"] - (1 - np.cos(w * found.t)))) <= 1e-6


@pytest.mark.share(3)
@pytest.mark.parametrize("sigma_0", [1e37, 1e40, 1e60])
def test_stiff_bristles_without_damping(sigma_0):
    law = {"name": "dahl", "parameters": {"sigma_0": sigma_0, "F_c": 10.0}}
    found = solved(contacts={"guide": {"from": "a", "law": law}}, loads=load({"kind": "ramp", "rate": 1.0}))
    assert reaches(found, 2.0 / sigma_0)


@pytest.mark.parametrize("gain", [1e37, 1e60])
def test_a_stiff_controller_without_damping(gain):
    controller = {"on": "a", "kind": "pid", "K_p": gain, "signal": {"kind": "ramp", "rate": 1e-3}}
    assert reaches(solved(controllers={"axis": controller}), 2e-3)


@pytest.mark.thorough
def test_lanes_that_lose_their_phase_are_counted():
    """Each lane is judged by its own constants, as its single run is."""
    link = {"from": SLOW_END, "to": "a", "stiffness": 1.0, "damping": 0.0}
    data = {"schema": 2, "bodies": {"a": {"mass": 1.0}}, "links": {"spring": link}, "solve": {"t_end": 1.0}}
    stiff = {"links.spring.stiffness": [1e4, 1e40, 1e6, 1e60], "bodies.a.mass": [1.0, 1.0, 1e-3, 1.0]}
    ensemble = stribeck.simulate({**data, "output": {"step": 0.1}}, vary=stiff)
    assert ensemble.inaccurate.tolist() == [False, True, False, True]
    assert "2 of 4 lanes do not reach the promised accuracy" in ensemble.message


def test_pieces_that_begin_before_the_run_are_judged_from_its_start():
    """Those of a controller do; there was a row -1 s then, which no short run has."""
    fast = {"contacts.bearing.law.parameters.sigma_1": 1e200, "solve.t_end": 0.05, "output.step": 0.01}
    assert stribeck.simulate(stribeck.load(examples.path("arm"), fast)).status == "done"

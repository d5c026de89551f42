"""A law in python-control: its numbers, and simulations against Stribeck's own."""

import math

import numpy as np
import pytest

import stribeck
from stribeck.exports.python import response, to_control
from stribeck.laws import builtin
from tests.laws.test_sanity import make
from tests.simulation.rig import rig, solved

ct = pytest.importorskip("control")


def spring(stiffness):
    return ct.nlsys(
        None, lambda t, x, u, params: stiffness * (u[0] - u[1]), inputs=["x", "y"], outputs=["u"], name="spring"
    )


@pytest.mark.parametrize("name", builtin())
def test_system_has_the_numbers_of_the_law(name):
    law = make(builtin()[name])
    v, z = 0.7 * law.scales(law.p).speed, 0.3 * law.scales(law.p).length
    system, body = to_control(law), to_control(law, mass=2.0)
    states = [z] if law.has_z else []
    assert (system.input_labels, system.output_labels, system.state_labels) == (["v"], ["F"], ["z"] * law.has_z)
    assert system.output(0, states, [v]) == pytest.approx([law.force(v, z)], rel=1e-14)
    assert list(system.dynamics(0, states, [v])) == ([law.rate(v, z)] if law.has_z else [])
    assert (body.input_labels, body.output_labels) == (["u"], ["y", "v", "F"])
    assert body.state_labels == ["y", "v", *["z"] * law.has_z]
    assert body.dynamics(0, [0.1, v, *states], [5.0])[:2] == pytest.approx([v, (5.0 - law.force(v, z)) / 2], rel=1e-14)


def test_parameters_of_the_system_replace_constants():
    law = stribeck.law("lugre", "canudas1995")
    other = stribeck.law("lugre", "canudas1995", F_c=0.5)
    got = to_control(law).output(0, [1e-6], [2e-3], params={"F_c": 0.5})
    assert got == pytest.approx([float(other.force(2e-3, 1e-6))], rel=1e-14)


def test_stick_slip_in_an_interconnected_system():
    """theory.md's y(40 s), by two solvers of others; here to 20 s against Stribeck's own solver."""
    body = to_control(stribeck.law("lugre", "canudas1995"), mass=1.0)
    loop = ct.interconnect([spring(2.0), body], inputs=["x"], outputs=["y", "v", "F"])
    T = np.linspace(0, 20, 1001)
    got = response(loop, T, 0.1 * T)
    reference = solved(
        rig("lugre", {"kind": "spring", "stiffness": 2.0}, {"kind": "ramp", "rate": 0.1}, 20.0, rows=1000)
    )
    assert np.max(abs(got.y[0] - reference["y"])) < 1e-5 * reference.peaks["y"]


def test_solver_follows_a_bristle_that_is_smaller_than_scipys_tolerance():
    law = stribeck.law("lugre_majorant", "canudas1995", k_v=1e6)
    T = np.linspace(0, 1, 11)
    got = response(to_control(law), T, np.full(11, 5e-4))
    assert got.y[0, -1] == pytest.approx(float(law.steady_force(5e-4)), rel=1e-6)


def test_the_tolerance_is_that_of_the_smallest_bristle_of_a_system(monkeypatch):
    stiff, soft = (stribeck.law("lugre", "canudas1995", sigma_0=sigma_0) for sigma_0 in (1e5, 1e3))
    bodies = [to_control(x, mass=1.0) for x in (soft, stiff)]
    pair = ct.interconnect(bodies, check_unused=False, warn_duplicate=False)
    monkeypatch.setattr(ct, "input_output_response", lambda *given, solve_ivp_kwargs: solve_ivp_kwargs)
    assert response(pair, [0.0, 1.0])["atol"] == pytest.approx(1e-9 * 1.5 / 1e5)


def test_linearized_stuck_body_rings_on_its_bristles():
    body = to_control(stribeck.law("lugre_majorant", "canudas1995", k_v=1e8), mass=1.0)
    poles = ct.linearize(body, [0, 0, 0], [0], eps=1e-14).poles()
    ringing = poles[abs(poles.imag) > 1]
    assert np.max(abs(abs(ringing) - math.sqrt(1e5))) < 1e-2 * math.sqrt(1e5)


def test_bad_mass_is_refused():
    for mass in (0.0, -1.0, math.nan, "2"):
        with pytest.raises(stribeck.InputError, match=r"^mass: "):
            to_control(stribeck.law("lugre", "canudas1995"), mass=mass)

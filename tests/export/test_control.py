"""A law in python-control, its describing function against closed forms, and what that predicts of hunting."""

import math

import numpy as np
import pytest

import stribeck
from stribeck import examples
from stribeck.analysis.oscillation import amplitude_and_period
from stribeck.export.control import describing_function, hunting, response
from stribeck.laws import builtin
from tests.laws.test_claims import CANUDAS, make

ct = pytest.importorskip("control")


def spring(stiffness):
    return ct.nlsys(
        None, lambda t, x, u, params: stiffness * (u[0] - u[1]), inputs=["x", "y"], outputs=["u"], name="spring"
    )


@pytest.mark.parametrize("name", builtin())
def test_system_has_the_numbers_of_the_law(name):
    law = make(builtin()[name])
    v, z = 0.7 * law.scales(law.p).speed, 0.3 * law.scales(law.p).length
    system, body = law.to_control(), law.to_control(mass=2.0)
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
    got = law.to_control().output(0, [1e-6], [2e-3], params={"F_c": 0.5})
    assert got == pytest.approx([float(other.force(2e-3, 1e-6))], rel=1e-14)


def test_stick_slip_in_an_interconnected_system():
    """theory.md's y(40 s), by two solvers of others; here to 20 s against Stribeck's own solver."""
    body = stribeck.law("lugre", "canudas1995").to_control(mass=1.0)
    loop = ct.interconnect([spring(2.0), body], inputs=["x"], outputs=["y", "v", "F"])
    T = np.linspace(0, 20, 1001)
    got = response(loop, T, 0.1 * T)
    scenario = stribeck.Scenario(
        law={"name": "lugre", "parameters": "canudas1995"},
        plant={"mass": 1.0},
        drive={"kind": "spring", "stiffness": 2.0, "signal": {"kind": "ramp", "rate": 0.1}},
        solve={"t_end": 20.0},
        output={"step": 0.02},
    )
    reference = stribeck.simulate(scenario)
    assert np.max(abs(got.y[0] - reference["y"])) < 1e-5 * reference.peaks["y"]


def test_solver_follows_a_bristle_that_is_smaller_than_scipys_tolerance():
    law = stribeck.law("lugre_majorant", "canudas1995", k_v=1e6)
    T = np.linspace(0, 1, 11)
    got = response(law.to_control(), T, np.full(11, 5e-4))
    assert got.y[0, -1] == pytest.approx(float(law.steady_force(5e-4)), rel=1e-6)


def test_linearised_stuck_body_rings_on_its_bristles():
    body = stribeck.law("lugre_majorant", "canudas1995", k_v=1e8).to_control(mass=1.0)
    poles = ct.linearize(body, [0, 0, 0], [0], eps=1e-14).poles()
    ringing = poles[abs(poles.imag) > 1]
    assert np.max(abs(abs(ringing) - math.sqrt(1e5))) < 1e-2 * math.sqrt(1e5)


def test_bad_mass_is_refused():
    for mass in (0.0, -1.0, math.nan, "2"):
        with pytest.raises(stribeck.InputError, match=r"^mass: "):
            stribeck.law("lugre", "canudas1995").to_control(mass=mass)


def test_describing_function_of_coulomb_and_viscous_friction():
    law = stribeck.law("coulomb_viscous", F_c=1.3, sigma_2=0.4, k_v=1e9)
    for amplitude in (0.01, 2.0):
        found = describing_function(law, amplitude)
        assert found.real == pytest.approx(4 * 1.3 / (math.pi * amplitude) + 0.4, rel=1e-5)
        assert abs(found.imag) < 1e-9 * found.real


def test_describing_function_agrees_with_python_controls_own():
    law = stribeck.law("makkar", g1=0.25, g2=100.0, g3=10.0, g4=0.1, g5=100.0, g6=0.01)
    for amplitude in (0.003, 0.1, 1.0):
        own = complex(
            np.squeeze(ct.describing_function(lambda v: float(np.squeeze(law.force(v))), amplitude, num_points=2000))
        )
        assert describing_function(law, amplitude).real == pytest.approx(own.real, rel=1e-4)


def test_describing_function_of_a_bristle_is_its_spring_and_its_slope():
    law = stribeck.law("lugre", "canudas1995")
    stuck = describing_function(law, 1e-9, frequency=2.0)
    omega = 4 * math.pi
    assert stuck.real == pytest.approx(CANUDAS["sigma_1"] + CANUDAS["sigma_2"], rel=1e-3)
    assert stuck.imag == pytest.approx(-CANUDAS["sigma_0"] / omega, rel=1e-3)
    sliding = describing_function(law, 1.0, frequency=0.1)  # Coulomb friction, but for the moments of reversal
    assert sliding.real == pytest.approx(4 * CANUDAS["F_c"] / math.pi + CANUDAS["sigma_2"], rel=1e-3)


def pid(law, initial=0.0, t_end=60.0, **gains):
    return stribeck.Scenario(
        law=law,
        plant={"mass": 1.0, "initial": {"y": initial}},
        drive={"kind": "pid", **gains, "signal": {"kind": "step", "value": 0.0, "time": 0.0}},
        solve={"t_end": t_end},
        output={"step": 0.01},
    )


UNSTABLE = {"K_p": 3.0, "K_i": 24.0, "K_d": 6.0}
COULOMB = {"name": "coulomb_viscous", "k_v": 1e5, "parameters": {"F_c": 1.0, "sigma_2": 0.4}}


def test_predicted_cycle_of_coulomb_friction_in_an_unstable_loop():
    """Closed form: omega^2 = K_p/M and 4 F_c/(pi A omega) = K_i/omega^2 - K_d - sigma_2."""
    found = hunting(pid(COULOMB, **UNSTABLE))
    omega = math.sqrt(3.0)
    amplitude = 4 / (math.pi * omega * (24 / omega**2 - 6.4))
    assert found.amplitude == pytest.approx(amplitude, rel=1e-3)
    assert found.period == pytest.approx(2 * math.pi / omega, rel=1e-3)
    for factor, grows in ((0.8, False), (1.3, True)):  # the cycle is unstable: it parts what dies out from what grows
        solution = stribeck.simulate(pid(COULOMB, factor * amplitude, t_end=30.0, **UNSTABLE))
        late = np.max(abs(solution["y"][-400:]))
        assert (late > 1.2 * factor * amplitude) == grows
        assert grows or late < 0.5 * factor * amplitude


def test_hunting_of_the_papers_loop_beside_its_simulation():
    """The law's first harmonic predicts none; the body's a cycle, far off: the motion is no sine. docs/tools.md."""
    scenario = stribeck.Scenario.load(str(examples.path("limit_cycle")))
    by_law, by_body = hunting(scenario), hunting(scenario, of="body")
    assert math.isnan(by_law.amplitude)
    assert 0.01 < by_law.mismatch < 0.1
    assert (round(by_body.amplitude, 2), round(by_body.period, 1)) == (0.31, 11.1)
    solution = stribeck.simulate(scenario)
    late = solution.t > 150
    amplitude, period = amplitude_and_period(solution.t[late], solution["y"][late])
    assert (round(amplitude, 3), round(period, 1)) == (0.064, 24.5)


def test_bad_arguments_are_refused():
    law = stribeck.law("lugre", "canudas1995")
    with pytest.raises(stribeck.InputError, match=r"^amplitude: -1"):
        describing_function(law, -1.0)
    with pytest.raises(stribeck.InputError, match=r"^frequency: nan"):
        describing_function(law, 1.0, math.nan)
    scenario = stribeck.Scenario.load(str(examples.path("stick_slip")))
    with pytest.raises(stribeck.InputError, match="must be 'pid'"):
        hunting(scenario)

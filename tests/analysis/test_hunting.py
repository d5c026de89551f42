"""Describing functions against closed forms and python-control's own, and what they predict of hunting."""

import math

import numpy as np
import pytest

import stribeck
from stribeck import examples
from stribeck.analysis.hunting import describing_function, hunting
from stribeck.analysis.oscillation import amplitude_and_period
from stribeck.laws import find
from tests.laws.test_claims import CANUDAS


def test_describing_function_of_coulomb_and_viscous_friction():
    law = stribeck.law("coulomb_viscous", F_c=1.3, sigma_2=0.4, k_v=1e9)
    for amplitude in (0.01, 2.0):
        found = describing_function(law, amplitude)
        assert found.real == pytest.approx(4 * 1.3 / (math.pi * amplitude) + 0.4, rel=1e-5)
        assert abs(found.imag) < 1e-9 * found.real


def test_describing_function_agrees_with_python_controls_own():
    ct = pytest.importorskip("control")
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


def test_describing_function_of_a_law_of_the_users_own(tmp_path):
    (tmp_path / "mine.py").write_text(
        "from stribeck.laws.lugre import LuGre\n\n\nclass Mine(LuGre):\n    name = 'lugre'\n"
    )
    mine = find("mine.py:Mine", tmp_path)(CANUDAS)
    law = stribeck.law("lugre", "canudas1995")
    assert describing_function(mine, 1e-3, 0.5) == pytest.approx(describing_function(law, 1e-3, 0.5), rel=1e-6)


def pid(law, initial=0.0, t_end=60.0, **gains):
    return stribeck.Scenario(
        law=law,
        plant={"mass": 1.0, "initial": {"y": initial}},
        drive={"kind": "pid", **gains, "signal": {"kind": "step", "value": 0.0, "time": 0.0}},
        solve={"t_end": t_end},
        output={"step": 0.01},
    )


UNSTABLE = {"K_p": 30.0, "K_i": 70.0, "K_d": 1.0}
COULOMB = {"name": "coulomb_viscous", "k_v": 1e5, "parameters": {"F_c": 1.0, "sigma_2": 0.4}}


def test_predicted_cycle_of_coulomb_friction_in_an_unstable_loop():
    """Closed form: omega^2 = K_p/M and 4 F_c/(pi A omega) = K_i/omega^2 - K_d - sigma_2."""
    found = hunting(pid(COULOMB, **UNSTABLE))
    omega = math.sqrt(30.0)
    amplitude = 4 / (math.pi * omega * (70 / omega**2 - 1.4))
    assert found.amplitude == pytest.approx(amplitude, rel=1e-3)
    assert found.period == pytest.approx(2 * math.pi / omega, rel=1e-3)
    for factor, grows in ((0.85, False), (1.15, True)):  # the cycle is unstable: it parts what dies out from what grows
        solution = stribeck.simulate(pid(COULOMB, factor * amplitude, t_end=20.0, **UNSTABLE))
        assert solution.status == "done"
        late = np.max(abs(solution["y"][-400:]))
        assert (late > 2 * amplitude) if grows else (late < 0.1 * amplitude)


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

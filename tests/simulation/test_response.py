"""The compiled answer of a law to a velocity, against the scenario solver and SciPy."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import stribeck
from stribeck.errors import BuildError
from stribeck.laws import find
from stribeck.simulation.response import Response
from tests.simulation.rig import needs_compiler

pytestmark = needs_compiler

PARAMETERS = {"sigma_0": 1e6, "sigma_1": 1e3, "sigma_2": 30.0, "F_c": 10.0, "F_s": 14.0, "v_s": 5e-3}
OWN = {
    "lugre": {},
    "lugre_sobczyk": {"k_v": 1e5},
    "elastoplastic": {"z_ba": 5e-6},
    "elastoplastic_majorant": {"k_v": 1e5, "z_ba": 5e-6},
    "dahl": {},
    "stribeck": {},
}
T = np.arange(0, 2, 1e-3)
V = 0.02 * np.sin(2 * np.pi * 1.3 * T) * T + 1e-4 * np.sin(2 * np.pi * 7 * T)


def make(name, **changes):
    return find(name)({**PARAMETERS, **OWN[name], **changes})


def answer(law, lanes, **options):
    response = Response(type(law), law.form)
    length = law.scales(law.p).length
    sets = response.lanes([each.values for each in lanes])
    return response.force(T, V, sets, np.zeros(len(lanes)), 1e-7 * length, **options)


@pytest.mark.parametrize("name", OWN)
def test_a_smooth_velocity_gives_the_force_of_the_scenario_solver(name):
    law = make(name)
    fine = np.arange(0, T[-1] + 1e-9, 1e-3 / 16)  # the same velocity, so finely that straight lines do
    v = 0.02 * np.sin(2 * np.pi * 1.3 * fine) * fine + 1e-4 * np.sin(2 * np.pi * 7 * fine)
    scenario = stribeck.Scenario(
        law={"name": name, "parameters": PARAMETERS, **OWN[name]},
        drive={"kind": "velocity", "signal": {"kind": "points", "t": fine.tolist(), "value": v.tolist()}},
        solve={"t_end": float(T[-1]), "rtol": 1e-9},
        output={"step": 1e-3},
    )
    solution = stribeck.simulate(scenario)
    assert solution.status == "done"
    # |v| has corners, and a parabola through samples meets them a little early or late
    assert answer(law, [law])[0] == pytest.approx(solution["F"], abs=2e-3)


def test_scipy_agrees():
    law = make("lugre")

    def rate(t, z):
        v = 0.02 * np.sin(2 * np.pi * 1.3 * t) * t + 1e-4 * np.sin(2 * np.pi * 7 * t)
        g = (10 + 4 * np.exp(-((v / 5e-3) ** 2))) / 1e6
        return v - abs(v) / g * z

    found = solve_ivp(rate, (0, T[-1]), [0.0], "Radau", T, rtol=1e-9, atol=1e-14, max_step=1e-3)
    force = 1e6 * found.y[0] + 1e3 * np.array([rate(t, z) for t, z in zip(T, found.y[0], strict=True)]) + 30 * V
    assert answer(law, [law])[0] == pytest.approx(force, abs=2e-3)


def test_lanes_are_each_their_own_law_and_differ_smoothly():
    law, step = make("lugre_sobczyk"), 1e-6
    other = make("lugre_sobczyk", sigma_0=1e6 * (1 + step))
    far = make("lugre_sobczyk", sigma_0=1e6 * (1 + 1e-3))
    base, near, distant = answer(law, [law, other, far])
    assert distant == pytest.approx(answer(far, [far])[0], abs=1e-4)
    slope, secant = (near - base) / step, (distant - base) / 1e-3
    assert slope == pytest.approx(secant, abs=0.01 * np.max(abs(secant)))


def test_a_shift_is_added_to_the_constants_named():
    law, more = make("lugre"), make("lugre", F_c=12.0, F_s=16.0)
    shifted = answer(law, [law], shift=np.full((1, len(T)), 2.0), shifted=("F_c", "F_s"))
    assert shifted == pytest.approx(answer(more, [more]), abs=1e-4)


def test_a_simulation_that_fails_is_none():
    law = make("lugre")
    response = Response(type(law))
    sets = response.lanes([{**law.values, "sigma_0": np.nan}])
    assert response.force(T, V, sets, np.zeros(1), 1e-12) is None


def test_without_a_compiler_it_says_what_to_install(monkeypatch):
    monkeypatch.setenv("STRIBECK_CC", "none")
    with pytest.raises(BuildError, match="C compiler"):
        Response(find("lugre"))

"""The step of a sampled observer is exact at the speed held, also where the law is not linear in z."""

import pytest
from scipy.integrate import solve_ivp

import stribeck as st
from stribeck.expressions.emit import python_function
from stribeck.expressions.graph import symbol
from stribeck.expressions.names import Names
from stribeck.machine.law import Friction
from stribeck.machine.observed import observed
from tests.simulation import independent

P = {"sigma_0": 6e3, "sigma_1": 5.0, "sigma_2": 1.0, "F_c": 0.8, "F_s": 0.95, "v_s": 0.05}
Z = P["F_s"] / P["sigma_0"]


@pytest.mark.parametrize(
    ("name", "own"), [("elastoplastic_majorant", {"k_v": 200.0, "z_ba": 8e-5}), ("elastoplastic", {"z_ba": 8e-5})]
)
def test_step(name, own):
    law = st.law(name, **own, parameters=P)
    friction = Friction(type(law), law.form, type(law).symbolic(lambda n: symbol(f"law.{n}"), law.form))
    z, v, period, called = symbol("z"), symbol("v"), symbol("period"), Names()
    rate = type(law).dz_dt(friction.with_named_terms(called.term), v, z)
    after = observed(friction, rate, z, v, period, called)
    step = python_function(("z", "v", "period", *(f"law.{n}" for n in law.p.numbers)), [after])
    rates = independent.friction(name, {**P, **own})
    for speed in (0.003, -0.1):
        for far in (0.3, 1.0, 3.0, 15.0, 100.0):  # how far the contact goes in a period, in Z
            for start in (-0.9 * Z, 0.0, Z):
                time = far * Z / abs(speed)
                exact = solve_ivp(
                    lambda t, z, speed=speed: [rates(speed, z[0])[0]], (0, time), [start], "LSODA", rtol=1e-10, atol=1e-14
                ).y[0, -1]  # fmt: skip
                result = step(start, speed, time, *law.p.numbers.values())[0]
                assert result == pytest.approx(exact, rel=0, abs=1e-5 * Z), (speed, far, start)

"""Steps 27 to 29 of docs/explanation/theory.md: what slow unwinding gives back is the least slope of a storage function."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp
from scipy.integrate import quad

import stribeck
from stribeck.properties import WORK
from stribeck.properties.checked import Checked
from stribeck.properties.passive import _numeric as numeric
from stribeck.properties.passive import elastic_forces
from tests.properties.nasty import MILD, cases

LAWS = {case.name: case for case in cases()}
S_0, S_2, LENGTH = MILD["sigma_0"], MILD["sigma_2"], MILD["F_s"] / MILD["sigma_0"]


def unwinding(name):
    """A law and phi(z) of theory.md, written here."""
    if name == "lugre":
        return stribeck.law("lugre", MILD), lambda z: 1 + abs(z) / LENGTH
    beta, gamma = {"BoucWen1": (0.6, 0.4), "BoucWenSoft": (0.2, 0.8)}[name]
    return LAWS[name].law(), lambda z: 1 + (beta - gamma) * abs(z) / LENGTH


@pytest.mark.parametrize("name", ["lugre", "BoucWen1", "BoucWenSoft"])
@pytest.mark.parametrize("side", [1, -1])
def test_27_slow_unwinding_gives_back_the_integral_of_the_force_at_rest_over_phi(name, side):
    law, phi = unwinding(name)
    start, end = side * 0.8 * LENGTH, side * 0.2 * LENGTH
    limit = quad(lambda z: law.force(0.0, z) / phi(z), start, end)[0]
    at_rest = law.friction(law.p, 0.0, start, 0.0)
    assert at_rest == pytest.approx(S_0 * start)
    gaps = []
    for slow in (1e-5, 1e-6, 1e-7):
        v = -side * slow
        put_in = quad(lambda z, v=v: law.force(v, z) * v / law.rate(v, z), start, end)[0]
        gaps.append(abs(put_in - limit) / abs(limit))
    assert gaps[0] > 5 * gaps[1] > 25 * gaps[2]  # of first order in the speed, or better
    assert gaps[2] < 1e-4


def test_28_what_bouc_wen_loses_with_that_slope():
    s0, s2, v, u, beta, length = sp.symbols("sigma_0 sigma_2 v u beta Z", positive=True)
    gamma = 1 - beta
    slope = s0 * u * length / (1 + (beta - gamma) * u)

    def lost(sign):  # of v, for z = u Z > 0
        f = sign * v - beta * v * u - gamma * sign * v * u
        return sp.cancel((s0 * u * length + s2 * sign * v) * sign * v - slope * f)

    assert sp.cancel(lost(-1) - s2 * v**2) == 0
    assert sp.cancel(lost(1) - s2 * v**2 - s0 * u * length * v * 2 * beta * u / (1 + (beta - gamma) * u)) == 0


@pytest.mark.parametrize(("name", "elastic"), [("BoucWen1", True), ("BoucWenSoft", False)])
def test_29_the_slope_that_check_forms_is_this_one_and_serves_where_the_elastic_energy_does_not(name, elastic):
    law, phi = unwinding(name)
    checked = Checked(law, None, WORK)
    model = checked.model
    slope = list(elastic_forces(model))[-1]
    z = np.linspace(-0.95, 0.95, 11) * LENGTH
    assert numeric(model, slope)(z) == pytest.approx(S_0 * z / phi(z), rel=1e-12, abs=1e-300)
    # W alone: F v - sigma_0 z f, unwinding slowly
    v, z = -1e-6, 0.5 * LENGTH
    assert (law.force(v, z) * v - S_0 * z * law.rate(v, z) >= 0) == elastic
    assert checked.passive().holds

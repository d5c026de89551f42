"""The steps of docs/explanation/theory.md on a level that varies and on machines, numbered there."""

import pytest
import sympy as sp

from stribeck.laws import builtin
from stribeck.machine.elements.links import Link
from stribeck.machine.elements.loads import Pendulum
from tests.theory.test_proofs import FORMS, constants, majorant, numeric

s0, s1, s2, F_c, F_s, v_s, k_v, v, x = sp.symbols("sigma_0 sigma_1 sigma_2 F_c F_s v_s k_v v x", positive=True)
N, q = sp.symbols("N q", nonnegative=True)
z, w, d = sp.symbols("z w d", real=True)


@pytest.mark.parametrize("word", FORMS)
def test_20_majorants_fall_as_k_v_rises(word):
    """dm/dk_v <= 0, so that the smallest k_v is the worst."""
    if word == "compact":
        formula = (3 + 6 * (k_v * v) ** 2 - (k_v * v) ** 4) / (8 * k_v)
        at = {v: sp.Rational(1, 3), k_v: 2}
        assert abs(float(formula.subs(at)) - float(majorant(word, 2.0, 1 / 3))) < 1e-15
        assert sp.simplify(sp.diff(formula, k_v) + 3 * (1 - (k_v * v) ** 2) ** 2 / (8 * k_v**2)) == 0
        return
    slope = sp.diff(majorant(word, k_v, v), k_v)
    stated = {"atan": -2 / (sp.pi * k_v**2 * (1 + (k_v * v) ** 2)), "sqrt": -1 / (k_v**3 * sp.sqrt(v**2 + 1 / k_v**2))}
    assert abs(numeric(slope - stated[word])) < 1e-14


def test_23_a_stiffness_that_changes_gives_energy_at_no_cost():
    """An elastic contact (dz/dt = v, |z| <= z_ba): wound up at lambda_1, unwound at lambda_2 > lambda_1."""
    one, two, top = sp.symbols("lambda_1 lambda_2 z_1", positive=True)
    put_in = sp.integrate(one * s0 * z, (z, 0, top)) + sp.integrate(two * s0 * z, (z, top, 0))
    assert sp.simplify(put_in + (two - one) * s0 * top**2 / 2) == 0


def test_24_links_and_pendulums_lose_nothing_that_is_not_damped():
    """f w - dE/dt = f_d w, and a damper limited to |f_c| has the sign of w."""
    k, damping = sp.symbols("k c", positive=True)
    free = Link("k", "a", stiffness=1.0, damping=1.0).model_copy(update={"stiffness": k, "damping": damping})
    assert sp.expand(free.force(d, w) * w - sp.diff(free.stored_energy(d), d) * w - damping * w**2) == 0
    for k_, c_, gap_ in ((3.0, 2.0, 0.2), (100.0, 1e-3, 1e-6)):
        link = Link("k", "a", stiffness=k_, damping=c_, gap=gap_)
        for at in (-1.0, -0.11, 0.0, 0.09, 0.1, 0.5):
            for speed in (-10.0, -0.1, 0.0, 0.1, 10.0):
                e = link.stretch(at)
                spring = k_ * e * speed if abs(at) > gap_ / 2 else 0.0  # dE/dt, with de/dt = w beyond the play
                assert link.force(at, speed) * speed - spring >= -1e-12
    amplitude, phase, y = sp.symbols("amplitude phase y", positive=True)
    pendulum = Pendulum("g", "a", amplitude=1.0).model_copy(update={"amplitude": amplitude, "phase": phase})
    assert sp.simplify(pendulum.force(0, y, v) + sp.diff(pendulum.stored_energy(y), y)) == 0


def test_26_dahl_loses_power_at_every_level():
    """D = s0^2 |v| z^2/F_c."""
    p = constants("dahl")
    each = builtin()["dahl"]
    rate = each.dz_dt(p, v, z)
    assert sp.simplify(each.friction(p, v, z, rate) * v - s0 * z * rate - s0**2 * v * z**2 / F_c) == 0


def test_30_the_least_power_by_z_is_a_quadratic_in_the_damping():
    """min over z of D at q = m s0/N is v^2 (a + s2 - a^2 m/(4 N)), at z = a v/(2 s0)."""
    a, m, level = sp.symbols("a m N", positive=True)
    D = (a + s2) * v**2 + m * s0 / level * (s0 * z**2 - a * v * z)
    (at,) = sp.solve(sp.diff(D, z), z)
    assert sp.simplify(at - a * v / (2 * s0)) == 0
    assert sp.simplify(D.subs(z, at) - v**2 * (a + s2 - a**2 * m / (4 * level))) == 0
    stated = (a + s2) * v**2 + q * (s0 * z**2 - a * v * z)  # [18]
    assert sp.expand(D - stated.subs(q, m * s0 / level)) == 0


def test_30_the_largest_damping_and_the_lowest_curve():
    """A solves a^2 q = 4 s0 (a + s2), which a - A and the other, negative, root make; N is at least N^-(v)."""
    a = sp.symbols("a", positive=True)
    A, other = (2 * (s0 + sign * sp.sqrt(s0**2 + s0 * q * s2)) / q for sign in (1, -1))
    assert sp.simplify(sp.expand(q * (a - A) * (a - other) - (a**2 * q - 4 * s0 * (a + s2)))) == 0
    share, more_c, more_s = sp.symbols("share more_c more_s", nonnegative=True)
    least = F_c * (1 - share) + N * share
    level = (F_c + more_c) + ((N + more_s) - (F_c + more_c)) * share
    assert sp.expand(level - least - (more_c * (1 - share) + more_s * share)) == 0


@pytest.mark.parametrize("name", ["lugre", "lugre_majorant"])
@pytest.mark.parametrize("way", [1, -1])
def test_31_slow_motion_at_a_high_level_costs_what_is_stored(name, way):
    """F v/f tends to s0 z as the level rises without end and v falls, whichever way z goes."""
    each, p = builtin()[name], constants(name)
    speed = way * v
    rate = each.dz_dt(p, speed, z)
    density = each.friction(p, speed, z, rate) * speed / rate
    risen = sp.limit(density.subs({F_c: N, F_s: 2 * N, s0: 2, s1: 3, s2: 5, v_s: 1, k_v: 7}), N, sp.oo)
    assert sp.simplify(sp.limit(risen, v, 0) - 2 * z) == 0

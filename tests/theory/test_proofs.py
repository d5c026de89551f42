"""The steps of the proofs in docs/explanation/theory.md, numbered there, from the equations that are simulated.

Only steps that no theorem of proofs/ contains: numbers, limits, and how fast something is reached.
"""

from __future__ import annotations

from math import e, pi, sqrt

import numpy as np
import pytest
import sympy as sp
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq

from stribeck import law
from stribeck.laws import builtin
from stribeck.laws.form import USUAL
from stribeck.laws.terms import m, m_0
from stribeck.parameter_sets import parameters

P = parameters()["canudas1995"].values
s0, s1, s2, F_c, F_s, v_s, k_v, v_d = SYMBOLS = sp.symbols("sigma_0 sigma_1 sigma_2 F_c F_s v_s k_v v_d", positive=True)
v, x, S, g = sp.symbols("v x S g", positive=True)  # the proofs take v > 0: the laws are odd
z, a = sp.symbols("z a", real=True)
NAMES = {symbol.name: symbol for symbol in SYMBOLS} | {"z_ba": sp.Symbol("z_ba", positive=True)}
FORMS = ("atan", "sqrt", "compact")


def constants(name, form=USUAL):
    """The constants of a law as SymPy's symbols."""
    return builtin()[name].symbolic(NAMES.__getitem__, form)


def majorant(word, k, at):
    """m of the laws, with its constant and argument."""
    return m(type("p", (), {"smooth_abs": word, "k_v": k}), at)


def numeric(expression):
    """The value at arbitrary places; what differs from 0 as a function does not vanish there."""
    values = zip(
        sorted(expression.free_symbols, key=str),
        (1.3, 0.7, 2.1, 0.45, 1.9, 0.31, 2.7, 1.1, 0.9, 1.7, 0.6, 2.3),
        strict=False,
    )
    return expression.subs(dict(values)).evalf(30)


# -- lugre_arctan ----------------------------------------------------------------------------------------------------


def test_1_the_limit_of_z():
    p = constants("lugre_arctan")
    rate = builtin()["lugre_arctan"].dz_dt(p, v, z)
    (limit,) = sp.solve(rate, z)
    assert sp.diff(rate, z, 2) == 0
    assert abs(numeric(sp.limit(limit * v, v, 0) - sp.pi * F_s / (2 * s0 * k_v))) < 1e-14


@pytest.mark.parametrize("level", [1e-4, 1e-2, 1.0])
def test_2_any_level_is_passed(level):
    model = law("lugre_arctan", "canudas1995", k_v=1e6)
    slow = pi * P["F_c"] / (4 * P["sigma_0"] * 1e6 * level)
    distance = 2 * level * np.log(2)
    solution = solve_ivp(lambda y, z: model.rate(slow, z) / slow, (0, distance), [0.0], rtol=1e-10, atol=1e-15)
    assert solution.y[0, -1] >= level * (1 - 1e-9)
    u = sp.Symbol("u", positive=True)
    assert sp.limit(-sp.log(1 - u) / u, u, 0) == 1
    assert sp.simplify(-sp.log(1 - u) / u).subs(u, sp.Rational(1, 2)) == 2 * sp.log(2)  # it rises with u


def test_3_arctan_is_not_passive():
    """F v/v^2 at a large v and z_0 beyond (F_c/sigma_0)(1 + sigma_2/sigma_1)."""
    p = constants("lugre_arctan")
    each = builtin()["lugre_arctan"]
    power = each.friction(p, v, z, each.dz_dt(p, v, z)) / v
    table = {s0: 2, s1: sp.Rational(7, 10), s2: sp.Rational(4, 10), F_c: 1, F_s: sp.Rational(3, 2), v_s: 1, k_v: 3}
    limit = sp.limit(power.subs(table).subs(2 / np.pi, 2 / sp.pi), v, sp.oo)
    expected = s1 + s2 - s1 * z * s0 / F_c
    assert float(sp.simplify(limit - expected.subs(table)).subs(z, 1.7)) == pytest.approx(0, abs=1e-12)


# -- lugre_sobczyk ---------------------------------------------------------------------------------------------------


def drawn(charged, slow, table, steep):
    """E(e) of docs/explanation/theory.md as numbers: F v/f from 0 to z_0, v = -e/k_v."""
    back, size = -slow / steep, (2 / np.pi) * np.arctan(slow)
    width = (table["F_c"] + (table["F_s"] - table["F_c"]) * np.exp(-((back / table["v_s"]) ** 2))) / table["sigma_0"]
    log = np.log1p(charged / (size * width))
    elastic = table["sigma_0"] * width / size * (charged - size * width * log)
    return elastic - table["sigma_1"] * slow / steep * charged - table["sigma_2"] * slow / steep * width / size * log


@pytest.mark.parametrize("set_name", parameters())
@pytest.mark.parametrize("slow", [1.0, 1e-2, 1e-5])
def test_5_the_energy_drawn_from_the_law_itself(set_name, slow):
    table = parameters()[set_name].values
    steep = 1e4 / table["v_s"]
    model = law("lugre_sobczyk", set_name, k_v=steep)
    charged, back = 0.5 * table["F_c"] / table["sigma_0"], -slow / steep
    integral, _ = quad(
        lambda q: float(model.force(back, q * charged) * back / model.rate(back, q * charged)) * charged,
        0, 1, epsabs=0, epsrel=1e-11, points=[min(0.5, slow)], limit=400,
    )  # fmt: skip
    assert integral == pytest.approx(drawn(charged, slow, table, steep), rel=1e-8)


def test_5_and_6_numbers():
    """1.838e-7 J at e = 1 with Table 1, k_v = 1e7, z_0 = 1e-6 m; and growth like 1/e, whatever sigma_2 is."""
    assert drawn(1e-6, 1.0, P, 1e7) == pytest.approx(1.838e-7, rel=1e-3)
    for table in (P, {**P, "sigma_2": 1e6}, {**P, "sigma_1": 1e5}):
        growth = [slow * drawn(1e-6, slow, table, 1e7) for slow in (1e-7, 1e-8)]
        assert growth == pytest.approx([np.pi / 2 * P["sigma_0"] * 1.5e-5 * 1e-6] * 2, rel=1e-2)


# -- majorants of |v| ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("word", FORMS)
@pytest.mark.parametrize("steep", [1e-3, 1.0, 1e7])
def test_majorants_as_they_are_computed(word, steep):
    speeds = np.concatenate([[0.0], np.geomspace(1e-9, 1e9, 4001)]) / steep
    p = type("p", (), {"smooth_abs": word, "k_v": steep})
    values, gap = m(p, speeds), m_0(p)
    assert np.all(values >= speeds * (1 - 4e-16))
    assert np.all(values - speeds <= gap * (1 + 1e-15) + 4e-16 * speeds)
    assert np.array_equal(values, m(p, -speeds))
    assert m(p, 0.0) == pytest.approx(gap)


def test_the_tail_of_each_majorant():
    """(2/(3 pi)) x^-3, x^-2/2 and 0."""
    for far in (50.0, 500.0):
        off = {word: float(majorant(word, 1.0, far)) / far - 1 for word in FORMS}
        assert off["atan"] == pytest.approx(2 / (3 * pi) / far**3, rel=1e-3)
        assert off["sqrt"] == pytest.approx(0.5 / far**2, rel=1e-3)
        assert off["compact"] == 0


def test_no_smooth_majorant_vanishes_at_rest():
    """A C1 m with m(0) = 0 has m/|v| -> 0, and then z has no bound: here v^2 k_v/(1 + k_v |v|), which is C1."""
    form = k_v * v**2 / (1 + k_v * v)
    assert sp.limit(sp.diff(form, v), v, 0) == 0
    assert sp.limit(form / v, v, 0) == 0
    assert sp.limit(g * v / form, v, 0) == sp.oo


@pytest.mark.parametrize(("word", "creep"), [("atan", 1.47), ("sqrt", 3.04), ("compact", 0.5895)])
def test_10_creep(word, creep):
    share = lambda at: at / float(m(type("p", (), {"smooth_abs": word, "k_v": 1.0}), at))  # noqa: E731
    assert brentq(lambda at: share(at) - 0.95, 1e-9, 1e9) == pytest.approx(creep, rel=4e-3)
    assert (brentq(lambda at: share(at) - 0.9999, 1e-9, 1e9) < 1) == (word == "compact")


# -- passivity -------------------------------------------------------------------------------------------------------


def test_15_damping_that_falls():
    (top,) = (root for root in sp.solve(sp.diff(x * sp.exp(-(x**2)), x), x) if root > 0)
    assert sp.simplify((x * sp.exp(-(x**2))).subs(x, top) - 1 / sp.sqrt(2 * sp.E)) == 0
    limit = 4 * sqrt(2 * e) * P["F_c"] / P["sigma_1"]
    assert limit == pytest.approx(0.0295, rel=2e-3)
    for name in ("lugre", "elastoplastic", "lugre_arctan"):
        own = {"z_ba": 7e-6} if name == "elastoplastic" else {"k_v": 1e6} if name == "lugre_arctan" else {}
        for factor in (1 - 1e-9, 1 + 1e-9):
            claim = law(name, "canudas1995", v_d=factor * limit, **own).guarantees()["passive"]
            assert claim == (factor < 1)


# -- elastoplastic_majorant ------------------------------------------------------------------------------------------


def test_16_the_smoothstep():
    step = 10 * x**3 - 15 * x**4 + 6 * x**5
    for n in (1, 2):
        assert sp.diff(step, x, n).subs(x, 0) == sp.diff(step, x, n).subs(x, 1) == 0
    assert sp.factor(sp.diff(step, x) - 30 * x**2 * (1 - x) ** 2) == 0  # it rises
    assert (step.subs(x, 0), step.subs(x, 1)) == (0, 1)
    model = law("elastoplastic_majorant", "canudas1995", k_v=1e6, z_ba=7e-6)
    width = 1.5e-5
    inside = 0.3
    share = (1.0 - model.rate(1.0, 7e-6 + inside * (1e-5 - 7e-6))) / float(
        m(model.p, 1.0) / 1e-5 * (7e-6 + inside * 3e-6)
    )
    assert share == pytest.approx(float(step.subs(x, inside)), rel=1e-9)
    assert width > 7e-6

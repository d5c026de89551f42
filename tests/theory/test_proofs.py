"""The steps of the proofs in docs/explanation/theory.md, numbered there, from the equations that are simulated.

SymPy checks identities and limits; python-flint's balls, rounded outward, check inequalities over whole ranges.
"""

from __future__ import annotations

from itertools import pairwise
from math import e, pi, sqrt

import numpy as np
import pytest
import sympy as sp
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq

from stribeck import law
from stribeck.laws import builtin
from stribeck.laws.elastoplastic import ElastoPlasticMajorant
from stribeck.laws.form import USUAL, Form
from stribeck.laws.terms import m, m_0
from stribeck.parameter_sets import parameters

flint = pytest.importorskip("flint")
arb = flint.arb

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


def test_4_sobczyk_is_bounded():
    """f sgn z = v S (S - z/g) for v, z > 0, which changes sign at z = S g < Z."""
    p = constants("lugre_sobczyk")
    rate = builtin()["lugre_sobczyk"].dz_dt(p, v, z)
    smooth, width = 2 / sp.pi * sp.atan(k_v * v), (F_c + (F_s - F_c) * sp.exp(-((v / v_s) ** 2))) / s0
    assert abs(numeric(rate - v * smooth * (smooth - z / width))) < 1e-14


def drawn(charged, slow, table, steep):
    """E(e) of docs/explanation/theory.md as numbers: F v/f from 0 to z_0, v = -e/k_v."""
    back, size = -slow / steep, (2 / np.pi) * np.arctan(slow)
    width = (table["F_c"] + (table["F_s"] - table["F_c"]) * np.exp(-((back / table["v_s"]) ** 2))) / table["sigma_0"]
    log = np.log1p(charged / (size * width))
    elastic = table["sigma_0"] * width / size * (charged - size * width * log)
    return elastic - table["sigma_1"] * slow / steep * charged - table["sigma_2"] * slow / steep * width / size * log


def test_5_the_energy_drawn_from_sobczyk_symbolically():
    slow, charged = sp.symbols("e z_0", positive=True)
    zz = sp.Symbol("zz", positive=True)
    back, rate = -slow / k_v, -(slow / k_v) * S * (S + zz / g)
    power = (s0 * zz + s1 * rate + s2 * back) * back / rate
    formula = (
        s0 * g / S * (zz - S * g * sp.log(1 + zz / (S * g)))
        - s1 * slow / k_v * zz
        - s2 * slow / k_v * g / S * sp.log(1 + zz / (S * g))
    )
    assert sp.simplify(sp.diff(formula, zz) - power) == 0
    assert formula.subs(zz, 0) == 0
    # [6] with S ~ 2 e/pi
    smooth = 2 / sp.pi * sp.atan(slow)
    leading = sp.limit((slow * formula.subs({zz: charged})).subs(S, smooth), slow, 0)
    assert sp.simplify(leading - sp.pi * s0 * g * charged / 2) == 0


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
def test_7_to_9_majorants(word):
    """|v| <= m <= |v| + m(0), on the whole axis by symmetry: with intervals to x = 1e6, symbolically beyond."""
    at = sp.Symbol("at", real=True)
    form = sp.nsimplify(majorant(word, 1, at).subs(at, x), rational=False)
    gap = float(m_0(type("p", (), {"smooth_abs": word, "k_v": 1.0})))
    assert float(form.subs(x, 1e-12)) == pytest.approx(gap)
    if word == "atan":
        rise = sp.diff(x * sp.atan(1 / x), x)
        assert sp.simplify(rise - (sp.atan(1 / x) - x / (1 + x**2))) == 0
        assert sp.simplify(sp.diff(rise, x) + 2 / (1 + x**2) ** 2) == 0
        assert sp.limit(rise, x, sp.oo) == 0
        assert sp.limit(x * sp.atan(1 / x), x, sp.oo) == 1
    elif word == "sqrt":
        assert sp.simplify((sp.sqrt(x**2 + 1) - x) * (sp.sqrt(x**2 + 1) + x)) == 1
    else:
        polynomial = (3 + 6 * x**2 - x**4) / 8
        assert sp.expand((1 - x) ** 3 * (3 + x) / 8 - (polynomial - x)) == 0
        at_one = [sp.diff(polynomial, x, n).subs(x, 1) for n in range(4)]
        assert at_one == [1, 1, 0, -3]  # |x| has 1, 1, 0, 0: twice differentiable, not thrice


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
        ball = arb(far)
        off = (2 / arb.pi()) * (ball * ball.atan() + 1) / ball - 1
        assert float(off.mid()) == pytest.approx(2 / (3 * pi) / far**3, rel=1e-3)
        off = (ball * ball + 1).sqrt() / ball - 1
        assert float(off.mid()) == pytest.approx(0.5 / far**2, rel=1e-3)


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


def dissipated(name, form=USUAL):
    """D = F v - W' f for v > 0, from the law's own functions."""
    each, p = builtin()[name], constants(name, form)
    rate = each.dz_dt(p, v, z)
    return each.friction(p, v, z, rate) * v - sp.diff(each.stored_energy(p, z), z) * rate, p


@pytest.mark.parametrize("form", [USUAL, Form(choices=(("smooth_abs", "sqrt"),)), Form(("v_d",))])
def test_11_what_is_dissipated(form):
    D, p = dissipated("lugre_majorant", form)
    width = (F_c + (F_s - F_c) * sp.exp(-((v / v_s) ** 2))) / s0
    damping = s1 * sp.exp(-((v / v_d) ** 2)) if "v_d" in form else s1
    expected = (damping + s2) * v**2 + m(p, v) / width * (s0 * z**2 - damping * v * z)
    assert abs(numeric(D - expected)) < 1e-12


def test_12_the_minimum_over_z():
    M = sp.Symbol("M", positive=True)
    D = (s1 + s2) * v**2 + M / g * (s0 * z**2 - s1 * v * z)
    (lowest,) = sp.solve(sp.diff(D, z), z)
    assert sp.simplify(lowest - s1 * v / (2 * s0)) == 0
    assert sp.simplify(D.subs(z, lowest) - v**2 * (s1 + s2 - s1**2 * M / (4 * s0 * g))) == 0
    # [13] at Z, with (sigma_1 + sigma_2) F_c = sigma_1 F_s and g_N = F_c
    gap = sp.Symbol("m0", positive=True)
    bracket = sp.expand(s1 * v**2 - (v + gap) * (s1 * v - F_s))
    assert sp.expand(bracket - (F_s * v + F_s * gap - s1 * gap * v)) == 0
    at_bound = D.subs({z: F_s / s0, M: v + gap, s2: s1 * (F_s - F_c) / F_c, g: F_c / s0})
    assert sp.simplify(at_bound - F_s / F_c * bracket) == 0


@pytest.mark.parametrize("word", FORMS)
@pytest.mark.parametrize("ratio", [1.0, 1.2, 3.0, 20.0])
def test_13_passive_at_the_threshold_by_intervals(word, ratio):
    """sigma_1 m(0) = F_s exactly, LuGre's condition met with equality; F_c = 1, sigma_1 = 1, for every g_N in [F_c, F_s]."""
    top, gap = ratio, float(m_0(type("p", (), {"smooth_abs": word, "k_v": 1.0})))
    steep = gap / top  # makes sigma_1 m(0) = F_s

    k = arb(steep)

    def per_speed(at):
        """m/v with at = t/k_v."""
        if word == "atan":
            return 1 + (2 / arb.pi()) * (at - at.atan())
        if word == "sqrt":
            return (1 + at * at).sqrt()
        inside = (3 * at + 6 / at - 1 / at**3) / 8
        return inside if bool(at > 1) else arb(1) if bool(at < 1) else inside.union(arb(1))

    # (a) v <= 2 F_s: 4 g_N (sigma_1 + sigma_2) - sigma_1^2 m > 0, least at g_N = F_c; sigma_1 + sigma_2 = F_s/F_c; m rises
    assert bool(4 * arb(top) - 2 * arb(top) * per_speed(1 / (2 * arb(top) * k)) > 0)
    # (b) beyond, t = 1/v <= 1/(2 F_s): D/v^2 at Z, over F_s/F_c: 1 - (m/v)(1 - F_s t) > 0
    edges = np.append(np.geomspace(1e-9, 0.5, 1001) / top, 0.5000001 / top)
    for low, high in pairwise(edges):
        t = arb(low).union(arb(high))
        assert bool(1 - per_speed(t / k) * (1 - arb(top) * t) > 0), t
    # below 1e-9/F_s: m/v <= 1 + m(0) t = 1 + F_s t, and 1 - (1 + F_s t)(1 - F_s t) = (F_s t)^2


@pytest.mark.parametrize("name", ["lugre", "lugre_majorant"])
def test_14_necessary(name):
    """F v/v^2 at a large v tends to sigma_1 + sigma_2 - sigma_1 sigma_0 z/F_c, whatever is stored."""
    model = law(name, "canudas1995", sigma_1=1.0, sigma_2=0.3, **({"k_v": 1e6} if name != "lugre" else {}))
    charged = 1.45 / P["sigma_0"]
    fast = 1e7
    assert float(model.force(fast, charged)) / fast == pytest.approx(1.0 + 0.3 - 1.45, rel=1e-5)
    assert float(model.rate(fast, charged)) / fast == pytest.approx(1 - 1.45, rel=1e-5)


def test_15_damping_that_falls():
    (top,) = (root for root in sp.solve(sp.diff(x * sp.exp(-(x**2)), x), x) if root > 0)
    assert sp.simplify((x * sp.exp(-(x**2))).subs(x, top) - 1 / sp.sqrt(2 * sp.E)) == 0
    D, _ = dissipated("lugre_majorant")
    assert sp.simplify(sp.diff(D, s1, 2)) == 0  # linear in sigma_1
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


def test_17_dissipation_is_linear_in_the_plastic_share():
    """D of v - a m z/g: its second derivative by a is 0, and it is (sigma_1 + sigma_2) v^2 at a = 0."""
    M = sp.Symbol("M", positive=True)
    rate = v - a * M / g * z
    D = (s0 * z + s1 * rate + s2 * v) * v - s0 * z * rate
    assert sp.simplify(sp.diff(D, a, 2)) == 0
    assert sp.simplify(D.subs(a, 0) - (s1 + s2) * v**2) == 0
    p = constants("elastoplastic_majorant")
    full = ElastoPlasticMajorant.dz_dt(p, v, sp.Rational(50)).subs(
        {s0: 1, F_c: 1, F_s: sp.Rational(3, 2), v_s: 1, k_v: 2, NAMES["z_ba"]: sp.Rational(1, 2)}
    )
    sliding = (
        builtin()["lugre_majorant"]
        .dz_dt(constants("lugre_majorant"), v, sp.Rational(50))
        .subs({s0: 1, F_c: 1, F_s: sp.Rational(3, 2), v_s: 1, k_v: 2})
    )
    assert float((full - sliding).subs(v, 0.37)) == pytest.approx(0, abs=1e-12)

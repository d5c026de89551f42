"""The laws' numbers against formulas written down a second time, from theory.md section 1, here and in tests/reference."""

from __future__ import annotations

from math import atan, exp, nan, pi

import numpy as np
import pytest

from stribeck import law
from stribeck.errors import NotDifferentiable
from stribeck.laws import builtin
from stribeck.parameter_sets import parameters
from tests.codegen.systems import IDS, VARIANTS
from tests.reference.apart_parts import friction

P = parameters()["canudas1995"].values
S0, S1, S2, FC, FS, VS = (P[n] for n in ("sigma_0", "sigma_1", "sigma_2", "F_c", "F_s", "v_s"))
KV, ZBA = 1e6, 7e-6
MAKKAR = {"g1": 0.25, "g2": 100.0, "g3": 10.0, "g4": 0.1, "g5": 100.0, "g6": 0.01}
OWN = {"k_v": KV, "z_ba": ZBA, **MAKKAR}
BRISTLES = [n for n, c in builtin().items() if c.has_z]
SMOOTH = [n for n, c in builtin().items() if c.claims.smooth or not c.has_z]


def make(name: str, **changes):
    constants = builtin()[name].own_constants()
    return law(name, "canudas1995", **{n: x for n, x in OWN.items() if n in constants}, **changes)


def g(v):
    return (FC + (FS - FC) * exp(-((v / VS) ** 2))) / S0


def S(v):
    return 2 / pi * atan(KV * v)


def m(v):
    return v * S(v) + 2 / (pi * KV)


SPEEDS = (0.0, 1e-9, 3e-7, 1e-6, 1e-4, 7e-4, 1e-3, 2.5e-3, 0.03, 1.0)
V = [s * v for v in SPEEDS for s in (1, -1)]
Z = [s * z for z in (0.0, 1e-9, 5e-6, 7e-6, 7.1e-6, 9e-6, 1.2e-5, 1.5e-5) for s in (1, -1)]


@pytest.mark.parametrize(("kind", "form"), VARIANTS, ids=IDS)
def test_rate_and_force(kind, form):
    """Of every law in every form, against the equations of tests/reference, in which nothing of stribeck is used."""
    known = {**OWN, "v_d": 2e-3, "delta": 1.3}
    given = {n: known[n] for n in kind.own_constants() if n in known and (n in OWN or n in form)}
    if kind.name == "stribeck" and "k_v" not in form:
        del given["k_v"]
    model = law(kind.name, "canudas1995", **given, **dict(form.choices))
    constants = {**{n: x for n, x in model.values.items() if x is not None}, **model.choices}
    assert model.form == form
    for v in [*V, 0.3 / KV, -0.99 / KV, 1 / KV, 1.01 / KV]:
        for z in Z if kind.has_z else (0.0,):
            rate, force = friction(kind.name, constants, v, z)
            scale = abs(v) + abs(z) * (abs(v) + 1 / KV) / g(v)
            assert model.rate(v, z) == pytest.approx(rate, rel=1e-12, abs=1e-14 * scale), (v, z)
            assert model.force(v, z) == pytest.approx(force, rel=1e-12, abs=1e-14 * S1 * scale + 1e-15), (v, z)
            if not kind.has_z:
                assert model.steady_force(v) == model.force(v)
                assert model.rate(v, 1.0) == model.steady_deflection(v) == 0.0


@pytest.mark.parametrize("name", builtin())
def test_force_rate(name):
    """dF/dt along a motion: v(t) = v + w t, and z follows its equation."""
    model = make(name)
    w, h = 0.3, 1e-9
    for v in (v for v in V if abs(v) >= 1e-6):
        for z in (-1.2e-5, 0.0, 2e-6, 8.3e-6):
            rate = model.rate(v, z)
            force = [model.force(v + s * w * h, z + s * rate * h) for s in (-1, 1)]
            size = abs(S0 * z) + S1 * abs(v) + FS
            expected = (force[1] - force[0]) / (2 * h)
            assert model.force_rate(v, z, w) == pytest.approx(expected, rel=1e-5, abs=1e-15 * size / h)
    if name in SMOOTH:
        at_rest = model.force_rate(0.0, np.array([-1e-5, 0.0, 1e-5]), np.array([[-1.0], [0.0], [2.0]]))
        assert np.isfinite(at_rest).all()
        assert at_rest.shape == (3, 3)


def test_the_force_rate_at_rest_in_numbers():
    """dF/dt = sigma_0 dz/dt + sigma_1 d2z/dt2 + sigma_2 dv/dt, all terms by hand."""
    z, w, g0 = 8e-6, 2.0, FS / S0
    assert make("lugre_sobczyk").force_rate(0.0, z, w) == pytest.approx(S2 * w)  # S_0^2 v and v S_0 vanish to 2nd order
    assert make("lugre_arctan").force_rate(0.0, z, w) == pytest.approx((S1 + S2) * w)
    leak = -2 / (pi * KV) / g0  # of lugre_majorant: dz/dt = v + leak z there
    expected = S0 * leak * z + S1 * (w + leak * leak * z) + S2 * w
    assert make("lugre_majorant").force_rate(0.0, z, w) == pytest.approx(expected)
    assert make("coulomb_viscous").force_rate(0.0, 0.0, w) == pytest.approx((2 / pi * KV * FC + S2) * w)


@pytest.mark.parametrize("name", ["lugre", "elastoplastic", "stribeck"])
def test_no_force_rate_at_rest(name):
    z = 1.4e-5
    changes = {"k_v": None} if name == "stribeck" else {}
    model = law(name, "canudas1995", **({"z_ba": ZBA} if name == "elastoplastic" else changes))
    with pytest.raises(NotDifferentiable, match=rf"law '{name}' has no dF/dt at v = 0.*use a smooth law such as"):
        model.force_rate(0.0, z, 1.0)
    with pytest.raises(NotDifferentiable):
        model.force_rate([1e-3, -0.0, 1.0], z, -1.0)
    assert np.isfinite(model.force_rate([1e-3, -1e-3], z, 1.0)).all()


def test_a_force_rate_where_both_sides_agree():
    """At v = 0 the elasto-plastic law is elastic below z_ba, LuGre's |v| z vanishes with z, and Dahl's F has no |v|."""
    model = law("elastoplastic", "canudas1995", z_ba=ZBA)
    assert model.force_rate(0.0, 0.9 * ZBA, 3.0) == pytest.approx((S1 + S2) * 3.0)
    assert make("lugre").force_rate(0.0, 0.0, 3.0) == pytest.approx((S1 + S2) * 3.0)
    assert make("lugre").force_rate(0.0, 1e-5, 0.0) == pytest.approx(0.0, abs=1e-200)
    assert make("lugre").force_rate(0.0, 0.0, 0.0) == pytest.approx(0.0, abs=1e-200)
    assert make("dahl").force_rate(0.0, 1e-5, 3.0) == pytest.approx(0.0, abs=1e-200)


EXTREMES = [s * v for v in (0.0, 5e-324, 1e-300, 1e6, 1e150, 1e300) for s in (1.0, -1.0)]


@pytest.mark.parametrize("set_name", parameters())
@pytest.mark.parametrize("name", builtin())
def test_extreme_speeds(name, set_name):
    p = parameters()[set_name].values
    own = {n: x for n, x in OWN.items() if n in builtin()[name].own_constants()}
    own |= {"z_ba": 0.7 * p["F_c"] / p["sigma_0"]} if "z_ba" in own else {}
    model = law(name, set_name, **own)
    length = model.scales(model.p).length
    v, z = np.array(EXTREMES)[:, None], length * np.array([-0.99, -0.5, 0.0, 0.5, 0.99])
    assert np.isfinite(model.rate(v, z)).all()
    assert np.isfinite(model.force(v, z)).all()
    steady = model.steady_force(v)
    assert np.isfinite(steady).all()
    assert np.all(steady * np.sign(v) >= 0)
    assert np.all(np.isfinite(model.steady_deflection(v)))
    derivatives = np.array(model.jacobian(v[:-2], z))  # at 1e300 m/s their terms overflow
    assert not np.isnan(derivatives).any()
    assert not np.isnan(model.force_rate(v[2:-2], z, 1.0)).any()


def test_steady_force_next_to_rest():
    tiny = np.array([1e-300, 1e-200, 1e-100, 1e-50])
    assert make("lugre").steady_force(tiny) == pytest.approx(FS)
    assert make("lugre_sobczyk").steady_force(tiny) == pytest.approx(0.0, abs=1e-30)
    assert make("elastoplastic_sobczyk").steady_deflection(tiny) == pytest.approx(ZBA, rel=1e-6)
    assert ZBA < make("elastoplastic_majorant").steady_deflection(1e-6) < g(1e-6)  # leaves z_ba when pulled


def test_shapes_broadcast():
    for name in builtin():
        model = make(name)
        v, z = np.full((4, 1), 1e-3), np.zeros(3)
        for result in (model.force(v, z), model.rate(v, z), *model.jacobian(v, z), model.force_rate(v, z, 1.0)):
            assert result.shape == (4, 3)
        assert model.steady_force(v).shape == model.steady_deflection(v).shape == (4, 1)
        for result in (model.force(1e-3), model.force(1, 0), model.rate(1e-3, 0), model.steady_force(1e-3)):
            assert isinstance(result, np.float64)
        assert model.force([1e-3, 1e-2]).shape == (2,)
        assert np.isnan(model.force(nan, nan))


def test_whole_and_numpy_numbers_are_taken():
    values = {**P, "F_c": 1, "F_s": np.int64(2), "v_s": np.float32(0.5)}
    model = law("lugre", values)
    assert model.values == {**P, "F_c": 1.0, "F_s": 2.0, "v_s": 0.5, "v_d": None, "delta": None}
    assert all(type(x) is float for n, x in model.values.items() if n not in ("v_d", "delta"))

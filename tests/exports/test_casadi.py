"""A law as a CasADi function: the same numbers and derivatives, and the reason where it is refused."""

import runpy
from pathlib import Path

import numpy as np
import pytest

import stribeck
from stribeck.exports.python import to_casadi
from stribeck.laws import builtin
from stribeck.laws.terms import g
from tests.laws.test_sanity import CANUDAS, make

ca = pytest.importorskip("casadi")

SMOOTH = [name for name, law in builtin().items() if law.claims.smooth]
STATIC = [name for name, law in builtin().items() if not law.has_z]
EXAMPLE = Path(__file__).parent.parent.parent / "docs" / "pictures" / "time_optimal_move.py"


def points(law, count=300):
    rng, scales = np.random.default_rng(1), law.scales(law.p)
    v = rng.choice([-1, 1], count) * scales.speed * 10 ** rng.uniform(-6, 4, count)
    return np.append(v, 0.0), rng.uniform(-1.2, 1.2, count + 1) * scales.length


@pytest.mark.parametrize("name", SMOOTH)
def test_numbers_and_derivatives_of_a_bristle_law(name):
    law = make(builtin()[name])
    function = to_casadi(law)
    assert (function.name_in(), function.name_out()) == (["v", "z"], ["dz_dt", "F"])
    v, z = points(law)
    got = function(v=v[None], z=z[None])
    force, opposite = law.force(v, z), law.force(v, -z)
    size = abs(law.rate(v, z)) + abs(law.rate(v, -z))
    assert np.all(abs(np.array(got["dz_dt"])[0] - law.rate(v, z)) <= 1e-14 * size)
    assert np.all(abs(np.array(got["F"])[0] - force) <= 1e-14 * (abs(force) + abs(opposite)))
    slopes = function.jacobian()(v=v[None], z=z[None])
    by_v, by_z = law.jacobian(v, z)
    for name, wanted in (("jac_dz_dt_v", by_v), ("jac_dz_dt_z", by_z)):
        found = np.array(ca.diag(slopes[name]) if slopes[name].shape[0] > 1 else slopes[name]).ravel()
        assert np.all(abs(found - wanted) <= 1e-9 * (abs(wanted) + 1))


@pytest.mark.parametrize("name", STATIC)
def test_static_laws_have_no_z(name):
    law = make(builtin()[name])
    function = to_casadi(law)
    assert (function.name_in(), function.name_out()) == (["v"], ["F"])
    v, _ = points(law)
    assert np.allclose(np.array(function(v=v[None])["F"])[0], law.force(v), rtol=1e-13, atol=0)


def test_free_constants_are_inputs():
    law = stribeck.law("lugre_majorant", "canudas1995", k_v=1e6)
    function = to_casadi(law, free=("F_s", "sigma_2"))
    assert function.name_in() == ["v", "z", "F_s", "sigma_2"]
    other = stribeck.law("lugre_majorant", {**CANUDAS, "F_s": 2.0, "sigma_2": 0.7}, k_v=1e6)
    assert float(function(3e-3, 1e-6, 2.0, 0.7)[1]) == pytest.approx(float(other.force(3e-3, 1e-6)), rel=1e-14)
    slope = function.jacobian()(v=3e-3, z=1e-6, F_s=2.0, sigma_2=0.7)["jac_F_sigma_2"]
    assert float(slope) == pytest.approx(3e-3, rel=1e-12)


def test_equations_of_the_package_run_on_casadi_symbols():
    law = stribeck.law("lugre_majorant", "canudas1995", k_v=1e6)
    v = ca.SX.sym("v")
    function = ca.Function("g", [v], [g(law.p, v)])
    assert float(function(1e-3)) == pytest.approx((1 + 0.5 * np.exp(-1)) / 1e5, rel=1e-15)


def test_the_worked_example_is_optimal_and_holds_in_simulation():
    """Where pre-sliding is short, full force forward and then back is optimal, and the time has a closed form."""
    example = runpy.run_path(str(EXAMPLE))
    found = example["solve"](intervals=40)
    assert found.time == pytest.approx(example["coulomb_time"]()[0], rel=5e-3)
    solution = example["simulate"](found)
    assert solution.status == "done"
    assert abs(solution["y"][-1] - example["DISTANCE"]) < 1e-2 * example["DISTANCE"]
    assert abs(solution["v"][-1]) < 2e-2 * solution.peaks["v"]

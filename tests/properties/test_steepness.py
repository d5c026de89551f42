"""Which k_v: closed forms against equations written anew, and creep in simulation."""

from __future__ import annotations

import json
from math import atan, exp, pi, sqrt, tan

import pytest
from scipy.optimize import brentq

from stribeck import Scenario, law, simulate
from stribeck.laws import builtin
from stribeck.parameter_sets import parameters
from stribeck.properties.steepness import Tolerated, smallest_steepness
from tests.simulation.rig import law_table, rig

P = parameters()["canudas1995"].values
S0, S2, FC, FS, VS = (P[n] for n in ("sigma_0", "sigma_2", "F_c", "F_s", "v_s"))


def advise(name, set_name, **given):
    """The smallest k_v for a law with these constants of its own, and tolerances."""
    own = {n: given.pop(n) for n in list(given) if n in ("z_ba", "smooth_abs")}
    return smallest_steepness(law(name, set_name, k_v=1.0, **own), Tolerated.given(given))


def sliding(v):
    return FC + (FS - FC) * exp(-((v / VS) ** 2))


def only(advices, name):
    (requirement,) = advices[name].requirements
    assert advices[name].k_v == requirement.k_v
    return requirement


@pytest.mark.parametrize("share", [0.2, 0.95, 0.999])
@pytest.mark.parametrize("speed", [1e-9, 1e-6, 2e-5])
def test_creep_against_equations_written_anew(speed, share):
    q = (share * FS - S2 * speed) / sliding(speed)
    expected = {
        "atan": brentq(lambda x: x / (x * 2 / pi * atan(x) + 2 / pi) - q, 1e-9, 1e6, xtol=1e-14),
        "sqrt": q / sqrt(1 - q * q),
        "compact": brentq(lambda x: 8 * x - q * (3 + 6 * x**2 - x**4), 0, 1, xtol=1e-14),
    }
    for smooth_abs, x in expected.items():
        result = only(
            advise("lugre_majorant", "canudas1995", creep=speed, share=share, smooth_abs=smooth_abs), "lugre_majorant"
        )
        assert result.k_v == pytest.approx(x / speed, rel=1e-9)
    result = only(advise("lugre_sobczyk", "canudas1995", creep=speed, share=share), "lugre_sobczyk")
    assert result.k_v == pytest.approx(tan(pi * q / 2) / speed, rel=1e-9)


@pytest.mark.parametrize("name", ["lugre_sobczyk", "lugre_majorant", "elastoplastic_majorant", "elastoplastic_sobczyk"])
def test_the_simulated_body_creeps_at_the_tolerated_speed(name):
    own = {"z_ba": 7e-6} if name.startswith("elastoplastic") else {}
    result = only(advise(name, "canudas1995", creep=2e-6, share=0.8, **own), name)
    held = {"kind": "points", "t": [0, 5], "value": [0, 0.8 * FS]}
    solution = simulate(Scenario(rig(law_table(name, k_v=result.k_v, **own), "force", held, 200.0)))
    assert solution["v"][-1] == pytest.approx(2e-6, rel=1e-3)
    assert result.achieved == pytest.approx(2e-6, rel=1e-6)


def test_laws_and_loads_that_do_not_creep():
    assert only(advise("lugre_arctan", "canudas1995", creep=1e-9), "lugre_arctan").k_v == 0.0
    own = {"creep": 1e-9, "share": 0.4, "z_ba": 7e-6}
    for name, each in advise("elastoplastic_sobczyk", "canudas1995", **own).items():
        assert each.k_v == 0.0, name
        assert each.cost is None
    own["share"] = 0.5
    assert all(each.k_v > 1e3 for each in advise("elastoplastic_sobczyk", "canudas1995", **own).values())


def test_a_load_that_slides_at_the_tolerated_speed():
    advices = advise("lugre_sobczyk", "canudas1995", creep=2e-3, share=0.95)
    assert all(each.k_v is None and each.cost is None for each in advices.values())
    assert "below the load" in only(advices, "lugre_majorant").detail


@pytest.mark.parametrize("error", [0.3, 1e-2, 1e-6])
@pytest.mark.parametrize("speed", [1e-7, 1e-4, 0.05])
def test_steady_error(speed, error):
    g = sliding(speed)
    force = g + S2 * speed

    def forces(name, k_v):
        x = k_v * speed
        shares = {
            "lugre_sobczyk": 2 / pi * atan(x),
            "lugre_arctan": 1 / (2 / pi * atan(x)),
            "lugre_majorant": x / (x * 2 / pi * atan(x) + 2 / pi),
        }
        return g * shares[name] + S2 * speed

    needed = {}
    for name in ("lugre_sobczyk", "lugre_arctan", "lugre_majorant"):
        result = advise(name, "canudas1995", steady_error=error, speed=speed)[name].requirements[0]
        assert abs(forces(name, result.k_v) / force - 1) == pytest.approx(error, rel=1e-6)
        assert result.achieved == pytest.approx(error, rel=1e-6)
        needed[name] = result.k_v
    assert needed["lugre_majorant"] < needed["lugre_sobczyk"]


def test_the_largest_requirement_decides():
    advices = advise("lugre_majorant", "canudas1995", creep=1e-6, steady_error=1e-2, speed=1e-4)
    assert list(advices) == ["lugre_majorant"]
    creep, steady = advices["lugre_majorant"].requirements
    assert advices["lugre_majorant"].k_v == max(creep.k_v, steady.k_v) > min(creep.k_v, steady.k_v)
    cost = advices["lugre_majorant"].cost
    assert cost.bend == pytest.approx(1 / creep.k_v)
    # sigma_1 z m''(0) at |z| = F_s/sigma_0, and m''(0) = 4 k_v/pi
    assert cost.force_bend == pytest.approx(P["sigma_1"] * 4 / pi * creep.k_v, rel=0.01)


@pytest.mark.share(5)
@pytest.mark.parametrize("set_name", parameters())
@pytest.mark.parametrize("name", [n for n, each in builtin().items() if each.has_z and "k_v" in each.constants()])
def test_every_law_and_machine(name, set_name):
    p = parameters()[set_name].values
    own = {"z_ba": 0.7 * p["F_c"] / p["sigma_0"]} if name.startswith("elastoplastic") else {}
    advices = advise(name, set_name, creep=1e-3 * p["v_s"], steady_error=1e-3, speed=p["v_s"], **own)
    for result, each in advices.items():
        assert each.k_v > 0
        for requirement in each.requirements:
            if requirement.k_v:
                assert requirement.achieved == pytest.approx(requirement.tolerance, rel=1e-4), (result, requirement)
        model = law(result, set_name, k_v=each.k_v, **own)
        assert each.cost.stiffness >= 0.999 * abs(model.jacobian(100 * p["v_s"], p["F_s"] / p["sigma_0"])[1])
    json.dumps([each.to_dict() for each in advices.values()], allow_nan=False)

"""The certificates that ``stribeck check`` gives, before the independent checker; and with other equations in them."""

from __future__ import annotations

import copy
import math
import random
from fractions import Fraction
from functools import cache
from typing import Any

import pytest

import stribeck
import stribeck_verify
from stribeck.properties import WORK
from stribeck.properties.checked import Checked
from stribeck.properties.verdicts import refusals
from stribeck_verify import verify
from tests.properties.nasty import MILD

# -- damping that falls with speed, a billionth below what theory.md allows ---------------------------------------------

OWN = {"lugre_arctan": {"k_v": 1e4}, "lugre_majorant": {"k_v": 1e4, "smooth_abs": "compact"}}


@cache
def damped(name: str) -> Any:
    excess = 0.375e-4 if "majorant" in name else 0.0
    v_d = math.sqrt(2 * math.e) * (4 * MILD["F_c"] / MILD["sigma_1"] - excess)
    return stribeck.law(name, MILD, **OWN[name], v_d=v_d * (1 - 1e-9))


@pytest.mark.parametrize("name", OWN)
def test_small_damping_is_confirmed_up_to_its_threshold(name):
    law = damped(name)
    verdict = Checked(law, None, WORK).passive()
    assert verdict.holds
    assert verdict.certificate["theorem"] == "damped"
    assert refusals(verdict.certificate, law, "passive") == []
    for number, factor in (("s", 1 + 1e-8), ("d", 1 + 1e-8), ("N", 1 - 1e-8), ("k", 2), ("c", 2), ("above", 2)):
        other = copy.deepcopy(verdict.certificate)
        value = Fraction(other["data"][number])
        other["data"][number] = str(value * Fraction(factor) if value else Fraction(1, 10**6))
        assert verify(other) != [], number
    for i in random.Random(2).sample(range(len(verdict.certificate["claims"])), 5):
        less = copy.deepcopy(verdict.certificate)
        del less["claims"][i]
        assert verify(less) != [], i


def test_a_bound_of_the_slope_that_sampling_only_just_meets_is_confirmed():
    """The checker took (a + b u)(1 + (w/l)^0) for a + b u, half of what was proved."""
    values = {"F_c": 0.00227, "v_s": 1.47e-3, "F_s": 0.38, "sigma_0": 5e10, "sigma_1": 0.011, "sigma_2": 0.0}
    law = stribeck.law("elastoplastic", values, z_ba=3.6e-14)
    verdict = Checked(law, None, WORK).unique()
    assert verdict.holds
    assert refusals(verdict.certificate, law, "unique") == []


def test_a_yes_that_the_checker_refuses_is_undecided(monkeypatch):
    monkeypatch.setattr(stribeck_verify, "verify", lambda *a: ["told to refuse"])
    verdicts = stribeck.check(stribeck.law("dahl", sigma_0=1e5, F_c=1.0))
    assert {v.holds for v in verdicts.properties.values()} <= {None, False}
    assert "told to refuse" in verdicts["bounded"].evidence["reason"]


@pytest.mark.share(3)
@pytest.mark.parametrize(
    ("k_v", "smooth_abs"), [(5e-324, "atan"), (1.7e308, "atan"), (1e-300, "sqrt"), (1e-300, "compact")]
)
def test_a_steepness_at_the_end_of_floats_stops_no_proof(k_v, smooth_abs):
    law = stribeck.law("lugre_majorant", MILD, k_v=k_v, smooth_abs=smooth_abs)
    verdicts = stribeck.check(law)
    assert verdicts["bounded"].holds
    assert not any("cannot be treated" in str(v.evidence.get("reason")) for v in verdicts.properties.values())
    assert smooth_abs != "sqrt" or law.rate(1e-3, 1e-6) == -math.inf  # as NumPy has it, and no exception


@pytest.mark.share(2)
@pytest.mark.parametrize(
    "change",
    [{"sigma_0": 1e-100}, {"sigma_1": 1e160}, {"sigma_2": 1e200}, {"v_s": 5e-324}, {"F_c": 1e307, "F_s": 1.7e308}],
)
def test_constants_at_the_ends_of_the_floats_are_decided(change):
    verdicts = stribeck.check(stribeck.law("lugre", {**MILD, **change}))
    assert [verdicts[n].holds for n in ("unique", "bounded", "drift_free")] == [True, True, False]
    assert not any("cannot be treated" in str(v.evidence.get("reason")) for v in verdicts.properties.values())


def test_a_set_a_billionth_below_the_condition_is_refuted():
    for distance in (1e-9, 1e-12):
        below = stribeck.law("lugre", {**MILD, "sigma_2": 50.0 * (1 - distance)})
        assert Checked(below, None, WORK).passive().holds is False
    assert Checked(stribeck.law("lugre", {**MILD, "sigma_2": 50.0}), None, WORK).passive().holds

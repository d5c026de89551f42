"""Counterexamples are looked at again with the law's own functions; what is not true is contradicted."""

from __future__ import annotations

from copy import deepcopy
from functools import cache

import pytest

import stribeck
from stribeck.expressions.ops import where
from stribeck.laws import BristleLaw
from stribeck.laws.terms import g
from stribeck.properties import WORK
from stribeck.properties.checked import Checked
from stribeck.properties.statement import statement
from stribeck_verify import confirmed
from tests.properties.nasty import MILD, cases

LAWS = {case.name: case for case in cases()}
# a law, what it lacks, and how to make the evidence wrong
WRONG = [
    ("DahlHalf", "smooth", {"from_above": 0.25}),
    ("GeneralisedHalf", "smooth", {"from_below": 0.25}),
    ("SmoothStepMistyped", "smooth", {"from_below": 9.9e-3}),
    ("RambergOsgood", "bounded", {"enclosed": {"z_to": 1e-9}}),
    ("EscapesWhenSliding", "unique", {"enclosed": {"c": 1e15, "power": 4}}),  # so it is near z_start
    ("BoucWenCubed", "drift_free", {"not_elastic": {"z_to": 0.0}}),
]


@cache
def checked(name):
    """A law and the verdicts on it."""
    law = LAWS[name].law()
    return law, stribeck.check(law)


@pytest.mark.share(7)
@pytest.mark.parametrize(("name", "prop", "change"), WRONG)
def test_a_counterexample_is_confirmed_and_a_wrong_one_is_not(name, prop, change):
    law, result = checked(name)
    verdict = result[prop]
    assert verdict.holds is False
    assert confirmed(statement(law), prop, verdict.evidence) is True
    evidence = deepcopy(verdict.evidence)
    for key, value in change.items():
        evidence[key] = {**evidence[key], **value} if isinstance(value, dict) else value
    assert confirmed(statement(law), prop, evidence) is False


@pytest.mark.share(7)
@pytest.mark.parametrize(
    "name", ["DahlHalf", "BoucWenHalf", "LorentzianPower", "SechStribeck", "BoucWenSoft", "OwnConstants"]
)
def test_powers_rising_exponentials_and_own_constants_are_decided_and_confirmed(name):
    case, (_, result) = LAWS[name], checked(name)
    open_ = {n for n, v in result.properties.items() if v.holds is None}
    assert open_ <= ({"unique"} if name.endswith("Half") else set())
    assert all(result[n].holds in (None, true) for n, true in case.truth.items())
    assert result.verify()


def test_floor_is_said_not_to_be_treated():
    verdicts = stribeck.check(LAWS["FloorPushes"].law())
    assert all(v.holds is None and "floor" in v.evidence["reason"] for v in verdicts.properties.values())


def test_a_law_that_is_elastic_near_0_is_not_said_to_drift():
    """Some of the points lie beyond z_0: that one is elastic is enough."""
    law = stribeck.law("elastoplastic", MILD, z_ba=7e-6)
    evidence = {"not_elastic": {"v": 1e-3, "z_to": 1e-5}}
    assert confirmed(statement(law), "drift_free", evidence) is False
    assert confirmed(statement(stribeck.law("lugre", MILD)), "drift_free", evidence) is True


@pytest.mark.parametrize("jump", [1e-9, 2e-9, -4e-9, 1e-8])
def test_a_jump_that_is_smaller_than_what_changes_beside_it_is_confirmed(jump):
    """It was contradicted: dz/dt was compared a billionth beside the place, where it had changed by more than the gap."""

    class Jumps(BristleLaw):
        name = "jumps"

        @staticmethod
        def dz_dt(p, v, z):
            x = abs(v) * 8e6
            return v - where(x < 1, 3 / 8 + 3 / 4 * x**2 - x**4 / 8 + jump, x) / 8e6 / g(p, v) * z

    law = Jumps(MILD)
    verdict = Checked(law, None, WORK).smooth()
    assert verdict.holds is False
    assert verdict.verify(law, "smooth") is True
    wrong = {**verdict.evidence, "from_above": 2 * verdict.evidence["from_above"]}
    assert confirmed(statement(law), "smooth", wrong) is False

"""``stribeck check`` on laws written to mislead it: no verdict may be wrong, and none may crash.

`make test` runs some of the laws of ``nasty/`` and `make thorough` all; ``python benchmarks/verdicts.py`` gives each yes
to the second checker too, and checks built-in laws with random and extreme constants.
"""

from __future__ import annotations

import random

import pytest

import stribeck
from stribeck.properties import WORK
from stribeck.properties.checked import Checked
from tests.properties.nasty import PROPERTIES, Case, cases

ALL = list(cases())
ONCE_MISTREATED = ("ThirteenthOfManyWindows", "ConditionsWithoutEnd", "ChainOfEqualEnds")


def wrong(case: Case) -> list[str]:
    """The verdicts on a law that contradict its truth, and the counterexamples that the second checker contradicts."""
    law = case.law()
    result = stribeck.check(law)
    contradicted = [n for n in PROPERTIES if result[n].holds is False and result[n].verify(law, n) is False]
    return [f"{case.kind}.{case.name}: {name}: contradicted" for name in contradicted] + [
        f"{case.kind}.{case.name}: {name}: {result[name].holds}, true is {case.truth[name]}: {result[name].method}"
        for name in PROPERTIES
        if None not in (result[name].holds, case.truth[name]) and result[name].holds is not case.truth[name]
    ]


@pytest.mark.share(30)
@pytest.mark.parametrize("case", ALL, ids=lambda case: case.name)
def test_no_verdict_is_wrong(case):
    assert wrong(case) == []


def test_every_law_states_its_truth_and_derives_it():
    assert len(ALL) >= 80
    assert len({case.name for case in ALL}) == len(ALL)
    for case in ALL:
        assert len(type(case.law()).__dict__["__doc__"]) > 20, case.name
    unclear = sum(x is None for case in ALL for x in case.truth.values())
    assert unclear <= 0.02 * 5 * len(ALL)


def test_nested_cases_cost_no_more_than_their_number():
    """Each of twenty windows doubled the work of the one before; and a condition joined with z < inf was refused."""
    laws = {case.name: case.law() for case in ALL if case.name in ONCE_MISTREATED}
    result = Checked(laws["ThirteenthOfManyWindows"], None, WORK).bounded()
    assert result.holds
    assert stribeck.check(laws["ConditionsWithoutEnd"])["passive"].holds


POWER = random.Random(5).sample([case for case in ALL if case.kind in ("aliases", "literature", "constants")], 14)
DECIDED, REGIONS = 70, 759  # of 70 verdicts, when this was written; a stronger prover may change both


@pytest.mark.thorough
def test_the_prover_is_no_weaker_than_it_was():
    """Undecided is never wrong: without a number that is written down a prover that decides nothing would pass."""
    verdicts = [v for case in POWER for v in stribeck.check(case.law()).properties.values()]
    assert sum(v.holds is not None for v in verdicts) >= DECIDED
    assert sum(v.evidence.get("regions", 0) for v in verdicts) <= REGIONS

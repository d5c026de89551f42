"""Where the verdict changes along one number: what is named of verdicts that are known."""

import math

import numpy as np
import pytest

from stribeck import Scenario
from stribeck.loops import boundary
from stribeck.loops.boundary import Turned, line
from stribeck.loops.judge import Judgment
from stribeck.loops.loop import loop_of
from stribeck.loops.said import mixed_sentence
from tests.loops.axis import axis

PATH = "controllers.hold.K_p"


def along(monkeypatch, verdict, low=100.0, high=800.0, tell=None):
    """What is named where the verdict at each value is what ``verdict`` says."""

    def judge(_, values, slowest):
        return [Judgment(verdict(x), "a", 0.0, 0.0) for x in values[PATH].tolist()]

    monkeypatch.setattr(boundary, "judge", judge)
    return line(loop_of(Scenario(axis())), Turned(PATH, low, high), tell)


def test_a_plain_change_is_a_boundary(monkeypatch):
    told = []
    solution = along(monkeypatch, lambda x: "quiet" if x < 333.3 else "hunting", tell=told.append)
    assert (told[0], told) == (0.0, sorted(told))
    (named,) = solution.boundaries
    assert named.low <= 333.3 <= named.high
    assert named.value == pytest.approx(333.3, rel=1e-3)
    assert (named.below, named.above, named.sure) == ("quiet", "hunting", True)
    assert not solution.mixed
    assert np.max(np.diff(solution.values[solution.values < 333.3])) <= 800.0 * (1 + 1e-9) * solution.resolution


def test_one_near_zero_is_found_as_finely(monkeypatch):
    (named,) = along(monkeypatch, lambda x: "quiet" if x < 1.7 else "hunting", 0.0, 1000.0).boundaries
    assert named.value == pytest.approx(1.7, rel=0.02)


def test_what_changes_everywhere_has_no_boundary(monkeypatch):
    solution = along(monkeypatch, lambda x: "quiet" if round((x - 100.0) * 12 / 700) % 2 else "hunting")
    assert not solution.boundaries
    (mixed,) = solution.mixed
    assert mixed.low < 150
    assert mixed.high > 750


@pytest.mark.parametrize(
    ("verdict", "named", "mixed"),
    [
        # a lane caught on its way between rest and a cycle
        (lambda x: "quiet" if x < 420 else "creeping" if x < 421 else "hunting", [420], []),
        # a cycle over less than 5 %: what is 5 % beside its ends rests
        (lambda x: "hunting" if 388 < x < 396 else "quiet", [], [(388, 396)]),
        # over more: two boundaries
        (lambda x: "hunting" if 390 < x < 460 else "quiet", [390, 460], []),
        # now this, now that over 8 %: between rest and a cycle lies no number
        (lambda x: "quiet" if x < 400 else "hunting" if x > 432 or math.sin(x) > 0 else "creeping", [], [(400, 432)]),
    ],
)
def test_beside_what_is_named_the_verdicts_hold(monkeypatch, verdict, named, mixed):
    """Boundaries stood 5 % beside which other verdicts stood."""
    solution = along(monkeypatch, verdict)
    assert [b.value for b in solution.boundaries] == pytest.approx(named, rel=5e-3)
    assert [x for m in solution.mixed for x in (m.low, m.high)] == pytest.approx(np.ravel(mixed).tolist(), rel=0.03)
    for b in solution.boundaries:
        for share, text in ((0.95, b.below), (1.05, b.above)):
            assert verdict(share * b.value) == text
    for m in solution.mixed:
        assert verdict(0.95 * m.low) == m.below
        assert verdict(1.05 * m.high) == m.above
        assert m.below in mixed_sentence(m)

"""Loops that still slip after 100 s, and then rest; a plant in C by someone else rests too."""

import pytest

from stribeck import Scenario, examples
from stribeck.loops.judge import IRREGULAR, SLOWING, judge
from stribeck.loops.loop import loop_of

GAINS = {
    "slips": (8717.482875294581, 69048.51914323123, 340.4991702003561),
    "creeps": (6933.6777556181905, 21172.567304895365, 925.018180553108),
}


def loop(name):
    scenario = Scenario.of(examples.path("axis_hunts"))
    gains = dict(zip(("K_p", "K_i", "K_d"), GAINS[name], strict=True))
    return loop_of(scenario.with_changes({f"controllers.axis.{k}": x for k, x in gains.items()}))


@pytest.mark.share(2)
@pytest.mark.parametrize(("name", "rests"), [("slips", (100, 125)), ("creeps", (85, 120))])
def test_a_loop_that_settles_late_is_quiet(name, rests):
    of = loop(name)
    (judgment,) = judge(of)
    assert judgment.verdict == "quiet"
    assert rests[0] < judgment.rested * of.slowest < rests[1]


@pytest.mark.parametrize(
    ("name", "steps", "verdict", "note"),
    [("creeps", 130_000, "hunting", IRREGULAR), ("slips", 10_000, "creeping", SLOWING)],
)
def test_a_run_that_ends_too_early_says_what_is_open(name, steps, verdict, note):
    (judgment,) = judge(loop(name), most_steps=steps)
    assert (judgment.verdict, judgment.note) == (verdict, note)

"""Laws as users write them: |v| as a root or a maximum, limits that never bite, cases that join smoothly."""

from __future__ import annotations

import pytest

import stribeck
from stribeck.expressions.ops import atan, clip, exp, larger, sign, smaller, sqrt, tanh, where
from stribeck.laws import BristleLaw
from stribeck.laws.terms import g
from stribeck.properties import WORK
from stribeck.properties.checked import Checked
from stribeck.properties.verdicts import accepted
from tests.properties.nasty import MILD

ROUND = 1e-12  # m^2/s^2


def law_with(size=None, decay=g, added=None):
    """LuGre with its |v|, its g or its force written otherwise."""

    class Written(BristleLaw):
        name = "written"

        @staticmethod
        def dz_dt(p, v, z):
            return v - (sqrt(v**2 + ROUND) if size is None else size(p, v)) / decay(p, v) * z

        @staticmethod
        def friction(p, v, z, dz_dt):
            own = p.sigma_0 * z + p.sigma_1 * dz_dt + p.sigma_2 * v
            return own if added is None else own + added(v, z)

    return Written(MILD)


ABSOLUTE = {
    "sqrt(v**2)": lambda p, v: sqrt(v**2),
    "sqrt(v*v)": lambda p, v: sqrt(v * v),
    "(v**2)**0.5": lambda p, v: (v**2) ** 0.5,
    "sqrt of a scaled square": lambda p, v: sqrt((v / p.v_s) ** 2) * p.v_s,
    "where(v > -v, v, -v)": lambda p, v: where(v > -v, v, -v),
    "the larger of v and -v": lambda p, v: larger(v, -v),
    "where(v > 0, v, -v)": lambda p, v: where(v > 0, v, -v),
    "v sign(v)": lambda p, v: v * sign(v),
}
SMOOTH = {
    "a limit above exp": {"size": lambda p, v: sqrt(v**2 + ROUND) * smaller(exp(-((v / p.v_s) ** 2)), 2.0)},
    "g below a limit": {"decay": lambda p, v: smaller(g(p, v), 2 * p.F_s / p.sigma_0)},
    "g up to what it reaches": {"decay": lambda p, v: smaller(g(p, v), p.F_s / p.sigma_0)},
    "g down to what it nears": {"decay": lambda p, v: larger(g(p, v), p.F_c / p.sigma_0)},
    "tanh within its range": {"added": lambda v, z: clip(tanh(v / 1e-3), -1.0, 1.0)},
    "atan within more": {"added": lambda v, z: clip(atan(v / 1e-3), -2.0, 2.0)},
    "a parabola that joins 0": {"added": lambda v, z: where(v > 1, 10 * (v - 1) ** 2, 0.0)},
    "both sides": {"added": lambda v, z: where(v > 1, 10 * (v - 1) ** 2, where(v < -1, -10 * (v + 1) ** 2, 0.0))},
    "|v| joined to a parabola": {"size": lambda p, v: where(abs(v) < p.v_s, (v**2 / p.v_s + p.v_s) / 2, abs(v))},
    "a smooth step": {"added": lambda v, z: where(v < 0, 0.0, where(v > 1, 1.0, v * v * (3 - 2 * v)))},
    "what is above 0, squared": {"added": lambda v, z: 100 * larger(z, 0.0) ** 2},
    "sgn(v) |v|^1.5": {"added": lambda v, z: sign(v) * abs(v) ** 1.5},
    "v^4 under a root": {"added": lambda v, z: 10 * v * sqrt(v**4)},
    "a kink that cancels": {"added": lambda v, z: 1e3 * (abs(v) - sqrt(v**2))},
}  # fmt: skip
KINKED = {
    "what is above 0": {"added": lambda v, z: 100 * larger(z, 0.0)},
    "|z| up to a limit": {"added": lambda v, z: 100 * smaller(abs(z), 1e-5)},
    "a ramp that begins": {"added": lambda v, z: larger(v - 1, 0.0)},
}


def smooth(law):
    """The verdict, a yes with a certificate that the independent checker accepts, a no confirmed by it."""
    verdict = accepted(Checked(law, None, WORK).smooth(), law, "smooth")
    assert verdict.verify(law, "smooth") in (True, None)
    return verdict.holds


@pytest.mark.share(3)
@pytest.mark.parametrize("text", ABSOLUTE)
def test_an_absolute_value_has_a_kink_however_it_is_written(text):
    assert smooth(law_with(size=ABSOLUTE[text])) is False


@pytest.mark.share(3)
@pytest.mark.parametrize("text", SMOOTH)
def test_limits_that_never_bite_and_cases_that_join_are_smooth(text):
    assert smooth(law_with(**SMOOTH[text])) is True


@pytest.mark.parametrize("text", KINKED)
def test_limits_that_bite_are_not(text):
    assert smooth(law_with(**KINKED[text])) is False


@pytest.mark.share(2)
@pytest.mark.parametrize("k_v", [1e-310, 1e4, 1e300])
def test_a_steepness_of_any_size_leaves_solutions_unique(k_v):
    """The slope's bound was sampled where it underflows, and so tight that regions did not suffice."""
    law = stribeck.law("elastoplastic_sobczyk", MILD, k_v=k_v, z_ba=7e-6)
    assert accepted(Checked(law, None, WORK).unique(), law, "unique").holds is True

"""What `check` reports of a kink or jump: its place, and which side has which value."""

import pytest

from stribeck.expressions.ops import both, sign, tanh, where
from stribeck.laws import BristleLaw
from stribeck.properties import WORK
from stribeck.properties.checked import Checked

VALUES = {"sigma_0": 1e5, "sigma_1": 100.0, "sigma_2": 100.0, "F_c": 1.0, "F_s": 1.5, "v_s": 1e-3}
S, C = 1e-3, 7.5e-6  # the first speed and deflection at which the search looks

SIDES = {
    "jump at v = 0": (lambda v, z: where(v > 0, 3.0, 1.0), "value", 1.0, 3.0),
    "fall at v = 0": (lambda v, z: where(v > 0, 1.0, 3.0), "value", 3.0, 1.0),
    "jump at z = 0": (lambda v, z: where(z <= 0, 1.0, 3.0), "value", 1.0, 3.0),
    "jump at a z > 0": (lambda v, z: where(z > 0.8 * C, 3.0, 1.0), "value", 1.0, 3.0),
    "jump at a z < 0": (lambda v, z: where(z > -0.8 * C, 3.0, 1.0), "value", 1.0, 3.0),
    "jump at a v > 0": (lambda v, z: where(v < 0.8 * S, 1.0, 3.0), "value", 1.0, 3.0),
    "jump at a speed that the search tries": (lambda v, z: where(v < 0.9 * S, 1.0, 3.0), "value", 1.0, 3.0),
    "jump at a v < 0": (lambda v, z: where(v < -0.8 * S, 1.0, 3.0), "value", 1.0, 3.0),
    "kink at v = 0": (lambda v, z: where(v > 0, 3.0, 1.0) * v, "by v", 1.0, 3.0),
    "kink at z = 0": (lambda v, z: where(z > 0, 3.0, 1.0) * z, "by z", 1.0, 3.0),
    "kink at a z < 0": (lambda v, z: where(z > -0.8 * C, 3.0, 1.0) * (z + 0.8 * C), "by z", 1.0, 3.0),
    "kink at a v < 0": (lambda v, z: where(v > -0.8 * S, 3.0, 1.0) * (v + 0.8 * S), "by v", 1.0, 3.0),
    "slope where v < 0 beside smooth cases where v > 0": (
        lambda v, z: where(v < -S / 2, sign(z) * (v + S / 2) ** 2, 0.0)
        + sum(where(v > k * S, (v - k * S) ** 2, 0.0) for k in range(1, 6)),
        "by v", S, -S,
    ),
    # derivatives of 2 (z + C/2) and of -2 (z + C/2) at z = -C
    "slope along v = 0 where z < 0": (lambda v, z: where(z < -C / 2, sign(v) * (z + C / 2) ** 2, 0.0), "by z", C, -C),
    "slope along v = 0 on one side": (lambda v, z: where(both(v > 0, z < -C / 2), (z + C / 2) ** 2, 0.0), "by z", 0, -C),
    "slope along z = 0 where v < 0": (lambda v, z: where(v < -S / 2, sign(z) * (v + S / 2) ** 2, 0.0), "by v", S, -S),
}  # fmt: skip


def elastic(h):
    """dz/dt = v with F = h(v, z)."""

    class Elastic(BristleLaw):
        name = "elastic"
        symmetric = False
        v_d = None

        @staticmethod
        def dz_dt(p, v, z):
            return v + 0.0 * z

        @staticmethod
        def friction(p, v, z, dz_dt):
            return h(v, z)

    return Elastic(VALUES)


@pytest.mark.parametrize(("h", "of", "below", "above"), SIDES.values(), ids=SIDES)
def test_each_side_of_a_kink_has_its_own_value(h, of, below, above):
    law = elastic(h)
    verdict = Checked(law, None, WORK).smooth()
    assert verdict.holds is False
    evidence, enclosed = verdict.evidence, verdict.evidence["enclosed"]
    assert of in evidence["derivative"]
    for side, value in (("from_below", below), ("from_above", above)):
        assert evidence[side] == pytest.approx(value, rel=1e-9, abs=1e-18)
        low, high = enclosed[side]
        assert low - 1e-9 * abs(value) <= value <= high + 1e-9 * abs(value)
    assert verdict.verify(law, "smooth") is True


LINES = {
    "z": lambda v, z: where(both(z <= C, z >= C), (z - C) * sign(v), 0.0),
    "v": lambda v, z: where(both(v <= S, v >= S), (v - S) * sign(z), 0.0),
    "v, in a condition": lambda v, z: where(where(both(v <= S, v >= S), -2.0, 2.0) + tanh(v) < 0, v - S, 0.0),
    "v, across a condition": lambda v, z: where(both(v <= S, v >= S), (v - S) * where(z < 0.8 * C, 1.0, -1.0), 0.0),
}


@pytest.mark.parametrize("h", LINES.values(), ids=LINES)
def test_a_case_that_holds_on_a_line_alone_makes_no_kink(h):
    """F = 0 everywhere, whatever the slope of the case that holds on the line."""
    assert Checked(elastic(h), None, WORK).smooth().holds is not False

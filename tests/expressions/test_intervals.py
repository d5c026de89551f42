"""The intervals hold the true values, found with exact rational numbers and with mpmath."""

from fractions import Fraction

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stribeck.expressions import intervals, ops
from stribeck.expressions.graph import symbol
from stribeck.expressions.intervals import Box, not_negative

size = st.floats(min_value=1e-120, max_value=1e120)
reals = st.one_of(size, size.map(lambda x: -x), st.just(0.0))
small = st.floats(min_value=-50, max_value=50)
inf = float("inf")
V = symbol("v")


def holds(x, value):
    low, high = x
    return (low == -inf or Fraction(low) <= value) and (high == inf or value <= Fraction(high))


def test_powers_are_as_narrow_as_they_are():
    assert intervals.power((0.0, 2.0), (2.0, 2.0)) == pytest.approx((0.0, 4.0))
    assert intervals.power((2.0, 4.0), (-1.0, 0.5)) == pytest.approx((0.25, 2.0))
    assert intervals.power((0.0, 2.0), (-1.0, 1.0)) == (-inf, inf)


@given(reals, reals)
def test_sums_products_and_quotients_hold_the_exact_result_within_two_roundings(a, b):
    exact = {"add": Fraction(a) + Fraction(b), "mul": Fraction(a) * Fraction(b)}
    exact |= {"div": Fraction(a) / Fraction(b)} if b else {}
    for op, value in exact.items():
        low, high = getattr(intervals, op)((a, a), (b, b))
        assert Fraction(low) <= value <= Fraction(high), op
        assert high <= np.nextafter(np.nextafter(low, inf), inf)


@pytest.mark.parametrize(
    ("a", "b", "ends"),
    [
        ((1.0, 2.0), (0.0, 4.0), (0.25, inf)), ((-2.0, -1.0), (0.0, 4.0), (-inf, -0.25)),
        ((-1.0, 2.0), (0.0, 4.0), (-inf, inf)), ((1.0, 2.0), (-4.0, 0.0), (-inf, -0.25)),
        ((-2.0, -1.0), (-4.0, 0.0), (0.25, inf)), ((1.0, 2.0), (-1.0, 4.0), (-inf, inf)),
        ((1.0, 2.0), (0.0, 0.0), (-inf, inf)), ((1.0, 2.0), (4.0, 8.0), (0.125, 0.5)),
    ],
)  # fmt: skip
def test_a_quotient_holds_every_one_of_a_divisor_that_is_not_0(a, b, ends):
    """What a divisor near 0 gives has no limit; the other end is that of the largest divisor, within a rounding."""
    low, high = intervals.div(a, b)
    assert low <= ends[0]
    assert high >= ends[1]
    assert (low, high) == pytest.approx(ends, rel=1e-15)


@given(
    st.lists(small, min_size=2, max_size=2), st.lists(small, min_size=2, max_size=2), st.floats(0, 1), st.floats(0, 1)
)
def test_an_operation_on_boxes_holds_that_on_their_points(a, b, s, t):
    a, b = sorted(a), sorted(b)
    x, y = (Fraction(e[0]) + Fraction(w) * (Fraction(e[1]) - Fraction(e[0])) for e, w in ((a, s), (b, t)))
    assert holds(intervals.neg(tuple(a)), -x)
    for op, value in {"add": x + y, "mul": x * y, **({"div": x / y} if y else {})}.items():
        assert holds(getattr(intervals, op)(tuple(a), tuple(b)), value)


@given(small)
def test_functions_hold_the_value_of_mpmath(x):
    with mpmath.workdps(50):
        for name in ("exp", "atan", "tanh", "sin", "cos"):
            low, high = Box({"v": (x, x)})(getattr(ops, name)(V))
            value = getattr(mpmath, name)(mpmath.mpf(x))
            assert mpmath.mpf(low) <= value <= mpmath.mpf(high)
            assert high - low <= 1e-14 * max(abs(float(value)), 1e-300) + 1e-16


@given(small, st.floats(min_value=0, max_value=20), st.floats(0, 1))
def test_functions_hold_their_values_on_boxes(low, width, share):
    high, box = low + width, Box({"v": (low, low + width)})
    x = mpmath.mpf(min(low + share * width, high))
    names = ("exp", "atan", "tanh", "sin", "cos", "sign")
    with mpmath.workdps(50):
        values = {getattr(ops, name)(V): getattr(mpmath, name)(x) for name in names} | {abs(V) ** 1.5: abs(x) ** 1.5}
        for node, value in values.items():
            assert mpmath.mpf(box(node)[0]) <= value <= mpmath.mpf(box(node)[1])


def test_unbounded_boxes():
    box = Box({"v": (2.0, inf)})
    assert box(ops.atan(V))[1] == pytest.approx(np.pi / 2)
    assert (box(ops.exp(-V * V))[0], box(1 / V)[0], box(abs(V))[1]) == (0.0, 0.0, inf)


def test_a_product_that_underflows_keeps_its_sign():
    tiny = (0.0, 5e-324)
    assert intervals.mul(tiny, (0.3, 0.3))[0] == 0.0
    assert intervals.mul(tiny, (-0.3, -0.3))[1] == 0.0
    assert intervals.mul(tiny, (0.3, 0.3))[1] > 0.0


EVERYWHERE = [(-inf, 0.0), (0.0, inf)]


@pytest.mark.parametrize(("expression", "holds"), [
    (V * V, True), (1 - ops.tanh(V), True), (0.1 + ops.exp(-V * V) - 0.1 * ops.exp(-2 * V * V), True), (abs(V) - 1e-3, False),
    (V * V - 2 * V + 0.99, False), (1e-6 + (V - 3) ** 2, True),
])  # fmt: skip
def test_a_bound_on_a_line_is_proved_or_a_place_is_named(expression, holds):
    cover = not_negative(lambda v: Box({"v": v})(expression), EVERYWHERE)
    assert cover.holds is holds
    assert cover.negative is not holds
    if not holds:
        assert Box({"v": cover.where})(expression)[0] < 0


def test_a_bound_that_rounding_decides_is_open():
    cover = not_negative(lambda v: Box({"v": v})((V - 1) ** 2 * 1e-3), [(0.5, 2.0)])
    assert cover.holds or cover.reason == "parts became too small"

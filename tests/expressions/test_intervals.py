"""The intervals hold the true values, found with exact rational numbers and with mpmath."""

from fractions import Fraction

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stribeck.expressions import intervals, ops
from stribeck.expressions.graph import symbol
from stribeck.expressions.intervals import Evaluator, bernstein, interval, point

size = st.floats(min_value=1e-120, max_value=1e120)
reals = st.one_of(size, size.map(lambda x: -x), st.just(0.0))
small = st.floats(min_value=-50, max_value=50)
inf = float("inf")


def holds(x, value):
    return Fraction(float(x.low)) <= value <= Fraction(float(x.high))


def test_powers_are_as_narrow_as_they_are():
    assert intervals.power((0.0, 2.0), (2.0, 2.0)) == pytest.approx((0.0, 4.0))
    assert intervals.power((2.0, 4.0), (-1.0, 0.5)) == pytest.approx((0.25, 2.0))
    assert intervals.power((0.0, 2.0), (-1.0, 1.0)) == (-inf, inf)


@given(reals, reals)
def test_sums_products_and_quotients_hold_the_exact_result_within_a_rounding(a, b):
    with np.errstate(all="ignore"):
        check_operations(a, b)


def check_operations(a, b):
    exact = {"+": Fraction(a) + Fraction(b), "*": Fraction(a) * Fraction(b)}
    found = {"+": point(a) + point(b), "*": point(a) * point(b)}
    if b:
        exact["/"], found["/"] = Fraction(a) / Fraction(b), point(a) / point(b)
    for op, value in exact.items():
        assert holds(found[op], value), op
        assert found[op].high <= np.nextafter(np.nextafter(found[op].low, inf), inf)


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
    with np.errstate(all="ignore"):
        found = interval(*a) / interval(*b)
    assert holds(interval(*a) * interval(*b), x * y)
    assert holds(interval(*a) - interval(*b), x - y)
    assert holds(abs(interval(*a)), abs(x))
    plain = {"add": x + y, "mul": x * y, **({"div": x / y} if y else {})}
    for op, value in plain.items():  # the same of pairs of floats
        low, high = getattr(intervals, op)(tuple(a), tuple(b))
        assert low == -inf or Fraction(low) <= value
        assert high == inf or Fraction(high) >= value
    if y:
        low, high = float(found.low), float(found.high)
        assert low == -inf or Fraction(low) <= x / y
        assert high == inf or Fraction(high) >= x / y


@given(small)
def test_functions_hold_the_value_of_mpmath(x):
    v = symbol("v")
    with mpmath.workdps(50):
        for name in ("exp", "atan", "tanh", "sin", "cos"):
            found = Evaluator([getattr(ops, name)(v)])({"v": point(np.array([x]))})[0]
            value = getattr(mpmath, name)(mpmath.mpf(x))
            assert mpmath.mpf(float(found.low[0])) <= value <= mpmath.mpf(float(found.high[0]))
            assert found.high[0] - found.low[0] <= 1e-14 * max(abs(float(value)), 1e-300) + 1e-16


@given(small, st.floats(min_value=0, max_value=20), st.floats(0, 1))
def test_functions_hold_their_values_on_boxes(low, width, share):
    v, high = symbol("v"), low + width
    x = mpmath.mpf(min(low + share * width, high))
    names = ("exp", "atan", "tanh", "sin", "cos", "sign")
    found = Evaluator([*(getattr(ops, name)(v) for name in names), abs(v) ** 1.5])({"v": interval([low], [high])})
    with mpmath.workdps(50):
        for box, value in zip(found, [*(getattr(mpmath, name)(x) for name in names), abs(x) ** 1.5], strict=True):
            assert mpmath.mpf(float(box.low[0])) <= value <= mpmath.mpf(float(box.high[0]))


def test_unbounded_boxes():
    v = symbol("v")
    found = Evaluator([ops.atan(v), ops.exp(-v * v), 1 / v, abs(v)])({"v": interval([2.0], [inf])})
    assert found[0].high[0] == pytest.approx(np.pi / 2)
    assert (found[1].low[0], found[2].low[0], found[3].high[0]) == (0.0, 0.0, inf)


@given(st.floats(-2, 2), st.floats(0, 2), st.floats(0, 1))
def test_the_range_of_a_polynomial(low, width, share):
    c = tuple(map(Fraction, (0, 0, 0, 10, -15, 6)))
    x = Fraction(low) + Fraction(share) * Fraction(width)
    assert holds(
        bernstein(c, interval(np.array(low), np.array(float(low + width)))), sum(a * x**i for i, a in enumerate(c))
    ) or (x > Fraction(float(low + width)))


def test_the_quintic_smoothstep_stays_within_0_and_1():
    s = ops.clip(symbol("x"), 0.0, 1.0)
    found = Evaluator([s**3 * (10 - 15 * s + 6 * s**2)])({"x": interval([-3.0, 0.25], [5.0, 0.5])})[0]
    assert (found.low[0], found.high[0]) == (0.0, 1.0)
    assert 0.0 < found.low[1] < found.high[1] < 1.0


def test_a_product_that_underflows_keeps_its_sign():
    tiny = interval([0.0], [5e-324])
    with np.errstate(all="ignore"):
        assert (tiny * point(np.array([0.3]))).low[0] == 0.0
        assert (tiny * point(np.array([-0.3]))).high[0] == 0.0
        assert (tiny * point(np.array([0.3]))).high[0] > 0.0

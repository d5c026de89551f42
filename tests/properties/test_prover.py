"""The parts of a proof: numbers that stay exact, signs over whole regions, and the mistakes that were made before."""

import math
import pickle
from fractions import Fraction

import pytest

import stribeck
from stribeck.expressions.exact import Exact
from stribeck.expressions.graph import constant, symbol
from stribeck.expressions.intervals import Box
from stribeck.expressions.ops import atan, clip, either, exp, pi, sign, sin, sqrt, where
from stribeck.laws import BristleLaw
from stribeck.laws.terms import g
from stribeck.properties import WORK, check
from stribeck.properties.checked import Checked
from stribeck.properties.enclosed import least
from stribeck.properties.model import Model
from stribeck.properties.prover import atoms
from stribeck.properties.prover.bernstein import POSITIVE, UNIT, signs
from stribeck.properties.prover.leaf import Leaf, Rules
from stribeck.properties.prover.region import Axis, Region
from stribeck.properties.prover.ring import Ring, Unclear
from stribeck.properties.prover.search import Budget, Prover

U, W = symbol("u"), symbol("w")
TABLE_1 = {"sigma_0": 1e5, "sigma_1": 1e5**0.5, "sigma_2": 200.0, "F_c": 1.0, "F_s": 1.5, "v_s": 1e-3}
EVERYWHERE = {"u": (Fraction(0), None), "w": (Fraction(0), None)}


def test_an_expression_of_too_many_functions_is_left_undecided():
    assert not shown(sum((exp(-(k + 2) * U) for k in range(25)), constant(1.0)))


def shown(expr, relation=">=0", ranges=EVERYWHERE):
    return Prover(Ring({}), {}).show(expr, relation, ranges, Budget(200)) is not None


def test_pi_is_pi_and_a_float_is_a_float():
    assert (2 / pi).tree == ("div", 2.0, "pi")
    assert isinstance(sqrt(pi + 1), Exact)
    assert (0.1 + constant(0.2)).value.tree == ("add", 0.1, 0.2)
    assert type(constant(1.0) + 2.0) is type(U)
    assert not isinstance((constant(1.0) + 2.0).value, Exact)
    low, high = Box({})(constant(1e12))
    assert low == high == 1e12
    assert shown(sin(pi * U / U) + 0.0 * W, "=0", {"u": (Fraction(1), Fraction(2))})
    assert not shown(sin(float(pi) * U / U), "=0", {"u": (Fraction(1), Fraction(2))})
    with pytest.raises(Unclear, match="sqrt of a number"):
        Ring({}).number(sqrt(Exact(2.0, 2.0)))


def test_signs_of_polynomials():
    from flint import fmpq

    square = {(0, 0): fmpq(1), (0, 1): fmpq(-2), (0, 2): fmpq(1)}  # (1 - x)^2
    assert signs(square, [UNIT], [False]) == (True, False, False)
    assert signs({(0, 1): fmpq(1), (0, 0): fmpq(-1)}, [POSITIVE], [False]) == (False, False, False)
    assert signs({(1, 0): fmpq(1), (0, 0): fmpq(-3)}, [None], [False]) == (True, False, True)  # pi - 3
    sums = []
    assert signs({(0, 3): fmpq(1), (0, 4): fmpq(-1)}, [UNIT], [True], sums.append)[0]  # x^3 (1 - x), x > 0
    assert sums == [3]  # of 1 - x alone


def test_a_lower_bound_is_found_by_bisection():
    model = Model(stribeck.law("lugre", TABLE_1))
    assert 0 < least(model, symbol("z") * (symbol("z") - 1) + 1, 1.0, 0.0, 1.0) <= 0.75


@pytest.mark.parametrize(
    ("expr", "holds"),
    [
        (U * (2 / pi) * atan(3 * U) + 2 / (3 * pi) - U, True),  # a majorant of |v|, unbounded
        (U * (2 / pi) * atan(3 * U) + 0.6 / (3 * pi) - U, False),
        (sqrt(U**2 + 0.25) - U, True),
        (1 - exp(-(U**2)) * 2, False),
        (
            1 - exp(-U / (1 + W)) * (1 + U / (1 + W) + U**2 / (2 * (1 + W) ** 2)),
            True,
        ),  # by exp(-x) <= 1/(1 + x + x^2/2)
        (0.99 - exp(-U / (1 + W)), False),
        (where(W < 1e300, W, -1.0), False),
        (clip((W - 1) / (2 + U), 0.0, 1.0), True),
        ((W - 1) * sign(W - 1), True),
        ((U - W) ** (2 * (1 + W) / (1 + W)), True),
        ((U + 1) ** W, True),
        ((4 + U / (1 + U)) ** 0.375 - 1.5, True),
        (2 - (1 - 2 * U) ** 0.3, False),  # the power is at most 1, but has no value for U > 1/2
        ((U - 1) * (U - 1) ** (-W / W), False),  # 1, but for U = 1
        (2 + sin(sqrt(U - 1)), False),
        (2 + exp(-sqrt(U - 1)), False),
        (-sign(W - 1), False),
        (sign(W - 1), False),
        (1e-300 - where(either(U < 1e-200, W > 1e250), 1.0, 0.0), False),
    ],
)
def test_what_holds_everywhere(expr, holds):
    assert shown(expr) == holds


@pytest.mark.parametrize(("op", "function"), [("tanh", math.tanh), ("atan", math.atan)])
@pytest.mark.parametrize("ends", [(0.1, 0.5), (0.5, 3.0), (2.0, 50.0)])
def test_the_range_of_a_quotient_that_falls_is_told_by_its_ends(op, function, ends):
    low, high = atoms._falling(op, ends)
    left, right = (function(y) / y for y in ends)
    assert right * (1 - 1e-6) < low <= right * (1 + 1e-15)
    assert left * (1 - 1e-15) <= high < left * (1 + 1e-6)


@pytest.mark.parametrize("name", ["elastoplastic", "elastoplastic_majorant"])
def test_elastoplastic_sets_at_their_limit_are_passive(name):
    own = {"k_v": 1e7} if "majorant" in name else {}
    law = stribeck.law(name, {**TABLE_1, "F_s": 1.0, "sigma_2": 0.0}, z_ba=0.7e-5, **own)
    assert Checked(law, None, WORK).passive().holds is True


def test_elastoplastic_near_the_largest_z_ba_is_decided():
    law = stribeck.law("elastoplastic", {**TABLE_1, "F_s": 1.1}, z_ba=0.9 * 1.1 / 1e5)
    assert [v.holds for v in check(law).properties.values()] == [True, True, False, True, True]


def test_two_z_is_not_z():
    """dz/dt = v - |v|/(2 g) z is bounded by 2 Z only, and not passive from far out."""

    class Loose(BristleLaw):
        @staticmethod
        def dz_dt(p, v, z):
            return v - abs(v) / (2 * g(p, v)) * z

    result = Checked(Loose(TABLE_1), None, WORK)
    assert result.bounded().holds is False
    assert result.passive().holds is not True


SPELLINGS = {
    "|z| for sgn(v) z": lambda p, v, z: v * (1 - sign(v) * z / g(p, v)),
    "clipped at infinity": lambda p, v, z: v - where(v < float("inf"), abs(v), -v) / g(p, v) * z,
    "combined conditions": lambda p, v, z: v - where(either(v * z > 0, v * z <= 0), abs(v), 0.0) / g(p, v) * z,
}


@pytest.mark.parametrize("words", SPELLINGS)
def test_a_law_spelt_otherwise_has_the_same_verdicts(words):
    law = type("Spelt", (BristleLaw,), {"dz_dt": staticmethod(SPELLINGS[words])})(TABLE_1)
    assert [v.holds for v in check(law).properties.values()] == [True, True, False, True, False]


def test_a_power_that_is_no_whole_number():
    """exp(-|v/v_s|^delta): C1 for delta > 1, kinked for delta = 1 (docs/explanation/check.md)."""

    def law(delta):
        def dz_dt(p, v, z):
            steady = (p.F_c + (p.F_s - p.F_c) * exp(-(abs(v / p.v_s) ** delta))) / p.sigma_0
            return v - sqrt(v**2 + 1e-14) / steady * z

        return type("Power", (BristleLaw,), {"dz_dt": staticmethod(dz_dt)})(TABLE_1)

    verdicts = {d: Checked(law(d), None, WORK) for d in (0.5, 1.0, 1.5)}
    assert [c.bounded().holds for c in verdicts.values()] == [True] * 3
    assert verdicts[1.0].smooth().holds is False
    assert verdicts[0.5].smooth().holds is not True
    assert verdicts[1.5].smooth().holds is True


def test_verdicts_can_be_pickled():
    result = check(stribeck.law("lugre", TABLE_1))
    again = pickle.loads(pickle.dumps(result))
    assert again.to_dict() == result.to_dict()
    assert again["passive"].certificate == result["passive"].certificate


def test_nothing_is_proved_without_work():
    verdicts = check(stribeck.law("lugre_majorant", TABLE_1, k_v=1e7), work=0.0).properties.values()
    assert all(v.holds in (None, False) for v in verdicts)


def test_a_function_of_a_function_whose_value_has_a_divisor():
    """exp(y) >= 1 + y for y = -atan(u), which far out is (1 - c)/u - pi/2: its numerator has a divisor of its own."""
    region = Region((Axis("u", Fraction(1), None),))
    for expr, holds in ((exp(-atan(U)) - 1 + atan(U), True), (exp(-atan(U)) - 1 + atan(U) / 2, False)):
        leaf = Leaf(Ring({}), region, Rules(exp="tangent", wave="far"), {})
        assert leaf.signs(leaf.convert(expr))[0] is holds


@pytest.mark.parametrize(("u", "w"), [(0.3, 1e-5), (7e-3, 1.1e-5), (0.1, 0.3)])
def test_both_triangles_of_a_rectangle_lie_within_it(u, w):
    sides = Axis("u", Fraction(0), Fraction(u)), Axis("w", Fraction(0), Fraction(w))
    within = Region(sides).bounds()
    for axis, share, steep in ((sides[0], "q", sides[1]), (sides[1], "p", sides[0])):
        assert Region((axis, Axis(share, Fraction(0), steep.high / axis.high))).bounds() == within

"""The checker's arithmetic against samples: what a leaf accepts is true, and a range holds every value."""

from __future__ import annotations

import random
from fractions import Fraction
from typing import Any

import mpmath
import pytest
from flint import fmpq

from stribeck_verify import schema
from stribeck_verify.expressions import Node, Refused, derivative, name, read, replace
from stribeck_verify.identities import Normal, written_out
from stribeck_verify.intervals import Evaluation, evaluate
from stribeck_verify.leaf import Leaf, Region
from stribeck_verify.meeting import Cases, agree_on_axis

U, W = name("u"), name("w")
NAMES = {"u": U, "w": W, "pi": name("pi")}
FUNCTIONS = ("exp", "sqrt", "sin", "cos", "atan", "tanh", "log")
_MATH: dict[str, Any] = {
    "add": lambda a, b: a + b, "sub": lambda a, b: a - b, "mul": lambda a, b: a * b, "div": lambda a, b: a / b,
    "neg": lambda a: -a, "abs": abs, "sign": lambda a: mpmath.mpf((a > 0) - (a < 0)), "pow": lambda a, b: a**b,
    "lt": lambda a, b: a < b, "le": lambda a, b: a <= b, "both": lambda a, b: a and b, "either": lambda a, b: a or b,
    "where": lambda c, a, b: a if c else b,
} | {n: getattr(mpmath, n) for n in FUNCTIONS}  # fmt: skip


def value(x: Node, at: dict[str, Any]) -> Any:
    """An expression at a point, by mpmath; complex or an error where it has no value."""
    if x.op == "number":
        return mpmath.mpf(int(x.value.p)) / int(x.value.q)
    if x.op == "name":
        return mpmath.pi if x.value == "pi" else at[x.value]
    if x.op == "where":
        return value(x.args[1] if value(x.args[0], at) else x.args[2], at)
    return _MATH[x.op](*(value(a, at) for a in x.args))


def expression(rng: random.Random, depth: int) -> Any:
    if depth == 0 or rng.random() < 0.1:
        return rng.choice(["u", "w", "u", "w", "1", "-2", "1/3", "pi"])
    kind = rng.choice(["add", "sub", "mul", "div", "one", "function", "where", "pow"])
    if kind == "pow":
        return ["pow", ["abs", expression(rng, depth - 1)], rng.choice(["1/2", "3/2", "2/5", "7/5", "-1/2", "2"])]
    if kind in ("add", "sub", "mul", "div"):
        return [kind, expression(rng, depth - 1), expression(rng, depth - 1)]
    if kind == "one":
        return [rng.choice(["neg", "abs", "sign"]), expression(rng, depth - 1)]
    if kind == "function":
        return [rng.choice(FUNCTIONS), expression(rng, depth - 1)]
    condition = [rng.choice(["lt", "le"]), expression(rng, depth - 1), expression(rng, depth - 2 if depth > 1 else 0)]
    return ["where", condition, expression(rng, depth - 1), expression(rng, depth - 1)]


def end(rng: random.Random) -> fmpq:
    return fmpq(rng.choice([0, 0, 1, 1, 2, 3, 5]), rng.choice([1, 1, 2, 7]))


def region(rng: random.Random, open_: bool = True) -> Region:
    axes = {}
    for axis in ("u", "w"):
        lo = end(rng)
        axes[axis] = (lo, None if rng.random() < 0.3 else lo + end(rng) + fmpq(1, 3))
    given = dict(axes)
    if open_ and rng.random() < 0.3:
        kept, ratio = rng.choice([("w", "p"), ("u", "q")])
        axes = {kept: given[kept], ratio: (fmpq(0), None)}
    return Region(axes, given, open_)


def points(rng: random.Random, box: dict[str, Any], n: int, least: float = 1e-30) -> Any:
    """Points of a box; u, w >= least."""
    for _ in range(n):
        at = {}
        for axis, (lo, hi) in box.items():
            low = mpmath.mpf(int(lo.p)) / int(lo.q)
            if hi is None:
                at[axis] = low + mpmath.mpf(10) ** rng.uniform(-6, 6)
            else:
                width = mpmath.mpf(int((hi - lo).p)) / int((hi - lo).q)
                at[axis] = low + width * rng.choice([1, rng.random(), rng.random() ** 8, 1 - rng.random() ** 8])
            at[axis] = max(low if rng.random() < 0.1 else at[axis], mpmath.mpf(least))
        yield at


@pytest.mark.parametrize("seed", range(3))
def test_a_range_holds_every_value(seed):
    rng, decided = random.Random(seed), 0
    with mpmath.workdps(40):
        for _ in range(150):
            x = read(expression(rng, 4), NAMES)
            box = region(rng).given
            try:
                lo, hi = evaluate(x, box)
            except Refused:
                continue
            decided += 1
            for at in points(rng, box, 6):
                y = value(x, at)
                assert lo is None or y >= mpmath.mpf(int(lo.p)) / int(lo.q) - 1e-30 * (1 + abs(y))
                assert hi is None or y <= mpmath.mpf(int(hi.p)) / int(hi.q) + 1e-30 * (1 + abs(y))
    assert decided > 60


def test_a_power_of_what_may_be_below_0_has_no_range():
    with pytest.raises(Refused, match="below 0"):
        evaluate(read(["pow", ["sub", "w", "2"], "2"], NAMES), {"w": (fmpq(0), fmpq(3))})


def atoms_for(rng: random.Random, x: Node) -> list[Any]:
    """Atoms with rules that may or may not fit, for every function and case in an expression."""
    results = []
    seen = set()

    def visit(y: Node) -> Any:
        parts = [visit(a) for a in y.args]
        text = str(Fraction(int(y.value.p), int(y.value.q))) if y.op == "number" else y.value
        written = [y.op, *parts] if y.args else text
        if y.op in (*FUNCTIONS, "pow") and y not in seen:
            rules = [["range", rng.choice(["0", "-1", "1/2"]), rng.choice(["1", "2", "10"])], ["range", "-1", "1"],
                     ["pi range", rng.choice(["0", "-1", "1/2"]), "1"], ["far"], ["slope", rng.choice(["0", "1/2"]), "1"],
                     ["root", rng.choice(["u", "w", "0"]), rng.choice(["1", "2"])], ["tangent"],
                     ["above", rng.choice(["0", "1", "-1"])], ["below", rng.choice(["0", "1"])],
                     ["chord", rng.choice(["0", "1/2", "2/5"]), rng.choice(["1", "1", "1/2"])]]  # fmt: skip
            rules += rules[-4:] * (y.op in ("pow", "sqrt", "exp"))
            results.append([written, *rng.choice(rules)])
        elif y.op in ("where", "abs", "sign") and y not in seen:
            results.append([written, "either"])
        seen.add(y)
        return written

    visit(x)
    return results


@pytest.mark.parametrize("open_", [True, False], ids=["u, w > 0", "u, w >= 0"])
@pytest.mark.parametrize("seed", range(5))
def test_what_a_leaf_accepts_is_true(seed, open_):
    rng, accepted = random.Random(100 + seed), 0
    with mpmath.workdps(40):
        for _ in range(150):
            x = read(expression(rng, 3), NAMES)
            where = region(rng, open_)
            relation = rng.choice([">=0", ">0", "!=0", "=0"])
            try:
                if not Leaf(where, atoms_for(rng, x)).holds(x, relation):
                    continue
            except Refused:
                continue
            accepted += 1
            signs = set()
            for at in points(rng, where.given, 12, 1e-30 if open_ else 0.0):
                y = value(x, at)  # an error where it has no value
                signs.add(mpmath.sign(y))
                small = mpmath.mpf(10) ** -25 * (1 + abs(y))
                true = {">=0": y >= -small, ">0": y > -small, "!=0": len(signs) == 1, "=0": abs(y) <= small}[relation]
                assert true, (x, relation, at, y)
    assert accepted > 3


@pytest.mark.parametrize("seed", range(3))
def test_equal_keys_are_equal_functions(seed):
    rng, result = random.Random(200 + seed), 0
    with mpmath.workdps(40):
        for _ in range(150):
            a, b = (read(expression(rng, 3), NAMES) for _ in range(2))
            both = [a, written_out(a), b]
            normal = Normal()
            try:
                keys = [normal.key(x) for x in both]
            except Refused:
                continue
            for i, j in ((0, 1), (0, 2)):
                if keys[i] != keys[j]:
                    continue
                result += 1
                for at in points(rng, region(rng).given, 4):
                    try:
                        y, other = (value(both[k], at) for k in (i, j))
                    except (ZeroDivisionError, TypeError):
                        continue
                    if not (mpmath.isfinite(y) and mpmath.isfinite(other)):
                        continue
                    assert abs(y - other) <= 1e-25 * (1 + abs(y))
    assert result > 30


ROOT, POWER, EXP, TANH = ["sqrt", "u"], ["pow", "u", "2/5"], ["exp", ["sub", "u", "1"]], ["tanh", "u"]
ATAN, ABOVE = ["atan", "u"], ["sub", ["atan", "u"], ["div", "pi", "4"]]


@pytest.mark.parametrize(
    ("statement", "ends", "atom", "holds"),
    [
        (["sub", POWER, "1"], (1, None), [POWER, "chord", "0", "2/5"], True),  # u^0.4 >= 1 for u >= 1
        (["sub", ["add", "1", ["mul", "2/5", ["sub", "u", "1"]]], POWER], (0, 1), [POWER, "chord", "2/5", "1"], True),
        (["sub", ["add", "1", ["mul", "2/5", ["sub", "u", "1"]]], POWER], (1, None), [POWER, "chord", "0", "2/5"], True),
        (["sub", ["add", "1", ["mul", "2/5", ["sub", "u", "1"]]], POWER], (1, None), [POWER, "chord", "0", "1/5"], False),
        (["sub", ["add", "1", ["mul", "1/3", ["sub", "u", "1"]]], ROOT], (1, None), [ROOT, "chord", "0", "1/3"], False),
        (["sub", POWER, "1"], (1, None), [POWER, "above", "1"], True),
        (["sub", POWER, "2"], (1, None), [POWER, "above", "2"], False),
        (["neg", ["log", "u"]], (0, 1), [["log", "u"], "below", "0"], False),  # no value at 0
        (["neg", ["log", "u"]], (1, 2), [["log", "u"], "below", "0"], False),
        (["sub", EXP, "u"], (0, None), [EXP, "tangent"], True),  # exp(y) >= 1 + y
        (["sub", "u", EXP], (0, None), [EXP, "tangent"], False),
        (["sub", TANH, ["mul", "2/5", "u"]], (1, 2), [TANH, "slope", "2/5", "1"], True),  # tanh(2)/2 = 0.482
        (["sub", TANH, ["mul", "1/2", "u"]], (1, 2), [TANH, "slope", "1/2", "1"], False),
        (["sub", TANH, ["mul", "1/2", "u"]], (1, None), [TANH, "slope", "1/2", "1"], False),
        (["sub", ["mul", "4/5", "u"], TANH], (1, 2), [TANH, "slope", "0", "4/5"], True),  # tanh(1) = 0.762
        (["sub", ["mul", "3/4", "u"], TANH], (1, 2), [TANH, "slope", "0", "3/4"], False),
        (["sub", ["mul", "4/5", "u"], TANH], (0, 2), [TANH, "slope", "0", "4/5"], False),
        (["sub", ["mul", "4/5", "u"], TANH], (-1, 2), [TANH, "slope", "0", "1"], False),
        (["mul", "u", ["sub", TANH, ["mul", "2/5", "u"]]], (-9, 2), [TANH, "slope", "2/5", "1"], False),
        (["sub", ["sin", ["div", "pi", "4"]], "1"], (1, 2), [TANH, "slope", "0", "1"], False),
        (ABOVE, (2, None), [ATAN, "pi range", "1/2", "1"], True),
        (ABOVE, (0, None), [ATAN, "pi range", "1/2", "1"], False),
        (["neg", ABOVE], (0, 2), [ATAN, "pi range", "0", "1/2"], False),
    ],
)  # fmt: skip
def test_rules_of_functions_without_bounds(statement, ends, atom, holds):
    axes = {"u": (fmpq(ends[0]), None if ends[1] is None else fmpq(ends[1]))}
    try:
        result = Leaf(Region(axes, axes, False), [atom]).holds(read(statement, NAMES), ">=0")
    except Refused:
        result = False
    assert result is holds


@pytest.mark.parametrize(
    ("data", "said"),
    [
        ([], "no expression"), (None, "no expression"), (3, "no expression"), (["nope", "u"], "no expression"),
        (["add", "u"], "no expression"), (["add", "u", "w", "u"], "no expression"), ("x", "unknown name"),
        ("1/0", "no rational number"), ("--1", "no rational number"), ("1e3", "no rational number"),
        (["add", ["lt", "u", "1"], "w"], "a condition stands"), (["where", "u", "u", "w"], "a condition stands"),
        (["both", "u", ["lt", "u", "1"]], "a condition stands"), (["where", ["lt", "u", "1"], "u", "w"], None),
        (["pow", ["sub", "u", "2"], "1/2"], "pow"),
        (["where", ["lt", "u", "w"], "w", "u"], "a condition that is not decided has no atom"),
        (["div", "1", ["sub", "u", "1"]], "a divisor may be 0"), (["log", ["sub", "u", "1"]], "log"),
    ],
)  # fmt: skip
def test_what_is_no_expression_or_has_no_value_is_refused(data, said):
    box = {"u": (fmpq(0), fmpq(1)), "w": (fmpq(0), None)}
    if said is None:
        assert evaluate(read(data, NAMES), box) == (0, None)
        return
    with pytest.raises(Refused, match=said):
        Leaf(Region(box, box, False), []).holds(read(data, NAMES), ">0")


@pytest.mark.parametrize(
    ("check", "right", "wrong"),
    [
        (schema._whole(1, 3), [1, 3], [0, 4]),
        (schema._formula("u", condition=True), [["lt", "u", "1"]], ["u", ["lt", "w", "1"]]),
        (schema.ends, [["-1", "inf"], ["1", "1"]], [["2", "1"]]),
        (schema._range, [["0", "2"]], [["-1", "2"]]),
    ],
)
def test_a_field_is_within_its_bounds(check, right, wrong):
    for x in right:
        check(x)
    for x in wrong:
        with pytest.raises(Refused):
            check(x)


def test_derivatives_are_those_of_differences():
    rng, compared = random.Random(7), 0
    with mpmath.workdps(60):
        step = mpmath.mpf(10) ** -25
        for _ in range(100):
            x = read(expression(rng, 3), NAMES)
            d = derivative(x, W)
            for at in points(rng, {"u": (fmpq(1), fmpq(2)), "w": (fmpq(1), fmpq(2))}, 2):
                try:
                    beside = {**at, "w": at["w"] + step}
                    slope = (value(x, beside) - value(x, {**at, "w": at["w"] - step})) / (2 * step)
                    own = value(d, at)
                except (ZeroDivisionError, ValueError, TypeError):
                    continue
                if isinstance(slope, mpmath.mpc) or isinstance(own, mpmath.mpc) or abs(slope) > 1e15:
                    continue
                compared += 1
                assert abs(own - slope) <= 1e-12 * (1 + abs(slope))
    assert compared > 70
    assert replace(U, {U: W}) is W


@pytest.mark.parametrize(
    "expression", [["div", ["mul", "u", "u"], "u"], ["div", "u", ["sub", "1", "u"]], ["div", "1", "u"]]
)
def test_a_divisor_that_may_be_0_is_refused(expression):
    """u u/u is no number at u = 0, which belongs to a closed region."""
    axes = {"u": (fmpq(0), fmpq(1))}
    with pytest.raises(Refused, match="a divisor may be 0"):
        Leaf(Region(axes, axes, False), []).holds(read(expression, NAMES), ">=0")
    if expression[-1] == "u":
        assert Leaf(Region(axes, axes, True), []).holds(read(expression, NAMES), ">=0")


def test_what_is_plainly_so_is_accepted():
    """One condition in two forms, the root of a square, and a quotient by what is < 0 and begins at 0."""
    normal, box = Normal(), {"u": (fmpq(0), fmpq(2))}
    conditions = (["le", "u", "w"], ["le", ["sub", "u", "w"], "0"])
    for same in (conditions, [["both", c, ["lt", "u", "1"]] for c in conditions]):
        assert len({normal.key(read(["where", c, "u", "w"], NAMES)) for c in same}) == 1
    open_case = read(["where", ["both", ["lt", "0", "1"], ["lt", "u", "w"]], "u", "w"], NAMES)
    assert normal.key(open_case) not in (normal.key(U), normal.key(W))
    assert normal.key(read(["pow", "u", ["sub", "w", "w"]], NAMES)) == normal.key(read("1", NAMES))
    assert Leaf(Region(box, box, True), []).holds(read(["sub", ["sqrt", ["mul", "u", "u"]], "u"], NAMES), "=0")
    assert Evaluation(box, positive=True)(read(["div", "1", ["neg", "u"]], NAMES)) == (None, fmpq(-1, 2))
    for open_ in (True, False):  # u (u - 1) < 0 is u < 1 where u > 0
        leaf = Leaf(Region(box, box, open_), [])
        sides = (leaf(read(x, NAMES)) for x in (["mul", "u", ["sub", "u", "1"]], ["sub", "u", "1"]))
        assert leaf._positive_multiple(*sides) is open_
    case = read(["where", ["lt", ["neg", "u"], ["add", "w", "1"]], "w", "u"], NAMES)  # on the whole quadrant
    agree_on_axis([(Cases(case), 1), (Cases(W), 1)], U, None)

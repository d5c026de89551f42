"""What stands for a function in a leaf: its value by a rule, with a share in [0, 1]; each rule's hypotheses are checked."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from flint import fmpq

from stribeck_verify import intervals
from stribeck_verify.expressions import Json, Node, Refused, node, rational, read
from stribeck_verify.intervals import decimal
from stribeck_verify.rational import Quotient

if TYPE_CHECKING:
    from stribeck_verify.leaf import Leaf


ENDLESS_RULES = ("above", "below", "tangent")  # their variable is only known to be >= 0


@dataclass
class Atom:
    """An expression of u and w, the rule for its value, what the rule needs, and the number of its share.

    The share is in [0, 1], or for :data:`ENDLESS_RULES` only known to be >= 0.
    """

    node: Node
    rule: str
    rest: Sequence[Json]
    share: int


def value(leaf: Leaf, x: Node, atom: Atom) -> Quotient:
    """The value of a function by the rule of its atom, whose hypotheses are checked."""
    ring, share = leaf.ring, leaf.ring.variable(atom.share)
    if atom.rule in ("range", "pi range", "slope"):
        lo, hi = (rational(n) for n in atom.rest)
        part = ring.add(ring.number(lo), ring.mul(ring.number(hi - lo), share))
        if atom.rule == "range":
            _check_range(leaf, x, lo, hi)
            return part
        if atom.rule == "pi range":
            _check_pi_range(leaf, x, lo, hi)
            return ring.mul(ring.mul(ring.pi, ring.number(fmpq(1, 2))), part)
        _check_slope(leaf, x, lo, hi)
        return ring.mul(leaf(x.args[0]), part)
    if atom.rule in ("above", "below"):
        return _one_end(leaf, x, atom, share)
    if atom.rule == "tangent" and x.op == "exp":  # exp(y) >= 1 + y for every y
        return ring.add(ring.add(ring.number(1), leaf(x.args[0])), share)
    if atom.rule == "chord":
        return _chord(leaf, x, atom, share)
    if atom.rule == "far":
        return _far(leaf, x, share)
    if atom.rule == "root" and x.op == "sqrt":
        return _root(leaf, x, atom, share)
    raise Refused(f"no rule {atom.rule!r} for {x.op}")


def _check_range(leaf: Leaf, x: Node, lo: fmpq, hi: fmpq) -> None:
    low, high = leaf.inside(x)
    if low is None or high is None or low < lo or high > hi:
        raise Refused(f"{x.op} is not within [{decimal(lo)}, {decimal(hi)}]")


def _one_end(leaf: Leaf, x: Node, atom: Atom, share: Quotient) -> Quotient:
    """What is above, or below, a number."""
    end = rational(atom.rest[0])
    low, high = leaf.inside(x)
    above = atom.rule == "above"
    if (low is None or low < end) if above else (high is None or high > end):
        raise Refused(f"{x.op} is not {atom.rule} {decimal(end)}")
    return leaf.ring.add(leaf.ring.number(end), share, 1 if above else -1)


def _chord(leaf: Leaf, x: Node, atom: Atom, share: Quotient) -> Quotient:
    """y^f = 1 + (y - 1) m, 0 < f < 1: m is the slope of the chord from 1 to y of a concave function, and falls with y."""
    y = x.args[0]
    f = fmpq(1, 2)
    if x.op == "pow":
        exponent = leaf(x.args[1])
        if not (exponent.above.is_constant() and exponent.below.is_constant()) or exponent.above == 0:
            raise Refused("the rule 'chord' needs a number as exponent")
        f = fmpq(exponent.above.leading_coefficient()) / fmpq(exponent.below.leading_coefficient())
    if x.op not in ("pow", "sqrt") or not 0 < f < 1:
        raise Refused(f"the rule 'chord' does not fit {x.op}")
    least, most = (rational(n) for n in atom.rest)
    one = node("number", value=fmpq(1))
    below, above, size = (
        leaf.sign_of(node("sub", *p)) for p in ((one, y), (y, one), (y, node("number", value=fmpq(0))))
    )
    if size is None or size[0] < 0:
        raise Refused("the base may be below 0")
    low = f if below is not None and below[0] >= 0 else fmpq(0)
    high = f if above is not None and above[0] >= 0 else fmpq(1)
    if least > low or most < high:
        raise Refused("the slope of the chord is not within its bounds")
    ring = leaf.ring
    slope = ring.add(ring.number(least), ring.mul(ring.number(most - least), share))
    return ring.add(ring.number(1), ring.mul(ring.add(leaf(y), ring.number(1), -1), slope))


def _check_pi_range(leaf: Leaf, x: Node, lo: fmpq, hi: fmpq) -> None:
    if x.op != "atan":
        raise Refused("the rule 'pi range' is for atan")
    low, high = leaf.inside(x.args[0])
    below = lo <= -1 or (low is not None and _at_least(intervals.bound_at("atan", low, False), lo))
    above = hi >= 1 or (high is not None and _at_least(_negative(intervals.bound_at("atan", high, True)), -hi))
    if not (below and above):
        raise Refused(f"atan is not within [{decimal(lo)}, {decimal(hi)}] pi/2")


def _check_slope(leaf: Leaf, x: Node, lo: fmpq, hi: fmpq) -> None:
    if x.op not in ("atan", "tanh"):
        raise Refused("the rule 'slope' is for atan and tanh")
    sign = leaf.sign_of(x.args[0])
    if sign is None or sign[0] < 0:
        raise Refused("the argument may be below 0")
    low, high = leaf.inside(x.args[0])
    if lo > 0:
        least = None if high is None or high <= 0 else intervals.bound_at(x.op, high, False)
        if least is None or high is None or least / high < lo:
            raise Refused(f"{x.op}(y)/y may be below {decimal(lo)}")
    if hi < 1:
        most = None if low is None or low <= 0 else intervals.bound_at(x.op, low, True)
        if most is None or low is None or most / low > hi:
            raise Refused(f"{x.op}(y)/y may be above {decimal(hi)}")


def _far(leaf: Leaf, x: Node, share: Quotient) -> Quotient:
    ring, y = leaf.ring, leaf(x.args[0])
    one = ring.number(1)
    sign = leaf.sign_of(x.args[0])
    if x.op == "atan" and sign == (1, True):
        return ring.add(ring.mul(ring.pi, ring.number(fmpq(1, 2))), ring.div(ring.add(one, share, -1), y), -1)
    if x.op == "tanh" and sign is not None and sign[0] >= 0:
        return ring.add(one, ring.div(share, ring.add(one, y)), -1)
    if x.op == "exp" and sign is not None and sign[0] <= 0:
        square = ring.mul(ring.number(fmpq(1, 2)), ring.mul(y, y))
        return ring.div(share, ring.add(ring.add(one, y, -1), square))
    raise Refused(f"the rule 'far' does not fit {x.op}")


def _root(leaf: Leaf, x: Node, atom: Atom, share: Quotient) -> Quotient:
    y, r = read(atom.rest[0], leaf.names), rational(atom.rest[1])
    below = leaf.sign_of(y)
    rest = node("sub", x.args[0], node("mul", y, y))
    over = leaf.sign_of(rest)
    room = leaf.sign_of(node("sub", node("number", value=r * r), rest))
    if r < 0 or any(sign is None or sign[0] < 0 for sign in (below, over, room)):
        raise Refused("the root is not within y and y + r")
    return leaf.ring.add(leaf(y), leaf.ring.mul(leaf.ring.number(r), share))


def _negative(x: fmpq | None) -> fmpq | None:
    return None if x is None else -x


def _at_least(x: fmpq | None, share: fmpq) -> bool:
    """Whether x >= share pi/2 for sure."""
    if x is None:
        return False
    lo, hi = intervals.PI_HALF
    assert lo is not None
    assert hi is not None
    return bool(x >= share * (hi if share > 0 else lo))

"""Atoms of the ring, which replace functions in a leaf, with rules for their values (docs/reference/certificates.md)."""

from __future__ import annotations

from fractions import Fraction
from math import ceil, floor, isqrt
from typing import TYPE_CHECKING

from stribeck.expressions.graph import Expr, constant, rebuild
from stribeck.expressions.intervals import INF, PI, Range, ends_of
from stribeck.expressions.ops import sqrt
from stribeck.properties.plain import Polynomial
from stribeck.properties.prover.region import down, up
from stribeck.properties.prover.ring import Quotient, Ring, Unclear

if TYPE_CHECKING:
    from stribeck.properties.prover.leaf import Leaf

_MOST = 16  # the largest whole power that is multiplied out


def power(leaf: Leaf, node: Expr, base: Quotient, exponent: Quotient) -> Quotient:
    """base^exponent: whole powers multiplied out, y^(n + f) as y^n y^f with 0 < f < 1.

    Raises:
        Unclear: it may have no value, or the base may be negative.
    """
    ring = leaf.ring
    value = exponent.rational
    if value is not None and value.denominator == 1 and abs(value) <= _MOST:
        return _integer_power(leaf, base, int(value))
    if base.is_zero and leaf.signs(exponent)[0] and leaf.signs(exponent)[2]:
        return ring.zero
    if not leaf.signs(base)[0]:
        raise Unclear("the base of a power may be negative")
    if value is None or not abs(value) < _MOST:
        return ranged(leaf, ring.atom(("pow", base.number, exponent.number), node), node)
    n = floor(value)
    if n == 0:
        return _root_of(leaf, node.args[0], base, value)
    return ring.apply("mul", _integer_power(leaf, base, n), _root_of(leaf, node.args[0], base, value - n))


def _integer_power(leaf: Leaf, base: Quotient, n: int) -> Quotient:
    if n <= 0 and not leaf.signs(base)[2]:
        raise Unclear("the base of a power may be 0")
    power = leaf.ring.one
    for _ in range(abs(n)):
        power = leaf.ring.apply("mul", power, base)
    return power if n >= 0 else leaf.ring.apply("div", leaf.ring.one, power)


def _root_of(leaf: Leaf, node: Expr, base: Quotient, share: Fraction) -> Quotient:
    """base^share for 0 < share < 1, base >= 0."""
    if share == Fraction(1, 2):
        return function(leaf, sqrt(node), base)
    root = node ** constant(float(share))
    if Fraction(float(share)) != share:
        raise Unclear("a power that is no float")
    atom = leaf.ring.atom(("pow", base.number, leaf.ring.constant(share).number), root)
    if leaf.rules.wave == "chord" and _chord(leaf, leaf.ring.index(atom), root, base, share):
        return atom
    return ranged(leaf, atom, root, base)


def function(leaf: Leaf, node: Expr, x: Quotient) -> Quotient:
    """exp, log, sqrt, sin, cos, atan, tanh of what has the normal form x.

    Raises:
        Unclear: it may have no value, or nothing finite is known of it.
    """
    op, ring = node.op, leaf.ring
    if x.is_zero:
        if op == "log":
            raise Unclear("the logarithm of 0")
        return ring.one if op in ("exp", "cos") else ring.zero
    if op in ("sin", "cos") and (wave := _quarter(ring, op, x)) is not None:
        return ring.constant(Fraction(wave))
    if (
        op in ("atan", "tanh", "sin", "cos") and x.top.leading_coefficient() < 0
    ):  # odd, but for cos: one atom for x and -x
        mirrored = function(leaf, rebuild(node, (-node.args[0],)), ring.apply("neg", x))
        return mirrored if op == "cos" else ring.apply("neg", mirrored)
    if op == "sqrt" and (root := _exact_root(leaf, x)) is not None:
        return root
    if op in ("sqrt", "log"):
        above, _, strict = leaf.signs(x)
        if not above or (op == "log" and not strict):
            raise Unclear(f"{op} of what may be negative")
    atom = ring.atom((op, x.number), node)
    index = ring.index(atom)
    if leaf.places[3 + index] is not None:
        return atom
    if op in ("atan", "tanh", "exp") and _special(leaf, op, index, x, node):
        return atom
    if op == "sqrt" and leaf.rules.wave == "far" and _root(leaf, index, x):
        return atom
    if op == "sqrt" and leaf.rules.wave == "chord" and _chord(leaf, index, node, x, Fraction(1, 2)):
        return atom
    return ranged(leaf, atom, node, x)


def _exact_root(leaf: Leaf, x: Quotient) -> Quotient | None:
    """The root of a square of known sign."""
    from flint.utils.flint_exceptions import DomainError

    try:
        root = leaf.ring.quotient(x.top.sqrt(), x.bottom.sqrt())
    except DomainError:
        return None
    above, below, _ = leaf.signs(root)
    return root if above else leaf.ring.apply("neg", root) if below else None


def _chord(leaf: Leaf, index: int, node: Expr, y: Quotient, share: Fraction) -> bool:
    """y^f = 1 + (y - 1) m for 0 < f < 1, where m falls with y, from 1 at y = 0, by f at y = 1, to 0."""
    if leaf.places[3 + index] is not None:
        return True
    parts = leaf.composed_quotient(y)
    if parts is None:
        return False
    top, bottom = parts
    low, high = leaf.box(node.args[0])
    least, most = Fraction(0), Fraction(1)
    if high <= 1 or leaf.signs(leaf.ring.apply("sub", leaf.ring.one, y))[0]:
        least = share
    if low >= 1 or leaf.signs(leaf.ring.apply("sub", y, leaf.ring.one))[0]:
        most = share
    slope = leaf.number(least) + leaf.number(most - least) * leaf.fresh()
    return leaf.set_atom(index, bottom + (top - bottom) * slope, bottom, "chord", least, most)


def _special(leaf: Leaf, op: str, index: int, x: Quotient, node: Expr) -> bool:
    """The rules "far", "slope" and "tangent"."""
    rule = leaf.rules.exp if op == "exp" else leaf.rules.wave
    if rule in ("range", "chord"):
        return False
    above, below, strict = leaf.signs(x)
    fits = rule == "tangent" or (below if op == "exp" else above)
    if not fits or (op == "atan" and rule == "far" and not strict) or (op == "exp" and rule == "slope"):
        return False
    parts = leaf.composed_quotient(x)
    if parts is None:
        return False
    top, bottom = parts
    if rule == "tangent":  # exp(y) = 1 + y + h
        return leaf.set_atom(index, bottom + top + leaf.fresh(positive=True) * bottom, bottom, "tangent")
    share = leaf.fresh()
    if rule == "slope":
        low, high = _falling(op, leaf.box(node.args[0]))
        value = top * (leaf.number(low) + leaf.number(high - low) * share)
        return leaf.set_atom(index, value, bottom, "slope", low, high)
    if op == "atan":
        return leaf.set_atom(index, leaf.pi * top - 2 * (1 - share) * bottom, 2 * top, "far")
    if op == "tanh":
        return leaf.set_atom(index, bottom + top - share * bottom, bottom + top, "far")
    square = bottom * bottom
    return leaf.set_atom(index, 2 * share * square, 2 * square - 2 * top * bottom + top * top, "far")


def _root(leaf: Leaf, index: int, x: Quotient) -> bool:
    """sqrt(x) = u + r c, for x = u^2 + r^2."""
    rest = leaf.ring.apply("sub", x, leaf.ring.apply("mul", leaf.ring.u, leaf.ring.u))
    square = rest.rational
    if square is None or square < 0 or leaf.places[1] is None:
        return False
    r = _root_above(square)
    return leaf.set_atom(index, leaf.places[1] + leaf.number(r) * leaf.fresh(), None, "root", "u", r)


def _root_above(x: Fraction) -> Fraction:
    """A number that is not below the root of x; x may be larger than any float."""
    top = ends_of("sqrt", up(x))[1]
    return Fraction(top) if top < INF else Fraction(isqrt(ceil(x)) + 1)


def _about_1(leaf: Leaf, node: Expr, y: Quotient, known: Range) -> Range:
    """The range of a root, power or logarithm of y, exact at 1 where y is at least or at most 1."""
    at_1 = 0.0 if node.op == "log" else 1.0
    low, high = known
    way = leaf.ring.apply("sub", y, leaf.ring.one)
    if low < at_1 <= high and leaf.signs(way)[0]:
        low = at_1
    if low <= at_1 < high and leaf.signs(way)[1]:
        high = at_1
    return low, high


def ranged(leaf: Leaf, atom: Quotient, node: Expr, argument: Quotient | None = None) -> Quotient:
    """The atom, of which its range is used: a share of it, or what it is above (or below) its one end.

    ``argument`` is that of the function, or the base of the power.

    Raises:
        Unclear: nothing is known of it.
    """
    index = leaf.ring.index(atom)
    if leaf.places[3 + index] is not None:
        return atom
    low, high = leaf.box(node)
    if argument is not None and node.op in ("sqrt", "pow", "log"):
        low, high = _about_1(leaf, node, argument, (low, high))
    if leaf.rules.opaque and not leaf.free:
        return atom
    if not (low > -INF and high < INF):
        if low == -INF and high == INF and leaf.rules.opaque:
            return atom
        if low == -INF and high == INF:
            raise Unclear(f"{node.op} has no finite range here")
        end, rule = (Fraction(low), "above") if low > -INF else (Fraction(high), "below")
        rest = leaf.fresh(positive=True)
        leaf.set_atom(index, leaf.number(end) + (rest if rule == "above" else -rest), None, rule, end)
        return atom
    if node.op == "atan" and leaf.free:
        low_share, high_share = _of_half_pi(low, False), _of_half_pi(high, True)
        value = leaf.pi * (leaf.number(low_share) + leaf.number(high_share - low_share) * leaf.fresh())
        leaf.set_atom(index, value, leaf.number(Fraction(2)), "pi range", low_share, high_share)
        return atom
    a, b = Fraction(low), Fraction(high)
    share: Polynomial = leaf.fresh() if b > a else 0
    leaf.set_atom(index, leaf.number(a) + leaf.number(b - a) * share, None, "range", a, b)
    return atom


def _of_half_pi(x: float, upper: bool) -> Fraction:
    """A bound of atan as a share of pi/2."""
    if abs(x) >= PI[0] / 2:
        return Fraction(1 if x > 0 else -1)
    low, high = sorted((Fraction(x) * 2 / Fraction(PI[0]), Fraction(x) * 2 / Fraction(PI[1])))
    share = high if upper else low
    rounded = Fraction(up(share) if upper else down(share))
    return max(min(rounded, Fraction(1)), Fraction(-1))


def _falling(op: str, y: Range) -> tuple[Fraction, Fraction]:
    """The range of f(y)/y, which falls with y."""
    low, high = Fraction(0), Fraction(1)
    if y[1] < INF and y[1] > 0:
        low = max(Fraction(down(Fraction(ends_of(op, y[1])[0]) / Fraction(y[1]))), Fraction(0))
    if y[0] > 0:
        high = min(Fraction(up(Fraction(ends_of(op, y[0])[1]) / Fraction(y[0]))), Fraction(1))
    return low, high


def _quarter(ring: Ring, op: str, x: Quotient) -> int | None:
    """sin or cos of a whole multiple of pi/2."""
    value = ring.apply("div", ring.apply("mul", x, ring.constant(Fraction(2))), ring.pi).rational
    if value is None or value.denominator != 1:
        return None
    return (0, 1, 0, -1)[(int(value) + (1 if op == "cos" else 0)) % 4]

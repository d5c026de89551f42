"""Whether the equations of a certificate are those of a law: the same operations on the same numbers."""

from __future__ import annotations

from fractions import Fraction
from math import isfinite, isinf
from types import SimpleNamespace

from flint import fmpq

from stribeck.expressions.graph import Expr, constant, symbol, wrap
from stribeck.laws.base import Law
from stribeck.properties.verify_certificate import intervals
from stribeck.properties.verify_certificate.expressions import Node, Refused, names

_ULPS = fmpq(1, 2**50)  # what rounding of numbers with pi in them may have left


def compare(law: Law, dz_dt: Node, force: Node) -> None:
    """Confirm that equations are those of a law with its constants.

    Raises:
        Refused: they differ.
    """
    v, z, rate = symbol("v"), symbol("z"), symbol("dz_dt")
    numbers = law.p.numbers
    made = [  # with numbers folded where they meet, as an evaluation would, and with the constants' names
        SimpleNamespace(**{n: x if x is None else constant(x) for n, x in law.values.items()}, **law.choices),
        law.symbolic(symbol, law.form),
    ]
    for what, stated, own in (
        ("dz/dt", dz_dt, [wrap(law.dz_dt(p, v, z)) for p in made]),
        ("F", force, [wrap(law.friction(p, v, z, rate)) for p in made]),
    ):
        if not any(_Comparison(numbers)(stated, x) for x in own):
            raise Refused(f"the equation of {what} is not that of the law {law.name!r}")


class _Comparison:
    """Node by node, with the values of constants that stand as names."""

    def __init__(self, numbers: dict[str, float]) -> None:
        self.numbers = numbers
        self.known: dict[tuple[Node, Expr], bool] = {}

    def __call__(self, a: Node, b: Expr) -> bool:
        if (a, b) not in self.known:
            self.known[a, b] = self._compared(a, b)
        return self.known[a, b]

    def _compared(self, a: Node, b: Expr) -> bool:
        if b.op == "where" and (decided := _endless(b.args[0])) is not None:
            return self(a, b.args[1 if decided else 2])
        if b.op in ("both", "either"):
            for x, other in (b.args, b.args[::-1]):
                if _endless(x) is (b.op == "both"):  # it decides nothing
                    return self(a, other)
        if b.op == "symbol":
            word = str(b.value)
            return _number(a, self.numbers[word]) if word in self.numbers else a.op == "name" and a.value == word
        if b.op == "constant":
            return _number(a, float(b.value or 0.0))
        same = a.op == b.op and len(a.args) == len(b.args)
        return same and all(self(x, y) for x, y in zip(a.args, b.args, strict=True))


def _endless(c: Expr) -> bool | None:
    """The truth of a condition that comparisons with infinite numbers decide; None where they do not."""
    if c.op in ("both", "either"):
        parts = [_endless(x) for x in c.args]
        decisive = c.op == "either"
        return decisive if decisive in parts else None if None in parts else not decisive
    if c.op not in ("lt", "le"):
        return None
    for side, x in enumerate(c.args):
        if x.op == "constant" and isinf(float(x.value or 0.0)):
            return (float(x.value or 0.0) > 0) == (side == 1)
    return None


def _number(a: Node, x: float) -> bool:
    if not isfinite(x):
        return False
    if a.op == "number":
        return bool(a.value == fmpq(*x.as_integer_ratio()))
    if names(a) - {"pi"}:
        return False
    exact = fmpq(*x.as_integer_ratio())
    lo, hi = intervals.evaluate(a, {})
    return lo is not None and hi is not None and bool(max(abs(lo - exact), abs(hi - exact)) <= _ULPS * abs(exact))


def compare_bound(law: Law, Z: fmpq) -> None:
    """Confirm that Z is the law's own, exactly where rational arithmetic gives it.

    Raises:
        Refused: it differs.
    """
    exact = {n: x if x is None else Fraction(x) for n, x in law.values.items()}
    try:
        own = law.z_bound(SimpleNamespace(**exact, **law.choices))
    except TypeError:
        own = None
    if not isinstance(own, Fraction):  # not a rational function of the constants: up to its rounding
        own = Fraction(float(law.z_bound(law.p)))
        if abs(Fraction(int(Z.p), int(Z.q)) - own) <= own * Fraction(1, 2**50):
            return
    if Fraction(int(Z.p), int(Z.q)) != own:
        raise Refused(f"Z is {float(Fraction(int(Z.p), int(Z.q)))!r}, the law's is {float(own)!r}")

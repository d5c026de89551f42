"""Ranges with exact rational ends, None where there is no end; functions by Arb, rounded outwards."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from flint import arb, ctx, fmpq

from stribeck_verify.expressions import Node, Refused, ordered

PRECISION = 256  # bits
_EXPONENT = 100_000  # beyond 2^+-this a function's value is taken as 0 or without end
_LARGE = 1500  # bits of a fraction from which on it is rounded

Range = tuple[fmpq | None, fmpq | None]
_NONE: Range = (None, None)


def point(x: fmpq | int) -> Range:
    """The range of one number."""
    return fmpq(x), fmpq(x)


def nearest(x: fmpq) -> float:
    """The nearest double, for messages; fractions of python-flint before 0.9 have no float()."""
    return int(x.p) / int(x.q)


def decimal(x: fmpq) -> str:
    """A number for people: the shortest decimal of the nearest double, after "about" unless one of both is the number."""
    try:
        near = nearest(x)
    except OverflowError:
        digits = str(abs(x.p) // x.q)  # of python-flint, which writes any count of digits
        return f"about {'-' if x < 0 else ''}{digits[0]}e{len(digits) - 1}"
    exact = fmpq(*near.as_integer_ratio()) == x or Fraction(repr(near)) == Fraction(int(x.p), int(x.q))
    return f"{'' if exact else 'about '}{near!r}"


def _rounded(x: fmpq, up: bool) -> fmpq:
    p, q = int(x.p), int(x.q)
    if p.bit_length() + q.bit_length() < _LARGE:
        return x
    shift = PRECISION - p.bit_length() + q.bit_length()
    above, below = (p << shift, q) if shift >= 0 else (p, q << -shift)
    whole = -(-above // below) if up else above // below
    return fmpq(whole << -shift, 1) if shift < 0 else fmpq(whole, 1 << shift)


def _made(lo: fmpq | None, hi: fmpq | None) -> Range:
    return (None if lo is None else _rounded(lo, False)), (None if hi is None else _rounded(hi, True))


def add(a: Range, b: Range) -> Range:
    """a + b."""
    return _made(
        None if a[0] is None or b[0] is None else a[0] + b[0], None if a[1] is None or b[1] is None else a[1] + b[1]
    )


def neg(a: Range) -> Range:
    """-a."""
    return (None if a[1] is None else -a[1]), (None if a[0] is None else -a[0])


def mul(a: Range, b: Range) -> Range:
    """a b, of finite numbers within them."""
    low: list[fmpq] = []
    endless_below = endless_above = False
    for x, x_sign in ((a[0], -1), (a[1], 1)):
        for y, y_sign in ((b[0], -1), (b[1], 1)):
            if x is not None and y is not None:
                low.append(x * y)
                continue
            signs = [(end > 0) - (end < 0) if end is not None else way for end, way in ((x, x_sign), (y, y_sign))]
            product = signs[0] * signs[1]
            if product == 0:
                low.append(fmpq(0))
            endless_below, endless_above = endless_below or product < 0, endless_above or product > 0
    return _made(None if endless_below else min(low), None if endless_above else max(low))


def inverse(a: Range) -> Range:
    """1/a.

    Raises:
        Refused: 0 is within a.
    """
    lo, hi = a
    if lo is not None and lo > 0:
        return _made(fmpq(0) if hi is None else 1 / hi, 1 / lo)
    if hi is not None and hi < 0:
        return _made(1 / hi, fmpq(0) if lo is None else 1 / lo)
    raise Refused("a divisor may be 0")


def exact(x: arb, up: bool) -> fmpq | None:
    """An end of a ball as a rational number."""
    if not x.is_finite():
        return None
    mantissa, exponent = (int(n) for n in (x.upper() if up else x.lower()).man_exp())
    size = mantissa.bit_length() + exponent
    if mantissa and size > _EXPONENT:
        return (None if up else fmpq(2) ** _EXPONENT) if mantissa > 0 else (-(fmpq(2) ** _EXPONENT) if up else None)
    if mantissa and size < -_EXPONENT:
        tiny = 1 / fmpq(2) ** _EXPONENT
        return (tiny if up else fmpq(0)) if mantissa > 0 else (fmpq(0) if up else -tiny)
    return fmpq(mantissa) * (fmpq(2) ** exponent if exponent >= 0 else 1 / fmpq(2) ** -exponent)


_AT_0 = {"exp": 1, "sqrt": 0, "sin": 0, "cos": 1, "atan": 0, "tanh": 0}
_ENDS = {"exp": (fmpq(0), None), "tanh": (fmpq(-1), fmpq(1)), "sqrt": (fmpq(0), None), "log": (None, None)}


def bound_at(function: str, x: fmpq, up: bool) -> fmpq | None:
    """An upper or lower bound of a function's value at a rational number."""
    if x == 0 and function in _AT_0:
        return fmpq(_AT_0[function])
    if function == "log" and x == 1:
        return fmpq(0)
    if function == "exp" and abs(x) > 10**9:
        return None if x > 0 and up else (fmpq(2) ** _EXPONENT if x > 0 else (fmpq(1, 2**_EXPONENT) if up else fmpq(0)))
    with ctx.workprec(PRECISION):
        return exact(getattr(arb(x), function)(), up)


def _pi_half() -> Range:
    with ctx.workprec(PRECISION):
        x = arb.pi() / 2
        return exact(x, False), exact(x, True)


PI_HALF = _pi_half()
PI: Range = mul(PI_HALF, point(2))


def rising(function: str, a: Range) -> Range:
    """exp, log, sqrt, atan or tanh over a range."""
    lo, hi = a
    if function in ("log", "sqrt") and (lo is None or lo < 0 or (lo == 0 and function == "log")):
        raise Refused(f"the argument of {function} may be below 0")
    ends = (neg(PI_HALF)[0], PI_HALF[1]) if function == "atan" else _ENDS[function]
    low = ends[0] if lo is None else bound_at(function, lo, False)
    high = ends[1] if hi is None else bound_at(function, hi, True)
    return low, high


def wave(function: str, a: Range) -> Range:
    """Sin or cos over a range."""
    lo, hi = a
    if lo is None or hi is None:
        return fmpq(-1), fmpq(1)
    with ctx.workprec(PRECISION):
        # extrema of sin at (n + 1/2) pi, of cos at n pi: which n are within
        n = [(arb(x) / arb.pi() - (arb(1) / 2 if function == "sin" else 0)) for x in (lo, hi)]
        first, last = (exact(n[0], False), exact(n[1], True))
    if first is None or last is None or last - first > 4:
        return fmpq(-1), fmpq(1)
    values = [bound_at(function, x, up) for x in (lo, hi) for up in (False, True)]
    extremes = [x for x in values if x is not None]
    if len(extremes) != 4:
        return fmpq(-1), fmpq(1)
    extremes += [fmpq(1 if k % 2 == 0 else -1) for k in range(int(first.ceil()), int(last.floor()) + 1)]
    return max(min(extremes), fmpq(-1)), min(max(extremes), fmpq(1))


def power(a: Range, b: Range) -> Range:
    """a^b for a >= 0."""
    lo, hi = a
    if lo is None or lo < 0:
        raise Refused("the base of a power may be below 0")
    if b[0] is not None and b[0] == b[1]:
        if b[0] == 0:
            return point(1)
        if b[0] > 0:
            return (_power(lo, b[0], False) or fmpq(0)), (None if hi is None else _power(hi, b[0], True))
    return rising("exp", mul(b, rising("log", a)))


def _power(x: fmpq, e: fmpq, up: bool) -> fmpq | None:
    if x in (0, 1):
        return x
    with ctx.workprec(PRECISION):
        return exact(arb(x) ** arb(e), up)


def size(a: Range) -> Range:
    """|a|."""
    lo, hi = a
    if lo is not None and lo >= 0:
        return a
    if hi is not None and hi <= 0:
        return neg(a)
    return fmpq(0), None if lo is None or hi is None else max(-lo, hi)


def hull(a: Range, b: Range) -> Range:
    """The least range that holds both."""
    return (
        None if a[0] is None or b[0] is None else min(a[0], b[0]),
        None if a[1] is None or b[1] is None else max(a[1], b[1]),
    )


def evaluate(top: Node, box: Mapping[str, Range]) -> Range:
    """An expression over a box of its names.

    Raises:
        Refused: it may have no value there.
    """
    return Evaluation(box)(top)


def joined(op: str, parts: list[bool | None]) -> bool | None:
    """Whether "both" or "either" of conditions hold, of which some may not be known."""
    decisive = op == "either"
    if decisive in parts:
        return decisive
    return None if None in parts else not decisive


class Evaluation:
    """Expressions over one box; what is shared is evaluated once."""

    def __init__(self, box: Mapping[str, Range], positive: bool = False) -> None:
        self.box = {**box, "pi": PI}
        self.positive = positive  # the names stand for numbers > 0, although their ranges may begin with 0
        self.known: dict[Node, Range] = {}
        self.preset: dict[Node, Range] = {}  # what a condition says of nodes, within its case

    def __call__(self, top: Node) -> Range:
        """The range of an expression.

        Raises:
            Refused: it may have no value.
        """
        if top not in self.known:
            self.known[top] = self._of(top)
        return self.known[top]

    def condition(self, c: Node) -> bool | None:
        """Whether a condition holds all over the box; None where that is not known."""
        if c.op in ("both", "either"):
            return joined(c.op, [self.condition(x) for x in c.args])
        lo, hi = add(self(c.args[1]), neg(self(c.args[0])))
        if c.op == "lt":
            return True if lo is not None and lo > 0 else (False if hi is not None and hi <= 0 else None)
        return True if lo is not None and lo >= 0 else (False if hi is not None and hi < 0 else None)

    def _of(self, x: Node) -> Range:
        if x.op == "number":
            return point(x.value)
        if x.op == "name":
            return self.box[x.value]
        if x.op == "where":
            chosen = self.condition(x.args[0])
            return self._cases(x) if chosen is None else self(x.args[1 if chosen else 2])
        a = self(x.args[0])
        if len(x.args) == 2:
            return self._binary(x, a)
        if x.op == "sign":
            return (
                fmpq(1 if a[0] is not None and a[0] > 0 else (0 if a[0] is not None and a[0] >= 0 else -1)),
                fmpq(-1 if a[1] is not None and a[1] < 0 else (0 if a[1] is not None and a[1] <= 0 else 1)),
            )
        if x.op in ("neg", "abs"):
            return neg(a) if x.op == "neg" else size(a)
        return wave(x.op, a) if x.op in ("sin", "cos") else rising(x.op, a)

    def _cases(self, x: Node) -> Range:
        """Both cases, each on what its condition leaves of the two sides that are compared."""
        c, *cases = x.args
        if c.op not in ("lt", "le"):
            return hull(self(cases[0]), self(cases[1]))
        left, right = c.args
        ranges = []
        for case, (small, large) in zip(cases, ((left, right), (right, left)), strict=True):
            (low, below), (above, high) = self(small), self(large)  # here small <= large
            if low is not None and high is not None and low > high:
                continue
            below = high if below is None else (below if high is None else min(below, high))
            above = low if above is None else (above if low is None else max(above, low))
            inside = Evaluation(self.box, self.positive)
            inside.known = {**self.preset, small: (low, below), large: (above, high)}
            inside.preset = dict(inside.known)
            ranges.append(inside(case))
        if not ranges:
            raise Refused("neither case of a condition can be")
        return ranges[0] if len(ranges) == 1 else hull(ranges[0], ranges[1])

    def _inverse(self, x: Node, b: Range) -> Range:
        sign = _sign(x) if self.positive else 0
        if sign > 0 and b[0] is not None and b[0] <= 0 and (b[1] is None or b[1] > 0):
            return (fmpq(0) if b[1] is None else 1 / b[1]), None
        if sign < 0 and b[1] is not None and b[1] >= 0 and (b[0] is None or b[0] < 0):
            return None, (fmpq(0) if b[0] is None else 1 / b[0])
        return inverse(b)

    def _binary(self, x: Node, a: Range) -> Range:
        b = self(x.args[1])
        if x.op == "mul" and x.args[0] is x.args[1]:
            return mul(size(a), size(a))
        if x.op == "pow":
            return power(a, b)
        if x.op == "div":
            return mul(a, self._inverse(x.args[1], b))
        return mul(a, b) if x.op == "mul" else add(a, b if x.op == "add" else neg(b))


def _sign(x: Node) -> int:
    """1 or -1 where an expression is > 0 or < 0 as every name in it is > 0; 0 where that is not plain."""
    if x.op == "number":
        return int((x.value > 0) - (x.value < 0))
    if x.op in ("name", "exp"):
        return 1
    signs = [_sign(a) for a in x.args]
    if x.op == "neg":
        return -signs[0]
    if x.op == "abs":
        return signs[0] ** 2
    if x.op in ("mul", "div"):
        return signs[0] * signs[1]
    if x.op in ("add", "sub"):
        second = signs[1] if x.op == "add" else -signs[1]
        return signs[0] if signs[0] == second else 0
    return 0


def finite_everywhere(top: Node, box: Mapping[str, Range]) -> bool:
    """Whether an expression is sure to have a value all over a box (no divisor that may be 0, and so on)."""
    evaluation = Evaluation(box)
    try:
        for x in ordered(top):
            if x.op not in ("lt", "le", "both", "either"):
                evaluation(x)
    except Refused:
        return False
    return True

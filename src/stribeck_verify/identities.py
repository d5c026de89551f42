"""Whether two expressions are the same rational function of u, w and of what is opaque; and where cases meet."""

from __future__ import annotations

from collections.abc import Hashable

from flint import fmpq, fmpq_mpoly_ctx

from stribeck_verify.expressions import CONDITIONS, PI, Node, Refused, U, W, by_cases, node, number, ordered, replace
from stribeck_verify.rational import Polynomial

Pair = tuple[Polynomial, Polynomial]  # numerator and denominator
_OPAQUE = 60  # functions and undecided cases in one expression, at most
_AT_0 = {"exp": 1, "sin": 0, "cos": 1, "atan": 0, "tanh": 0, "sqrt": 0, "abs": 0, "sign": 0}
_SINES = (0, 1, 0, -1)
_MOST = 16  # the largest whole power that is multiplied out


class Normal:
    """Expressions as quotients of polynomials in u, w, pi and opaque parts, which are equal where their arguments are.

    ``positive`` are the names of what is known to be > 0, so that abs and sign of products of them are known.
    """

    def __init__(self, positive: tuple[Node, ...] = (U, W)) -> None:
        names = ["u", "w", "pi", *(f"x{i}" for i in range(_OPAQUE))]
        self.context = fmpq_mpoly_ctx.get(names, "lex")
        self.generators = self.context.gens()
        self.one = self.context.constant(1)
        self.positive = positive
        self.known: dict[Node, Pair] = {}
        self.opaque: dict[Hashable, int] = {}

    def __call__(self, top: Node) -> Pair:
        """Numerator and denominator, without common factors, the denominator's leading coefficient 1.

        Raises:
            Refused: a divisor is 0, or too much is opaque.
        """
        if top not in self.known:
            self.known[top] = self._of(top)
        return self.known[top]

    def zero(self, top: Node) -> bool:
        """Whether an expression is 0 identically."""
        return bool(self(top)[0] == 0)

    def key(self, top: Node) -> Hashable:
        """What equal expressions share."""
        if top.op in CONDITIONS[:2]:
            return top.op, *self._key(self(node("sub", top.args[1], top.args[0])))
        if top.op in CONDITIONS:
            return top.op, *(self.key(x) for x in top.args)
        return self._key(self(top))

    @staticmethod
    def _key(x: Pair) -> tuple[Hashable, ...]:
        return tuple(tuple(sorted((m, (int(c.p), int(c.q))) for m, c in part.to_dict().items())) for part in x)

    def _made(self, above: Polynomial, below: Polynomial) -> Pair:
        if below == 0:
            raise Refused("a divisor is 0")
        if above == 0:
            return above, self.one
        common = above.gcd(below)
        above, below = above / common, below / common
        lead = below.leading_coefficient()
        return above / lead, below / lead

    def _of(self, x: Node) -> Pair:
        if x.op == "number":
            return self.context.constant(x.value), self.one
        for i, plain in enumerate((U, W, PI)):
            if x is plain:
                return self.generators[i], self.one
        if x.op == "where":
            return self._case(x)
        if x.op == "neg":
            above, below = self(x.args[0])
            return -above, below
        if x.op in ("add", "sub", "mul", "div"):
            (a, b), (c, d) = self(x.args[0]), self(x.args[1])
            if x.op == "mul":
                return self._made(a * c, b * d)
            if x.op == "div":
                return self._made(a * d, b * c)
            return self._made(a * d + (c * b if x.op == "add" else -c * b), b * d)
        return self._function(x)

    def _case(self, x: Node) -> Pair:
        c, a, b = x.args
        decided = self.decided(c)
        if decided is not None:
            return self(a if decided else b)
        first, second = self(a), self(b)
        if first == second:
            return first
        return self._opaque(("where", self.key(c), self._key(first), self._key(second)))

    def decided(self, c: Node) -> bool | None:
        """A condition whose two sides differ by a number, or by a product of what is known to be > 0."""
        if c.op in ("both", "either"):
            parts = [self.decided(x) for x in c.args]
            decisive = c.op == "either"
            return decisive if decisive in parts else (None if None in parts else not decisive)
        sign = self.sign(node("sub", c.args[1], c.args[0]))
        return None if sign is None else (sign > 0 or (sign == 0 and c.op == "le"))

    def sign(self, x: Node) -> int | None:
        """The sign of a number, or of a number times powers of what is known to be > 0 (and pi)."""
        above, below = self(x)
        if above == 0:
            return 0
        signs = []
        for part in (above, below):
            terms = part.to_dict()
            if len(terms) != 1:
                return None
            ((exponents, c),) = terms.items()
            allowed = [*(x in self.positive for x in (U, W)), True]
            if any(n for n, ok in zip(exponents, allowed, strict=False) if not ok) or any(exponents[3:]):
                return None
            signs.append(1 if c > 0 else -1)
        return signs[0] * signs[1]

    def _function(self, x: Node) -> Pair:
        arguments = [self(a) for a in x.args]
        first = arguments[0]
        if x.op in ("abs", "sign"):
            sign = self.sign(x.args[0])
            if sign is not None:
                return (sign * first[0], first[1]) if x.op == "abs" else (self.context.constant(sign), self.one)
            # |-x| = |x|, sgn(-x) = -sgn(x): the one of the two with a leading coefficient > 0
            flip = first[0].leading_coefficient() < 0
            atom = self._opaque((x.op, self._key((-first[0], first[1]) if flip else first)))
            return (-atom[0], atom[1]) if flip and x.op == "sign" else atom
        if first[0] == 0 and x.op in _AT_0:
            return self.context.constant(_AT_0[x.op]), self.one
        if x.op in ("sin", "cos"):
            quarters = self._quarters(first)
            if quarters is not None:
                return self.context.constant(_SINES[(quarters + (x.op == "cos")) % 4]), self.one
        if x.op == "pow" and (parts := self._power(*arguments)) is not None:
            return parts
        return self._opaque((x.op, *(self._key(a) for a in arguments)))

    def _power(self, y: Pair, power: Pair) -> Pair | None:
        """y^0 = 1; 0^e = 0 for e > 0; y^(n + f) as y^n y^f with n >= 0 whole and 0 <= f < 1, y^(1/2) as a root."""
        if power[0] == 0:
            return self.one, self.one
        if not (power[0].is_constant() and power[1].is_constant()):
            return None
        exact = fmpq(power[0].leading_coefficient()) / fmpq(power[1].leading_coefficient())
        n = int(exact.floor())
        if not 0 <= n <= _MOST:
            return None
        if y[0] == 0:
            return y
        rest = exact - n
        key = ("sqrt", self._key(y)) if rest == fmpq(1, 2) else ("pow", self._key(y), (int(rest.p), int(rest.q)))
        root = self._opaque(key) if rest != 0 else (self.one, self.one)
        return self._made(y[0] ** n * root[0], y[1] ** n * root[1])

    def _quarters(self, x: Pair) -> int | None:
        """n where x is n pi/2."""
        ratio = self._made(x[0] * 2, x[1] * self.generators[2])
        if not (ratio[0].is_constant() and ratio[1].is_constant()):
            return None
        n = fmpq(ratio[0].leading_coefficient()) / fmpq(ratio[1].leading_coefficient())
        return int(n.p) if n.q == 1 else None

    def _opaque(self, key: Hashable) -> Pair:
        if key not in self.opaque:
            if len(self.opaque) == _OPAQUE:
                raise Refused("too many functions in one identity")
            self.opaque[key] = len(self.opaque)
        return self.generators[3 + self.opaque[key]], self.one


def written_out(top: Node) -> Node:
    """The expression with abs and sign of what has no known sign as cases."""
    normal = Normal()
    by: dict[Node, Node] = {}
    for x in ordered(top):
        if x.op in ("abs", "sign"):
            a = replace(x.args[0], by)
            try:
                known = normal.sign(a)
            except Refused:
                known = None
            if known is not None:
                by[x] = number(known) if x.op == "sign" else (a if known >= 0 else node("neg", a))
            else:
                by[x] = by_cases(x.op, a)
    return _replaced(top, by)


def _replaced(top: Node, by: dict[Node, Node]) -> Node:
    """The node with others in place of keys, which may stand within each other."""
    new: dict[Node, Node] = {}
    for x in ordered(top):
        if x in by:
            new[x] = by[x]
        else:
            args = tuple(new[a] for a in x.args)
            new[x] = x if args == x.args else node(x.op, *args)
    return new[top]

"""Elementary statements about a law, which the prover shows over a whole region or not at all."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from fractions import Fraction

from stribeck.expressions.graph import ZERO, Expr, derivative, substitute, symbols
from stribeck.expressions.ops import exp
from stribeck.properties.certificate import Claim
from stribeck.properties.model import REST, SIGNS, Model, U, V, W, Z
from stribeck.properties.plain import Json
from stribeck.properties.prover.region import ExactRange
from stribeck.properties.prover.search import Budget

Ranges = Mapping[str, ExactRange]
NULL = Fraction(0)
_QUADRANT: Ranges = {"u": (NULL, None), "w": (NULL, None)}


class ClaimProver:
    """Builds the expressions of claims and proves them."""

    def __init__(self, model: Model, work: Budget) -> None:
        self.model, self.work = model, work

    @contextmanager
    def at_most(self, amount: float) -> Iterator[None]:
        """Limit the work of the proofs within the context."""
        whole = self.work
        try:
            with whole.limited(amount) as self.work:
                yield
        finally:
            self.work = whole

    def _claim(
        self, about: str, relation: str, sides: tuple[int, int], ranges: Ranges, expr: Expr, closed: bool = False,
        **extra: Json,
    ) -> Claim | None:  # fmt: skip
        kept = {n: r for n, r in ranges.items() if (n == "u" and sides[0]) or (n == "w" and sides[1])}
        cones = about in ("power", "elastic")
        tree = self.model.prover.show(expr, relation, kept, self.work, closed, cones)
        return Claim(about, relation, *sides, kept, tree, extra) if tree is not None else None

    # -- kinds of claims -------------------------------------------------------------------------------------------

    def inward(self, w: ExactRange) -> list[Claim] | None:
        """-sgn(z) dz/dt >= 0 for |z| in w and every v."""
        return every(
            self._claim("inward", ">=0", (s, t), {"u": (NULL, None), "w": w}, self.model.form(s, t) * -t)
            for s in (0, *SIGNS)
            for t in SIGNS
        )

    def power(self, slope: Expr, u: ExactRange, w: ExactRange, z_sides: Iterable[int]) -> list[Claim] | None:
        """F v - S' dz/dt >= 0; S' is an expression of z."""
        lost = self.model.power_force * V - slope * self.model.rate
        return every(
            self._claim("power", ">=0", (s, t), {"u": u, "w": w}, self.model.form_of(lost, s, t), slope=slope)
            for t in z_sides
            for s in (0, *SIGNS)
        )

    def rising(self, slope: Expr, w: ExactRange) -> list[Claim] | None:
        """S' sgn z >= 0."""
        return every(
            self._claim("slope sign", ">=0", (0, t), {"w": w}, self.model.form_of(slope, 0, t) * t, slope=slope)
            for t in SIGNS
        )

    def lipschitz(self, sides: tuple[int, int], w: ExactRange, growth: Mapping[str, Json], sign: int) -> Claim | None:
        """sign d(dz/dt)/dw <= (a + b u^k)(1 + (w/l)^m)."""
        a, b, length = (self.model.number(growth[n]) for n in "abl")
        most = (a + b * U ** growth["k"]) * (1 + (W / length) ** growth["m"])
        if sides[0] == 0:
            most = substitute([most], {U: REST})[0]
        slope = derivative(self.model.form(*sides), W)
        return self._claim(
            "lipschitz", ">=0", sides, {"u": (NULL, None), "w": w}, most - slope * sign, sign=sign, **growth
        )

    def grows(self, sides: tuple[int, int], growth: Mapping[str, Json]) -> Claim | None:
        """sgn(z) dz/dt <= (a + b u^k)(w + l)."""
        a, b, length = (self.model.number(growth[n]) for n in "abl")
        u = U if sides[0] else REST
        most = (a + b * u ** growth["k"]) * (W + length)
        extra = {n: x for n, x in growth.items() if n != "m"}
        return self._claim(
            "growth", ">=0", sides, {"u": (NULL, None), "w": (NULL, None)},
            most - self.model.form(*sides) * sides[1], **extra,
        )  # fmt: skip

    def finite(self, v_side: int, growth: Mapping[str, Json], sign: int) -> Claim | None:
        """sign dz/dt <= a + b u^k at z = 0."""
        a, b = (self.model.number(growth[n]) for n in "ab")
        u = U if v_side else REST
        extra = {n: growth[n] for n in "abk"}
        return self._claim(
            "finite", ">=0", (v_side, 0), {"u": (NULL, None)},
            a + b * u ** growth["k"] - self.model.form(v_side, 0) * sign, sign=sign, **extra,
        )  # fmt: skip

    def elastic(self, w: ExactRange) -> list[Claim] | None:
        """dz/dt = v."""
        return every(
            self._claim(
                "elastic", "=0", (s, t), {"u": (NULL, None), "w": w},
                self.model.form(s, t) - (U * s if s else REST),
            )
            for s in (0, *SIGNS)
            for t in (0, *SIGNS)
        )  # fmt: skip

    # -- F = k z + s exp(-(v/d)^2) dz/dt + c v, dz/dt = v - q z ------------------------------------------------------

    def force_form(self, s: int, t: int, data: Mapping[str, Fraction]) -> bool:
        """Whether F is k z + s exp(-(v/d)^2) dz/dt + c v."""
        k, sigma_1, d, c = (self.model.number(data[n]) for n in "ksdc")
        stated = k * Z + sigma_1 * exp(-((V / d) ** 2)) * self.model.rate + c * V
        form = self.model.form_of(self.model.power_force - stated, s, t)
        return self._claim("force form", "=0", (s, t), _QUADRANT, form) is not None

    def follows(self, s: int) -> Claim | None:
        """dz/dt = v at z = 0."""
        return self._claim("elastic", "=0", (s, 0), _QUADRANT, self._decay(s, 0))

    def decays(self, s: int, t: int) -> Claim | None:
        """(v - dz/dt) sgn z >= 0."""
        return self._claim("decay", ">=0", (s, t), _QUADRANT, self._decay(s, t) * t)

    def exceeds(self, s: int, t: int, data: Mapping[str, Fraction]) -> Claim | None:
        """k (|v| + above) |z| - N (v - dz/dt) sgn z >= 0."""
        k, above, least = (self.model.number(data[n]) for n in ("k", "above", "N"))
        u = U if s else REST
        most = k * (u + above) * W - least * self._decay(s, t) * t
        numbers: dict[str, Json] = {n: data[n] for n in ("k", "above", "N")}
        return self._claim("excess", ">=0", (s, t), _QUADRANT, most, **numbers)

    def _decay(self, s: int, t: int) -> Expr:
        return self.model.form_of(V - self.model.rate, s, t)

    def identity(self, sides: tuple[int, int], a: Expr, b: Expr, ranges: Ranges, **extra: Json) -> Claim | None:
        """a = b for all u and w."""
        kept = {n: r for n, r in ranges.items() if n in symbols([a, b])}
        difference = ZERO if a is b else a - b
        return self._claim("switching", "=0", sides, kept, difference, **extra, a=a, b=b)

    def divisor(self, sides: tuple[int, int], expr: Expr, relation: str, ranges: Ranges) -> Claim | None:
        """An expression that must not be 0, on closed ranges."""
        return self._claim("divisor", relation, sides, ranges, expr, closed=True, expression=expr)


def every(claims: Iterable[Claim | None]) -> list[Claim] | None:
    """All of the claims, or None if one could not be shown."""
    proved = []
    for claim in claims:
        if claim is None:
            return None
        proved.append(claim)
    return proved

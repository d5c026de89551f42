"""Switching surfaces of an equation's cases, with exact tests of values and derivatives there."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

from stribeck.expressions.graph import Expr, derivative, ordered, rewrite, substitute, wrap
from stribeck.properties.certificate import Claim
from stribeck.properties.claims import NULL, ClaimProver
from stribeck.properties.model import REST, SIGNS, Model, U, W, depends

EVERYWHERE: dict[str, tuple[Fraction, Fraction | None]] = {"u": (NULL, None), "w": (NULL, None)}


@dataclass(frozen=True)
class SwitchingSurface:
    """A condition in a form of an equation, and the form for each outcome."""

    sides: tuple[int, int]
    condition: Expr
    if_true: Expr
    if_false: Expr

    @property
    def text(self) -> str:
        """Its text for reports."""
        return f"{self.condition!r} changes"


def switching_surfaces(form: Expr, sides: tuple[int, int]) -> Iterator[SwitchingSurface]:
    """Every condition of a form."""
    conditions = dict.fromkeys(node.args[0] for node in ordered([form]) if node.op == "where")
    for condition in conditions:
        if condition.op in ("lt", "le"):
            yield SwitchingSurface(sides, condition, settled(form, condition, True), settled(form, condition, False))


def settled(form: Expr, condition: Expr, holds: bool) -> Expr:
    """The expression for a given outcome of a condition."""

    def rule(node: Expr) -> Expr:
        if node.op == "where" and node.args[0] is condition:
            return node.args[1 if holds else 2]
        return node

    return rewrite([form], rule)[0]


class Joints:
    """Proves that cases agree at switching surfaces, for dz/dt or another expression of v and z."""

    def __init__(self, model: Model, claims: ClaimProver, expr: Expr) -> None:
        self.model, self.claims, self.expr = model, claims, expr

    def at_condition(self, surface: SwitchingSurface, order: int) -> list[Claim] | None:
        """Both forms agree at the surface: in value, and with order 1 in first derivatives."""
        pairs = [(surface.if_true, surface.if_false)]
        if order:
            pairs += [(derivative(surface.if_true, x), derivative(surface.if_false, x)) for x in (U, W)]
        proofs: list[Claim] = []
        for a, b in pairs:
            claims = next((c for c in self._claims_on_sides(surface, a, b) if c is not None), None)
            if claims is None:
                return None
            proofs += claims
        return proofs

    def _claims_on_sides(self, surface: SwitchingSurface, a: Expr, b: Expr) -> Iterator[list[Claim] | None]:
        less, more = surface.condition.args
        extra = {"condition": surface.condition}
        for start, end in ((less, more), (more, less)):
            if start.op != "constant":
                yield self._replaced(surface, a, b, start, end, [], extra)
        difference = less - more
        for x in (W, U):
            slope = derivative(difference, x)
            if depends(difference, x) and not depends(slope, x):
                steep = self.claims.divisor(surface.sides, slope, "!=0", present(slope))
                if steep is not None:
                    end = -substitute([difference], {x: wrap(0)})[0] / slope
                    yield self._replaced(surface, a, b, x, end, [steep], extra)

    def _replaced(
        self,
        surface: SwitchingSurface,
        a: Expr,
        b: Expr,
        start: Expr,
        end: Expr,
        also: list[Claim],
        extra: dict[str, Expr],
    ) -> list[Claim] | None:
        left, right = substitute([a, b], {start: end})
        claim = self.claims.identity(surface.sides, left, right, EVERYWHERE, there=[[start, end]], **extra)
        return [claim, *also] if claim is not None else None

    def at_axis(self, axis: str, side: int, order: int) -> list[Claim] | None:
        """The forms on both sides of z = 0 (or v = 0) agree with each other and with the form exactly at 0."""
        here = W if axis == "z" else U
        sides = [(side, t) if axis == "z" else (t, side) for t in (*SIGNS, 0)]
        above, below, exact = (self.model.form_of(self.expr, *each) for each in sides)
        pairs = [(above, exact), (below, exact)]
        if order:
            for x in (U, W):
                a, b = derivative(above, x), derivative(below, x)
                pairs.append((a, -b if x is here else b))
        proofs = []
        for a, b in pairs:
            left, right = substitute([a, b], {here: REST})
            claim = self.claims.identity(sides[0], left, right, EVERYWHERE, axis=axis, side=side)
            if claim is None:
                return None
            proofs.append(claim)
        return proofs


def present(expr: Expr) -> dict[str, tuple[Fraction, Fraction | None]]:
    """The ranges of the variables in an expression."""
    return {n: r for n, r in EVERYWHERE.items() if depends(expr, {"u": U, "w": W}[n])}

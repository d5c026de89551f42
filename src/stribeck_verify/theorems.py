"""The theorems that a certificate may use, and what each needs. Nothing else is accepted."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise, product

from flint import fmpq

from stribeck_verify import claims as of
from stribeck_verify import fields, intervals, schema
from stribeck_verify.claims import Claim, Law
from stribeck_verify.expressions import (
    CONDITIONS,
    PI,
    Json,
    Node,
    Refused,
    U,
    W,
    name,
    names,
    node,
    number,
    ordered,
    rational,
    read,
    replace,
)
from stribeck_verify.identities import Normal
from stribeck_verify.intervals import Range, decimal
from stribeck_verify.leaf import Leaf, Region
from stribeck_verify.meeting import Cases, Place, agree_on_axis, depends, meets

FORMAT = 1
PROPERTIES = ("unique", "bounded", "smooth", "passive", "drift_free")
KEYS = frozenset((
    "format", "law", "property", "v_max", "constants", "definitions", "dz_dt", "force", "Z", "theorem", "data", "claims",
    "hypotheses", "level",
))  # fmt: skip
UNREADABLE = (KeyError, TypeError, ValueError, AttributeError, IndexError, RecursionError)
SIGNS = (1, -1, 0)
ENDLESS: Range = (fmpq(0), None)
_DEEPEST = 4  # certificates within certificates


@dataclass
class Case:
    """A certificate whose fields have been read: its equations, claims, and what its theorem takes."""

    name: str
    property: str
    theorem: str
    law: Law
    Z: fmpq
    v_max: fmpq | None
    claims: list[Claim]
    facts: Mapping[str, Json]
    hypotheses: Mapping[str, Case]

    def proved(self, about: str, relation: str, closed: bool = False) -> list[Claim]:
        """The claims about something, each proved by its tree.

        Raises:
            Refused: one does not hold, or states another relation.
        """
        claims = [c for c in self.claims if c.about == about]
        for claim in claims:
            if claim.data.get("relation") != relation:
                raise Refused(f"claim {about}: the relation must be {relation}")
            of.prove(claim, self.law, closed)
        return claims

    def hypothesis(self, name: str) -> Case | None:
        """The certificate of another property of the same law, confirmed; None where there is none."""
        if name not in self.hypotheses:
            return None
        case = self.hypotheses[name]
        prove(case)
        if not (case.law == self.law and case.Z == self.Z and case.property == name):
            raise Refused(f"the hypothesis {name} is about another law")
        return case


def read_case(data: Json, depth: int = 0) -> Case:
    """A certificate's fields, each by its type, and those of the certificates within it.

    Raises:
        Refused: one is missing, of another type or unknown.
    """
    if not isinstance(data, dict):
        raise Refused(f"a certificate must be a table: {data!r}")
    if depth > _DEEPEST:
        raise Refused("too many certificates within each other")
    if unknown := [key for key in data if key not in KEYS]:
        raise Refused(f"no certificate has {unknown[0]!r}")
    fields.whole(data, "format", FORMAT, FORMAT)
    title = fields.text(data, "law")
    for value in fields.table(data, "constants").values():
        rational(value)
    for ends in fields.table(data, "level").values():
        schema.ends(ends)
    kind = fields.text(data, "property", PROPERTIES), fields.text(data, "theorem")
    if kind not in schema.DATA:
        raise Refused(f"no theorem {kind[1]!r} for {kind[0]!r}")
    facts = fields.table(data, "data")
    schema.DATA[kind].check(f"data of {kind[1]!r}", facts)
    claims = [of.read_claim(c) for c in fields.items(data, "claims")]
    hypotheses = {}
    for name_, each in fields.table(data, "hypotheses").items():
        if name_ not in schema.HYPOTHESES.get(kind, ()):
            raise Refused(f"no hypothesis of {kind[1]!r} is {name_!r}")
        hypotheses[name_] = read_case(each, depth + 1)
        if hypotheses[name_].name != title:
            raise Refused(f"the hypothesis {name_} is about another law")
    law, Z, v_max = _read_law(data), rational(data.get("Z")), fields.limit(data, "v_max")
    return Case(title, *kind, law, Z, v_max, claims, facts, hypotheses)


def _read_law(data: Mapping[str, Json]) -> Law:
    known = {n: name(n) for n in ("v", "z", "dz_dt", "u", "w")} | {"pi": PI}
    for pair in fields.items(data, "definitions"):
        if not isinstance(pair, list) or len(pair) != 2 or not isinstance(pair[0], str):
            raise Refused(f"definitions: {pair!r}: must be a name and an expression")
        word, expression = pair
        if word in known or not word.isidentifier():
            raise Refused(f"{word!r} cannot be defined")
        known[word] = read(expression, known)
    law = Law(read(data.get("dz_dt"), known), read(data.get("force"), known))
    if {law.dz_dt.op, law.force.op} & set(CONDITIONS):
        raise Refused("the equations must be numbers, not conditions")
    if names(law.dz_dt) - {"v", "z", "pi"} or names(law.force) - {"v", "z", "dz_dt", "pi"}:
        raise Refused("the equations may depend on v and z only, the force on dz/dt too")
    return law


def prove(case: Case) -> None:
    """Confirm a certificate that has been read.

    Raises:
        Refused: with what could not be confirmed.
    """
    THEOREMS[case.property, case.theorem](case)


def need(claims: list[Claim], s: int, t: int, u: Range, w: Range) -> None:
    """Claims must cover a region of the side (s, t).

    Raises:
        Refused: they do not.
    """
    whole = {n: r for n, r, sign in (("u", u, s), ("w", w, t)) if sign != 0}
    parts = [c.region for c in claims if (c.s, c.t) == (s, t)]
    if not of.covers(parts, whole):
        raise Refused(f"the claims do not cover v {'0+-'[s]}, z {'0+-'[t]}")


# -- bounded ------------------------------------------------------------------------------------------------------------


def outside(case: Case) -> None:
    """|z| does not grow while it is Z or more: then it stays below Z."""
    _at_least_positive(case.Z)
    claims = case.proved("inward", ">=0")
    for s in SIGNS:
        for t in (1, -1):
            need(claims, s, t, ENDLESS, (case.Z, None))


def edge(case: Case) -> None:
    """dz/dt points inwards at |z| = Z, and solutions are unique beyond."""
    _at_least_positive(case.Z)
    claims = case.proved("inward", ">=0")
    for s in SIGNS:
        for t in (1, -1):
            need(claims, s, t, ENDLESS, (case.Z, case.Z))
    if "unique" not in case.hypotheses:
        raise Refused("the theorem 'edge' needs that solutions are unique")
    unique = case.hypotheses["unique"]
    if unique.law != case.law:
        raise Refused("the hypothesis unique is about another law")
    _locally_unique(unique, (fmpq(0), 2 * case.Z))


def _at_least_positive(x: fmpq) -> None:
    if x <= 0:
        raise Refused(f"{decimal(x)} must be > 0")


# -- unique -------------------------------------------------------------------------------------------------------------


def lipschitz(case: Case) -> None:
    """dz/dt is continuous in z with bounded slopes, and no solution escapes."""
    within = case.facts.get("within")
    if within not in (None, "Z") and rational(within) < case.Z:
        raise Refused(f"solutions are unique within {within!r} only")
    slopes = _locally_unique(case, (fmpq(0), None if within is None else case.Z))
    growth = case.proved("growth", ">=0")
    if growth and within is None:
        for s in SIGNS:
            for t in (1, -1):
                need(growth, s, t, ENDLESS, ENDLESS)
    elif (within is not None or any(c.data.get("m") for c in slopes)) and case.hypothesis("bounded") is None:
        raise Refused("nothing says that solutions exist for all times")


def _locally_unique(case: Case, reach: Range) -> list[Claim]:
    """Solutions exist and do not part while |z| is in a range: dz/dt is Lipschitz in z there."""
    slopes = case.proved("lipschitz", ">=0")
    for sign in (1, -1):
        chosen = [c for c in slopes if c.data.get("sign") == sign]
        for s in SIGNS:
            for t in (1, -1):
                need(chosen, s, t, ENDLESS, reach)
    finite = case.proved("finite", ">=0")
    for sign in (1, -1):
        for s in SIGNS:
            need([c for c in finite if c.data.get("sign") == sign], s, 0, ENDLESS, ENDLESS)
    _continuous_in_z(case, reach)
    return slopes


def _continuous_in_z(case: Case, reach: Range) -> None:
    for s in SIGNS:
        forms = []
        for t in (1, -1):
            form = Cases(case.law.rate(s, t))
            domain = {n: r for n, r in (("u", ENDLESS), ("w", reach)) if n == "w" or s != 0}
            meets(form, [W], list(_places(case, s, t)), [x for x, _ in _divisors(case, False)], domain)
            forms.append((form, t))
        agree_on_axis(forms, W, case.law.rate(s, 0))


def _places(case: Case, s: int, t: int) -> Iterator[Place]:
    for c in case.claims:
        if c.about == "switching" and (c.s, c.t) == (s, t):
            for what, to in fields.items(c.data, "there"):
                yield Place(*(read(x, {"u": U, "w": W, "pi": PI}) for x in (what, to)))


def _divisors(case: Case, closed: bool) -> Iterator[tuple[Node, bool]]:
    """Expressions that claims show to be not 0 for all u, w, and whether they are shown to be > 0."""
    for c in case.claims:
        if c.about == "divisor" and c.data.get("relation") in ("!=0", ">0"):
            part = of.subject(c, case.law)
            used = {n: ENDLESS for n, x in (("u", U), ("w", W)) if depends(part, [x])}
            if all(c.region.get(n) == r for n, r in used.items()):
                of.prove(c, case.law, closed)
                yield part, c.data["relation"] == ">0"


# -- smooth -------------------------------------------------------------------------------------------------------------


def smooth(case: Case) -> None:
    """dz/dt and F are analytic but where cases meet, and there values and first derivatives agree."""
    shown = list(_divisors(case, True))
    not_zero = [x for x, _ in shown]
    law = case.law
    quadrant = {"u": ENDLESS, "w": ENDLESS}
    for build in (law.rate, law.load):
        forms = {}
        for s in (1, -1):
            for t in (1, -1):
                form = forms[s, t] = Cases(build(s, t), order=1)
                _singular_nowhere(form.value, shown)
                meets(form, [U, W], list(_places(case, s, t)), not_zero, quadrant)
        for s in (1, -1):
            agree_on_axis([(forms[s, 1], 1), (forms[s, -1], -1)], W, build(s, 0))
        for t in (1, -1):
            agree_on_axis([(forms[1, t], 1), (forms[-1, t], -1)], U, build(0, t))
        agree_on_axis([(Cases(build(0, t)), t) for t in (1, -1)], W, build(0, 0))


def _singular_nowhere(top: Node, shown: list[tuple[Node, bool]]) -> None:
    normal = Normal()
    quadrant = {"u": ENDLESS, "w": ENDLESS}
    whole = Leaf(Region(quadrant, quadrant, False), [])
    positive = {normal.key(x) for x, above in shown if above}
    other = {normal.key(x) for x, _ in shown}
    for x in ordered(top):
        if x.op not in ("div", "log", "sqrt", "pow"):
            continue
        part = x.args[1] if x.op == "div" else x.args[0]
        sign = whole.sign_of(part)
        if sign is not None and sign[1] and (x.op == "div" or sign[0] > 0):
            continue
        if x.op == "pow" and x.args[1].op == "number" and x.args[1].value > 1 and sign is not None and sign[0] >= 0:
            continue  # y^e has the derivative e y^(e - 1), which is continuous for y >= 0 too
        key = normal.key(part)
        if key not in (other if x.op == "div" else positive):
            raise Refused(f"{x.op} may be singular")


# -- passive ------------------------------------------------------------------------------------------------------------


def storage(case: Case) -> None:
    """The power F v is at least the slope of a storage function times dz/dt, for all v and z."""
    u: Range = (fmpq(0), case.v_max)
    bounded = case.hypothesis("bounded")
    w: Range = (fmpq(0), None if bounded is None else case.Z)
    power = case.proved("power", ">=0")
    by_slope: dict[Node, list[Claim]] = {}
    for c in power:
        by_slope.setdefault(of.read_slope(c.data["slope"]), []).append(c)
    for t in (1, -1):
        ranges = []
        for slope, claims in by_slope.items():
            ranges += [{"w": r} for r in _served(claims, t, u)]
            _has_integral(slope, t, w, claims)
        if not of.covers(ranges, {"w": w}):
            raise Refused("the slopes of the storage function do not cover z")
    for s in SIGNS:
        need(power, s, 0, u, w)
    if w[1] is None:
        signs = case.proved("slope sign", ">=0")
        for t in (1, -1):
            for slope in by_slope:
                chosen = [c for c in signs if c.t == t and of.read_slope(c.data["slope"]) is slope]
                parts = [{"w": c.w} for c in chosen if c.w is not None]
                if not all(of.covers(parts, {"w": reach}) for reach in _served(by_slope[slope], t, u)):
                    raise Refused("nothing says that the storage function has a lower bound")


def damped(case: Case) -> None:
    """F = k z + s exp(-(v/d)^2) f + c v and f = v - q z with 0 <= N q <= k (|v| + m_0), s (d/sqrt(2 e) + m_0) <= 4 N.

    With a = s exp(-(v/d)^2): a q <= (k/N) s (d/sqrt(2 e) + m_0) <= 4 k, as x exp(-x^2) <= 1/sqrt(2 e). So F v - k z f
    = k q z^2 - a q z v + (a + c) v^2 >= 0 for every z: its discriminant is q (a^2 q - 4 k (a + c)) v^2.
    """
    data = case.facts
    k, s, d, c, least, above = (rational(data[n]) for n in ("k", "s", "d", "c", "N", "above"))
    for x in (k, d, least):
        _at_least_positive(x)
    if min(s, c, above) < 0:
        raise Refused("the theorem 'damped' needs s, c, above >= 0")
    _decays_fast(s, d, c, least, above, [rational(x) for x in fields.items(data, "knots")])
    identity = Normal()
    for side, t in product(SIGNS, SIGNS):
        place = of.signed(side, U), of.signed(t, W), case.law.rate(side, t)
        stated = _damped_load([number(x) for x in (k, s, d, c)], *place)
        if not identity.zero(node("sub", case.law.load(side, t), stated)):
            raise Refused("the force is not k z + s exp(-(v/d)^2) dz/dt + c v")
    elastic, decay, excess = case.proved("elastic", "=0"), case.proved("decay", ">=0"), case.proved("excess", ">=0")
    if any([rational(x.data[n]) for n in ("k", "above", "N")] != [k, above, least] for x in excess):
        raise Refused("claim excess: other numbers than the theorem's")
    for side in SIGNS:
        need(elastic, side, 0, ENDLESS, ENDLESS)
        for t in (1, -1):
            need(decay, side, t, ENDLESS, ENDLESS)
            need(excess, side, t, ENDLESS, ENDLESS)


def _decays_fast(s: fmpq, d: fmpq, c: fmpq, least: fmpq, above: fmpq, knots: Sequence[fmpq]) -> None:
    """s (d/sqrt(2 e) + above) <= 4 N; or s E (d x + above) <= 4 N (1 + c/(s E)), E = exp(-x^2), between and beyond knots."""
    if not knots:
        room, e = 4 * least - s * above, intervals.bound_at("exp", fmpq(1), False)
        if e is None or room < 0 or (s * d) ** 2 > 2 * e * room**2:
            raise Refused("s (d/sqrt(2 e) + above) <= 4 N does not hold")
        return
    if knots[0] != 0 or knots[-1] < 1 or any(a >= b for a, b in pairwise(knots)):
        raise Refused("the knots do not rise from 0 to 1 or beyond")
    for x, end in pairwise([*knots, knots[-1]]):  # E there, x here: as E falls, the left falls and the right rises
        share = intervals.bound_at("exp", -x * x, True)
        if share is None or s * s * share * share * (d * end + above) > 4 * least * (s * share + c):
            raise Refused(
                f"s^2 E^2 (d x + above) <= 4 N (s E + c) is not shown between {decimal(x)} and {decimal(end)}"
            )


def _damped_load(numbers: Sequence[Node], v: Node, z: Node, f: Node) -> Node:
    """k z + s exp(-(v/d)^2) f + c v."""
    k, s, d, c = numbers
    share = node("exp", node("neg", node("mul", node("div", v, d), node("div", v, d))))
    return node("add", node("add", node("mul", k, z), node("mul", node("mul", s, share), f)), node("mul", c, v))


def reaches(case: Case, v_max: float | None) -> None:
    """The certificate must be about every speed up to ``v_max`` (None: about every speed)."""
    if case.v_max is not None and (v_max is None or case.v_max < fmpq(*v_max.as_integer_ratio())):
        raise Refused(f"it is about speeds up to {decimal(case.v_max)} m/s only")


def _served(claims: list[Claim], t: int, u: Range) -> list[Range]:
    """The cells of |z| on which one slope serves for every v."""
    slices = [c for c in claims if c.t == t]
    ends = sorted({x for c in slices if c.w is not None for x in c.w if x is not None})
    cells: list[Range] = list(pairwise(ends))
    if any(c.w is not None and c.w[1] is None for c in slices):
        cells.append((ends[-1], None))
    served = []
    for cell in cells:
        try:
            for s in SIGNS:
                need(slices, s, t, u, cell)
        except Refused:
            continue
        served.append(cell)
    return served


def _has_integral(slope: Node, t: int, w: Range, claims: list[Claim]) -> None:
    """The slope is bounded on every finite range of its cells, so that S exists."""
    form = replace(slope, {of.Z_NAME: of.signed(t, W)})
    for c in claims:
        if c.t == t and c.w is not None and not of.bounded_on(form, "w", c.w):
            raise Refused("the slope of the storage function may have no bound")


# -- drift ----------------------------------------------------------------------------------------------------------------


def elastic(case: Case) -> None:
    """dz/dt = v for |z| <= z_0."""
    z_0 = rational(case.facts["z_0"])
    _at_least_positive(z_0)
    claims = case.proved("elastic", "=0")
    for s, t in product(SIGNS, SIGNS):
        need(claims, s, t, ENDLESS, (fmpq(0), z_0))


THEOREMS: dict[tuple[str, str], Callable[[Case], None]] = {
    ("bounded", "outside"): outside,
    ("bounded", "edge"): edge,
    ("unique", "lipschitz"): lipschitz,
    ("smooth", "switching"): smooth,
    ("passive", "storage"): storage,
    ("passive", "damped"): damped,
    ("drift_free", "elastic"): elastic,
}

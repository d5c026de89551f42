"""Where the cases of an expression meet: values, and for smoothness first derivatives, must agree there.

At a place where a comparison l < r (or l <= r) changes, l = r. There every comparison whose two sides become equal too
is at its own edge: the values for all combinations of their truths must be the same.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import product

from flint import fmpq

from stribeck_verify.expressions import ZERO, Node, Refused, U, W, derivative, node, ordered
from stribeck_verify.identities import Normal, Pair, written_out
from stribeck_verify.intervals import Evaluation, Range
from stribeck_verify.leaf import Leaf, Region

_MOST = 5  # comparisons that meet at one place, at most
TRUE, FALSE = node("le", ZERO, ZERO), node("lt", ZERO, ZERO)


@dataclass(frozen=True)
class Place:
    """A place given by an equation: ``what`` = ``to`` there."""

    what: Node
    to: Node


@dataclass
class Cases:
    """An expression of u, w > 0 with its cases written out, and its derivatives where ``order`` is 1."""

    value: Node
    order: int = 0

    def __post_init__(self) -> None:
        self.value = known_decided(without_extremes(written_out(self.value)))

    def comparisons(self) -> Iterator[Node]:
        """Those in the expression, each once."""
        for x in ordered(self.value):
            if x.op in ("lt", "le") and x not in (TRUE, FALSE):
                yield x

    def all_at(self, place: Place, normal: Normal, domain: Mapping[str, Range]) -> list[tuple[Pair, ...]]:
        """The values (and derivatives) at a place, for every truth of the comparisons that meet there.

        Other comparisons are decided where intervals over the domain of u and w do it.
        """
        ties = [c for c in self.comparisons() if normal.zero(moved(node("sub", c.args[1], c.args[0]), place, normal))]
        if len(ties) > _MOST:
            raise Refused("too many cases meet at one place")
        forms = []
        for truths in product((TRUE, FALSE), repeat=len(ties)):
            value = put(self.value, dict(zip(ties, truths, strict=True)))
            parts = [value] if self.order == 0 else [value, derivative(value, U), derivative(value, W)]
            forms.append(tuple(normal(decided_on(moved(part, place, normal), domain)) for part in parts))
        return forms


def put(top: Node, by: dict[Node, Node]) -> Node:
    """The node with others in place of keys, nothing else changed."""
    new: dict[Node, Node] = {}
    for x in ordered(top):
        args = tuple(new[a] for a in x.args)
        new[x] = by[x] if x in by else (x if args == x.args else node(x.op, *args))
    return new[top]


def moved(top: Node, place: Place, normal: Normal) -> Node:
    """The expression at a place: what equals ``what`` replaced by ``to``."""
    if place.what.op == "name":
        return put(top, {place.what: place.to})
    key = normal.key(place.what)
    by = {}
    for x in ordered(top):
        if x.op not in ("number", "lt", "le", "both", "either"):
            try:
                if normal.key(x) == key:
                    by[x] = place.to
            except Refused:
                continue
    return put(top, by)


def known_decided(top: Node) -> Node:
    """The expression with comparisons that positivity of u and w decides."""
    normal = Normal()
    by = {}
    for x in ordered(top):
        if x.op in ("lt", "le"):
            try:
                decided = normal.decided(x)
            except Refused:
                decided = None
            if decided is not None:
                by[x] = TRUE if decided else FALSE
    return put(top, by)


def without_extremes(top: Node) -> Node:
    """The expression with where(l < r, l, r), and the like, as the one that is the smaller (or larger) for all u, w >= 0."""
    evaluation = Evaluation({n: (fmpq(0), None) for n in ("u", "w")})
    new: dict[Node, Node] = {}
    for x in ordered(top):
        args = tuple(new[a] for a in x.args)
        new[x] = x if args == x.args else node(x.op, *args)
        if x.op == "where" and x.args[0].op in ("lt", "le") and set(x.args[1:]) == set(x.args[0].args):
            less, more = x.args[0].args
            with suppress(Refused, KeyError):
                low, high = evaluation(node("sub", more, less))
                if low is not None and low >= 0:
                    new[x] = args[1]  # where the two are equal it does not matter which
                elif high is not None and high <= 0:
                    new[x] = args[2]
    return new[top]


def decided_on(top: Node, domain: Mapping[str, Range]) -> Node:
    """The expression with comparisons that intervals over a domain decide."""
    evaluation = Evaluation(domain)
    by = {}
    for x in ordered(top):
        if x.op in ("lt", "le"):
            with suppress(Refused, KeyError):
                decided = evaluation.condition(x)
                if decided is not None:
                    by[x] = TRUE if decided else FALSE
    return put(top, by)


def depends(x: Node, names: Iterable[Node]) -> bool:
    """Whether an expression has one of the names in it."""
    wanted = set(names)
    return any(y in wanted for y in ordered(x))


def ratio(c: Node, place: Place, normal: Normal) -> Pair:
    """(l - r)/(what - to) as a quotient."""
    difference = node("sub", c.args[0], c.args[1])
    return normal(node("div", difference, node("sub", place.what, place.to)))


def linear(c: Node, normal: Normal) -> Place | None:
    """Where a comparison changes, if its sides' difference is linear in w or u with a number as coefficient."""
    above, below = normal(node("sub", c.args[0], c.args[1]))
    for i, x in ((1, W), (0, U)):
        if above.degrees()[i] != 1 or below.degrees()[i] != 0:
            continue
        terms = above.to_dict()
        heads = {m: k for m, k in terms.items() if m[i] == 1}
        rest = [m for m in terms if m[i] == 0]
        if len(heads) == 1 and sum(next(iter(heads))) == 1 and all(sum(m) == 0 for m in rest):
            coefficient: fmpq = next(iter(heads.values()))
            constant = terms[rest[0]] if rest else fmpq(0)
            return Place(x, node("number", value=-constant / coefficient))
    return None


def meets(
    form: Cases, names: Sequence[Node], places: Sequence[Place], not_zero: Sequence[Node], domain: dict[str, Range]
) -> None:
    """Confirm that the values agree wherever a comparison that depends on one of the names changes.

    Args:
        form: the expression.
        names: u, w or both.
        places: where comparisons change, as a certificate says.
        not_zero: expressions that were shown to be not 0 all over the domain.
        domain: of u and w.

    Raises:
        Refused: they could not be shown to agree.
    """
    normal = Normal()
    whole = Leaf(Region(domain, domain, True), [])
    for c in form.comparisons():
        if not depends(c, names) or whole.condition(c) is not None:
            continue
        root = linear(c, normal)
        candidates = [*([root] if root is not None else []), *places]
        if not _same(form, c, normal) and not any(
            _agree(form, c, place, not_zero, normal, domain) for place in candidates
        ):
            raise Refused("the cases of an expression could not be shown to meet")


def _same(form: Cases, c: Node, normal: Normal) -> bool:
    """Whether a comparison decides nothing: both cases are the same expression."""
    try:
        return normal(put(form.value, {c: TRUE})) == normal(put(form.value, {c: FALSE}))
    except Refused:
        return False


def _agree(
    form: Cases, c: Node, place: Place, not_zero: Sequence[Node], normal: Normal, domain: Mapping[str, Range]
) -> bool:
    try:
        k = ratio(c, place, normal)
        if k[0] == 0:
            return False
        # k = (l - r)/(what - to) must not be 0: a number over something, or what a claim shows to be not 0
        if not k[0].is_constant() and not any(k[0] in (normal(x)[0], -normal(x)[0]) for x in not_zero):
            return False
        values = form.all_at(place, normal, domain)
    except Refused:
        return False
    return len(values) > 1 and all(v == values[0] for v in values)


def agree_on_axis(forms: Sequence[tuple[Cases, int]], axis: Node, exact: Node | None) -> None:
    """Confirm that forms from both sides agree at ``axis`` (u or w) = 0, also with the value there.

    Args:
        forms: each with the sign of v (or z) on its side.
        axis: u or w.
        exact: the value at 0 itself.

    Raises:
        Refused: they could not be shown to agree.
    """
    normal, place = Normal(), Place(axis, ZERO)
    quadrant: dict[str, Range] = {n: (fmpq(0), None) for n in ("u", "w")}
    values, slopes = [], []
    for form, side in forms:
        for pairs in form.all_at(place, normal, quadrant):
            values.append(pairs[0])
            if form.order:
                above, below = pairs[1 if axis is U else 2]
                slopes.append((side * above, below))
    if exact is not None:
        values.append(normal(decided_on(known_decided(without_extremes(written_out(exact))), quadrant)))
    if any(v != values[0] for v in values) or any(s != slopes[0] for s in slopes):
        raise Refused(f"the two sides of {'v' if axis is U else 'z'} = 0 could not be shown to agree")

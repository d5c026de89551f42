"""Elementary claims of a certificate: what each is about, the trees that prove them, and switching surfaces."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

from flint import fmpq

from stribeck_verify import intervals, schema
from stribeck_verify.expressions import (
    ONE,
    PI,
    ZERO,
    Json,
    Node,
    Refused,
    U,
    W,
    derivative,
    make,
    name,
    number,
    rational,
    read,
    replace,
    without_roots,
)
from stribeck_verify.identities import written_out
from stribeck_verify.intervals import Range
from stribeck_verify.leaf import Leaf, Region

V, Z_NAME, RATE = name("v"), name("z"), name("dz_dt")


@dataclass(frozen=True)
class Law:
    """The equations of a certificate."""

    dz_dt: Node
    force: Node

    @cached_property
    def plain(self) -> tuple[Node, Node]:
        """Both, with roots of squares as absolute values."""
        return without_roots(self.dz_dt), without_roots(self.force)

    def rate(self, s: int, t: int) -> Node:
        """dz/dt where v = s u and z = t w."""
        return replace(self.plain[0], {V: signed(s, U), Z_NAME: signed(t, W)})

    def load(self, s: int, t: int) -> Node:
        """F where v = s u and z = t w."""
        return replace(self.plain[1], {RATE: self.rate(s, t), V: signed(s, U), Z_NAME: signed(t, W)})


def signed(s: int, x: Node) -> Node:
    """x, -x or 0."""
    return ZERO if s == 0 else (x if s > 0 else make("neg", x))


@dataclass(frozen=True)
class Claim:
    """A claim whose parts have been read; ``u`` and ``w`` are None where they do not occur."""

    about: str
    s: int
    t: int
    u: Range | None
    w: Range | None
    data: Mapping[str, Json]

    @property
    def region(self) -> dict[str, Range]:
        """The ranges that it covers."""
        return {n: r for n, r in (("u", self.u), ("w", self.w)) if r is not None}


def read_range(data: Json) -> Range:
    """A range [lo, hi] of numbers >= 0, hi a number or ``inf``, as text."""
    return rational(data[0]), None if data[1] == "inf" else rational(data[1])


def read_claim(data: Json) -> Claim:
    """A claim from its fields, each of which is checked.

    Raises:
        Refused: a field is missing, of another type, or unknown.
    """
    schema.claim(data)
    about, s, t = data["about"], data["v"], data["z"]
    # a range that is left out is everything
    u, w = (read_range(data.get(n, ["0", "inf"])) for n in ("u", "w"))
    return Claim(about, s, t, u if s != 0 else None, w if t != 0 else None, data)


def _limit(claim: Claim) -> Node:
    """a + b u^k, with a, b >= 0 and k >= 1."""
    a, b, k = rational(claim.data["a"]), rational(claim.data["b"]), claim.data["k"]
    if a < 0 or b < 0:
        raise Refused(f"claim {claim.about}: a and b must not be negative")
    u = U if claim.s != 0 else ZERO
    return make("add", number(a), make("mul", number(b), _to_the(u, k)))


def _to_the(x: Node, k: int) -> Node:
    power = ONE
    for _ in range(k):
        power = make("mul", power, x)
    return power


def subject(claim: Claim, law: Law) -> Node:
    """The expression T of u and w that a claim is on."""
    s, t, data = claim.s, claim.t, claim.data
    f = law.rate(s, t)
    v, z = signed(s, U), signed(t, W)
    if claim.about == "inward" and t != 0:
        return make("neg", f) if t > 0 else f
    if claim.about == "power":
        slope = replace(read_slope(data["slope"]), {Z_NAME: z})
        return make("sub", make("mul", law.load(s, t), v), make("mul", slope, f))
    if claim.about == "slope sign" and t != 0:
        slope = replace(read_slope(data["slope"]), {Z_NAME: z})
        return slope if t > 0 else make("neg", slope)
    if claim.about == "lipschitz" and t != 0:
        size, m = rational(data["l"]), data["m"]
        if size <= 0:
            raise Refused("claim lipschitz: l must be > 0")
        far = make("add", ONE, _to_the(make("div", W, number(size)), m))  # 1 + (w/l)^m, 2 where m = 0
        slope = derivative(written_out(f), W)
        return make("sub", make("mul", _limit(claim), far), slope if data["sign"] > 0 else make("neg", slope))
    if claim.about == "growth" and t != 0:
        size = rational(data["l"])
        if size < 0:
            raise Refused("claim growth: l must be >= 0")
        reach = make("mul", _limit(claim), make("add", W, number(size)))
        return make("sub", reach, f if t > 0 else make("neg", f))
    if claim.about == "finite" and t == 0:
        return make("sub", _limit(claim), f if data["sign"] > 0 else make("neg", f))
    if claim.about == "elastic":
        return make("sub", f, v)
    if claim.about in ("decay", "excess") and t != 0:
        lag = make("sub", v, f)
        lag = lag if t > 0 else make("neg", lag)
        return (
            lag if claim.about == "decay" else make("sub", _most(data, U if s != 0 else ZERO), _times(data, "N", lag))
        )
    if claim.about == "divisor":
        return read(data["expression"], {"u": U, "w": W, "pi": PI})
    raise Refused(f"no claim is about {claim.about!r} with v = {s}, z = {t}")


def _times(data: Mapping[str, Json], name: str, x: Node) -> Node:
    return make("mul", number(rational(data[name])), x)


def _most(data: Mapping[str, Json], u: Node) -> Node:
    """k (u + above) w."""
    return make("mul", _times(data, "k", make("add", u, number(rational(data["above"])))), W)


def read_slope(data: Json) -> Node:
    """A slope of the storage function, an expression of z."""
    return read(data, {"z": Z_NAME, "pi": PI})


# -- trees ----------------------------------------------------------------------------------------------------------------


def prove(claim: Claim, law: Law, closed: bool = False) -> None:
    """Confirm a claim by its tree; ``closed``: u = 0 and w = 0 belong to the region.

    Raises:
        Refused: a leaf does not hold, or the tree does not fit.
    """
    relation = claim.data["relation"]
    top = subject(claim, law)
    region = Region(claim.region, claim.region, not closed)
    stack: list[tuple[Json, Region]] = [(claim.data["tree"], region)]
    while stack:
        tree, at = stack.pop()
        kind, *rest = tree
        if kind == "leaf":
            if not Leaf(at, rest[0]).holds(top, relation):
                raise Refused(f"claim {claim.about} (v {claim.s}, z {claim.t}): a leaf does not hold on {_shown(at)}")
        elif kind == "split":
            stack += _split(at, *rest)
        elif kind == "diagonal":
            stack += zip(rest, _diagonal(at), strict=True)
        else:
            stack.append((rest[0], _polar(at)))


def _shown(region: Region) -> str:
    ends = {n: [None if x is None else intervals.nearest(x) for x in r] for n, r in region.axes.items()}
    return ", ".join(f"{n} in {x}" for n, x in ends.items())


def _split(region: Region, axis: Json, at: Json, below: Json, above: Json) -> list[tuple[Json, Region]]:
    x = rational(at)
    if axis not in region.axes:
        raise Refused(f"no axis {axis!r} to split")
    lo, hi = region.axes[axis]
    assert lo is not None
    if not lo < x or (hi is not None and not x < hi):
        raise Refused(f"{intervals.decimal(x)} is not within the range of {axis}")
    return [
        (tree, Region({**region.axes, axis: part}, region.given, region.open))
        for tree, part in ((below, (lo, x)), (above, (x, hi)))
    ]


def _polar(region: Region) -> Region:
    if set(region.axes) != {"u", "w"}:
        raise Refused("polar coordinates need a rectangle in u and w")
    if not region.open and region.axes["u"][0] == 0:
        raise Refused("polar coordinates leave out an axis that belongs to the region")
    return Region({"u": region.axes["u"], "q": (fmpq(0), None)}, region.axes, region.open)


def _diagonal(region: Region) -> list[Region]:
    if set(region.axes) != {"u", "w"} or any(lo != 0 or not hi for lo, hi in region.axes.values()):
        raise Refused("'diagonal' needs a rectangle [0, U] x [0, W]")
    (_, u), (_, w) = region.axes["u"], region.axes["w"]
    assert u is not None
    assert w is not None
    zero = fmpq(0)
    return [
        Region({"u": (zero, u), "q": (zero, w / u)}, region.axes, region.open),
        Region({"w": (zero, w), "p": (zero, u / w)}, region.axes, region.open),
    ]


# -- coverage -------------------------------------------------------------------------------------------------------------


def covers(parts: list[dict[str, Range]], whole: Mapping[str, Range]) -> bool:
    """Whether rectangles cover a rectangle, all with the same axes."""
    axes = list(whole)
    if not axes:
        return bool(parts)
    grids = []
    for axis in axes:
        ends = [x for part in (*parts, dict(whole)) for x in part[axis] if x is not None]
        lo, hi = whole[axis]
        assert lo is not None
        ends = sorted({x for x in ends if x >= lo and (hi is None or x <= hi)})
        cells: list[Range] = list(pairwise(ends)) or [(lo, lo)]
        if hi is None:
            cells = [*(c for c in cells if c[0] != c[1]), (ends[-1], None)]
        grids.append(cells)
    todo: list[tuple[Range, ...]] = [()]
    for cells in grids:
        todo = [(*head, cell) for head in todo for cell in cells]
    return all(
        any(all(_holds(part[axis], cell) for axis, cell in zip(axes, cells, strict=True)) for part in parts)
        for cells in todo
    )


def _holds(outer: Range, inner: Range) -> bool:
    assert outer[0] is not None
    assert inner[0] is not None
    return bool(outer[0] <= inner[0] and (outer[1] is None or (inner[1] is not None and inner[1] <= outer[1])))


def bounded_on(top: Node, axis: str, reach: Range) -> bool:
    """Whether an expression has a value, with finite bounds where the range is finite, all over a range."""
    return intervals.finite_everywhere(top, {axis: reach})

"""Signs of polynomials over unit and positive variables, by Bernstein coefficients with exact rational numbers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache
from math import comb

from stribeck.properties.plain import Polynomial

UNIT, POSITIVE = "unit", "positive"
_MOST = 20_000  # coefficients

Signs = tuple[bool, bool, bool]  # >= 0, <= 0, not 0
UNKNOWN: Signs = (False, False, False)


@lru_cache(maxsize=256)
def _weights(n: int) -> list[list[Polynomial]]:
    from flint import fmpq

    return [[fmpq(comb(i, j), comb(n, j)) for j in range(i + 1)] for i in range(n + 1)]


@lru_cache(maxsize=1)
def _pi() -> tuple[Polynomial, Polynomial]:
    """Two rational numbers around pi, 1e-40 apart."""
    from flint import arb, ctx, fmpq

    with ctx.workprec(200):
        digits = int(str((arb.pi() * arb(10) ** 40).floor().unique_fmpz()))
    return fmpq(digits, 10**40), fmpq(digits + 1, 10**40)


def _in_pi(powers: dict[int, Polynomial]) -> int | None:
    """The sign of a polynomial in pi; None where it is undecided."""
    if not any(powers):  # no pi
        c = powers.get(0, 0)
        return int(c > 0) - int(c < 0)
    low = high = 0
    below, above = _pi()
    for k, c in powers.items():
        a, b = (below, above) if c > 0 else (above, below)
        low, high = low + c * a**k, high + c * b**k
    return 1 if low > 0 else -1 if high < 0 else 0 if low == high == 0 else None


def signs(
    terms: dict[tuple[int, ...], Polynomial], kinds: Sequence[str | None], opened: Sequence[bool],
    spend: Callable[[int], None] = lambda sums: None,
) -> Signs:  # fmt: skip
    """The sign of a polynomial with the given terms (powers -> coefficient).

    Args:
        terms: the first power is that of pi.
        kinds: for each further variable UNIT, POSITIVE, or None where it does not occur.
        opened: for each further variable whether it is > 0 strictly.
        spend: called with the number of sums of coefficients that are formed.
    """
    if not terms:
        return True, True, False
    least = [min(k[i + 1] for k in terms) if o else 0 for i, o in enumerate(opened)]
    units = [i for i, kind in enumerate(kinds) if kind == UNIT and any(k[i + 1] for k in terms)]
    positives = [i for i, kind in enumerate(kinds) if kind == POSITIVE]
    size = 1
    degrees = []
    for i in units:
        degrees.append(max(k[i + 1] for k in terms) - least[i])
        size *= degrees[-1] + 1
    groups: dict[tuple[int, ...], dict[tuple[int, ...], dict[int, Polynomial]]] = {}
    for k, c in terms.items():
        outer = tuple(int(k[i + 1] - least[i]) for i in positives)
        inner = tuple(int(k[i + 1] - least[i]) for i in units)
        groups.setdefault(outer, {}).setdefault(inner, {})[int(k[0])] = c
    if size * len(groups) > _MOST:
        return UNKNOWN
    spend(int(size) * len(groups) * (2 + int(sum(degrees))) // 2)
    above, below, strict = True, True, False
    for outer, table in groups.items():
        coefficient_signs = {_in_pi(x) for x in _coefficients(table, degrees)}
        if None in coefficient_signs:
            return UNKNOWN
        above, below = above and -1 not in coefficient_signs, below and 1 not in coefficient_signs
        if not (above or below):
            return UNKNOWN
        free = all(power == 0 or opened[i] for power, i in zip(outer, positives, strict=True))
        strict = strict or (free and coefficient_signs in ({1}, {-1}))
    return above, below, strict and (above or below)


def _coefficients(
    table: dict[tuple[int, ...], dict[int, Polynomial]], degrees: list[int]
) -> list[dict[int, Polynomial]]:
    """The Bernstein coefficients, each a polynomial in pi, one dimension after the other."""
    for axis, n in enumerate(degrees):
        if n == 0:
            continue
        weights = _weights(n)
        lines: dict[tuple[int, ...], list[tuple[int, dict[int, Polynomial]]]] = {}
        for k, x in table.items():
            lines.setdefault((*k[:axis], *k[axis + 1 :]), []).append((k[axis], x))
        new: dict[tuple[int, ...], dict[int, Polynomial]] = {}
        for rest, entries in lines.items():
            for i in range(n + 1):
                total: dict[int, Polynomial] = {}
                for j, x in entries:
                    if j <= i:
                        weight = weights[i][j]
                        for p, c in x.items():
                            total[p] = total[p] + c * weight if p in total else c * weight
                new[(*rest[:axis], i, *rest[axis:])] = total
        table = new
    # what is missing is 0
    count = 1
    for n in degrees:
        count *= n + 1
    coefficients = [x if x else {0: 0} for x in table.values()]
    return coefficients if len(coefficients) == count else [*coefficients, {0: 0}]

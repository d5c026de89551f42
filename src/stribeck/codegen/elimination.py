"""Gaussian elimination of a sparse matrix, carried out on symbols once so that the generated code has no loops."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from stribeck.expressions.graph import ONE, ZERO, Expr, is_zero

Keep = Callable[[str, Expr], Expr]  # keeps a computed entry under a name and returns the symbol to use for it


def order_of_elimination(matrix: Sequence[Sequence[Expr]]) -> list[int]:
    """Order of the diagonal pivots, fewest new entries first (Markowitz).

    The velocity, coupled to all others, comes last: it is then the first unknown computed, and the next stage needs it.
    """
    n = len(matrix)
    in_row = [{j for j in range(n) if j == i or not is_zero(matrix[i][j])} for i in range(n)]
    in_column = [{i for i in range(n) if k in in_row[i]} for k in range(n)]
    remaining, order = set(range(n)), []
    while remaining:
        pivot = min(remaining, key=lambda k: ((len(in_column[k]) - 1) * (len(in_row[k]) - 1), k))
        order.append(pivot)
        remaining.remove(pivot)
        rows, columns = in_column[pivot] - {pivot}, in_row[pivot] - {pivot}
        for i in rows:
            in_row[i] = (in_row[i] | columns) - {pivot}
        for j in columns:
            in_column[j] = (in_column[j] | rows) - {pivot}
    return order


def eliminate(matrix: Sequence[Sequence[Expr]], names: Sequence[str], right: Sequence[Expr], keep: Keep) -> list[Expr]:
    """Solve matrix * x = right; entries of the factorization go through ``keep``.

    ``right`` are symbols; the result consists of these, kept entries and entries of the matrix.
    """
    n, w = len(matrix), [list(row) for row in matrix]
    order = order_of_elimination(matrix)
    r = list(right)
    inverse: dict[int, Expr] = {}
    for step, k in enumerate(order):
        inverse[k] = keep(f"d_{names[k]}", ONE / w[k][k])
        for i in order[step + 1 :]:
            if is_zero(w[i][k]):
                continue
            factor = keep(f"l_{names[i]}_{names[k]}", w[i][k] * inverse[k])
            for j in order[step + 1 :]:
                if not is_zero(w[k][j]):
                    w[i][j] = w[i][j] - factor * w[k][j]
            r[i] = r[i] - factor * r[k]
        for j in order[step + 1 :]:
            if not is_zero(w[k][j]):
                w[k][j] = keep(f"u_{names[k]}_{names[j]}", w[k][j])
    x: list[Expr] = [ZERO] * n
    for step in reversed(range(n)):
        k = order[step]
        total = r[k]
        for j in order[step + 1 :]:
            if not is_zero(w[k][j]):
                total = total - w[k][j] * x[j]
        x[k] = total * inverse[k]
    return x

"""A law as plain data, for the independent checker: its equations with its constants' names, and its constants."""

from __future__ import annotations

from stribeck.expressions.exact import tree_of
from stribeck.expressions.graph import Expr, ordered, symbol, wrap
from stribeck.laws.base import Law
from stribeck.properties.plain import Json


def statement(law: Law) -> dict[str, Json]:
    """A law as the input of :func:`stribeck_verify.verify` and :func:`stribeck_verify.confirmed`.

    It is written independently of the certificates, which the checker compares with it. Constants are called ``c_NAME``; a tree
    is a number, a name or a list of an operation and its trees.
    """
    p = law.symbolic(lambda name: symbol(f"c_{name}"), law.form)
    v, z, rate = symbol("v"), symbol("z"), symbol("dz_dt")
    scales = law.scales(law.p)
    return {
        "law": law.name,
        "constants": {f"c_{n}": float(x) for n, x in law.p.numbers.items()},
        "dz_dt": _tree(wrap(law.dz_dt(p, v, z))),
        "force": _tree(wrap(law.friction(p, v, z, rate))),
        "Z": _tree(wrap(law.z_bound(p))),
        "scales": {"speed": float(scales.speed), "length": float(scales.length)},
    }


def _tree(top: Expr) -> Json:
    """An expression; repeated parts are the same list."""
    written: dict[Expr, Json] = {}
    for node in ordered([top]):
        if node.op == "constant":
            assert isinstance(node.value, float)
            written[node] = _number(tree_of(node.value))
        else:
            written[node] = str(node.value) if node.op == "symbol" else [node.op, *(written[a] for a in node.args)]
    return written[top]


def _number(tree: Json) -> Json:
    """A number as a float, or as an operation on floats and pi."""
    return [tree[0], *map(_number, tree[1:])] if isinstance(tree, tuple) else tree

"""Certificates: proofs as plain data, for an independent checker that shares no code with the prover.

The format is described in docs/reference/certificates.md.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING

from stribeck.expressions.exact import tree_of
from stribeck.expressions.graph import Expr, ordered
from stribeck.properties.plain import Json
from stribeck.properties.prover.region import End
from stribeck.properties.prover.search import Tree

if TYPE_CHECKING:
    from stribeck.properties.model import Model

FORMAT = 1
_TEXT = {"symbol", "constant"}


def rational(x: Fraction | None) -> str:
    """A rational number as text; "inf" for no bound."""
    return "inf" if x is None else str(x)


def _number(tree: Json) -> Json:
    if isinstance(tree, tuple):
        return [tree[0], *map(_number, tree[1:])]
    return tree if isinstance(tree, str) else rational(Fraction(tree))


class PrefixWriter:
    """Writer of expressions as prefix lists, with a law's values for its constants and names for shared parts.

    Args:
        values: the constants.
        shared: expressions whose parts may be named in ``definitions``, or None.
    """

    def __init__(self, values: Mapping[str, Fraction], shared: Iterable[Expr] = ()) -> None:
        self.values = values
        self.definitions: list[list[Json]] = []
        self._names: dict[Expr, str] = {}
        self._written: dict[Expr, Json] = {}
        outputs = list(shared)
        uses: dict[Expr, int] = {}
        for node in ordered(outputs):
            for a in node.args:
                uses[a] = uses.get(a, 0) + 1
        for node in ordered(outputs):
            if uses.get(node, 0) > 1 and node.op not in _TEXT | {"lt", "le", "both", "either"}:
                text = self.write(node)
                self._names[node] = f"n{len(self.definitions)}"
                self.definitions.append([self._names[node], text])

    def write(self, node: Expr) -> Json:
        """The expression; repeated parts are the same list."""
        if node in self._names:
            return self._names[node]
        if node not in self._written:
            self._written[node] = self._text(node)
        return self._written[node]

    def _text(self, node: Expr) -> Json:
        if node.op == "symbol":
            name = str(node.value)
            return rational(self.values[name]) if name in self.values else name
        if node.op == "constant":
            assert isinstance(node.value, float)
            return _number(tree_of(node.value))
        return [node.op, *(self.write(a) for a in node.args)]


@dataclass
class Claim:
    """An elementary statement, and the tree that proves it."""

    about: str
    relation: str
    v: int
    z: int
    ranges: Mapping[str, tuple[Fraction, End]]
    tree: Tree
    extra: Mapping[str, Json] = field(default_factory=dict)

    def to_json(self, writer: PrefixWriter) -> dict[str, Json]:
        """Plain data."""
        data: dict[str, Json] = {"about": self.about, "v": self.v, "z": self.z}
        for name, x in self.extra.items():
            data[name] = _plain(x, writer)
        data["relation"] = self.relation
        data |= {name: [rational(low), rational(high)] for name, (low, high) in self.ranges.items()}
        data["tree"] = _tree(self.tree, writer)
        return data


def _plain(x: Json, writer: PrefixWriter) -> Json:
    if isinstance(x, Expr):
        return writer.write(x)
    if isinstance(x, Fraction):
        return rational(x)
    return [_plain(a, writer) for a in x] if isinstance(x, list | tuple) else x


def _tree(tree: Tree, writer: PrefixWriter) -> Json:
    if tree[0] == "leaf":
        return ["leaf", [[writer.write(node), *(_plain(x, writer) for x in rule)] for node, rule in tree[1]]]
    return [_tree(part, writer) if isinstance(part, list) else part for part in tree]


@dataclass
class Certificate:
    """A proof of one property: the theorem, its elementary claims, and certificates of the properties that it uses."""

    prop: str
    theorem: str
    claims: list[Claim]
    data: Mapping[str, Json] = field(default_factory=dict)
    hypotheses: Mapping[str, Certificate] = field(default_factory=dict)

    @property
    def leaves(self) -> int:
        """The number of parts of the domain."""
        return sum(_leaves(claim.tree) for claim in self.claims) + sum(c.leaves for c in self.hypotheses.values())

    def to_json(self, model: Model) -> dict[str, Json]:
        """Plain data."""
        law = model.law
        shared = PrefixWriter(model.values, [model.rate, model.force])
        plain = PrefixWriter(model.values)
        return {
            "format": FORMAT,
            "law": law.name,
            "property": self.prop,
            "v_max": rational(model.v_max),
            "constants": {n: rational(x) for n, x in model.values.items()},
            "dz_dt": shared.write(model.rate),
            "force": shared.write(model.force),
            "definitions": shared.definitions,
            "Z": rational(model.bound[1]),
            "theorem": self.theorem,
            "data": {n: _plain(x, plain) for n, x in self.data.items()},
            "claims": [claim.to_json(plain) for claim in self.claims],
            "hypotheses": {n: c.to_json(model) for n, c in self.hypotheses.items()},
        }


def _leaves(tree: Tree) -> int:
    return 1 if tree[0] == "leaf" else sum(_leaves(part) for part in tree if isinstance(part, list))

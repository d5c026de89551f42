"""Names of intermediate results in generated code."""

from __future__ import annotations

from stribeck.expressions.graph import Expr
from stribeck.expressions.ops import Value


class Names(dict[Expr, str]):
    """Names of intermediate results in the code of one build; a node keeps its first name."""

    def give(self, node: Value, name: str) -> None:
        """Name a result; symbols and numbers get no name."""
        if isinstance(node, Expr) and node.args:
            self.setdefault(node, name)

    def hand_on(self, old: Expr, new: Expr) -> Expr:
        """Give a node's name to its replacement, and return that."""
        if old is not new and old in self:
            self.give(new, self[old])
        return new

    def term(self, name: str, latex: str, args: tuple[Value, ...], value: Value) -> Value:
        """Name a term of an equation and return its value; see :class:`stribeck.laws.values.Constants`."""
        self.give(value, name)
        return value

"""What intermediate results are called."""

from __future__ import annotations

from stribeck.expressions.graph import Expr
from stribeck.expressions.ops import Value


class Names(dict[Expr, str]):
    """What intermediate results are called in the code of one build; a node keeps the first name that it is given."""

    def give(self, node: Value, name: str) -> None:
        """Call a result so; symbols and numbers have no names of their own."""
        if isinstance(node, Expr) and node.args:
            self.setdefault(node, name)

    def hand_on(self, old: Expr, new: Expr) -> Expr:
        """Call what stands in the place of a node as it was called; the new node."""
        if old is not new and old in self:
            self.give(new, self[old])
        return new

    def term(self, name: str, latex: str, args: tuple[Value, ...], value: Value) -> Value:
        """Call a term of an equation by its name; see :class:`stribeck.laws.values.Constants`."""
        self.give(value, name)
        return value

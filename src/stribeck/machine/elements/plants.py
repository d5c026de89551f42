"""The body of a file of schema 1: a mass, the piston of a cylinder, or a plant of the user's own."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from stribeck.constants import Constant
from stribeck.expressions.ops import Value
from stribeck.machine.elements.bodies import Body
from stribeck.machine.table import Carrier, ConstantLeaf, Frozen
from stribeck.plants import Plant


class Numbers(Frozen):
    """The constants of a plant by name, which are run-time constants."""

    declared: dict[str, Constant]

    @classmethod
    def of(cls, declared: dict[str, Constant], values: dict[str, Any]) -> Numbers:
        """The values of some of the constants."""
        made = cls(values)
        made.declared = declared
        return made

    def leaves(self, path: str) -> Iterator[ConstantLeaf]:
        """See :class:`FileTable`."""
        owner = path.rpartition(".")[0]
        return (ConstantLeaf(f"{owner}.{n}", (owner, n), self.declared[n], x) for n, x in self.items())

    def carrying(self, path: str, carrier: Carrier) -> Numbers:
        """See :class:`FileTable`."""
        owner = path.rpartition(".")[0]
        return Numbers.of(self.declared, {n: carrier.put(owner, n) for n in self})


class SingleBody(Body):
    """The body of a file of schema 1: a mass, or any other plant with its constants."""

    acts: Any = None  # the plant
    numbers: Any = None

    @property
    def plant(self) -> type[Plant]:  # type: ignore[override]
        """See :class:`Body`."""
        kind: type[Plant] = self.acts
        return kind

    @property
    def constants(self) -> dict[str, Value]:
        """See :class:`Body`."""
        return dict(self.numbers)

    @property
    def heavy(self) -> Value:
        """Its mass, where its plant has one."""
        return self.numbers.get("mass")

"""A spring whose far end is moved."""

from __future__ import annotations

from types import SimpleNamespace
from typing import ClassVar

from stribeck.constants import Constant
from stribeck.drives.base import Column, Drive
from stribeck.expressions.ops import Value


class Spring(Drive):
    """The body is pulled through a spring (the paper's Fig. 5)."""

    kind, meaning = "spring", "the signal is the position of the far end of a spring, m"
    signal = Column("x", "m", "position of the spring's far end")
    constants: ClassVar[dict[str, Constant]] = {
        "stiffness": Constant("N/m", "stiffness of the spring", above=0, rotary_unit="N m/rad")
    }
    columns = (Column("u", "N", "force of the spring on the body"),)

    @staticmethod
    def force(p: SimpleNamespace, r: Value, y: Value, v: Value, x: tuple[Value, ...]) -> Value:
        """Hooke's law."""
        return p.stiffness * (r - y)

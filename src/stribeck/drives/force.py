"""A force applied to the body."""

from __future__ import annotations

from types import SimpleNamespace

from stribeck.drives.base import Column, Drive
from stribeck.expressions.ops import Value


class Force(Drive):
    """The signal is the force."""

    kind, meaning = "force", "the signal is the force on the body, N"
    signal = Column("u", "N", "force on the body")

    @staticmethod
    def force(p: SimpleNamespace, r: Value, y: Value, v: Value, x: tuple[Value, ...]) -> Value:
        """The signal."""
        return r

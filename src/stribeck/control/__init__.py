"""Controllers that compensate friction: their equations, written once, and their Lyapunov function."""

from stribeck.control.cascade import Cascade

__all__ = ["KINDS", "Cascade"]

KINDS = {Cascade.kind: Cascade}

"""Controllers that compensate friction: their equations, written once, and their Lyapunov function."""

from stribeck.control.cascade import PressureCascade

__all__ = ["PressureCascade"]

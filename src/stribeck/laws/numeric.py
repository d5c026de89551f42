"""NumPy helpers of the laws' evaluation."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from stribeck.arrays import Array
from stribeck.expressions.ops import Value


def shaped(value: Value, v: Value, z: Value) -> Array:
    """A value that may not depend on one of v and z, with the shape of both."""
    shape = np.broadcast_shapes(np.shape(v), np.shape(z))
    return np.asarray(value if np.shape(value) == shape else np.full(shape, value))[()]


def first_root(f: Callable[[Value], Value], direction: Value, start: float) -> Array:
    """The first root of f along ``direction`` from 0, f positive before it; inf where none is found."""
    low, high = np.zeros_like(direction), np.full_like(direction, start)
    for _ in range(200):
        short = f(direction * high) > 0
        if not short.any():
            break
        high = np.where(short, 2 * high, high)
    for _ in range(120):
        middle = 0.5 * (low + high)
        if not ((low < middle) & (middle < high)).any():
            break
        positive = f(direction * middle) > 0
        low, high = np.where(positive, middle, low), np.where(positive, high, middle)
    return np.asarray(direction * high)

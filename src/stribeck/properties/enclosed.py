"""Enclosures by interval arithmetic, which make a counterexample certain."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from stribeck.expressions.graph import Expr
from stribeck.expressions.intervals import Box, Range, add, div, mul
from stribeck.properties.model import Model

_PANELS = (1024, 16384)  # of the enclosing quadrature: sixteen times as many while the sign is open
_PARTS = 400  # most intervals of z for a lower bound, which are halved while the bound is not above 0
_ROUNDING = 1e-12  # of a sum: exceeds its rounding


def energy(model: Model, v: float, a: float, b: float, panels: int) -> tuple[float, float] | None:
    """Bounds of the energy supplied, J, while the constant speed v takes z from a to b; None if dz/dt may reach 0.

    It is the integral of F v/(dz/dt) over z, which does not depend on time.
    """
    edges = np.linspace(a, b, panels + 1).tolist()
    lows, highs = [], []
    for start, end in pairwise(edges):
        if not (end - start) * (b - a) > 0:
            return None
        box = Box({**model.inputs, "v": (v, v), "z": (min(start, end), max(start, end))})
        rate, force = box(model.rate), box(model.power_force)
        if not (rate[0] > 0 if b > a else rate[1] < 0):
            return None
        put_in = mul(div(mul(force, (v, v)), rate), add((end, end), (-start, -start)))
        lows.append(put_in[0])
        highs.append(put_in[1])
    if not np.all(np.isfinite([lows, highs])):
        return None
    slack = _ROUNDING * math.fsum(max(abs(low), abs(high)) for low, high in zip(lows, highs, strict=True))
    return math.fsum(lows) - slack, math.fsum(highs) + slack


def programme(pieces: Sequence[tuple[Model, float, float, float]]) -> tuple[float, float] | None:
    """Bounds of the energy supplied, J, while constant speeds take z from one deflection to the next.

    More panels are used until the bounds have a sign. None if dz/dt may reach 0.

    Args:
        pieces: (law, speed in m/s, z at its start, z at its end) of each piece.
    """
    bounds: tuple[float, float] | None = None
    for panels in _PANELS:
        parts = [energy(model, v, a, b, panels) for model, v, a, b in pieces]
        known = [part for part in parts if part is not None]
        if len(known) < len(parts):
            continue
        slack = _ROUNDING * sum(abs(x) for part in known for x in part)
        bounds = sum(low for low, _ in known) - slack, sum(high for _, high in known) + slack
        if bounds[1] < 0 or bounds[0] > 0:
            return bounds
    return bounds


def least(model: Model, expr: Expr, v: float, a: float, b: float) -> float:
    """A lower bound of an expression of v and z over z in [a, b] at a constant speed, by bisection until it is above 0."""
    bound, work, parts = math.inf, [(min(a, b), max(a, b))], _PARTS
    while work and parts > 0:
        low, high = work.pop()
        parts -= 1
        value: Range = Box({**model.inputs, "v": (v, v), "z": (low, high)})(expr)
        if value[0] > 0:
            bound = min(bound, value[0])
            continue
        middle = 0.5 * (low + high)
        if not low < middle < high or value[1] <= 0:
            return min(bound, value[0])
        work += [(low, middle), (middle, high)]
    return bound if not work else -math.inf

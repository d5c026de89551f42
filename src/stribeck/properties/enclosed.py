"""Enclosures by interval arithmetic, which make a counterexample certain."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from stribeck.expressions.graph import Expr
from stribeck.expressions.intervals import Box, Range, add, div, mul
from stribeck.properties.model import Model

_PANELS, _MOST = 256, 4096  # of the enclosing quadrature: of each piece at first, and of all in the end
_FINEST = 1 / 16384  # of the longest piece: a shorter panel on which dz/dt may still reach 0 has a zero, or nearly
_PARTS = 400  # most intervals of z for a lower bound, which are halved while the bound is not above 0
_ROUNDING = 1e-12  # of a sum: exceeds its rounding
Panel = tuple[Model, float, float, float]  # law, speed (m/s), z at the start and at the end of a part of the motion (m)


def supplied(panel: Panel) -> Range:
    """Bounds of the energy supplied, J, while a constant speed takes z from one deflection to another.

    It is the integral of F v/(dz/dt) over z, which does not depend on time. Unbounded if dz/dt may reach 0.
    """
    model, v, start, end = panel
    box = Box({**model.inputs, "v": (v, v), "z": (min(start, end), max(start, end))})
    rate, force = box(model.rate), box(model.power_force)
    if not (rate[0] > 0 if end > start else end < start and rate[1] < 0):
        return -math.inf, math.inf
    low, high = mul(div(mul(force, (v, v)), rate), add((end, end), (-start, -start)))
    return (low, high) if math.isfinite(low) and math.isfinite(high) else (-math.inf, math.inf)


def program(pieces: Sequence[Panel]) -> tuple[float, float] | None:
    """Bounds of the energy supplied, J, while constant speeds take z from one deflection to the next.

    Panels without bounds are halved, then the wider half of all, until the sum has a sign. None if dz/dt may reach 0.
    """
    shortest = _FINEST * max(abs(b - a) for _, _, a, b in pieces)
    panels = [
        (model, v, *ends)
        for model, v, a, b in pieces for ends in pairwise(np.linspace(a, b, _PANELS + 1).tolist())
    ]  # fmt: skip
    bounds = [supplied(panel) for panel in panels]
    while True:
        unbounded = [(abs(panels[i][3] - panels[i][2]), i) for i, (low, _) in enumerate(bounds) if low == -math.inf]
        if unbounded:  # the shortest first: one that stays unbounded ends the search
            length, i = min(unbounded)
            if length <= shortest or len(panels) >= _MOST:
                return None
            wide = [i]
        else:
            slack = _ROUNDING * math.fsum(max(abs(low), abs(high)) for low, high in bounds)
            total = math.fsum(low for low, _ in bounds) - slack, math.fsum(high for _, high in bounds) + slack
            if total[1] < 0 or total[0] > 0 or len(panels) >= _MOST:
                return total
            wide = sorted(range(len(panels)), key=lambda i: bounds[i][0] - bounds[i][1])[: len(panels) // 2]
        for i in wide:
            model, v, start, end = panels[i]
            middle = 0.5 * (start + end)
            panels[i] = (model, v, start, middle)
            panels.append((model, v, middle, end))
            bounds[i] = supplied(panels[i])
            bounds.append(supplied(panels[-1]))


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

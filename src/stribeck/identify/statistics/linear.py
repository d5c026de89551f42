"""A static model near its optimum: what is free there, and how the force changes with it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array
from stribeck.identify.models.separable import Minimum, Separable
from stribeck.identify.models.terms import TERMS


@dataclass(frozen=True)
class Linear:
    """The model near its optimum: names, values, whether the logarithm is what counts, slopes by that, the residual."""

    names: tuple[str, ...]
    values: Array
    log: NDArray[np.bool_]
    slopes: Array
    misfit: Array


def linearised(model: Separable, solution: Minimum) -> Linear:
    """Slopes of the weighted force at the optimum by everything that is free and not at its bound."""
    values = solution.values
    columns = model.columns.at(values, model.terms)
    found: dict[str, Array] = {}
    tied = "F_s" in model.wanted and values["F_s"] <= values["F_c"] * (1 + 1e-4)
    for name in (*model.wanted, *model.free):
        if at_zero(name, values, model) or (name == "F_s" and tied):
            continue
        found[name] = columns[name] + columns["F_s"] if name == "F_c" and tied else columns[name]
    before = model.force_at(values)
    for shape in model.shapes:
        if tied and shape.name in ("v_s", "delta"):
            continue
        step = 1e-4 * values[shape.name] if shape.log else 1e-3 * (shape.high - shape.low)
        after = model.force_at({**values, shape.name: values[shape.name] + step})
        found[shape.name] = (after - before) / step
    names = tuple(found)
    log = np.array([_is_log(n) for n in names], bool)
    x = np.array([values[n] for n in names])
    slopes = np.column_stack([found[n] for n in names]) * np.where(log, x, 1.0) if names else np.zeros((len(before), 0))
    return Linear(names, x, log, model.weight[:, None] * slopes, model.weight * (model.force - before))


def at_zero(name: str, values: dict[str, float], model: Separable) -> bool:
    """Whether a coefficient that cannot be negative comes out as nothing."""
    if name in TERMS and not TERMS[name].positive:
        return False
    return values[name] <= (2 * model.least if name == "F_c" else 0.0)


def _is_log(name: str) -> bool:
    return TERMS[name].positive if name in TERMS else True

"""Terms of the force other than the law's friction: inertia, spring, offset, pressure, varying levels."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from stribeck.arrays import Array
from stribeck.errors import InputError, arg, nearest
from stribeck.identify.data.quality import LARGEST
from stribeck.identify.log import Log


@dataclass(frozen=True)
class Term:
    """A coefficient times a column of the log.

    Attributes:
        unit: of the coefficient.
        meaning: in a line; ``factor``: what it multiplies, as text.
        column: the log's column; None for a number that has none of its own, such as a delay.
        level: multiplies the law's sliding level instead of standing alone: F_c (and F_s) grow by it.
        needs: the optional column of the log that it takes.
        positive: the coefficient must be so.
        friction: it is part of friction, and not of the rig.
    """

    unit: str
    meaning: str
    factor: str = ""
    column: Callable[[Log], Any] | None = None
    level: bool = False
    needs: str = ""
    positive: bool = False
    friction: bool = False


TERMS: dict[str, Term] = {
    "mass": Term("kg", "inertia", "a", lambda log: log.acceleration, positive=True),
    "offset": Term("N", "constant force, such as gravity", "1", lambda log: np.ones(len(log))),
    "stiffness": Term("N/m", "spring to ground", "y", lambda log: log.position),
    "gravity_sin": Term(
        "N", "coefficient of the sine of the position (rad): an arm's weight", "sin(y)", lambda log: np.sin(log.position)
    ),
    "gravity_cos": Term("N", "coefficient of the cosine of the position (rad)", "cos(y)", lambda log: np.cos(log.position)),
    "area": Term("m^2", "effective area of the pressure", "p", lambda log: log.pressure, needs="pressure"),
    "sigma_2_by_direction": Term(
        "N s/m", "half of viscous friction forwards minus backwards", "|v|", lambda log: abs(log.velocity), friction=True
    ),
    "F_c_by_direction": Term(
        "N", "half of the friction level forwards minus backwards", "sign(v)", lambda log: np.sign(log.velocity), level=True
    ),
    "F_c_by_load": Term("1", "growth of the friction level with load", "N", lambda log: log.load, True, "load"),
    "F_c_by_pressure": Term("m^2", "growth of the level with pressure", "p", lambda log: log.pressure, True, "pressure"),
    "delay": Term("s", "time by which the measured motion lags the force"),
}  # fmt: skip
WEIGHT = {"gravity_sin": 0.0, "gravity_cos": float(np.pi / 2)}  # terms of a weight, and the phase of its pendulum, rad


def column(name: str, log: Log) -> Array:
    """The column of the log that a term multiplies."""
    formula = TERMS[name].column
    assert formula is not None
    return np.asarray(formula(log))


def problem(name: str, value: object) -> str:
    """A message about an invalid value of a term; empty if it is valid."""
    positive = TERMS[name].positive
    number = value if isinstance(value, int | float) and not isinstance(value, bool) else float("nan")
    if abs(number) <= LARGEST and not (positive and number < 0):
        return ""
    return f"must be a number from {0 if positive else -LARGEST:g} to {LARGEST:g}"


def check(names: tuple[str, ...], log: Log) -> None:
    """Refuse terms that are unknown or lack their column.

    Raises:
        InputError: a line for each.
    """
    problems = []
    for name in names:
        if name not in TERMS:
            guess = nearest(name, TERMS) or f" (known: {', '.join(TERMS)})"
            problems.append(f"{arg('term')}: {name!r}: no such term{guess}")
        elif (needs := TERMS[name].needs) and getattr(log, needs) is None:
            problems.append(f"{arg('term')}: {name!r}: needs a column: {arg(needs)}")
    if problems:
        raise InputError(problems)

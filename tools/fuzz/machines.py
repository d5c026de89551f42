"""Random machines, against SciPy on equations written apart (tests/reference/apart.py)."""

from __future__ import annotations

import random
import warnings
from collections import Counter

import numpy as np
from random_machines import random_machine

from stribeck import InputError, Scenario, simulate
from tests.reference import apart

_MOTION, _FORCE = 1e-5, 2e-4  # of the peak: what the second solver itself is good for
_UNSURE = 10.0  # by how much more than between two tolerances of the second solver


def campaign(
    seed: int, count: int, ended: Counter[str] | None = None, faults: list[str] | None = None
) -> tuple[Counter[str], list[str]]:
    """How the runs ended, and which are off; both are also added to what is given."""
    ended, faults = Counter() if ended is None else ended, [] if faults is None else faults
    for i in range(count):
        data = random_machine(random.Random(f"{seed}/{i}").randrange(2**32))
        try:
            what, fault = one(data)
        except Exception as error:
            what, fault = "failed", f"{type(error).__name__}: {str(error)[:200]}"
        ended[what] += 1
        if fault:
            faults.append(f"machine {seed}/{i}: {fault}")
    return ended, faults


def one(data: dict[str, object]) -> tuple[str, str | None]:
    """How the run of one machine ended, and what is wrong with it."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            found = simulate(Scenario(data))
        except InputError as error:
            return "refused", None if "z_ba" in str(error) else str(error)
        if found.status != "done":
            return found.status, found.reason
        expected = apart.solve(data)
        off = _off(found, expected)
        if not off:
            return "agree", None
        other = apart.solve(data, rtol=1e-8)  # a motion in which errors grow tells by itself how much
    own = _off(other, expected, 0.0)
    off = {name: error for name, error in off.items() if error > _UNSURE * own.get(name, 0.0)}
    if off:
        return "differ", ", ".join(f"{name} is off by {error:.1e} of its peak" for name, error in off.items())
    return "differ no more than SciPy from itself", None


def _off(found: object, expected: dict[str, np.ndarray], share: float = 1.0) -> dict[str, float]:
    """The columns that differ by more than they may, and by how much of their peaks."""
    wrong = {}
    for name, x in expected.items():
        error = float(np.max(np.abs(found[name] - x)) / max(np.max(np.abs(x)), 1e-12))
        if not error <= share * (_MOTION if name.endswith((".y", ".v", ".w", ".r")) else _FORCE):
            wrong[name] = error
    return wrong

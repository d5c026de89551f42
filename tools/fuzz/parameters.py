"""Random laws, machines, drives and signals, against SciPy on equations written apart (tests/simulation)."""

from __future__ import annotations

import random
import warnings
from collections import Counter

import numpy as np

from stribeck import Scenario, simulate
from tests.simulation import independent
from tests.simulation.random_rigs import random_rig

_AGREE = 1e-5  # of the peak: what the second solver itself is good for


def campaign(
    seed: int, count: int, ended: Counter[str] | None = None, faults: list[str] | None = None
) -> tuple[Counter[str], list[str]]:
    """How the runs ended, and which are off; both are also added to what is given."""
    ended, faults = Counter() if ended is None else ended, [] if faults is None else faults
    for i in range(count):
        data = random_rig(random.Random(f"{seed}/{i}").randrange(2**32))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found, expected = simulate(Scenario(data)), independent.solve(data)
        ended[found.status] += 1
        if found.status != "done":
            faults.append(f"parameters {seed}/{i}: {found.reason}")
            continue
        for name in ("y", "v"):
            off = float(np.max(abs(found[name] - expected[name])) / max(np.max(abs(expected[name])), 1e-300))
            if not off < _AGREE:
                faults.append(f"parameters {seed}/{i}: {name} is off by {off:.1e} of its peak")
    return ended, faults

"""Whether a fit misses so much of what was measured that its numbers are those of another machine."""

from __future__ import annotations

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.statistics.verdicts import Noise

_BEYOND = 3.0  # times what noise explains: a residual that is the model's


def misses(misfit: Array, measured: Array, noise: Noise) -> str:
    """Why nothing can be said of a fit, or nothing: it leaves more than noise does, and much of what was measured."""
    left, whole = float(np.linalg.norm(misfit)), float(np.linalg.norm(measured))
    deviation = left / np.sqrt(max(len(misfit), 1))
    if noise.expected <= 0 or deviation <= _BEYOND * noise.expected:
        return ""
    share = max(left / whole, noise.farther)
    text = (
        f"the fit misses {share:.0%} of what was measured, {deviation / noise.expected:.3g} times what noise explains"
    )
    if share > noise.missed:
        return f"{text}: its numbers say nothing about the machine"
    return f"{text}, and one start alone led to it: give more starts" if noise.alone else ""

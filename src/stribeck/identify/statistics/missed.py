"""Whether a fit misses so much of what was measured that its numbers are those of another machine."""

from __future__ import annotations

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.models.memory import rows_together
from stribeck.identify.models.motion_problem import white_noise
from stribeck.identify.models.static_problem import Rows
from stribeck.identify.statistics.verdicts import Noise

_BEYOND = 3.0  # times what noise explains: a residual that is the model's
_NOISE_TOGETHER = 4.0  # rows of the record in a row that err alike: noise of a force may do so too


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


def static_misses(rows: Rows, weight: Array, force: Array, misfit: Array) -> str:
    """The same of a static fit of the force. A residual that hardly remembers is the force's noise, however large it is.

    Args:
        rows: of the record.
        weight: of each row that is compared; ``force`` and ``misfit``: measured there, N, and what the fit leaves of it times
            the weight.
    """
    counted = weight > 0
    if not counted.any() or rows.q * rows_together(misfit[counted]) <= _NOISE_TOGETHER:
        return ""
    level = white_noise(rows.log.force, list(rows.log.runs())) / float(np.sqrt(rows.q))  # behind the filter of the rows
    return misses(misfit[counted], (weight * force)[counted], Noise(level, level))

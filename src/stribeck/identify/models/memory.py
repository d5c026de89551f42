"""How long a residual remembers."""

from __future__ import annotations

import numpy as np
from scipy.fft import next_fast_len

from stribeck.arrays import Array


def rows_together(r: Array) -> float:
    """How many rows in a row err alike: the sum of the residual's correlation up to its first zero."""
    n, length = len(r), next_fast_len(2 * len(r), real=True)
    correlation = np.fft.irfft(abs(np.fft.rfft(r - r.mean(), length)) ** 2, length)[: n // 2]
    if correlation[0] <= 0:
        return 1.0
    correlation = correlation / correlation[0]
    end = int(np.argmax(correlation < 0)) or 1
    return float(1 + 2 * np.sum(correlation[1:end]))

"""Prediction errors: residuals less what their own past predicts.

The error of a simulated position integrates those of the measured force: it drifts, and neighbouring samples repeat it. Least
squares then weights slow errors too much. An autoregressive model of the residual takes out what is predicted
(Ljung, System Identification, 1999, section 3.2), and what is left is white.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stribeck.arrays import Array

_ORDERS = (1, 2, 3, 4, 6, 8, 12, 16, 24, 32)  # an integrated force error under an encoder's noise takes some 20
_ENOUGH = 4 * _ORDERS[-1]  # samples of a residual with several times as many as its largest model has coefficients
_FAINT = 1e-13  # of the largest: smaller products of lagged residuals are rounding


def prediction_filter(parts: Sequence[Array]) -> Array:
    """The coefficients whose moving sum over a residual's pieces is white with deviation 1; 1 alone if they are white.

    The order is chosen by BIC.
    """
    long = [x for x in parts if len(x) >= _ENOUGH and np.isfinite(x).all()]
    if not long:
        return np.ones(1)
    most = _ORDERS[-1]
    lagged = np.concatenate([np.lib.stride_tricks.sliding_window_view(x, most + 1)[:, ::-1] for x in long])
    products, rows = lagged.T @ lagged / len(lagged), len(lagged)
    best, chosen = products[0, 0], np.ones(1)
    if not best > 0:
        return chosen
    score = rows * np.log(best)
    for order in _ORDERS:
        past = products[1 : order + 1, 1 : order + 1]
        whole = np.append(1.0, -np.linalg.lstsq(past, products[1 : order + 1, 0], rcond=_FAINT)[0])
        left = max(float(whole @ products[: order + 1, : order + 1] @ whole), _FAINT * best)
        if (with_order := rows * np.log(left) + order * np.log(rows)) < score:
            score, chosen = with_order, whole / np.sqrt(left)
    return chosen

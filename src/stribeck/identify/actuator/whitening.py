"""Prediction errors: residuals less what their own past predicts.

The error of a simulated position integrates the errors of the measured force. It drifts, and neighboring samples repeat it.
Least squares then weights slow errors too much. An autoregressive model of the residual takes out what is predicted
(Ljung, System Identification, 1999, section 3.2), and what is left is white.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stribeck.arrays import Array

WHITE = np.ones(1)  # the filter of a residual that is white
_ORDERS = (1, 2, 3, 4, 6, 8, 12, 16, 24, 32)  # steps of a third or more, which BIC tells apart; trials chose 24 at most
_ENOUGH = 4 * _ORDERS[-1]  # samples of a piece: four for each coefficient of the largest model
_FAINT = 1e-13  # of the largest: smaller products of lagged residuals are rounding


def prediction_filter(parts: Sequence[Array]) -> Array:
    """The filter that makes a residual white with deviation 1, from its pieces; ``WHITE`` if it is white.

    BIC chooses the order.
    """
    long = [x for x in parts if len(x) >= _ENOUGH and np.isfinite(x).all()]
    if not long:
        return WHITE
    most = _ORDERS[-1]
    lagged = np.concatenate([np.lib.stride_tricks.sliding_window_view(x, most + 1)[:, ::-1] for x in long])
    products, rows = lagged.T @ lagged / len(lagged), len(lagged)
    best, chosen = products[0, 0], WHITE
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

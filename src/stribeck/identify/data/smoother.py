"""The smoother of a measured motion, with the order and the cut-off that are most likely for the record.

Let the n-th derivative of the motion be white noise, and let the measurement add white noise. Then the Kalman smoother gives
the best estimate of the motion. Inside a long record it is a Butterworth filter of order n that runs forwards and backwards.
Its cut-off is the frequency at which motion and noise have the same spectral density. The likelihood of Gaussian noise is
largest where the one-step prediction errors of the Kalman filter are least.
See Harvey (1989), Forecasting, Structural Time Series Models and the Kalman Filter, 3.4. A speed that jumps has a low
order, a smooth motion the highest. The noise is at least that of quantization, which a slow motion does not show.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy import signal
from scipy.interpolate import BSpline, make_interp_spline, make_smoothing_spline
from scipy.optimize import minimize_scalar

from stribeck.arrays import Array
from stribeck.identify.data.filters import HIGHEST, ORDER, SETTLED

_SETTLES = 0.25  # of the longest run: the longest time in which the filter may settle
LOOK = 1 << 18  # samples that are predicted: fewer already determine the cut-off
_STEP, _CLOSE = 1.3, 0.01  # ratio of the cut-offs on the first grid; relative error at which the search ends
_WHOLE = 0.1  # of an encoder step: rounding of the unit conversion
_FAINT, _REAL, _LEAST = 1e-6, 1e-12, 1e-300  # zero except for rounding: of a motion, a pole, a square
_FEWEST = 5  # samples of a smoothing spline: a cubic through fewer leaves no noise


class Smoother(NamedTuple):
    """The most likely filter of a motion.

    Attributes:
        order: the derivative of the motion that is modeled as white noise.
        cutoff: frequency at which motion and noise have the same spectral density, Hz.
        noise: spectral density of the noise.
    """

    order: int
    cutoff: float
    noise: float


def likeliest(runs: Sequence[Array], step: float, orders: Sequence[int] = range(1, ORDER + 1)) -> Smoother:
    """The maximum-likelihood smoother of the runs of a motion; ``step``: between samples, s."""
    highest, longest = HIGHEST / step, max(map(len, runs)) * step
    ends = min(SETTLED / (_SETTLES * longest), highest), highest
    some = _shortened(runs)
    least = max(encoder_step(some) ** 2 / 12, _LEAST)  # the variance of rounding
    return min((_of_order(n, some, step, ends, least) for n in orders), key=lambda each: each[0])[1]


def smoothing(t: Array, x: Array) -> float:
    """The parameter of the likeliest cubic smoothing spline of a signal that may lack samples: the smoother of order 2.

    It is 0 if there are too few samples to see their noise.
    """
    if len(t) < _FEWEST:
        return 0.0
    steps = np.diff(t)
    step = float(np.median(steps))
    gaps = np.flatnonzero(steps > 1.5 * step) + 1  # two steps lack a sample
    runs = [part for part in np.split(x, gaps) if len(part) > 2]
    cutoff = likeliest(runs or [x], step, orders=(2,)).cutoff
    return float(1 / (step * (2 * np.pi * cutoff) ** 4))  # the spline's gain at the cut-off is one half


def smooth(t: Array, x: Array, parameter: float) -> BSpline:
    """The cubic smoothing spline with this parameter; the polynomial through too few samples."""
    if len(t) < _FEWEST:
        return make_interp_spline(t, x, k=min(3, len(t) - 1))
    return make_smoothing_spline(t, x, lam=parameter)


def _of_order(
    order: int, runs: Sequence[Array], step: float, ends: tuple[float, float], least: float
) -> tuple[float, Smoother]:
    """The least deviance for cut-offs between ends (Hz), and its smoother; ``least``: least variance of the noise."""
    differences = [np.diff(x, order) for x in runs]

    def deviance(log_cutoff: float) -> tuple[float, float]:
        """The deviance, and the variance of the noise by the prediction errors, or the least."""
        cutoff = float(np.exp(log_cutoff)) * step
        poles = _poles(order, cutoff)
        errors, gain = (
            _prediction_error(differences, poles),
            np.prod(abs(1 - poles)) ** 2 / (2 * np.sin(np.pi * cutoff)) ** (2 * order),
        )
        noise = max(errors * float(gain), least)
        return float(np.log(noise / gain) + errors * gain / noise), noise

    low, high = np.log(ends)
    tried = np.linspace(low, high, 2 + int((high - low) / np.log(_STEP)))
    i = int(np.argmin([deviance(x)[0] for x in tried]))
    around = tried[max(i - 1, 0)], tried[min(i + 1, len(tried) - 1)]
    minimum = minimize_scalar(lambda x: deviance(x)[0], bounds=around, method="bounded", options={"xatol": _CLOSE})
    value, noise = deviance(float(minimum.x))
    return value, Smoother(order, float(np.exp(minimum.x)), 2 * step * noise)


def encoder_step(runs: Sequence[Array]) -> float:
    """The quantization step of a motion, or 0 if not all changes are multiples of the smallest."""
    changes = np.concatenate([abs(np.diff(x)) for x in _shortened(runs)])
    if not changes.any():
        return 0.0
    least = float(np.min(changes[changes > 0]))
    off = np.remainder(changes + least / 2, least) - least / 2  # a quotient may overflow
    return least if float(np.max(abs(off))) < _WHOLE * least else 0.0


def _shortened(runs: Sequence[Array]) -> list[Array]:
    """The first samples of all runs, at most ``LOOK``."""
    ends = np.cumsum([len(x) for x in runs])
    return [x[: LOOK - (end - len(x))] for x, end in zip(runs, ends, strict=True) if end - len(x) < LOOK]


def _poles(order: int, cutoff: float) -> Array:
    """The poles of the Kalman filter's prediction error, by spectral factorization; the cut-off in cycles per sample.

    Its spectrum is flat: that of the motion's differences is noise * (|1 - z|^(2 order) + (2 sin(pi cut-off))^(2 order)).
    """
    size = (2 * np.sin(np.pi * cutoff)) ** 2
    half = 1 - size / 2 * np.exp(1j * np.pi * (2 * np.arange(order) + 1) / order)
    root = np.sqrt(half**2 - 1)
    return np.asarray(np.where(abs(half - root) < 1, half - root, half + root))


def _prediction_error(differences: Sequence[Array], poles: Array) -> float:
    """The mean square of the one-step prediction errors, from differences of the motion.

    The errors before a run are unknown. Their effect is a sum of the filter's free responses, and is projected out.
    """
    sections, total, count = signal.zpk2sos(np.zeros(len(poles)), poles, 1.0), 0.0, 0
    lasts = 1 + int(np.log(_FAINT) / np.log(abs(poles).max()))
    above = poles[poles.imag > -_REAL]  # one of each conjugate pair
    for x in differences:
        errors = signal.sosfilt(sections, x)
        responses = above ** np.arange(min(len(x), lasts))[:, None]
        basis = np.linalg.qr(np.hstack([responses.real, responses.imag[:, above.imag > _REAL]]))[0]
        errors[: len(basis)] -= basis @ (basis.T @ errors[: len(basis)])
        total, count = total + float(errors @ errors), count + len(errors)
    return total / count

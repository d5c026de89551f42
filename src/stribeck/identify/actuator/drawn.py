"""Effects of measurement errors of known size on all residuals, as random draws: noise, missing samples, filters.

A simulation follows its inputs, so these are errors in variables. Their residuals are correlated over a whole recording.
Some errors are available as alternative recordings: noise added once more behind the filter (Cook and Stefanski 1994), or
another filter. These recordings are fitted again, and the shift of the estimates shows the bias.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.actuator.problem import MachineProblem
from stribeck.identify.actuator.residuals import by_column, floor_of
from stribeck.identify.actuator.runs import RecordedRun, rms
from stribeck.identify.actuator.solve import left_step
from stribeck.identify.features.filtering import roughness
from stribeck.waveforms import Signal

_ORDER = 6  # of the differences that estimate noise: a high order removes fast inputs
_DRAWS = 24  # they give a deviation to 15 %
_AS_WELL = 1.2  # ratio of rms residuals up to which two agree: white noise reaches 1 to some hundredths
_MOST = 0.49  # largest relative change: the extrapolation is singular at one half


def input_errors(problem: MachineProblem, u: Array, J: Array) -> list[Array]:
    """The changes of the residuals by each source of errors, (draws, residuals); ``J``: the Jacobian.

    An input's noise may move the estimates most where it is a small part of the residual: the output's noise is averaged.
    """
    draws, noise = [*_fitted_again(problem, u, J)], _by_noise(problem, u)
    if noise is not None and np.isfinite(noise).all():
        draws.append(noise * _possible(noise, problem.residuals(u[None])[0], J))
    return [x for x in draws if np.isfinite(x).all()]


def _possible(changes: Array, r: Array, J: Array) -> float:
    """The share of drawn changes that the residual allows.

    The command of a controller on an encoder is as rough as noise, and is none: as noise it would leave a larger residual.
    """
    left = changes - np.linalg.lstsq(J, changes.T, rcond=None)[0].T @ J.T
    size = float(np.linalg.norm(left)) / float(np.sqrt(len(left)))
    return min(1.0, float(np.linalg.norm(r)) / max(size, 1e-300))


def change_by(problem: MachineProblem, u: Array, r: Array, runs: list[RecordedRun]) -> Array:
    """The change of the residuals with other runs; priors are unchanged."""
    off, compared = np.zeros(len(r)), int(problem.first[-1])
    off[:compared] = replace(problem, runs=runs).residuals(u[None])[0][:compared] - r[:compared]
    return off


def _alternatives(problem: MachineProblem) -> Iterator[list[list[RecordedRun]]]:
    """By cause, the alternative recordings."""
    for cause in dict.fromkeys(cause for run in problem.runs for cause in run.as_well):
        count = max(len(run.as_well.get(cause, ())) for run in problem.runs)
        yield [
            [run.instead(run.as_well[cause][n]) if cause in run.as_well else run for run in problem.runs]
            for n in range(count)
        ]


def _fitted_again(problem: MachineProblem, u: Array, J: Array) -> Iterator[Array]:
    """By cause, changes of the residuals that move the estimates as a fit of the alternative recordings does.

    The move is a Gauss-Newton step with the alternative's own Jacobian, which contains the bias. The same step for the
    fit's own recordings is subtracted.
    """
    base: Array | None = None
    for same in _alternatives(problem):
        base = _newton(problem, u) if base is None else base
        others = [replace(problem, runs=runs) for runs in same]
        yield np.array([J @ _extrapolated(problem, _newton(other, u) - base) for other in others])


def _extrapolated(problem: MachineProblem, step: Array) -> Array:
    """The bias of the estimates, from the step that the same errors cause when added once more.

    An attenuated estimate falls as 1/(1 + s), and as 1/(1 + 2 s) with the errors added once more. This is the rational
    extrapolant of Carroll, Ruppert, Stefanski and Crainiceanu (Measurement Error in Nonlinear Models, 2006, chapter 5). It
    is applied to numbers searched by their logarithm, whose steps are relative changes. A lower filter and another drive
    between samples are no errors added once more: for them it is a larger step to the same side.
    """
    share = np.minimum(abs(step), _MOST)
    far = np.sign(step) * np.log((1 - share) / (1 - 2 * share))
    return np.where([c.logarithmic for c in problem.sought], far, step)


def _newton(problem: MachineProblem, u: Array) -> Array:
    """The Gauss-Newton step."""
    r, J = problem.slopes(u[None])
    return left_step(problem, u, r[0], J[0])


def _by_noise(problem: MachineProblem, u: Array) -> Array | None:
    """Changes of the residuals by each recorded input's noise, given or estimated from sample to sample without steps."""
    sizes = []
    for run in problem.runs:
        noise = {p: x.noise or roughness([x.x], _ORDER, typical=True) for p, x in run.inputs.items()}
        sizes.append({p: size for p, size in noise.items() if size > 0})
    if not any(sizes):
        return None
    rng, signals = np.random.default_rng(0), [defaultdict[str, list[Signal]](list) for _ in problem.runs]
    for _ in range(_DRAWS):
        for run, size, noisy in zip(problem.runs, sizes, signals, strict=True):
            for p, s in size.items():
                drive = run.inputs[p]
                noisy[p].append(replace(drive, x=drive.x + s * rng.standard_normal(len(drive.x))).signal())
    points, r = np.repeat(u[None], _DRAWS, axis=0), problem.plain(u[None])[0]
    off = np.zeros((_DRAWS, len(r)))
    columns = [x for k, run in enumerate(problem.runs) for x in problem.predicted(run, k, points, signals=signals[k])]
    for (_, target, rows), x in zip(problem.pieces, columns, strict=True):
        off[:, rows] = (x - target.x) / problem.noise[target.column] - r[rows]
    return problem.whitened(off)


def above_noise(problem: MachineProblem, u: Array) -> bool:
    """Whether a residual is larger than the noise of its column, and that of the inputs, explain."""
    columns, drawn = by_column(problem, problem.plain(u[None])[0]), _by_noise(problem, u)
    inputs = by_column(problem, np.zeros(problem.size) if drawn is None else np.sqrt(np.mean(drawn**2, axis=0)))
    least = {n: np.hypot(max(floor_of(problem, n), roughness(x)), rms(inputs[n])) for n, x in columns.items()}
    return any(not rms(x) <= _AS_WELL * least[n] for n, x in columns.items())  # nan: the simulation fails there

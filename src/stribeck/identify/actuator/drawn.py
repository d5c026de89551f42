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
from stribeck.identify.actuator.runs import RecordedRun
from stribeck.identify.actuator.solve import direction
from stribeck.identify.features.filtering import typical_roughness
from stribeck.waveforms import Signal

ORDER = 6  # of the differences that estimate noise: a high order removes fast inputs
PILOT, DRAWS = 4, 24  # draws that decide whether the noise matters; draws that give a deviation to 15 %
LITTLE = 0.02  # of the residual sum of squares: a smaller contribution does not matter
FAINT = 1e-9  # damping of a step: only against rounding
MOST = 0.49  # largest relative change: the extrapolation is singular at one half


def input_errors(problem: MachineProblem, u: Array, J: Array) -> list[Array]:
    """The changes of the residuals by each relevant source of errors, (draws, residuals); ``J``: the Jacobian."""
    r = problem.residuals(u[None])[0]
    found = [_by_gaps(problem, u, r), *_fitted_again(problem, u, J)]
    pilot = _by_noise(problem, u, r, PILOT)
    if pilot is not None and np.mean(pilot**2) * problem.size > LITTLE * float(r @ r):
        found.append(_by_noise(problem, u, r, DRAWS))
    return [x for x in found if x is not None and np.isfinite(x).all()]


def carried(problem: MachineProblem, u: Array) -> dict[str, float]:
    """The rms effect of these errors on each column at a point, without fitting again."""
    r = problem.residuals(u[None])[0]
    draws = [*_as_well(problem, u, r), _by_gaps(problem, u, r), _by_noise(problem, u, r, PILOT)]
    square = sum((np.mean(x**2, axis=0) for x in draws if x is not None and np.isfinite(x).all()), np.zeros(len(r)))
    of: dict[str, list[Array]] = {}
    for k, run in enumerate(problem.runs):
        at = int(problem.first[k])
        for target in run.targets:
            of.setdefault(target.column, []).append(square[at : at + len(target.t)])
            at += len(target.t)
    return {n: float(np.sqrt(np.mean(np.concatenate(parts)))) * problem.noise[n] for n, parts in of.items()}


def _alternatives(problem: MachineProblem) -> Iterator[list[list[RecordedRun]]]:
    """By cause, the alternative recordings."""
    for cause in dict.fromkeys(cause for run in problem.runs for cause in run.as_well):
        count = max(len(run.as_well[cause]) for run in problem.runs)
        yield [[run.instead(run.as_well[cause][n]) for run in problem.runs] for n in range(count)]


def _as_well(problem: MachineProblem, u: Array, r: Array) -> Iterator[Array]:
    """The change of the residuals with the alternative recordings, by cause."""
    for same in _alternatives(problem):
        yield np.array([_moved(problem, u, r, runs) for runs in same])


def _fitted_again(problem: MachineProblem, u: Array, J: Array) -> Iterator[Array]:
    """By cause, changes of the residuals that move the estimates as a fit of the alternative recordings does.

    The move is a Gauss-Newton step with the alternative's own Jacobian, which contains the bias. The same step for the
    fit's own recordings is subtracted.
    """
    base: Array | None = None
    for same in _alternatives(problem):
        base = _newton(problem, u) if base is None else base
        others = [replace(problem, runs=runs, noise=dict(problem.noise)) for runs in same]
        yield np.array([J @ _extrapolated(problem, _newton(other, u) - base) for other in others])


def _extrapolated(problem: MachineProblem, step: Array) -> Array:
    """The bias of the estimates, from the step that the same errors cause when added once more.

    An attenuated estimate falls as 1/(1 + s), and as 1/(1 + 2 s) with the errors added once more. This is the rational
    extrapolant of Carroll, Ruppert, Stefanski and Crainiceanu (Measurement Error in Nonlinear Models, 2006, chapter 5). It
    is applied to numbers searched by their logarithm, whose steps are relative changes. A lower filter and another drive
    between samples are no errors added once more: for them it is a larger step to the same side.
    """
    share = np.minimum(abs(step), MOST)
    far = np.sign(step) * np.log((1 - share) / (1 - 2 * share))
    return np.where([c.logarithmic for c in problem.sought], far, step)


def _newton(problem: MachineProblem, u: Array) -> Array:
    """The Gauss-Newton step."""
    r, J = problem.slopes(u[None], np.full(len(u), problem.step))
    return direction(r[0], J[0], u, problem, FAINT)


def _moved(problem: MachineProblem, u: Array, r: Array, runs: list[RecordedRun]) -> Array:
    """The change of the residuals with other runs; priors are unchanged."""
    own, off = replace(problem, runs=runs, noise=dict(problem.noise), tied=False), np.zeros(len(r))
    compared = int(problem.first[-1])
    off[:compared] = own.residuals(u[None])[0][:compared] - r[:compared]
    return off


def _by_noise(problem: MachineProblem, u: Array, r: Array, draws: int) -> Array | None:
    """Changes of the residuals by each recorded input's noise, given or estimated from sample to sample without steps."""
    sizes = []
    for run in problem.runs:
        of = {p: typical_roughness([x.x], ORDER) if x.noise is None else x.noise for p, x in run.inputs.items()}
        sizes.append({p: size for p, size in of.items() if size > 0})
    if not any(sizes):
        return None
    rng, signals = np.random.default_rng(0), [defaultdict[str, list[Signal]](list) for _ in problem.runs]
    for _ in range(draws):
        for run, size, own in zip(problem.runs, sizes, signals, strict=True):
            for p, s in size.items():
                drive = run.inputs[p]
                own[p].append(replace(drive, x=drive.x + s * rng.standard_normal(len(drive.x))).signal())
    found = np.zeros((draws, len(r)))
    for k, (run, own) in enumerate(zip(problem.runs, signals, strict=True)):
        at, columns = int(problem.first[k]), problem.predicted(run, k, np.repeat(u[None], draws, axis=0), signals=own)
        for target, x in zip(run.targets, columns, strict=True):
            rows = slice(at, at := at + len(target.t))
            found[:, rows] = (x - target.x) / problem.noise[target.column] - r[rows]
    return found


def _by_gaps(problem: MachineProblem, u: Array, r: Array) -> Array | None:
    """Changes of the residuals by the interpolation error of inputs in their gaps."""
    draws = max(len(run.otherwise) for run in problem.runs)
    if not draws:
        return None
    found = []
    for n in range(draws):
        off = np.zeros(len(r))
        for k, run in enumerate(problem.runs):
            if n < len(run.otherwise):
                runs = [*problem.runs]
                runs[k] = replace(run, scenario=run.otherwise[n])
                off += run.doubt * _moved(problem, u, r, runs)
        found.append(off)
    return np.array(found)

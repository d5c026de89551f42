"""Whether the noise of what drives the machine explains what is left: a simulation follows it, and slips and drift grow."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.actuator.estimate import BestPoint, floor_of
from stribeck.identify.actuator.intervals import Spread, places, spread
from stribeck.identify.actuator.problem import Colour, MachineProblem
from stribeck.identify.actuator.runs import RecordedRun, roughness, typical_roughness
from stribeck.identify.actuator.solve import search

_ORDER = 6  # of the differences that are noise: an input may be fast
_EXPLAINS = 0.5  # of what is left
_PILOT, _FEWEST, _DRAWS = 4, 24, 128  # draws of the inputs' noise: to see whether it matters; of each run; of all
_WEIGHINGS = 2  # the draws are those at the numbers found with the ones before
_LITTLE = 0.02  # of the sum of squares that is left
_COMMON = (0.02, 0.95)  # shares of the draws between which what is left is usual
MUCH = 1e-3  # of an input's changes: less noise says more of a poor point, where all grows, than of the recording
_MORE = 4.0  # times the usual: more is no noise of the inputs


def otherwise_held(problem: MachineProblem) -> tuple[MachineProblem, str] | None:
    """The problem with its inputs held from sample to sample, or straight where all are held, and that in words; None
    where no input was recorded."""
    drives = [x for run in problem.runs for x in run.inputs.values() if not x.spline]
    if not drives:
        return None
    held = not all(x.held for x in drives)
    runs = [
        run.driven({p: replace(x, held=held and not x.spline) for p, x in run.inputs.items()}) for run in problem.runs
    ]
    words = "held from sample to sample (held = true)" if held else "straight from sample to sample (held = false)"
    return replace(problem, runs=runs, noise=dict(problem.noise), tied=False), words


def bent(problem: MachineProblem) -> MachineProblem | None:
    """The problem with inputs that bend between their samples where they run straight; None where none does."""
    smooth = [{p: x.smooth() for p, x in run.inputs.items()} for run in problem.runs]
    if all(x is run.inputs[p] for run, each in zip(problem.runs, smooth, strict=True) for p, x in each.items()):
        return None
    runs = [run.driven(each) for run, each in zip(problem.runs, smooth, strict=True)]
    return replace(problem, runs=runs, noise=dict(problem.noise), tied=False)


def noises(run: RecordedRun) -> dict[str, float]:
    """The noise of each recorded input: as given, or what changes from sample to sample; steps, which few samples take, are
    no noise."""
    found = {}
    for path, x in run.inputs.items():
        found[path] = x.noise if x.noise is not None else typical_roughness(x.x, _ORDER)
    return {path: size for path, size in found.items() if size > 0}


def _moved(problem: MachineProblem, u: Array, k: int, draws: int, seed: int) -> Array | None:
    """The residuals of a run as noise of its inputs moves them, a row for each draw; None where it has none."""
    run, rng, found = problem.runs[k], np.random.default_rng([seed, k]), list[Array]()
    if not (size := noises(run)):
        return None
    r = problem.raw(u[None])[0][problem.first[k] : problem.first[k + 1]]
    for _ in range(draws):
        noisy = {
            p: replace(x, x=x.x + size[p] * rng.standard_normal(len(x.x))) for p, x in run.inputs.items() if p in size
        }
        own = replace(problem, runs=[run.driven(noisy)], noise=dict(problem.noise), tied=False, colours=())
        found.append(own.raw(u[None])[0][: run.size] - r)
    rows = np.array(found)
    return rows if np.isfinite(rows).all() else None


def drawn(problem: MachineProblem, u: Array, seed: int) -> Array | None:
    """The residuals of all runs as noise of the inputs moves them, a row for each draw; None where it moves little."""
    draws = max(_FEWEST, _DRAWS // len(problem.runs))
    found, r = np.zeros((draws, problem.size)), problem.raw(u[None])[0]
    for k in range(len(problem.runs)):
        rows = slice(problem.first[k], problem.first[k + 1])
        few = _moved(problem, u, k, _PILOT, 0)
        if few is None or not np.mean(few**2) > _LITTLE * np.mean(r[rows] ** 2):
            continue
        more = _moved(problem, u, k, draws, seed)
        if more is None:
            return None
        found[:, rows] = more
    return found if found.any() else None


def moved_by_noise(problem: MachineProblem, u: Array, s: Spread) -> tuple[Array, bool] | None:
    """The residuals as noise of the inputs moves them, a row for each draw, as large as what is left allows; and whether that
    explains all that is left beside noise from sample to sample. None where it moves little.

    The numbers sought follow the noise, so what is left is less than what it moved: both are compared without what follows.
    """
    found = drawn(problem, u, 1)
    if found is None or problem.colours:
        return None if found is None else (problem.whitened(found), True)
    left = found - found @ s.J @ s.covariance @ s.J.T
    r, scale, explained = problem.raw(u[None])[0], 0.0, True
    given = all(x.noise is not None for run in problem.runs for x in run.inputs.values())
    for column in problem.noise:
        parts = [slice(at, at + size) for at, size, name in places(problem) if name == column]
        slow = sum(float(np.sum(r[x] ** 2)) - r[x].size * roughness([r[x]]) ** 2 for x in parts)
        own = np.sum([np.sum(left[:, x] ** 2, axis=1) for x in parts], axis=0)
        low, high = np.quantile(own, _COMMON)
        explained &= slow <= _MORE * high
        scale = max(scale, slow / high if slow > high else 1.0 if given or slow >= low else max(slow, 0.0) / low)
    return np.sqrt(scale) * found, explained


def weighed(best: BestPoint) -> BestPoint | None:
    """The fit with residuals made white by what noise of the inputs does to them, where that explains what is left beyond the
    noise from sample to sample; else None."""
    problem, u = best.problem, best.u
    found = moved_by_noise(problem, u, spread(problem, u))
    if found is None or not found[1]:
        return None
    r = problem.raw(u[None])[0]
    for column, old in problem.noise.items():
        parts = [r[at : at + size] for at, size, name in places(problem) if name == column]
        problem = replace(
            problem, noise={**problem.noise, column: max(old * roughness(parts), floor_of(problem, column))}
        )
    for seed in range(_WEIGHINGS):
        draws = drawn(problem, u, 2 + seed)
        if draws is None:
            return None
        colours = tuple(Colour.of(draws[:, a:b]) for a, b in pairwise(problem.first))
        problem = replace(problem, noise=dict(problem.noise), colours=colours)
        end = search(problem, 1, 0, u)
        u = end.u
    return replace(best, problem=problem, u=u, found=replace(end, agreeing=best.found.agreeing))


def by_noise(problem: MachineProblem, u: Array, least: float = 0.0, below: float = np.inf) -> list[str]:
    """The recordings in which noise of the inputs, as large as what changes from sample to sample, and from ``least`` to
    ``below`` by their changes, moves the outputs as far as they are missed, in words."""
    for k, run in enumerate(problem.runs):
        rough = noises(run)
        if not rough or not least <= max(_share(run, rough, path) for path in rough) < below:
            continue
        off = _moved(problem, u, k, 1, 0)
        r = problem.raw(u[None])[0][problem.first[k] : problem.first[k + 1]]
        if off is not None and not np.linalg.norm(off) < _EXPLAINS * np.linalg.norm(r):
            return [
                f"{run.name}: noise in its inputs ({in_words(run)}) moves the simulated outputs as far as they are missed: short "
                "windows (window = 0.3) keep that from adding up"
            ]
    return []


def _share(run: RecordedRun, rough: dict[str, float], path: str) -> float:
    """The noise of an input by its changes."""
    return rough[path] / max(float(np.std(run.inputs[path].x)), 1e-300)


def in_words(run: RecordedRun) -> str:
    """The input with the most noise, and how much."""
    rough = noises(run)
    worst = max(rough, key=lambda path: _share(run, rough, path))
    return f"{worst}: {rough[worst]:.2g} from sample to sample"

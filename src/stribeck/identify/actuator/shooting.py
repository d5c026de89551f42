"""Multiple shooting: consecutive stretches of recordings, each with its own initial state.

Unmeasured initial states (bristles, currents, unmeasured bodies) continue the stretch before. The ends are tied to the next
starts with the accuracy to which the samples determine these.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from stribeck.arrays import Array
from stribeck.identify.actuator.problem import MachineProblem
from stribeck.identify.actuator.runs import RecordedRun
from stribeck.identify.actuator.solve import Found, half_squares, search

_ROUNDS, _TIED_ROUNDS = 12, 3
_STEPS = 5  # of the search between two updates of the unmeasured initial states
_SHARES = (1.0, 0.3, 0.1)  # tried steps toward the end of the stretch before
_WORSE = 1.1
_LITTLE = 1e-6  # mean square residual, by the noise, that does not matter
_SETTLED = 1e-3  # of the largest shift of a state


def joined_stretches(
    problem: MachineProblem, u: Array, keep: Callable[[Array, float], None] | None,
    weigh: Callable[[MachineProblem, Array], None],
) -> tuple[MachineProblem, Found] | None:  # fmt: skip
    """The problem with tied stretches and its best point; None if there is nothing to tie or no convergence.

    ``weigh`` sets the noise to the residual. While the residual is large, the ties are loose.
    """
    if not replace(problem, tied=True).ties:
        return None
    for _ in range(_ROUNDS):
        moved = _handed_on(problem, u, keep)
        if moved is None:
            return None
        change = max((_far(a.shift, b.shift) for a, b in zip(moved[0].runs, problem.runs, strict=True)), default=0.0)
        problem, u = moved[0], moved[1].u
        if moved[1].stopped:
            return moved
        if change < _SETTLED:
            break
    problem = replace(problem, tied=True)
    for _ in range(_TIED_ROUNDS):
        weigh(problem, u)
        found = search(problem, 1, 0, u, keep, steps=_STEPS)
        u = found.u
        if found.stopped:
            break
    return problem, found


def _handed_on(
    problem: MachineProblem, u: Array, keep: Callable[[Array, float], None] | None
) -> tuple[MachineProblem, Found] | None:
    """Move the unmeasured initial states to the ends of the stretches before, at most as far as the fit stays as good."""
    before = float(half_squares(problem.residuals(u[None]))[0])
    asked = relayed(problem, u)
    for share in _SHARES:
        runs = []
        for old, new in zip(problem.runs, asked, strict=True):
            shift = {n: old.shift.get(n, 0.0) + share * (x - old.shift.get(n, 0.0)) for n, x in new.shift.items()}
            runs.append(replace(old, shift=shift))
        own = replace(problem, runs=runs)
        found = search(own, 1, 0, u, keep, steps=_STEPS)
        if found.stopped or found.cost <= _WORSE * before + 0.5 * problem.size * _LITTLE:
            return own, found
    return None


def _far(new: dict[str, float], old: dict[str, float]) -> float:
    size = max((abs(x) for x in new.values()), default=0.0)
    return max((abs(x - old.get(name, 0.0)) for name, x in new.items()), default=0.0) / size if size > 0 else 0.0


def relayed(problem: MachineProblem, u: Array) -> list[RecordedRun]:
    """The runs. States that no coordinate sets continue the run before."""
    return replace(problem, tied=True).handed_on(u)

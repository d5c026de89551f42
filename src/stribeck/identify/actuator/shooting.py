"""Multiple shooting: stretches of recordings that follow each other, each with a start of its own.

What the start of a stretch does not set (bristles, currents, bodies that nobody measures) begins where the stretch before
ended, and the ends are tied to the starts by what the samples tell of these.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from stribeck.arrays import Array
from stribeck.identify.actuator.problem import MachineProblem
from stribeck.identify.actuator.runs import RecordedRun
from stribeck.identify.actuator.solve import Found, half_squares, search

_ROUNDS, _TIED_ROUNDS = 12, 3
_STEPS = 5  # of the search between two looks at where stretches end
_SHARES = (1.0, 0.3, 0.1)  # of the way to where the stretch before ends
_WORSE = 1.1
_LITTLE = 1e-6  # of what is compared, by its noise
_SETTLED = 1e-3  # of the largest shift of a state


def joined_stretches(
    problem: MachineProblem, u: Array, keep: Callable[[Array, float], None] | None,
    weigh: Callable[[MachineProblem, Array], None],
) -> tuple[MachineProblem, Found] | None:  # fmt: skip
    """The problem with its stretches tied to each other, and its best point; None where there is nothing to tie, or the
    stretches do not come to meet.

    ``weigh`` sets the noise to what is left: as long as that is much, the ties are loose.
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
    """The stretches begun where those before end, or a part of the way there, so that they are followed as well."""
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
    """The runs, each with the states that nothing else sets as the run before left them."""
    return replace(problem, tied=True).handed_on(u)

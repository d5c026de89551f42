"""Simulation of scenarios: one, or many at once with other numbers."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, overload

from stribeck.errors import InputError, arg, note
from stribeck.scenario import Scenario
from stribeck.simulation import single
from stribeck.simulation.solution import Solution

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from stribeck.scenario.objects import Machine
    from stribeck.simulation.ensemble import Ensemble

__all__ = ["Ensemble", "Solution", "simulate"]


@overload
def simulate(
    what: Scenario | Machine | str | Path | Mapping[str, object], vary: None = None, *, t_end: float | None = None,
    step: float | None = None, threads: None = None, progress: Callable[[float], None] | None = None, **solve: object,
) -> Solution: ...  # fmt: skip


@overload
def simulate(
    what: Scenario | Machine | str | Path | Mapping[str, object], vary: Mapping[str, ArrayLike], *,
    t_end: float | None = None, step: float | None = None, threads: int | None = None,
    progress: Callable[[float], None] | None = None, **solve: object,
) -> Ensemble: ...  # fmt: skip


def simulate(
    what: Scenario | Machine | str | Path | Mapping[str, object],
    vary: Mapping[str, ArrayLike] | None = None,
    *,
    t_end: float | None = None,
    step: float | None = None,
    threads: int | None = None,
    progress: Callable[[float], None] | None = None,
    **solve: object,
) -> Solution | Ensemble:
    """Simulate a scenario or a machine, once or for many values of some of its numbers.

    The first simulation of a structure (law, drive, kind of signal) compiles it, in about 0.3 s. Later ones, in this process or
    another, find it in the cache. With ``vary``, lane i takes the i-th value of every path:
    ``simulate(s, {"law.k_v": [1e6, 1e7], "plant.mass": [1, 2]})`` has two lanes. A lane is one simulation of a batch.

    Args:
        what: a scenario, a machine, the path of its file, or its tables.
        vary: values by path, as many for each path as there are lanes; a single number holds for all. Constants of laws,
            drives and signals, masses and initial values can be varied.
        t_end: end of the simulation, s; required for a :class:`Machine`.
        step: time between rows, s; of a :class:`Machine` t_end/1000 unless given.
        threads: with ``vary``, number of threads; all cores unless given.
        progress: called from time to time with the share done, 0 to 1.
        **solve: other values of [solve], such as ``rtol=1e-10``; of a :class:`Machine` also ``energy=True``.

    Returns:
        The solution; with ``vary`` the ensemble of all lanes. If a computation fails, ``status`` is "failed", ``reason`` states
        why, and the rows up to there are kept. Other lanes continue.

    Raises:
        InputError: if the file or the tables are not a valid scenario, a path cannot be varied, its values are not numbers,
            or the rows do not fit into memory.
    """
    if vary is not None:
        from stribeck.simulation.ensemble import inaccurate_lanes, simulate_ensemble

        ensemble = simulate_ensemble(what, vary, t_end=t_end, step=step, threads=threads, progress=progress, **solve)  # type: ignore[arg-type]
        if text := inaccurate_lanes(int(ensemble.inaccurate.sum()), len(ensemble)):
            note(text)
        return ensemble
    if threads is not None:
        raise InputError(f"{arg('threads')}: {threads}: goes with vary, which is not given")
    return single.simulate_once(what, progress, t_end=t_end, step=step, **solve)


def __getattr__(name: str) -> object:
    """Ensembles are read at first use: one run needs none of them."""
    if name != "Ensemble":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from stribeck.simulation import ensemble

    return getattr(ensemble, name)

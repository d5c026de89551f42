"""Every ensemble of a fit or a design on a Dask cluster: its lanes are sent out as numbers, and come back to the last bit as
this machine would have made them."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Lock

import numpy as np

from stribeck.scenario import Scenario
from stribeck.simulation import lanes
from stribeck.simulation.lanes import Outcome, Progress
from stribeck.simulation.variations import Variations
from stribeck.sweeps import worker
from stribeck.sweeps.cluster import Call, Workers, connected

_VECTOR = 8  # lanes that a processor solves beside each other: no part has fewer
_Shared = tuple[str, dict[str, bytes]]


@contextmanager
def on_cluster(on: str) -> Iterator[None]:
    """Within, the lanes of ensembles, fits of machines and designs are solved by the workers of a Dask cluster.

    Their numbers are those of this machine to the last bit: workers that would make others are left out, and named; what a
    worker had in hand that dies goes to another one.

    Args:
        on: ``"dask://HOST:PORT"``, the scheduler of a cluster; ``"dask"`` starts one of processes on this machine
            (``pip install 'stribeck[cluster]'``).

    Raises:
        InputError: ``on`` is something else, or no scheduler answers there.
        StribeckError: there is no C compiler here; within, the scheduler went away or no worker can solve the lanes.
    """
    with connected(on) as workers, lanes.solved_by(_Far(workers).solve):
        yield


class _Far:
    """Sends lanes to workers, with a text of what they share, from which each worker builds its solver once."""

    def __init__(self, workers: Workers) -> None:
        self.workers = workers
        self._lock, self._shared = Lock(), dict[tuple[Scenario, tuple[tuple[str, float], ...]], _Shared]()

    def solve(self, library: ctypes.CDLL, variations: Variations, progress: Progress | None) -> Outcome:
        """All lanes, in parts of whole vectors."""
        text, first_lane = self._sent(library, variations)
        threads, count = max(sum(self.workers.threads().values()), 1), len(variations)
        size = _VECTOR * max(1, -(-count // (_VECTOR * threads)))
        found: dict[int, Outcome] = {}

        def call(part: int) -> Call[worker.SolvedLanes]:
            numbers = {path: x[part * size : (part + 1) * size].tobytes() for path, x in variations.values.items()}
            return worker.some_lanes, (text, first_lane, numbers)

        def take(part: int, made: worker.SolvedLanes) -> None:
            found[part] = Outcome(made["states"], made["t_reached"], made["counts"])
            if progress is not None:
                progress(min(len(found) * size / count, 1.0))

        self.workers.do(range(-(-count // size)), call, take)
        return Outcome.joined([found[part] for part in sorted(found)])

    def _sent(self, library: ctypes.CDLL, variations: Variations) -> _Shared:
        """The text of what the lanes share, with the digest of the first lane that was ever asked for, solved here; and that
        lane's values."""
        key = (variations.scenario, tuple(variations.shift.items()))
        with self._lock:
            if key not in self._shared:
                first = variations.part(np.array([0]))
                probe = lanes.solve_here(library, first, 1).digest
                text = worker.lanes_text(variations.scenario, variations.shift, probe)
                self._shared[key] = (text, {path: x.tobytes() for path, x in first.values.items()})
            return self._shared[key]

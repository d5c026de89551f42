"""Every ensemble of a fit or a design, and every answer of a law to a log, on a Dask cluster: sent out as numbers, they come
back to the last bit as this machine would have made them."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Lock

import numpy as np

from stribeck.scenario import Scenario
from stribeck.simulation import lanes, response
from stribeck.simulation.lanes import Outcome, Progress
from stribeck.simulation.variations import Variations
from stribeck.sweeps import worker
from stribeck.sweeps.cluster import Call, Workers, connected

_VECTOR = 8  # lanes that a processor solves beside each other: no part has fewer
_Shared = tuple[str, dict[str, bytes]]


@contextmanager
def on_cluster(on: str) -> Iterator[None]:
    """Within, the lanes of ensembles, fits and designs are solved by the workers of a Dask cluster; of the fit of a log, the
    law along the record from many starts and for many profiles at once.

    Their numbers are those of this machine to the last bit: workers that would make others are left out, and named; what a
    worker had in hand that dies goes to another one.

    Args:
        on: ``"dask://HOST:PORT"``, the scheduler of a cluster; ``"dask"`` starts one of processes on this machine
            (``pip install 'stribeck[cluster]'``).

    Raises:
        InputError: ``on`` is something else, or no scheduler answers there.
        StribeckError: there is no C compiler here; within, the scheduler went away or no worker can solve the lanes.
    """
    with connected(on) as workers:
        far = _Far(workers)
        with lanes.solved_by(far.solve), response.answered_by(far.answer):
            yield


class _Far:
    """Sends lanes to workers, with a text of what they share, from which each worker builds its solver once."""

    def __init__(self, workers: Workers) -> None:
        self.workers = workers
        self._lock, self._shared = Lock(), dict[Scenario, _Shared]()
        self._laws = dict[str, str]()

    def solve(self, library: ctypes.CDLL, variations: Variations, progress: Progress | None) -> Outcome:
        """All lanes, in parts of whole vectors."""
        text, first_lane = self._sent(library, variations)
        threads, count = max(sum(self.workers.threads().values()), 1), len(variations)
        size = _VECTOR * max(1, -(-count // (_VECTOR * threads)))
        found: dict[int, Outcome] = {}

        def call(part: int) -> Call[worker.SolvedLanes]:
            numbers = {path: x[part * size : (part + 1) * size].tobytes() for path, x in variations.numbers.items()}
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
        key = variations.scenario
        with self._lock:
            if key not in self._shared:
                first = variations.part(np.array([0]))
                probe = lanes.solve_here(library, first, 1).digest
                text = worker.lanes_text(variations.scenario, probe)
                self._shared[key] = (text, {path: x.tobytes() for path, x in first.numbers.items()})
            return self._shared[key]

    def answer(self, question: response.Question) -> response.Answer:
        """A law's answer, whole, by one worker: all its lanes take the same steps."""
        with self._lock:
            if question.text not in self._laws:
                probe = question.probe()
                self._laws[question.text] = worker.law_text(probe, response.digest(response.answer_here(probe)))
            text = self._laws[question.text]
        found: list[response.Answer] = []
        self.workers.do(
            [0], lambda _: (worker.some_answers, (text, question.numbers)), lambda _, made: found.append(made["found"])
        )
        return found[0]

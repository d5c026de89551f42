"""A sweep on a Dask cluster: its parts are sent out as numbers, and what comes back is written here or by the workers."""

from __future__ import annotations

import os
from collections import Counter, deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from stribeck.errors import InputError, StribeckError, arg, needed, note
from stribeck.simulation import compiler
from stribeck.sweeps import worker

if TYPE_CHECKING:
    from distributed import Client, Future

    from stribeck.sweeps.job import Sweep

_LOOK = 2.0  # s: how often workers that came or went are looked for
_DEATHS = 5  # times that the scheduler gives up a part whose workers died: then it is the part that kills them
_AHEAD = 2  # parts in hand for each thread of the cluster


def run_on(on: str, job: Sweep, todo: list[int], tell: Callable[[float], None]) -> None:
    """Have the workers of a cluster make parts of a sweep.

    Args:
        on: ``dask`` (a cluster of processes here) or ``dask://HOST:PORT`` (of its scheduler).
        job: the sweep.
        todo: its parts to make.
        tell: called with the number of lanes done.

    Raises:
        InputError: ``on`` is something else, or there is no scheduler.
        StribeckError: the scheduler went away, no worker can make the parts, or a part killed its workers.
    """
    if compiler.find() is None:
        raise StribeckError(
            f"{arg('on')} {on}: without a C compiler here a cluster's numbers would differ in their last bits"
        )
    with _client(on) as client:
        _Run(client, on, job, todo, tell).run()


@contextmanager
def _client(on: str) -> Iterator[Client]:
    kind, _, address = on.partition("://")
    if kind != "dask" or ("://" in on and not address):
        raise InputError(f"{arg('on')}: {on!r}: must be dask or dask://HOST:PORT")
    with needed(f"{arg('on')} {on}", "cluster"):
        import distributed
    if not address:
        with (
            distributed.LocalCluster(
                n_workers=os.cpu_count(), threads_per_worker=1, processes=True, dashboard_address=None
            ) as cluster,
            distributed.Client(cluster) as client,
        ):
            yield client
        return
    try:
        client = distributed.Client(f"tcp://{address}", timeout=10)
    except (OSError, ValueError) as error:
        raise InputError(f"{arg('on')}: {on!r}: no scheduler answers there: {error}") from None
    with client:
        yield client


class _Run:
    """The parts in hand, and which workers may have them."""

    def __init__(self, client: Client, on: str, job: Sweep, todo: list[int], tell: Callable[[float], None]) -> None:
        self.client, self.on, self.job, self.tell = client, on, job, tell
        self.order = job.order.to_text(job.order.probe(job.values_of(0)))
        self.first_lane = {path: x[:1].tobytes() for path, x in job.values_of(0).items()}
        self.todo, self.total = deque(todo), len(todo)
        self.hand: dict[Future[worker.Made], tuple[int, frozenset[str] | None]] = {}
        self.refused: dict[str, str] = {}
        self.deaths: Counter[int] = Counter()
        self.lanes = self.parts = 0
        self.waiting = False

    def run(self) -> None:
        """Until every part is written."""
        try:
            while self.todo or self.hand:
                self._send(self._workers())
                for future in self._finished():
                    self._take(future)
        except Exception as error:  # what a client says whose scheduler dies under it depends on the moment
            if isinstance(error, StribeckError) or self.client.status == "running":
                raise
            raise self._gone() from None

    def _finished(self) -> set[Future[worker.Made]]:
        """The parts of those in hand that came to an end, within a while."""
        import distributed

        try:
            return set(distributed.wait(list(self.hand), timeout=_LOOK, return_when="FIRST_COMPLETED").done)
        except (TimeoutError, distributed.TimeoutError):
            return set()
        except distributed.CancelledError:
            return {future for future in self.hand if future.status != "pending"}

    def _workers(self) -> dict[str, int]:
        """The threads of each worker that there is now.

        Raises:
            StribeckError: the scheduler went away.
        """
        if self.client.status != "running":
            raise self._gone()
        found = self.client.scheduler_info(n_workers=-1).get("workers", {})
        return {address: int(each["nthreads"]) for address, each in found.items()}

    def _gone(self) -> StribeckError:
        text = f"the scheduler went away after {self.parts} of {self.total} parts; the same command goes on from there"
        return StribeckError(f"{arg('on')} {self.on}: {text}")

    def _send(self, workers: dict[str, int]) -> None:
        """Hand out parts, to workers that have not refused."""
        may = {address: n for address, n in workers.items() if address not in self.refused}
        if not workers and not self.waiting:
            note(
                f"{arg('on')} {self.on}: no worker at present; waiting for one ({self.parts} of {self.total} parts done)"
            )
        self.waiting = not workers
        if self.refused and not may and not self.hand:
            reasons = "; ".join(f"{address} {why}" for address, why in self.refused.items())
            raise StribeckError(f"{arg('on')} {self.on}: no worker can make these numbers: {reasons}")
        for future, (part, only) in list(self.hand.items()):
            if only is not None and not only & may.keys():  # those that it may go to are gone
                self.hand.pop(future)
                future.cancel(force=True)
                self.todo.appendleft(part)
        if self.refused and not may:
            return
        room = _AHEAD * max(sum(may.values()), 1) - len(self.hand)
        only = frozenset(may) if self.refused else None
        while self.todo and room > 0:
            part = self.todo.popleft()
            numbers = {path: x.tobytes() for path, x in self.job.values_of(part).items()}
            future = self.client.submit(
                worker.part, self.order, self.first_lane, numbers, self.job.lanes_of_part(part)[0], self.job.name(part),
                pure=False, workers=sorted(only) if only else None,
            )  # fmt: skip
            self.hand[future] = (part, only)
            room -= 1

    def _take(self, future: Future[worker.Made]) -> None:
        """What came of a part."""
        from distributed import KilledWorker

        part, _ = self.hand.pop(future)
        if future.status in ("cancelled", "lost"):
            if self.client.status != "running":
                raise self._gone()
            self.todo.appendleft(part)
            return
        if future.status == "error":
            error = future.exception()
            if not isinstance(error, KilledWorker):
                text = f"part {part} failed on a worker: {type(error).__name__}: {error}"
                raise StribeckError(f"{arg('on')} {self.on}: {text}")
            self.deaths[part] += 1
            if self.deaths[part] >= _DEATHS:
                text = f"part {part} lost its worker again and again; {self.parts} of {self.total} parts are written"
                raise StribeckError(f"{arg('on')} {self.on}: {text}")
            self.todo.appendleft(part)
            return
        made = future.result()
        if why := made.get("refused"):
            if made["worker"] not in self.refused:
                note(f"{arg('on')} {self.on}: left out: {made['worker']} {why}")
            self.refused[made["worker"]] = why
            self.todo.appendleft(part)
            return
        data = made["data"]
        if data is not None:
            self.job.place.put(self.job.name(part), lambda beside: beside.write_bytes(data))
        self.job.written(part, made["sha256"])
        first, end = self.job.lanes_of_part(part)
        self.parts, self.lanes = self.parts + 1, self.lanes + end - first
        self.tell(self.lanes)

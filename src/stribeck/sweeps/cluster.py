"""A Dask cluster: work is sent out in parts, as numbers and text, and goes to another worker where one dies or cannot do it."""

from __future__ import annotations

import os
from collections import Counter, deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Generic, TypeVar

from stribeck.errors import InputError, StribeckError, arg, needed, note
from stribeck.simulation import compiler
from stribeck.sweeps import worker
from stribeck.sweeps.worker import Answer

if TYPE_CHECKING:
    from distributed import Client, Future

    from stribeck.sweeps.job import Sweep

A = TypeVar("A", bound=Answer)
# What a part is for a worker: a function of a module of ours, and numbers and texts for it.
Call = tuple[Callable[..., A], tuple[object, ...]]

_LOOK = 2.0  # s: how often workers that came or went are looked for
_DEATHS = 5  # times that the scheduler gives up a part whose workers died: then it is the part that kills them
_AHEAD = 2  # parts in hand for each thread of the cluster


def run_on(workers: Workers, job: Sweep, todo: list[int], tell: Callable[[float], None]) -> None:
    """Have the workers of a cluster make parts of a sweep.

    Args:
        workers: of :func:`connected`.
        job: the sweep.
        todo: its parts to make.
        tell: called with the number of lanes done.

    Raises:
        StribeckError: the scheduler went away, no worker can make the parts, or a part killed its workers.
    """
    done = 0

    def call(part: int) -> Call[worker.Made]:
        numbers = {path: x.tobytes() for path, x in job.values_of(part).items()}
        return worker.part, (order, first_lane, numbers, job.lanes_of_part(part)[0], job.name(part))

    def take(part: int, made: worker.Made) -> None:
        nonlocal done
        data = made["data"]
        if data is not None:
            job.place.put(job.name(part), lambda beside: beside.write_bytes(data))
        job.written(part, made["sha256"])
        first, end = job.lanes_of_part(part)
        done += end - first
        tell(done)

    order = job.order.to_text(job.order.probe(job.values_of(0)))
    first_lane = {path: x[:1].tobytes() for path, x in job.values_of(0).items()}
    workers.do(todo, call, take)


@contextmanager
def connected(on: str, after: str = "") -> Iterator[Workers]:
    """The workers of a cluster; ``after`` ends what is said when its scheduler goes away.

    Raises:
        InputError: ``on`` is neither ``dask`` nor ``dask://HOST:PORT``, or there is no scheduler.
        StribeckError: there is no C compiler here.
    """
    if compiler.find() is None:
        raise StribeckError(
            f"{arg('on')} {on}: without a C compiler here a cluster's numbers would differ in their last bits"
        )
    with _client(on) as client:
        yield Workers(client, on, after)


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


class Workers:
    """The workers of a cluster, and which of them make other bits than this machine and may have nothing.

    Attributes:
        client: of Dask; ``on``: how the cluster was named; ``after``: what is to be done when its scheduler went away.
        refused: why a worker is left out, by its address.
    """

    def __init__(self, client: Client, on: str, after: str) -> None:
        self.client, self.on, self.after = client, on, after
        self.refused: dict[str, str] = {}

    def do(self, todo: Iterable[int], call: Callable[[int], Call[A]], take: Callable[[int, A], None]) -> None:
        """Have every part made.

        Args:
            call: the work of a part; its answer has ``refused`` where this worker cannot do it.
            take: is given each part and what came back of it, in the order in which they come.

        Raises:
            StribeckError: the scheduler went away, no worker can make the parts, or a part killed its workers.
        """
        _Parts(self, deque(todo), call, take).run()

    def threads(self) -> dict[str, int]:
        """The threads of each worker that there is now."""
        scheduler = self.client.scheduler
        try:  # asked anew: what the client keeps is at times without its workers
            told = self.client.sync(scheduler.identity, n_workers=-1) if scheduler is not None else {}
        except OSError:
            told = {}
        return {address: int(each["nthreads"]) for address, each in told.get("workers", {}).items()}

    def leave_out(self, address: str, why: str) -> None:
        """Send nothing to a worker any more."""
        if address not in self.refused:
            note(f"{arg('on')} {self.on}: left out: {address} {why}")
        self.refused[address] = why


class _Parts(Generic[A]):
    """The parts to be made, and those in hand: each with the workers that it may go to, None for any."""

    def __init__(
        self, workers: Workers, todo: deque[int], call: Callable[[int], Call[A]], take: Callable[[int, A], None]
    ) -> None:
        self.workers, self.client, self.on = workers, workers.client, workers.on
        self.todo, self.total, self.call, self.take = todo, len(todo), call, take
        self.hand: dict[Future[A], tuple[int, frozenset[str] | None]] = {}
        self.deaths: Counter[int] = Counter()
        self.done = 0
        self.waiting = False

    def run(self) -> None:
        """Until every part is taken."""
        try:
            while self.todo or self.hand:
                if self.client.status != "running":
                    raise self._gone()
                self._send(self.workers.threads())
                for future in self._finished():
                    self._take(future)
        except Exception as error:  # what a client says whose scheduler dies under it depends on the moment
            if isinstance(error, StribeckError) or self.client.status == "running":
                raise
            raise self._gone() from None
        finally:  # Ctrl-C, or a part that failed: nobody waits for the others
            for future in self.hand:
                future.cancel(force=True)

    def _finished(self) -> set[Future[A]]:
        """The parts of those in hand that came to an end, within a while."""
        import distributed

        try:
            return set(distributed.wait(list(self.hand), timeout=_LOOK, return_when="FIRST_COMPLETED").done)
        except (TimeoutError, distributed.TimeoutError):
            return set()
        except distributed.CancelledError:
            return {future for future in self.hand if future.status != "pending"}

    def _gone(self) -> StribeckError:
        text = f"the scheduler went away after {self.done} of {self.total} parts{self.workers.after}"
        return StribeckError(f"{arg('on')} {self.on}: {text}")

    def _send(self, workers: dict[str, int]) -> None:
        """Hand out parts, to workers that have not refused."""
        refused = dict(self.workers.refused)  # other threads may add to it
        may = {address: n for address, n in workers.items() if address not in refused}
        if not workers and not self.waiting:
            note(
                f"{arg('on')} {self.on}: no worker at present; waiting for one ({self.done} of {self.total} parts done)"
            )
        self.waiting = not workers
        if refused and not may and not self.hand:
            reasons = "; ".join(f"{address} {why}" for address, why in refused.items())
            raise StribeckError(f"{arg('on')} {self.on}: no worker can make these numbers: {reasons}")
        for future, (part, only) in list(self.hand.items()):
            if only is not None and not only & may.keys():  # those that it may go to are gone
                self.hand.pop(future)
                future.cancel(force=True)
                self.todo.appendleft(part)
        if refused and not may:
            return
        room = _AHEAD * max(sum(may.values()), 1) - len(self.hand)
        only = frozenset(may) if refused else None
        while self.todo and room > 0:
            part = self.todo.popleft()
            what, given = self.call(part)
            future = self.client.submit(what, *given, pure=False, workers=sorted(only) if only else None)
            self.hand[future] = (part, only)
            room -= 1

    def _take(self, future: Future[A]) -> None:
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
                text = f"part {part} lost its worker again and again; {self.done} of {self.total} parts are done"
                raise StribeckError(f"{arg('on')} {self.on}: {text}")
            self.todo.appendleft(part)
            return
        made = future.result()
        if why := made.get("refused"):
            self.workers.leave_out(made["worker"], str(why))
            self.todo.appendleft(part)
            return
        self.take(part, made)
        self.done += 1

"""The workers of a Dask cluster make a sweep's parts.

Dask gives the parts of a worker that died to others, and gives a part up that kills its workers (allowed-failures). It
drops a worker that stopped answering (worker-ttl). Left to us: workers whose files would have other bits get no parts.
"""

from __future__ import annotations

import logging
import math
import socket
from collections import deque
from collections.abc import Callable, Generator, Iterator
from contextlib import contextmanager
from time import monotonic
from typing import TYPE_CHECKING

from stribeck.errors import InputError, StribeckError, arg, needed, note, said_by
from stribeck.sweeps.parts import MadePart, Refusal, made_by_worker

if TYPE_CHECKING:
    from distributed import Client, Future

# The arguments of made_by_worker for a part.
Sent = tuple[str, dict[str, bytes], dict[str, bytes], int]

_LOOK = 2.0  # s, between two looks at the workers: what a user may wait for a line about them
_SILENT = (
    60.0  # s without a heartbeat until a worker is named; Dask's own limit is 5 minutes, its heartbeats come each 5 s
)
_AHEAD = 2  # parts in hand for each thread: one is computed while the other one travels
_CONNECT = 10.0  # s, for a scheduler to answer: Dask's own 30 s are long for a wrong address


@contextmanager
def connected(cluster: str | Client) -> Iterator[Client]:
    """A client of a cluster's scheduler, within which Dask's own log is silent.

    Raises:
        InputError: no scheduler answers.
    """
    with needed(f"{arg('cluster')} {cluster}", "cluster"):
        import distributed
        from distributed.comm.addressing import get_address_host_port
    log = logging.getLogger("distributed")
    level = log.level
    log.setLevel(logging.CRITICAL + 1)  # what goes wrong is said by us, in a line
    try:
        if isinstance(cluster, distributed.Client):
            yield cluster
            return
        try:  # by a plain connection first: Dask tries a wrong address again and again, and its loop outlives the failure
            socket.create_connection(get_address_host_port(cluster), _CONNECT).close()
            client = distributed.Client(cluster, timeout=_CONNECT)
        except (OSError, ValueError) as error:
            raise InputError(f"{arg('cluster')}: {cluster!r}: no scheduler answers there: {error}") from None
        with client:
            yield client
    finally:
        log.setLevel(level)


def made_on(client: Client, todo: list[int], sent: Callable[[int], Sent]) -> Generator[tuple[int, MadePart]]:
    """The parts as they come from the workers.

    Raises:
        StribeckError: the scheduler went away, no worker can make the parts, or a part failed.
    """
    work = _Work(client, todo, sent)
    try:
        yield from work.parts()
    except StribeckError:
        raise
    except Exception as error:  # what a client raises whose scheduler dies under it depends on the moment
        if client.status == "running":
            raise
        text = f"the scheduler went away after {work.done} of {len(todo)} parts; the same command goes on from there"
        raise StribeckError(f"{arg('cluster')}: {text} ({said_by(error)})") from None
    finally:  # Ctrl-C, or a part that failed: nobody waits for the others
        work.cancel()


class _Work:
    """The parts to be made and those in hand, and the workers that get none."""

    def __init__(self, client: Client, todo: list[int], sent: Callable[[int], Sent]) -> None:
        self.client, self.sent = client, sent
        self.todo, self.total, self.done = deque(todo), len(todo), 0
        self.hand: dict[Future[MadePart | Refusal], int] = {}
        self.may: frozenset[str] | None = None  # the workers that what is in hand may go to; None: all
        self.left_out: dict[str, str] = {}
        self.seen: dict[str, tuple[float, float]] = {}  # a worker's last heartbeat, and when we first saw that one
        self.waiting = False

    def parts(self) -> Iterator[tuple[int, MadePart]]:
        """Until every part is made."""
        import distributed

        while self.todo or self.hand:
            self._send(self._workers())
            try:
                distributed.wait(list(self.hand), timeout=_LOOK, return_when="FIRST_COMPLETED")
            except (TimeoutError, distributed.TimeoutError):
                continue
            except distributed.CancelledError:
                pass
            for future in [each for each in self.hand if each.status != "pending"]:
                part = self.hand.pop(future, None)
                if part is not None and (made := self._taken(part, future)) is not None:
                    self.done += 1
                    yield part, made

    def cancel(self) -> None:
        """Take back what is in hand."""
        for future, part in self.hand.items():
            future.cancel(force=True)
            self.todo.append(part)
        self.hand.clear()

    def _workers(self) -> dict[str, int]:
        """The threads of each worker that there is now. Workers that stopped answering are named, once."""
        scheduler = self.client.scheduler
        if self.client.status != "running" or scheduler is None:
            raise ConnectionError("no connection")
        # asked anew: what the client keeps is at times without its workers
        found = self.client.sync(scheduler.identity)["workers"]
        for address, each in found.items():
            beat, since = self.seen.get(address, (0.0, 0.0))
            if beat != each["last_seen"]:
                self.seen[address] = each["last_seen"], monotonic()
            elif monotonic() - since > _SILENT:
                text = f"has not answered for {_SILENT:.0f} s; Dask gives its parts to others after worker-ttl"
                note(f"{arg('cluster')}: {address} {text} (5 minutes unless configured)")
                self.seen[address] = beat, math.inf  # said
        return {address: int(each["nthreads"]) for address, each in found.items()}

    def _send(self, workers: dict[str, int]) -> None:
        """Hand out parts, to workers that are not left out."""
        may = {address: n for address, n in workers.items() if address not in self.left_out}
        if not workers and not self.waiting:
            text = f"no worker at present; waiting for one ({self.done} of {self.total} parts done)"
            note(f"{arg('cluster')}: {text}")
        self.waiting = not workers
        if workers and not may:
            reasons = "; ".join(f"{address} {self.left_out[address]}" for address in workers)
            raise StribeckError(f"{arg('cluster')}: no worker can make these numbers: {reasons}")
        if self.may is not None and not self.may & may.keys():  # those that parts in hand may go to are gone
            self.cancel()
        self.may = frozenset(may) if self.left_out and may else None
        while self.todo and len(self.hand) < _AHEAD * max(sum(may.values()), 1):
            part = self.todo.popleft()
            where = sorted(self.may) if self.may is not None else None
            future = self.client.submit(made_by_worker, *self.sent(part), pure=False, workers=where)
            self.hand[future] = part

    def _taken(self, part: int, future: Future[MadePart | Refusal]) -> MadePart | None:
        """A part, or None if it is to be made again."""
        if future.status in ("cancelled", "lost"):
            self.todo.append(part)
            return None
        if future.status == "error":
            raise StribeckError(f"{arg('cluster')}: part {part} failed on a worker: {said_by(future.exception())}")
        made = future.result()
        if isinstance(made, MadePart):
            return made
        if made.worker not in self.left_out:
            note(f"{arg('cluster')}: left out: {made.worker} {made.reason}")
            self.left_out[made.worker] = made.reason
            self.cancel()  # some of it may go to that worker
        self.todo.append(part)
        return None

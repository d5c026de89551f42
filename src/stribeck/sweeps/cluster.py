"""A sweep on a Dask cluster, whose workers compute the parts.

Dask gives the parts of a dead worker to others. It abandons a part that kills its workers (allowed-failures), and drops a
worker that no longer answers (worker-ttl). This module gives no parts to workers whose files would have different bits.
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

from stribeck.errors import InputError, StribeckError, arg, error_text, needed, note
from stribeck.sweeps.parts import MadePart, Refusal, make_part

if TYPE_CHECKING:
    from distributed import Client, Future

# The arguments of made_by_worker for a part.
Sent = tuple[str, dict[str, bytes], dict[str, bytes], int]

_LOOK = 2.0  # s between two checks of the workers: an acceptable delay of a message about them
# s without a heartbeat, before a worker is reported: Dask drops it after 5 minutes; heartbeats come each 5 s
_SILENT = 60.0
_AHEAD = 2  # parts in hand for each thread: one is computed while the other one is transferred
_CONNECT = 10.0  # s, for a scheduler to answer: Dask's own 30 s are long for a wrong address


@contextmanager
def connected(cluster: str | Client) -> Iterator[Client]:
    """A client of a cluster's scheduler; Dask's own log is silent meanwhile.

    Raises:
        InputError: if no scheduler answers.
    """
    with needed(f"{arg('cluster')} {cluster}", "cluster"):
        import distributed
        from distributed.comm.addressing import get_address_host_port
    log = logging.getLogger("distributed")
    level = log.level
    log.setLevel(logging.CRITICAL + 1)  # errors are reported by us, in one line
    try:
        if isinstance(cluster, distributed.Client):
            yield cluster
            return
        try:  # a plain connection first: Dask retries a wrong address, and its loop outlives the failure
            socket.create_connection(get_address_host_port(cluster), _CONNECT).close()
            client = distributed.Client(cluster, timeout=_CONNECT)
        except (OSError, ValueError) as error:
            raise InputError(f"{arg('cluster')}: {cluster!r}: no scheduler answers there: {error}") from None
        with client:
            yield client
    finally:
        log.setLevel(level)


def make_on_cluster(client: Client, todo: list[int], sent: Callable[[int], Sent]) -> Generator[tuple[int, MadePart]]:
    """The parts in the order in which the workers finish them.

    Raises:
        StribeckError: if the scheduler is lost, no worker can compute the parts, or a part failed.
    """
    work = _Work(client, todo, sent)
    try:
        yield from work.parts()
    except StribeckError:
        raise
    except Exception as error:  # the error of a client whose scheduler dies depends on the moment
        if client.status == "running":
            raise
        text = f"the scheduler went away after {work.done} of {len(todo)} parts; the same command goes on from there"
        raise StribeckError(f"{arg('cluster')}: {text} ({error_text(error)})") from None
    finally:  # Ctrl-C or a failed part: the others are not needed
        work.cancel()


class _Work:
    """The parts to compute, those given to workers, and the workers that get none."""

    def __init__(self, client: Client, todo: list[int], sent: Callable[[int], Sent]) -> None:
        self.client, self.sent = client, sent
        self.todo, self.total, self.done = deque(todo), len(todo), 0
        self.in_hand: dict[Future[MadePart | Refusal], int] = {}
        self.allowed: frozenset[str] | None = None  # the workers that the parts in hand may use; None: all
        self.left_out: dict[str, str] = {}
        self.seen: dict[
            str, tuple[float, float]
        ] = {}  # a worker's last heartbeat, and the time at which it was first seen
        self.waiting = False

    def parts(self) -> Iterator[tuple[int, MadePart]]:
        """Yield the parts until all are computed."""
        import distributed

        while self.todo or self.in_hand:
            self._send(self._workers())
            try:
                distributed.wait(list(self.in_hand), timeout=_LOOK, return_when="FIRST_COMPLETED")
            except (TimeoutError, distributed.TimeoutError):
                continue
            except distributed.CancelledError:
                pass
            for future in [each for each in self.in_hand if each.status != "pending"]:
                part = self.in_hand.pop(future, None)
                if part is not None and (finished := self._result_of(part, future)) is not None:
                    self.done += 1
                    yield part, finished

    def cancel(self) -> None:
        """Cancel the parts in hand and queue them again."""
        for future, part in self.in_hand.items():
            future.cancel(force=True)
            self.todo.append(part)
        self.in_hand.clear()

    def _workers(self) -> dict[str, int]:
        """The number of threads of each present worker. A worker that no longer answers is reported once."""
        scheduler = self.client.scheduler
        if self.client.status != "running" or scheduler is None:
            raise ConnectionError("no connection")
        # asked from the scheduler: the client's own copy is at times without its workers
        workers = self.client.sync(scheduler.identity)["workers"]
        for address, each in workers.items():
            beat, since = self.seen.get(address, (0.0, 0.0))
            if beat != each["last_seen"]:
                self.seen[address] = each["last_seen"], monotonic()
            elif monotonic() - since > _SILENT:
                text = f"has not answered for {_SILENT:.0f} s; Dask gives its parts to others after worker-ttl"
                note(f"{arg('cluster')}: {address} {text} (5 minutes unless configured)")
                self.seen[address] = beat, math.inf  # reported
        return {address: int(each["nthreads"]) for address, each in workers.items()}

    def _send(self, workers: dict[str, int]) -> None:
        """Give parts to the workers that are not left out."""
        allowed = {address: n for address, n in workers.items() if address not in self.left_out}
        if not workers and not self.waiting:
            text = f"no worker at present; waiting for one ({self.done} of {self.total} parts done)"
            note(f"{arg('cluster')}: {text}")
        self.waiting = not workers
        if workers and not allowed:
            reasons = "; ".join(f"{address} {self.left_out[address]}" for address in workers)
            raise StribeckError(f"{arg('cluster')}: no worker can make these numbers: {reasons}")
        if self.allowed is not None and not self.allowed & allowed.keys():  # all workers of the parts in hand are gone
            self.cancel()
        self.allowed = frozenset(allowed) if self.left_out and allowed else None
        while self.todo and len(self.in_hand) < _AHEAD * max(sum(allowed.values()), 1):
            part = self.todo.popleft()
            where = sorted(self.allowed) if self.allowed is not None else None
            future = self.client.submit(make_part, *self.sent(part), pure=False, workers=where)
            self.in_hand[future] = part

    def _result_of(self, part: int, future: Future[MadePart | Refusal]) -> MadePart | None:
        """The computed part, or None if it must be computed again."""
        if future.status in ("cancelled", "lost"):
            self.todo.append(part)
            return None
        if future.status == "error":
            raise StribeckError(f"{arg('cluster')}: part {part} failed on a worker: {error_text(future.exception())}")
        result = future.result()
        if isinstance(result, MadePart):
            return result
        if result.worker not in self.left_out:
            note(f"{arg('cluster')}: left out: {result.worker} {result.reason}")
            self.left_out[result.worker] = result.reason
            self.cancel()  # some parts may be queued for that worker
        self.todo.append(part)
        return None

"""Progress and cancellation of a long fit."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

from stribeck.simulation.lanes import threads_of_this_machine

T = TypeVar("T")
S = TypeVar("S")
Progress = Callable[[float], None]
_TYPICAL = 300  # simulations of a fit with a handful of numbers: only the bar hangs on it


def part(progress: Progress | None, number: int, count: int) -> Progress | None:
    """The progress of one of several consecutive fits."""
    return None if progress is None else lambda share: progress((number + share) / count)


class Stopped(KeyboardInterrupt):
    """The work is to end; what was found so far is kept."""


class Work:
    """The share of a fit that is done, never falling, and a flag that ends it.

    Args:
        tell: called with the share, 0 to 1.
    """

    def __init__(self, tell: Progress | None = None) -> None:
        self._tell, self._lock = tell, threading.Lock()
        self._start = self._end = self.share = 0.0
        self._ticks = 0
        self._stop = threading.Event()

    def section(self, end: float) -> None:
        """Begin a section of the work, from the share done to ``end``."""
        self._start, self._end, self._ticks = max(self.share, self._end), end, 0
        self.done(0.0)

    def done(self, part: float) -> None:
        """So much of the section is done, 0 to 1."""
        with self._lock:
            self.share = max(self.share, self._start + (self._end - self._start) * min(max(part, 0.0), 1.0))
            if self._tell is not None:
                self._tell(self.share)

    def tick(self) -> None:
        """Another simulation is done; nobody knows how many there will be: half of the section is ``_TYPICAL`` of them."""
        self._ticks += 1
        self.done(self._ticks / (self._ticks + _TYPICAL))

    @property
    def stopped(self) -> bool:
        """Whether the work is to end."""
        return self._stop.is_set()

    def stop(self) -> None:
        """End the work."""
        self._stop.set()

    def check(self) -> None:
        """Raises: Stopped: the work is to end."""
        if self.stopped:
            raise Stopped

    def each(self, what: Callable[[S], T], of: Iterable[S]) -> list[T]:
        """``what`` of each on all cores.

        Raises:
            Stopped: after Ctrl-C or :meth:`stop`.
        """

        def compute(item: S) -> T:
            self.check()
            return what(item)

        pool = ThreadPoolExecutor(threads_of_this_machine())
        try:
            return [future.result() for future in [pool.submit(compute, item) for item in of]]
        except KeyboardInterrupt:
            self.stop()
            raise Stopped from None
        finally:
            pool.shutdown(wait=True, cancel_futures=True)

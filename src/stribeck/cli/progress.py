"""Progress on standard error: a bar on a terminal, elsewhere lines."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, suppress
from typing import TYPE_CHECKING

from stribeck.errors import printable

if TYPE_CHECKING:
    from rich.progress import Progress, TaskID

_EVERY = 10.0  # s, between two lines of progress in a log file
_UNSEEN = 0.5  # s, that a command takes without a bar


def progress(what: str) -> AbstractContextManager[Callable[..., None]]:
    """Progress on standard error of work that reports the share done (None: the bar moves), and its stage if it has some.

    It is a bar on a terminal, elsewhere lines.
    """
    return (_bar if sys.stderr.isatty() else _lines)(printable(what))


@contextmanager
def _lines(what: str) -> Iterator[Callable[..., None]]:
    """A line each :data:`_EVERY` seconds, as for a log file."""
    from threading import Event, Thread
    from time import monotonic

    started, done, last = monotonic(), Event(), [""]

    def tell(share: float | None, stage: str = "") -> None:
        last[0] = ", ".join(x for x in (stage, "" if share is None else f"{100 * share:.0f} %") if x)

    def write() -> None:
        while not done.wait(_EVERY):
            with suppress(OSError, ValueError):  # the reader has gone
                state = f"{last[0]} after" if last[0] else "running for"
                print(f"stribeck: {what}: {state} {monotonic() - started:.0f} s", file=sys.stderr, flush=True)

    Thread(target=write, daemon=True).start()
    try:
        yield tell
    finally:
        done.set()


@contextmanager
def _bar(what: str) -> Iterator[Callable[..., None]]:
    """A bar that appears after half a second and moves from then on, also without reports."""
    from threading import Timer

    bars: list[tuple[Progress, TaskID]] = []
    last: list[tuple[float | None, str]] = [(None, "")]

    def put(bar: Progress, task: TaskID) -> None:
        share, stage = last[0]
        total, description = None if share is None else 1.0, f"{what}: {stage}" if stage else what
        bar.update(task, completed=share or 0.0, total=total, description=description)

    def start() -> None:
        from rich.console import Console
        from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

        said = TextColumn("{task.description}", markup=False)
        columns = SpinnerColumn(), said, BarColumn(bar_width=24), TimeElapsedColumn()
        bar = Progress(*columns, console=Console(stderr=True), transient=True)
        bars.append((bar, bar.add_task(what, total=None)))
        put(*bars[0])
        bar.start()

    def tell(share: float | None, stage: str = "") -> None:
        last[0] = share, stage
        for each in bars:
            put(*each)

    timer = Timer(_UNSEEN, start)
    timer.daemon = True
    timer.start()
    try:
        yield tell
    finally:
        timer.cancel()
        timer.join()
        for bar, _ in bars:
            bar.stop()

"""Progress on standard error: a bar on a terminal, elsewhere lines."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING

from stribeck.errors import printable

if TYPE_CHECKING:
    from rich.progress import Progress, TaskID

_EVERY = 10.0  # s, between two lines of progress in a log file
_UNSEEN = 0.5  # s, that a command takes without a bar


@contextmanager
def progress(what: str) -> Iterator[Callable[..., None]]:
    """Progress on standard error of work that reports the share done (None: the bar moves), and its stage if it has some."""
    with _shown(what) as tell:
        yield lambda share, stage="": tell(share, stage, "")


@contextmanager
def rate(what: str, unit: str = "") -> Iterator[Callable[[float, float], None]]:
    """The same with the rate in units per second, for work that reports the share done and the number of units done."""
    from time import monotonic

    with _shown(what) as show:
        started = monotonic()

        def tell(share: float, count: float) -> None:
            show(share, "", f"{count / max(monotonic() - started, 1e-9):.0f} {unit}/s" if unit else "")

        yield tell


@contextmanager
def _shown(what: str) -> Iterator[Callable[[float | None, str, str], None]]:
    """A function that shows share, stage and rate: as a bar on a terminal, elsewhere as lines."""
    with (_bar if sys.stderr.isatty() else _lines)(printable(what)) as tell:
        yield tell


@contextmanager
def _lines(what: str) -> Iterator[Callable[[float | None, str, str], None]]:
    """A line each :data:`_EVERY` seconds, as for a log file."""
    from threading import Event, Thread
    from time import monotonic

    started, done, last = monotonic(), Event(), [""]

    def tell(share: float | None, text: str, speed: str) -> None:
        last[0] = ", ".join(x for x in (text, "" if share is None else f"{100 * share:.0f} %", speed) if x)

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
def _bar(what: str) -> Iterator[Callable[[float | None, str, str], None]]:
    """A bar that appears after half a second and moves from then on, also without reports."""
    from threading import Timer

    bars: list[tuple[Progress, TaskID]] = []
    last: list[tuple[float | None, str, str]] = [(None, "", "")]

    def put(bar: Progress, task: TaskID) -> None:
        share, text, speed = last[0]
        total, description = None if share is None else 1.0, f"{what}: {text}" if text else what
        bar.update(task, completed=share or 0.0, total=total, speed=speed, description=description)

    def start() -> None:
        from rich.console import Console
        from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

        columns = (
            SpinnerColumn(), TextColumn("{task.description}", markup=False), BarColumn(bar_width=24), TimeElapsedColumn(),
            TextColumn("{task.fields[speed]}"),
        )  # fmt: skip
        bar = Progress(*columns, console=Console(stderr=True), transient=True)
        bars.append((bar, bar.add_task(what, total=None, speed="")))
        put(*bars[0])
        bar.start()

    def tell(share: float | None, text: str, speed: str) -> None:
        last[0] = (share, text, speed)
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

"""Settings of the whole process: signals that end it, streams, threads and garbage collection."""

from __future__ import annotations

import gc
import io
import os
import signal
import sys
from types import FrameType

# Commands that may solve large linear systems.
_LINEAR_ALGEBRA = ("fit", "predict", "design")
_YOUNG = 100_000  # objects made between two looks for garbage: a start makes many, and all of them stay
SIGNALS = {"SIGINT": "interrupted", "SIGTERM": "terminated", "SIGHUP": "ended"}


class Stop(KeyboardInterrupt):
    """A signal that ends the process, taken as Ctrl-C is: what has been begun is cleared away."""

    last: int = signal.SIGINT  # Typer catches what is raised and tells no more than that it came


def listen() -> list[int]:
    """Take as stops the signals that nobody else takes or ignores, as a shell's background job and nohup do."""
    usual = (signal.SIG_DFL, signal.default_int_handler)
    taken = [n for name in SIGNALS if (n := getattr(signal, name, None)) is not None and signal.getsignal(n) in usual]
    for number in taken:
        signal.signal(number, _stop)
    return taken


def _stop(number: int, frame: FrameType | None) -> None:
    Stop.last = number
    raise Stop


def make_ready(command: str) -> None:
    """Set what the whole process goes by."""
    # pydantic asks every installed package whether it is a plugin of its, which takes as long as a run
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    if command not in _LINEAR_ALGEBRA:  # its threads would take their time to begin, and have no work
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    gc.set_threshold(_YOUNG, 20, 100)
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:  # closed by the shell, and asked whether it is a terminal
            setattr(sys, name, io.StringIO())
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # a file's name, or a Greek letter, may have no code there

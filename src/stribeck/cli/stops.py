"""Signals that stop the command: of Ctrl-C, of other programs, and of a terminal that is closed."""

from __future__ import annotations

import signal

_WORDS = {"SIGINT": "interrupted", "SIGTERM": "terminated", "SIGHUP": "ended"}
_last = signal.SIGINT  # Typer catches what is raised and tells no more than that it came


def listen() -> list[signal.Signals]:
    """Take as stops the signals that nobody else takes or ignores, as a shell's background job and nohup do."""

    def stop(number: int, frame: object) -> None:
        global _last
        _last = signal.Signals(number)
        raise KeyboardInterrupt

    usual = (signal.SIG_DFL, signal.default_int_handler)
    taken = [number for number in signal.Signals if number.name in _WORDS and signal.getsignal(number) in usual]
    for number in taken:
        signal.signal(number, stop)
    return taken


def stopped() -> tuple[int, str]:
    """The status of a command that a signal has stopped, and what it prints."""
    return 128 + _last, f"stribeck: {_WORDS[_last.name]}"

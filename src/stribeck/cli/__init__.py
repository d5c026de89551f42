"""The command ``stribeck``: one file a command, each thin."""

from __future__ import annotations

import gc
import io
import os
import signal
import sys
import warnings
from contextlib import suppress
from types import FrameType
from typing import NoReturn

from stribeck.cli.words import option, status_of
from stribeck.errors import InputError, StribeckNote, naming, one_line

# Commands that may solve large linear systems.
_LINEAR_ALGEBRA = ("fit", "predict", "design")
_YOUNG = 100_000  # objects made between two looks for garbage: a start makes many, and all of them stay
SIGNALS = {"SIGINT": "interrupted", "SIGTERM": "terminated", "SIGHUP": "ended"}


def main(arguments: list[str] | None = None) -> NoReturn:
    """Run the command and exit: 0 done, 1 the computation failed, 2 bad usage or bad input, 130 or 143 interrupted."""
    taken: list[int] = []
    given = sys.argv[1:] if arguments is None else arguments
    try:
        taken = listen()
        make_ready(_command(given))
        status = _status(given)
        for number in taken:  # all is done and said: Python's own end takes no more stops
            signal.signal(number, signal.SIG_IGN)
    except KeyboardInterrupt:  # before the command begins, or between its end and here
        status = 128 + Stop.last
    gc.freeze()  # the last look for garbage takes a seventh of a short run, and what it frees goes with the process
    sys.exit(status)


def _status(arguments: list[str]) -> int:
    """Run the command; its status, after a line for each problem on standard error."""
    command = _command(arguments)
    warnings.simplefilter("always", StribeckNote)
    warnings.showwarning = _show  # type: ignore[assignment]
    try:
        from stribeck.cli.app import with_command  # here, as a signal may come while it is read

        with naming(lambda name: option(name, command)):
            result = with_command(command)(args=arguments or ["--help"], prog_name="stribeck", standalone_mode=False)
        if result == 130:  # Typer's own word for Ctrl-C
            raise KeyboardInterrupt
        return result if isinstance(result, int) else 0
    except InputError as error:
        print("\n".join(error.problems), file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        with suppress(OSError):  # the terminal may have gone
            print(f"stribeck: {SIGNALS[signal.Signals(Stop.last).name]}", file=sys.stderr)
        return 128 + Stop.last
    except BrokenPipeError:
        sys.stderr.close()  # the reader has gone: nothing is left to tell
        return 1
    except BaseException as error:  # a user's file may raise any: sys.exit() in a law would end the command as if done
        status, text = status_of(error, command)
        if text:
            print(one_line(f"stribeck: {text}"), file=sys.stderr)
        return status


def _show(message: Warning | str, category: type[Warning], *rest: object) -> None:
    text = str(message) if isinstance(message, StribeckNote) else one_line(f"{category.__name__}: {message}")
    print(f"stribeck: {text}", file=sys.stderr)


def _command(arguments: list[str]) -> str:
    """The command that was given: the first word that is no option."""
    return next((word for word in arguments if not word.startswith("-")), "")


# -- settings of the whole process -------------------------------------------------------------------------------------


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

"""The command ``stribeck``: one file a command, each thin."""

from __future__ import annotations

import gc
import io
import os
import signal
import sys
import warnings
from contextlib import suppress
from typing import NoReturn

from stribeck.cli.stops import listen, stopped
from stribeck.cli.words import option, status_of
from stribeck.errors import InputError, StribeckNote, naming, one_line

_LINEAR_ALGEBRA = {"fit", "predict", "design"}  # commands that may solve large linear systems
_YOUNG = 100_000  # objects made between two looks for garbage: a start makes many, and all of them stay


def main(arguments: list[str] | None = None) -> NoReturn:
    """Run the command and exit: 0 done, 1 the computation failed, 2 bad usage or bad input, 130 or 143 interrupted."""
    given = sys.argv[1:] if arguments is None else arguments
    try:
        taken = listen()
        make_ready(given)
        status = _status(given)
        for number in taken:  # all is done and said: Python's own end takes no more stops
            signal.signal(number, signal.SIG_IGN)
    except KeyboardInterrupt:  # before the command begins, or between its end and here
        status, _ = stopped()
    gc.freeze()  # the last look for garbage takes a seventh of a short run, and what it frees goes with the process
    sys.exit(status)


def make_ready(arguments: list[str]) -> None:
    """Set what the whole process goes by."""
    # pydantic asks every installed package whether it is a plugin of its, which takes as long as a run
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    if _LINEAR_ALGEBRA.isdisjoint(arguments):  # its threads would take their time to begin, and have no work
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    gc.set_threshold(_YOUNG, 20, 100)
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name) or io.StringIO()  # closed by the shell, and asked whether it is a terminal
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # a file's name, or a Greek letter, may have no code there
        setattr(sys, name, stream)


def _status(arguments: list[str]) -> int:
    """Run the command; its status, after a line for each problem on standard error."""
    command = next((word for word in arguments if not word.startswith("-")), "")
    warnings.simplefilter("always", StribeckNote)
    warnings.showwarning = _show  # type: ignore[assignment]
    try:
        from stribeck.cli.app import with_command  # here, as a signal may come while it is read

        with naming(lambda name: option(name, command)):
            result = with_command(command)(args=arguments or ["--help"], prog_name="stribeck", standalone_mode=False)
        if result == 130:  # Typer's own word for Ctrl-C
            raise KeyboardInterrupt
        return int(result or 0)
    except InputError as error:
        print("\n".join(error.problems), file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        status, text = stopped()
        with suppress(OSError):  # the terminal may have gone
            print(text, file=sys.stderr)
        return status
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

"""The command ``stribeck``: one file a command, each thin."""

from __future__ import annotations

import gc
import io
import os
import signal
import sys
import threading
import time
import warnings
from contextlib import suppress
from types import FrameType
from typing import NoReturn

from stribeck.cli.options import said
from stribeck.errors import EXTRAS, InputError, Line, MissingExtra, StribeckError, StribeckNote, one_line, remedy
from stribeck.platforms import signal_self

# The extra that has all a command needs, where one of its packages comes with another one too.
_EXTRA = {"fit": "fit", "predict": "fit", "check": "fit", "design": "fit", "export": "fmu"}
# Commands that may solve large linear systems.
_LINEAR_ALGEBRA = ("fit", "predict", "design")
_YOUNG = 100_000  # objects made between two looks for garbage: a start makes many, and all of them stay
_GRACE = 5.0  # s, to clear away what has been begun
_MOMENT = 0.05  # s, after which a signal comes again
_LONGEST_IMPORT = 20.0  # s on the wall, as the machine may be busy: so long a signal waits for its end
_WORDS: dict[int, str] = {signal.SIGINT: "interrupted", signal.SIGTERM: "terminated"}


class _Stop(KeyboardInterrupt):
    """A signal that ends the process, taken as Ctrl-C is: what has been begun is cleared away."""

    last: int = signal.SIGINT
    since: float | None = None  # when it came that waits for the end of an import
    due: bool = False  # what comes is that one again


def main(arguments: list[str] | None = None) -> NoReturn:
    """Run the command and exit: 0 done, 1 the computation failed, 2 bad usage or bad input, 130 or 143 interrupted."""
    watched: list[int] = []
    try:
        _listen(watched)
        _make_ready(arguments)
        status = _status(arguments)
        signal.signal(signal.SIGINT, signal.SIG_IGN)  # all is done and said: Python's own end takes no more stops
        for number in watched:  # with a handler of its own, as a process that never ends must go
            signal.signal(number, lambda *_: None)
    except KeyboardInterrupt:  # before the command begins, or between its end and here
        status = 128 + _Stop.last
    gc.freeze()  # the last look for garbage takes a seventh of a short run, and what it frees goes with the process
    sys.exit(status)


def _listen(watched: list[int]) -> None:
    """Take signals as stops; ``watched`` gets those that end the process in any case."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:  # a shell's background job ignores it
        signal.signal(signal.SIGINT, _stop)
    for name in ("SIGTERM", "SIGHUP"):
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) is signal.SIG_DFL:  # nohup ignores it, and so do we
            signal.signal(number, _stop)
            watched.append(number)
    _see_to_the_end(watched)


def _make_ready(arguments: list[str] | None) -> None:
    """Set what the whole process goes by."""
    sys.unraisablehook = _once_more
    # pydantic asks every installed package whether it is a plugin of its, which takes as long as a run
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    if _command(arguments) not in _LINEAR_ALGEBRA:  # its threads would take their time to begin, and have no work
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    gc.set_threshold(_YOUNG, 20, 100)
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:  # closed by the shell, and asked whether it is a terminal
            setattr(sys, name, io.StringIO())
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # a file's name, or a Greek letter, may have no code there


def _see_to_the_end(numbers: list[int]) -> None:
    """End the process some seconds after one of these signals, where a library never comes back to Python."""
    read, write = os.pipe()
    if sys.platform != "win32":  # Python 3.11 has it there for POSIX alone, and Windows asks for no such pipe
        os.set_blocking(write, False)
    signal.set_wakeup_fd(write, warn_on_full_buffer=False)

    def watch() -> None:
        while not set(got := os.read(read, 64)) & set(numbers):
            if not got:
                return
        time.sleep(_GRACE)
        os._exit(128 + got[0])

    threading.Thread(target=watch, daemon=True).start()


def _once_more(lost: sys.UnraisableHookArgs) -> None:
    """A signal that came while Python took away an object, and got lost there, comes again."""
    if not isinstance(lost.exc_value, KeyboardInterrupt):
        sys.__unraisablehook__(lost)
        return
    _again(_Stop.last if isinstance(lost.exc_value, _Stop) else signal.SIGINT)


def _again(number: int) -> None:
    """Have a signal come again, a moment later."""

    def come() -> None:
        _Stop.due = True
        signal_self(number)

    again = threading.Timer(_MOMENT, come)
    again.daemon = True
    again.start()


def _stop(number: int, frame: FrameType | None) -> None:
    """Stop here; while a library is imported, after that: some catch all that comes meanwhile, and it would be lost."""
    _Stop.last, now, again, _Stop.due = number, time.monotonic(), _Stop.due, False
    if _Stop.since is not None and not again:
        return  # another one, while the first waits
    if _importing(frame) and now - (_Stop.since or now) < _LONGEST_IMPORT:
        _Stop.since = _Stop.since or now
        _again(number)
        return
    _Stop.since = None
    raise _Stop


def _importing(frame: FrameType | None) -> bool:
    while frame is not None:
        if frame.f_code.co_filename.startswith("<frozen importlib"):
            return True
        frame = frame.f_back
    return False


def _status(arguments: list[str] | None) -> int:
    """Of the command, which leaves no empty folder where it failed."""
    status = _outcome(arguments)
    if status and (show := sys.modules.get("stribeck.cli.show")):  # what was not needed is not read now
        show.take_back()
    return status


def _outcome(arguments: list[str] | None) -> int:
    warnings.simplefilter("always", StribeckNote)
    warnings.showwarning = _show  # type: ignore[assignment]
    try:
        from stribeck.cli.app import with_command  # here, as a signal may come while it is read

        result = with_command(_command(arguments))(args=arguments, prog_name="stribeck", standalone_mode=False)
        if result == 130:  # Typer's own word for Ctrl-C
            raise KeyboardInterrupt
        return result if isinstance(result, int) else 0
    except InputError as error:
        for line in error.problems:
            print(said(line, _command(arguments)), file=sys.stderr)
        return 2
    except (MissingExtra, ModuleNotFoundError) as error:
        command = _command(arguments)
        package = error.package if isinstance(error, MissingExtra) else (error.name or "").partition(".")[0]
        if package not in EXTRAS:
            return _of_a_file(error)
        if isinstance(error, MissingExtra) and (command not in _EXTRA or error.extra not in ("plot", "fit", "fmu")):
            print(f"stribeck: {said(Line(error.marked()), command)}", file=sys.stderr)
        else:
            how = remedy(package, EXTRAS[package] and _EXTRA.get(command, EXTRAS[package]))
            print(f"stribeck: '{command}' needs {package}: {how}", file=sys.stderr)
        return 2
    except ImportError as error:  # no memory is left for it, or its file is damaged
        with suppress(ImportError):
            return _of_a_file(error)
        print(f"stribeck: {one_line(f'a library cannot be loaded: {error}')}", file=sys.stderr)
        return 1
    except StribeckError as error:
        print(f"stribeck: {said(Line(error.marked()), _command(arguments))}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        with suppress(OSError):  # the terminal may have gone
            print(f"stribeck: {_WORDS.get(_Stop.last, 'ended')}", file=sys.stderr)
        return 128 + _Stop.last
    except BrokenPipeError:
        sys.stderr.close()  # the reader has gone: nothing is left to tell
        return 1
    except MemoryError as error:
        print(f"stribeck: not enough memory{f': {error}' if str(error) else ''}", file=sys.stderr)
        return 1
    except OSError as error:
        where = f"{error.filename}: " if error.filename else ""
        print(f"stribeck: {one_line(f'{where}{error.strerror or error}')}", file=sys.stderr)
        return 1
    except Exception as error:
        usage = getattr(error, "format_message", None)
        if usage is None:
            return _of_a_file(error)
        if text := " ".join(usage().split()):  # none where the help was printed instead
            print(one_line(f"stribeck: {text} (stribeck --help)"), file=sys.stderr)
        return 2
    except BaseException as error:  # a user's file may raise any: sys.exit() in a law would end the command as if done
        return _of_a_file(error)


def _of_a_file(error: BaseException) -> int:
    """Say what a user's own law or element raised; what nobody's file is at fault for is raised again."""
    from stribeck.kinds import at_fault

    if (text := at_fault(error)) is None:
        raise error
    print(f"stribeck: {one_line(text)}", file=sys.stderr)
    return 2


def _show(message: Warning | str, category: type[Warning], *rest: object) -> None:
    text = one_line(f"{category.__name__}: {message}")
    if isinstance(message, StribeckNote):
        text = said(message.args[0], _command(None))
    print(f"stribeck: {text}", file=sys.stderr)


def _command(arguments: list[str] | None) -> str:
    """The command that was given: the first word that is no option."""
    given = sys.argv[1:] if arguments is None else arguments
    return next((word for word in given if not word.startswith("-")), "")

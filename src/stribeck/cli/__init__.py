"""The command ``stribeck``: one file a command, each thin."""

from __future__ import annotations

import sys
import warnings
from typing import Any, NoReturn

from stribeck.cli.options import said
from stribeck.errors import EXTRAS, InputError, Line, MissingExtra, StribeckError, StribeckNote

_EXTRA = {"fit": "fit", "rig": "fit", "export": "export", "check": "check", "gains": "check", "paper": "paper"}


def main(arguments: list[str] | None = None) -> NoReturn:
    """Run the command and exit: 0 done, 1 the computation failed, 2 bad usage or bad input, 130 interrupted."""
    sys.exit(_status(arguments))


def _status(arguments: list[str] | None) -> int:
    from stribeck.cli.app import app

    warnings.simplefilter("always", StribeckNote)
    warnings.showwarning = _show  # type: ignore[assignment]
    try:
        result = app(args=arguments, prog_name="stribeck", standalone_mode=False)
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
            raise
        if isinstance(error, MissingExtra) and command not in _EXTRA:
            print(f"stribeck: {said(Line(str(error)), command)}", file=sys.stderr)
        else:
            extra = _EXTRA.get(command, EXTRAS[package])
            print(f"stribeck: '{command}' needs {package}: pip install 'stribeck[{extra}]'", file=sys.stderr)
        return 2
    except StribeckError as error:
        print(f"stribeck: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("stribeck: interrupted", file=sys.stderr)
        return 130
    except BrokenPipeError:
        sys.stderr.close()  # the reader has gone: nothing is left to tell
        return 1
    except OSError as error:
        where = f"{error.filename}: " if error.filename else ""
        print(f"stribeck: {where}{error.strerror or error}", file=sys.stderr)
        return 1
    except Exception as error:
        usage = getattr(error, "format_message", None)
        if usage is None:
            raise
        if text := " ".join(usage().split()):  # none where the help was printed instead
            print(f"stribeck: {text} (stribeck --help)", file=sys.stderr)
        return 2


def _show(message: Warning | str, category: type[Warning], *rest: Any) -> None:
    text = f"{category.__name__}: {message}"
    if isinstance(message, StribeckNote):
        text = said(message.args[0], _command(None))
    print(f"stribeck: {text}", file=sys.stderr)


def _command(arguments: list[str] | None) -> str:
    """The command that was given: the first word that is no option."""
    given = sys.argv[1:] if arguments is None else arguments
    return next((word for word in given if not word.startswith("-")), "")

"""The exceptions of Stribeck. Each says what was wrong, with which value, and what would be right."""

from __future__ import annotations

import re
import warnings
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TypeVar

S = TypeVar("S")
T = TypeVar("T")

_LONGEST_LINE, _HEAD = 300, 180
_BLANKS = re.compile(r"[ \t\r\n\f\v]+")  # not all that Unicode has: the others are shown as escapes


class StribeckError(Exception):
    """Any error that Stribeck raises on purpose."""


class InputError(StribeckError, ValueError):
    """Bad input. ``problems`` holds one line for each problem found: the key's path, the value, what is allowed."""

    def __init__(self, problems: str | Sequence[str]) -> None:
        self.problems: list[str] = [one_line(p) for p in ([problems] if isinstance(problems, str) else problems)]
        super().__init__("\n".join(self.problems))

    def __reduce__(self) -> tuple[type[InputError], tuple[list[str]]]:
        return type(self), (self.problems,)  # between processes


class NotDifferentiable(StribeckError, ArithmeticError):
    """A derivative was asked for where the law has none."""


class BuildError(StribeckError, RuntimeError):
    """The machine's C compiler did not build a system; the message is its first complaint."""


class MissingExtra(StribeckError, ImportError):
    """A part of Stribeck needs a package that is not installed; the message names the extra that brings it."""

    def __init__(self, what: str, package: str, extra: str) -> None:
        self.package, self.extra = package, extra
        super().__init__(what, package, extra)

    def __str__(self) -> str:
        return f"{self.args[0]} needs {self.package}: {self.remedy}"

    @property
    def remedy(self) -> str:
        """The command that installs the package."""
        return remedy(self.package, self.extra)


class StribeckNote(UserWarning):
    """Something a user should know that does not stop the work: a dropped constant, a missing compiler."""


def arg(name: str) -> str:
    """An argument's name within a message: as Python has it, or the option that gives it (:func:`naming`)."""
    return _Called.by(name)


class _Called:
    by: Callable[[str], str] = str  # of a whole process, for its threads tell of arguments too


@contextmanager
def naming(called: Callable[[str], str]) -> Iterator[None]:
    """Around what a command does: messages call arguments so."""
    before, _Called.by = _Called.by, called
    try:
        yield
    finally:
        _Called.by = before


def first_line(error: StribeckError) -> str:
    """The first line of an error's message."""
    return one_line(str(error).splitlines()[0])


def one_line(text: str) -> str:
    """The text on one line, see :func:`unbroken`; without its middle where it is too long."""
    text = unbroken(text)
    return text if len(text) <= _LONGEST_LINE else f"{text[:_HEAD]}...{text[_HEAD + 3 - _LONGEST_LINE :]}"


def error_text(error: BaseException) -> str:
    """An error's kind and words, also where a user's own kind of error cannot be shown."""
    try:
        return f"{type(error).__name__}: {error}"
    except Exception:
        return type(error).__name__


def printable(text: str, but: str = "") -> str:
    """The text with what is no printable character as an escape (``\\x1b``), except for the characters in ``but``.

    A terminal shows such text and obeys nothing in it; on a page nothing in it is hidden or turns the order of letters.
    """
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() or c in but else c.encode("unicode_escape").decode() for c in text)


def unbroken(text: str) -> str:
    """Words on one line, as people read them: each white space is one blank; for the rest see :func:`printable`."""
    return printable(_BLANKS.sub(" ", text).strip(" "))


def note(text: str) -> None:
    """Tell the user one line: a :class:`StribeckNote` in Python, a line on standard error from the command."""
    warnings.warn(StribeckNote(one_line(text)), stacklevel=3)


def nearest(name: str, known: Iterable[str]) -> str:
    """`` (did you mean 'x'?)`` for the known name closest to ``name``, or nothing when none is close."""
    match = _closest(name, known)
    return f" (did you mean '{match[0]}'?)" if match else ""


def corrected(given: Mapping[str, T], known: Collection[str]) -> dict[str, T]:
    """What is given. A misspelt name is there under the known name, too, so that this is not said to be missing."""
    meant = {match: x for name, x in given.items() if name not in known for match in _closest(name, known)}
    return meant | dict(given)


def _closest(name: str, known: Iterable[str]) -> list[str]:
    from difflib import get_close_matches

    return get_close_matches(str(name), list(known), n=1, cutoff=0.6)


def read_pairs(read: Callable[[S], tuple[str, T]], given: Iterable[S], what: str) -> dict[str, T]:
    """The name and the value that ``read`` finds in each of what is given, as a mapping.

    Args:
        what: what gives them, in messages.

    Raises:
        InputError: the lines of each that ``read`` refuses, and a line for each name that is given more than once: which
            value is meant nobody can know.
    """
    problems: list[str] = []
    pairs = []
    for each in given:
        try:
            pairs.append(read(each))
        except InputError as error:
            problems += error.problems
    counts = Counter(name for name, _ in pairs)
    problems += [f"{what} {name}: given {n} times; must be given once" for name, n in counts.items() if n > 1]
    if problems:
        raise InputError(problems)
    return dict(pairs)


def check_all(*readings: Callable[[], object]) -> None:
    """Read several inputs, so that the problems of all are reported together.

    Raises:
        InputError: the lines of each reading that fails.
    """
    problems: list[str] = []
    for read in readings:
        try:
            read()
        except InputError as error:
            problems += error.problems
    if problems:
        raise InputError(problems)


# The packages that the base installation does not have, and the extra that brings each; none brings tools that one has.
EXTRAS = {
    **dict.fromkeys(("matplotlib", "jinja2", "markupsafe", "pyarrow", "pandas", "bokeh"), "plot"),
    **dict.fromkeys(("scipy", "threadpoolctl", "h5py", "flint", "sympy"), "fit"),
    **dict.fromkeys(("mujoco", "mcap", "mcap_ros2", "rosbags"), "robotics"),
    "ziglang": "fmu",
    **dict.fromkeys(("jax", "torch"), ""),
}  # fmt: skip


def remedy(package: str, extra: str) -> str:
    """The command that installs a package, by the extra that brings it if there is one."""
    return f"pip install 'stribeck[{extra}]'" if extra else f"pip install {package}"


@contextmanager
def needed(what: str, extra: str = "") -> Iterator[None]:
    """Around imports of what the base installation does not have: where it is missing, one line says how to get it.

    Args:
        what: what needs it, the line's first words.
        extra: the extra to name, where it is not the package's own (:data:`EXTRAS`).

    Raises:
        MissingExtra: ``what`` needs the package; ``pip install 'stribeck[extra]'`` brings it.
    """
    try:
        yield
    except ModuleNotFoundError as error:
        package = (error.name or "").partition(".")[0]
        if package not in EXTRAS:
            raise
        raise MissingExtra(what, package, EXTRAS[package] and (extra or EXTRAS[package])) from None


@contextmanager
def left_out(what: str) -> Iterator[None]:
    """A context for files beside the numbers. If a package or disk space for them is missing, a note reports it."""
    try:
        with needed(what):
            yield
    except MissingExtra as error:
        note(f"without {what}: {error.package} is not installed ({error.remedy})")
    except OSError as error:
        note(f"without {what}: {error.strerror or error}")

"""The exceptions of Stribeck. Each says what was wrong, with which value, and what would be right."""

from __future__ import annotations

import difflib
import warnings
from collections.abc import Iterable, Sequence

_LONGEST_LINE, _HEAD = 300, 180


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


class StribeckNote(UserWarning):
    """Something a user should know that does not stop the work: a dropped constant, a missing compiler."""


def one_line(text: str) -> str:
    """The text as one line that a terminal can show: no control characters, and no middle where it is too long."""
    text = " ".join("".join(c if c.isprintable() else " " for c in text).split())
    return text if len(text) <= _LONGEST_LINE else f"{text[:_HEAD]}...{text[_HEAD + 3 - _LONGEST_LINE :]}"


def printable(text: str) -> str:
    """The text with what is no printable character as an escape (``\\x1b``): a terminal shows it and obeys nothing."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def note(text: str) -> None:
    """Tell the user one line: a :class:`StribeckNote` in Python, a line on standard error from the command."""
    warnings.warn(one_line(text), StribeckNote, stacklevel=3)


def nearest(name: str, known: Iterable[str]) -> str:
    """`` (did you mean 'x'?)`` for the known name closest to ``name``, or nothing when none is close."""
    match = difflib.get_close_matches(name, list(known), n=1, cutoff=0.6)
    return f" (did you mean '{match[0]}'?)" if match else ""

"""Words for the terminal: lines that end between words, at its width."""

from __future__ import annotations

import shutil
import textwrap

from stribeck.errors import printable

_WIDEST = 100  # columns: longer lines are hard to read


def width() -> int:
    """The columns of the terminal, at most 100; 80 where there is none."""
    return max(40, min(shutil.get_terminal_size((80, 24)).columns, _WIDEST))


def say(text: str, indent: int = 0, first: str = "") -> None:
    """Print text on lines that end between words.

    Args:
        text: what to print; a word longer than the line stays whole.
        indent: of the lines after the first, in columns.
        first: what the first line begins with: a heading, to which ``indent`` makes the others stand beside.
    """
    lines = textwrap.wrap(
        printable(" ".join(text.split())), width(), initial_indent=first, subsequent_indent=" " * indent, break_long_words=False,
        break_on_hyphens=False,
    )  # fmt: skip
    print("\n".join(lines) if lines else first.rstrip())

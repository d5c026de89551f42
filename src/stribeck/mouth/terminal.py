"""A document on a terminal: lines that end between words, at its width, and tables that fit it."""

from __future__ import annotations

import shutil
import textwrap
from collections.abc import Sequence

from stribeck.errors import printable
from stribeck.mouth.cells import texts
from stribeck.mouth.document import Document, Table

_WIDEST = 100  # columns: longer lines are hard to read
_LEAST = 24  # columns, of a folded cell
_APART = 3  # blanks between two columns


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
    lines = _folded(printable(" ".join(text.split())), width(), first, " " * indent)
    print("\n".join(lines) if lines else first.rstrip())


def tell(document: Document, files: Sequence[str] = ()) -> None:
    """Print a document, the files that were written, and what comes next."""
    say(f"{document.title}: {document.lead}", 4)
    for text in document.facts:
        say(text, 4, "  ")
    for chapter in document.chapters:
        tables = [table for table in chapter.tables if "terminal" in table.on]
        if "terminal" not in chapter.on or not (tables or chapter.facts or chapter.code):
            continue
        print()
        if chapter.headed:
            say(chapter.title, 4)
        for text in chapter.facts:
            say(text, 4, "  ")
        for i, table in enumerate(tables):
            if i:
                print()
            _table(table)
        for line in chapter.code.splitlines():
            say(line, 4, "  ")
    for file in files:
        print(f"  wrote {printable(file)}")
    if document.next is not None:
        command, why = document.next
        print(f"\n  next: {command}    {why}".rstrip())


def _folded(text: str, wide: int, first: str = "", other: str = "") -> list[str]:
    return textwrap.wrap(
        text, wide, initial_indent=first, subsequent_indent=other, break_long_words=False, break_on_hyphens=False
    )


def _table(table: Table) -> None:
    """Rows in columns; where they are wider than the terminal the last column of words folds, or the first stands above."""
    titles, rows, words = texts(table, "terminal")
    if not rows:
        return
    columns = len(titles)
    rows = [titles, *([printable(cell) if "\n" not in cell else cell for cell in row] for row in rows)]
    widths = [max(max(map(len, row[i].split("\n")), default=0) for row in rows) for i in range(columns)]
    room = width() - 2 - sum(widths[:-1]) - _APART * (columns - 1)
    above = False
    if widths[-1] > room:
        above = columns > 2 and not (words[-1] and room >= _LEAST)
        room += widths[0] if above else 0
        widths[0] = 0 if above else widths[0]
        widths[-1] = max(room, _LEAST) if words[-1] else widths[-1]
    for row in rows:
        if above and row[0]:
            print(f"  {row[0]}")
        cells = ["", *row[1:]] if above else row
        folded = [
            [
                line
                for part in cell.split("\n")
                for line in (_folded(part, wide, "", "  ") if i == columns - 1 else [part])
            ]
            for i, (cell, wide) in enumerate(zip(cells, widths, strict=True))
        ]
        for k in range(max(map(len, folded), default=0)):
            line = [lines[k] if k < len(lines) else "" for lines in folded]
            shown = [x.ljust(w) if left else x.rjust(w) for x, w, left in zip(line, widths, words, strict=True)]
            print("  " + (" " * _APART).join(shown).rstrip())

"""A document on a terminal: lines that end between words, at its width, and tables that fit it."""

from __future__ import annotations

import shutil
import textwrap
from collections.abc import Iterator, Sequence
from html import escape

from stribeck.errors import printable, unbroken
from stribeck.mouth.cells import texts
from stribeck.mouth.document import Chapter, Document, Table

_WIDEST = 100  # columns: longer lines are hard to read
_LEAST = 24  # columns, of a folded cell
_APART, _NEAR = 3, 2  # blanks between two columns; where the room is short
_ONE_LINE = 10_000  # columns
_BRIEF = 5  # facts of a brief chapter: what one reads


class Told:
    """A result that says itself: ``print()`` and a notebook show what a terminal would."""

    def document(self) -> Document:
        """The document of the result, for the terminal and for a page."""
        raise NotImplementedError

    def __str__(self) -> str:
        return "\n".join(lines(self.document()))

    def _repr_html_(self) -> str:
        return f"<pre>{escape(str(self))}</pre>"


def width(without: int = 80) -> int:
    """The columns of the terminal, at most 100; ``without`` where there is none."""
    return max(40, min(shutil.get_terminal_size((without, 24)).columns, _WIDEST))


def tell(document: Document, files: Sequence[str] = (), verbose: bool = False) -> None:
    """Print a document, the files that were written, and what comes next; with ``verbose`` every note."""
    for text in lines(document, files, verbose):
        print(text)


def lines(document: Document, files: Sequence[str] = (), verbose: bool = False) -> Iterator[str]:
    """The lines of a document."""
    whole = shutil.get_terminal_size((_ONE_LINE, 24)).columns  # a headline in a file is one line
    yield from _said(f"{document.title}: {document.lead}", 4, wide=max(40, whole))
    for text in document.facts:
        yield from _said(text, 4, "  ")
    for chapter in document.chapters:
        if "terminal" in chapter.on:
            yield from _chapter(chapter, verbose)
    for file in files:
        yield f"  wrote {printable(file)}"
    if document.next is not None:
        command, why = document.next
        yield ""
        yield f"  next: {printable(command)}    {unbroken(why)}".rstrip()


def _chapter(chapter: Chapter, verbose: bool) -> Iterator[str]:
    """A blank line, the facts, the tables and the code; nothing where there is none of these."""
    tables = [table for table in chapter.tables if "terminal" in table.on]
    facts = chapter.facts if verbose or not chapter.brief else chapter.facts[:_BRIEF]
    if not (tables or facts or chapter.code):
        return
    yield ""
    if chapter.headed:
        yield from _said(chapter.title, 4)
    for text in facts:
        yield from _said(text, 4, "  ")
    if left := len(chapter.facts) - len(facts):
        yield f"  {left} more: --verbose, or the page (--out DIR)"
    for i, table in enumerate(tables):
        if i or facts:
            yield ""
        yield from _table(table)
    for line in chapter.code.split("\n") if chapter.code else ():
        yield from _said(line, 4, "  ")


def _said(text: str, indent: int, first: str = "", wide: int | None = None) -> list[str]:
    """Text on lines that end between words; a word longer than the line stays whole.

    Args:
        indent: of the lines after the first, in columns.
        first: what the first line begins with.
    """
    folded = _folded(unbroken(text), wide or width(), first, " " * indent)
    return folded or [first.rstrip()]


def _folded(text: str, wide: int, first: str = "", other: str = "") -> list[str]:
    return textwrap.wrap(
        text, wide, initial_indent=first, subsequent_indent=other, break_long_words=False, break_on_hyphens=False
    )


def _table(table: Table) -> Iterator[str]:
    """Rows in columns. If they are too wide, the last column folds if it has words, else the first stands above the others.

    Words fold at 100 columns, as prose does. Rows that do not fold take the whole terminal, and in a file one line.
    """
    titles, rows, words = texts(table, "terminal")
    if not rows:
        return
    columns = len(titles)
    rows = [titles, *rows]
    widths = [max(len(row[i]) for row in rows) for i in range(columns)]
    whole = width(_WIDEST) - 2
    if not words[-1] or whole - sum(widths[:-1]) - _NEAR * (columns - 1) < min(_LEAST, widths[-1]):
        whole = shutil.get_terminal_size((_ONE_LINE, 24)).columns - 2
    apart = _APART if sum(widths) + _APART * (columns - 1) <= whole else _NEAR
    room = whole - sum(widths[:-1]) - apart * (columns - 1)
    above = False
    if widths[-1] > room:
        above = columns > 2 and not (words[-1] and room >= _LEAST)
        room += widths[0] if above else 0
        widths[0] = 0 if above else widths[0]
        widths[-1] = max(room, _LEAST) if words[-1] else widths[-1]
    for row in rows:
        if above and row[0]:
            yield f"  {row[0]}"
        cells = ["", *row[1:]] if above else row
        folded = [*([cell] for cell in cells[:-1]), _folded(cells[-1], widths[-1], "", "  ")]
        for k in range(max(map(len, folded), default=0)):
            line = [lines[k] if k < len(lines) else "" for lines in folded]
            shown = [x.ljust(w) if left else x.rjust(w) for x, w, left in zip(line, widths, words, strict=True)]
            yield "  " + (" " * apart).join(shown).rstrip()

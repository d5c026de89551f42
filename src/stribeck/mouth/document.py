"""A document: what a result says to people. Its tables hold values; terminal and page turn numbers into text."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Drawn

BOTH, PAGE, TERMINAL = ("terminal", "page"), ("page",), ("terminal",)


@dataclass(frozen=True)
class Amount:
    """A number with its SI unit; the text has a prefix that keeps it short, ``64.2 mm``, and so many digits."""

    value: float | None
    unit: str
    digits: int = 3


@dataclass(frozen=True)
class Share:
    """A share of one, whose text is a percentage with three digits."""

    value: float | None


@dataclass(frozen=True)
class Uncertain:
    """A number with the places that its interval leaves it; ``doubtful``: marked ``~``."""

    value: float
    interval: tuple[float, float]
    doubtful: bool = False


@dataclass(frozen=True)
class Ends:
    """The ends of an interval about ``value``. An infinite end is open: what is left is a bound."""

    ends: tuple[float, float] | None
    value: float


Cell = str | int | float | None | Amount | Share | Uncertain | Ends


@dataclass(frozen=True)
class Head:
    """A column of a table: its title, the digits of its plain numbers, and where it is shown."""

    title: str
    digits: int = 6
    on: Sequence[str] = BOTH


@dataclass(frozen=True)
class Table:
    """Columns and rows of values. ``prose``: cells of words, whose lines a page breaks."""

    columns: Sequence[str | Head]
    rows: Sequence[Sequence[Cell]]
    prose: bool = False
    on: Sequence[str] = BOTH


@dataclass(frozen=True)
class Figure:
    """A figure that is drawn when a page asks, within the common style of plots; ``draw`` may find that there is none."""

    name: str
    caption: str
    draw: Callable[[], Drawn | None]


@dataclass(frozen=True)
class FigureSvg:
    """A drawn figure: a name for its files, the SVG, and a caption that says what to see."""

    name: str
    svg: str
    caption: str

    @property
    def inline(self) -> str:
        """The SVG to stand in HTML: no prolog, no fixed size, and ids that clash with no other figure's."""
        body = self.svg[self.svg.index("<svg") :]
        body = re.sub(r'(<svg[^>]*?) width="[^"]*"', r"\1", body, count=1)
        body = re.sub(r'(<svg[^>]*?) height="[^"]*"', r"\1", body, count=1)
        body = re.sub(r"<metadata>.*?</metadata>", "", body, flags=re.DOTALL)
        body = re.sub(r'\bid="', f'id="{self.name}-', body)
        body = re.sub(r'(xlink:href="|url\()#', rf"\1#{self.name}-", body)
        return body.replace("<svg", f'<svg role="img" aria-label="{self.name}"', 1)


@dataclass(frozen=True)
class Chapter:
    """A chapter: tables, figures and code, and where it is shown.

    Attributes:
        text: paragraphs of the page. facts: sentences for the terminal too.
        headed: the terminal prints its title too.
        brief: the terminal prints the first facts only, and how many more there are, unless it is to print all.
    """

    key: str
    title: str
    text: Sequence[str] = ()
    tables: Sequence[Table] = ()
    figures: Sequence[Figure | FigureSvg] = ()
    facts: Sequence[str] = field(default=(), kw_only=True)
    code: str = field(default="", kw_only=True)
    on: Sequence[str] = field(default=BOTH, kw_only=True)
    headed: bool = field(default=False, kw_only=True)
    brief: bool = field(default=False, kw_only=True)


@dataclass(frozen=True)
class Document:
    """The document of a result.

    Attributes:
        title: what it is about, such as a file's name.
        lead: the answer, in one sentence; the terminal prints it behind the title.
        facts: sentences below it.
        chapters: in the order of reading.
        next: the command that comes next, and what for; on a terminal.
    """

    title: str
    lead: str
    facts: Sequence[str] = ()
    chapters: Sequence[Chapter] = ()
    next: tuple[str, str] | None = None

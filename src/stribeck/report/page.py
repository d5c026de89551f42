"""A report as a list of chapters, and the self-contained HTML page that shows it."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from importlib.resources import files
from typing import Any

from numpy.typing import ArrayLike

from stribeck.errors import needed

_NUMBER = re.compile(r"(open|given|any|-|[-+\N{MINUS SIGN}]?(\d[\d.e+-]*|nan|inf)( ?%)?)$")


@dataclass(frozen=True)
class Table:
    """A table: its head and its rows, as text; ``prose`` for cells of words instead of numbers."""

    head: Sequence[str]
    rows: Sequence[Sequence[str]]
    prose: bool = False

    @property
    def words(self) -> set[int]:
        """The columns of words, which stand to the left; numbers stand to the right."""
        return {i for i in range(len(self.head)) if any(not _NUMBER.match(row[i]) for row in self.rows if row[i:])}


@dataclass(frozen=True)
class FigureSvg:
    """A figure: a name for its files, the SVG (PNG, PDF), and a caption that says what to see."""

    name: str
    svg: str
    caption: str
    png: bytes = b""
    pdf: bytes = b""

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


def in_script(data: object) -> str:
    """Data as JSON that may stand in a script of HTML: nothing in it ends that, or opens another."""
    return json.dumps(data, allow_nan=False).replace("<", "\\u003c")


@dataclass(frozen=True)
class Chapter:
    """A chapter of a report: text, tables, figures and code for people, ``numbers`` and ``data`` (columns) for programs."""

    key: str
    title: str
    text: Sequence[str] = ()
    tables: Sequence[Table] = ()
    figures: Sequence[FigureSvg] = ()
    numbers: Mapping[str, Any] = field(default_factory=dict)
    data: Mapping[str, ArrayLike] = field(default_factory=dict)
    code: str = ""


def _whole(text: str) -> str:
    """The text as HTML; options of commands are not broken behind their dashes."""
    from markupsafe import Markup, escape

    return Markup(re.sub(r"--[\w-]+", r'<span class="whole">\g<0></span>', str(escape(text))))


def html(title: str, about: str, introduction: Sequence[str], chapters: Sequence[Chapter], command: str = "") -> str:
    """The page: nothing in it is fetched from elsewhere. ``command`` is what a button copies."""
    with needed("a page"):
        import jinja2

    template, script = (
        files("stribeck.report").joinpath(name).read_text(encoding="utf-8") for name in ("page.html", "page.js")
    )
    environment = jinja2.Environment(autoescape=True, trim_blocks=True, undefined=jinja2.StrictUndefined)
    environment.filters["whole"] = _whole
    return environment.from_string(template).render(
        title=title,
        about=about,
        introduction=introduction,
        chapters=chapters,
        command=command,
        script=script,
    )

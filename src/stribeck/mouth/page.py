"""The self-contained HTML page of a document."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING

from stribeck.errors import needed, printable, unbroken
from stribeck.files import write_text
from stribeck.mouth import plots
from stribeck.mouth.cells import texts
from stribeck.mouth.document import Chapter, Document, Figure, FigureSvg
from stribeck.version import __version__

if TYPE_CHECKING:
    import jinja2


def in_script(data: object) -> str:
    """Data as JSON that may stand in a script of HTML: nothing in it ends that, or opens another."""
    return json.dumps(data, allow_nan=False).replace("<", "\\u003c")


def _whole(text: str) -> str:
    """The text as HTML; options of commands are not broken behind their dashes, paths of keys are behind their dots."""
    from markupsafe import Markup
    from markupsafe import escape as safe

    shown = str(safe(unbroken(text)))
    shown = re.sub(r"\b[A-Za-z]\w*(?:\.\w+){2,}", lambda path: path[0].replace(".", ".<wbr>"), shown)
    return Markup(re.sub(r"--[\w-]+", r'<span class="whole">\g<0></span>', shown))


def _visible(value: object) -> object:
    """A text that the template shows: lines of code stay lines. What is HTML has been made visible where it was made."""
    return printable(value, but="\n") if type(value) is str else value


def write(
    document: Document, folder: Path, command: str = "", name: str = "report.html", *, pictures: bool = True
) -> list[Path]:
    """Write a document's page, which stands alone, and with ``pictures`` its figures as SVG: all of them or none.

    Args:
        folder: where they go.
        command: that made it: the page shows it.
        name: of the page's file.

    Returns:
        The paths, last the page.
    """
    chapters, pictured = [], list[FigureSvg]()
    for chapter in (each for each in document.chapters if "page" in each.on):
        drawings = [plots.drawn(each) if isinstance(each, Figure) else each for each in chapter.figures]
        shown = [figure for figure in drawings if figure is not None]
        chapters.append(replace(chapter, figures=shown))
        pictured += shown if pictures else []
    introduction = [_sentence(text) for text in (document.lead, *document.facts)]
    about = f"Stribeck {__version__}" + (f", {command}" if command else "")
    text = html(document.title, about, introduction, chapters, command)
    paths = [*(folder / f"{figure.name}.svg" for figure in pictured), folder / name]
    try:
        for path, content in zip(paths, (*(figure.svg for figure in pictured), text), strict=True):
            write_text(path, content)
    except OSError:
        for path in paths:
            path.unlink(missing_ok=True)
        raise
    return paths


def _sentence(text: str) -> str:
    """The text with a capital, unless it begins with the name of a file, a parameter or a law, and with a full stop."""
    first = text.split(" ", 1)[0].rstrip(":;")
    begun = text if re.search(r"\w[_./]\w|,$", first) else f"{text[:1].upper()}{text[1:]}"
    return begun + ("" if text.endswith((".", "!", "?", ":")) else ".")


@cache
def _template() -> tuple[jinja2.Template, str]:
    """The template of a page, compiled once, and its script."""
    with needed("a page"):
        import jinja2

    text, script = (
        files("stribeck.mouth").joinpath(name).read_text(encoding="utf-8") for name in ("page.html", "page.js")
    )
    environment = jinja2.Environment(
        autoescape=True, trim_blocks=True, undefined=jinja2.StrictUndefined, finalize=_visible
    )
    environment.filters["whole"] = _whole
    environment.filters["sentence"] = lambda text: _whole(_sentence(text))
    return environment.from_string(text), script


def html(title: str, about: str, introduction: Sequence[str], chapters: Sequence[Chapter], command: str = "") -> str:
    """The page: nothing in it is fetched from elsewhere.

    Args:
        command: what a button copies.
    """
    template, script = _template()
    return template.render(
        title=title,
        about=about,
        introduction=introduction,
        chapters=chapters,
        command=command,
        script=script,
        texts=lambda table: texts(table, "page"),
    )

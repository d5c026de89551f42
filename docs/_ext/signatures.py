"""Signatures in the Python reference as a user writes them: a table's keys, and arrays under their short name."""

from __future__ import annotations

import inspect
import re
from typing import Any

from sphinx.application import Sphinx

import stribeck
from stribeck.machine.table import FileTable

# NumPy's ArrayLike and an array of floats, as inspection writes them out
ARRAY_LIKE = re.compile(r"[~\w.]*_Buffer \|.*?_NestedSequence\[complex \| bytes \| str\]")
ARRAY = re.compile(r"[~\w.]*ndarray\[tuple\[[~\w.]*Any, \.\.\.\], [~\w.]*dtype\[[~\w.]*\]\]")
PAGE = re.compile(r"docs/((?:reference|explanation|howto)/[\w-]+)\.md")  # a page, as docstrings name it


def of_table(table: type[FileTable]) -> str:
    """The call that makes a table: its positional keys, then the others by name; ``=None`` marks an optional key."""
    written = inspect.signature(table.__init__).parameters
    named = [p for n, p in written.items() if n != "self" and p.kind in (p.POSITIONAL_OR_KEYWORD, p.KEYWORD_ONLY)]
    taken = {p.name for p in named}
    optional = {p.name: p.default for p in named if p.default is not p.empty}
    first = [p.name for p in named if p.kind is p.POSITIONAL_OR_KEYWORD] or list(table.positional)
    last = [p.name for p in named if p.kind is p.KEYWORD_ONLY]
    hidden = {"kind", "name", "folder", *(["initial"] if "y" in taken else [])}  # a body takes y and v in its place
    for name, field in table.model_fields.items():
        if name not in taken | hidden:
            if name not in first:
                last.append(name)
            if not field.is_required():
                optional[name] = field.default
    last.sort(key=lambda name: name in optional)  # required keys first
    calls = [f"{name}={optional[name]!r}" if name in optional else name for name in (*first, *last)]
    return f"({', '.join([*calls[: len(first)], *(['*'] if last else []), *calls[len(first) :]])})"


def shortened(
    _app: Sphinx, what: str, _name: str, thing: Any, _options: Any, signature: str | None, returned: str | None
) -> tuple[str | None, str | None]:
    """What autodoc shows in the place of a signature."""
    if inspect.isclass(thing) and issubclass(thing, FileTable):
        return of_table(thing), None
    called = thing is stribeck.Constant or "Args:" in (thing.__doc__ or "")
    if what == "class" and not called:
        return "", None  # a result or a base: a user makes none
    texts = (text and ARRAY.sub("ndarray", ARRAY_LIKE.sub("ArrayLike", text)) for text in (signature, returned))
    return next(texts), next(texts)


def linked(_app: Sphinx, _what: str, _name: str, _thing: Any, _options: Any, lines: list[str]) -> None:
    """Make links of the pages that a docstring names."""
    lines[:] = [PAGE.sub(r":doc:`/\1`", line) for line in lines]


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the hooks."""
    app.connect("autodoc-process-signature", shortened)
    app.connect("autodoc-process-docstring", linked)
    return {"parallel_read_safe": True}

"""The paper's phenomena as a report: one module a chapter, each with a function ``chapter()``."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import stribeck
from stribeck.report.files import write_json, write_text
from stribeck.report.page import Chapter, html

# In the order of the report; a new chapter is a module here and a name in this list.
CHAPTERS = ("presliding", "stick_slip", "sine_force", "limit_cycle", "break_away", "hysteresis")

TITLE = "Friction phenomena under three laws"
_INTRODUCTION = (
    "LuGre (the reference), its continuous approximation of Sobczyk, Perondi and Cunha (k_v = 1e7 s/m), and the "
    "majorant law of this project (k_v = 1e6 s/m) under the scenarios of the paper 'A continuous approximation of the "
    "LuGre friction model', with the parameters of its Table 1.",
    "Every number in the text and the tables was computed when this page was made.",
)


def write(folder: Path, progress: Callable[[float], None] | None = None) -> dict[str, Any]:
    """Compute every chapter and write report.html, figures/*.svg and summary.json; the summary.

    Raises:
        OSError: a file could not be written; files written before it are whole.
    """
    chapters: list[Chapter] = []
    for i, name in enumerate(CHAPTERS):
        if progress is not None:
            progress(i / len(CHAPTERS))
        chapters.append(importlib.import_module(f"{__name__}.{name}").chapter())
    figures = folder / "figures"
    figures.mkdir(parents=True, exist_ok=True)
    paths = []
    for figure in (figure for chapter in chapters for figure in chapter.figures):
        paths.append(figures / f"{figure.name}.svg")
        write_text(paths[-1], figure.svg)
    page = folder / "report.html"
    about = f"Made by Stribeck {stribeck.__version__}."
    write_text(page, html(TITLE, about, _INTRODUCTION, chapters))
    summary = {
        "status": "done",
        "version": stribeck.__version__,
        "chapters": {chapter.key: chapter.numbers for chapter in chapters},
        "files": [str(path) for path in (page, *paths, folder / "summary.json")],
    }
    write_json(folder / "summary.json", summary)
    return summary

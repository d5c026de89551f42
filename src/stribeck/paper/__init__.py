"""The paper as a report: one module a chapter, each with a function ``chapter(done)``."""

from __future__ import annotations

import importlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

from stribeck.files import write_columns, write_json, write_text, write_with
from stribeck.report.page import Chapter, html
from stribeck.version import __version__

# In the order of the report; a new chapter is a module here and a name in this list.
CHAPTERS = (
    "steady", "smoothing", "presliding", "stick_slip", "sine_force", "limit_cycle", "break_away", "servo", "statements",
    "beyond", "guarantees", "evidence", "which_k_v",
)  # fmt: skip
_READS_OTHERS = ("statements",)  # chapters made of what the others computed
_SLOWEST_FIRST = ("guarantees", "servo", "evidence", "which_k_v", "beyond", "stick_slip", "limit_cycle", "break_away")

TITLE = "A continuous approximation of the LuGre friction model: every figure, computed"
_INTRODUCTION = (
    "The figures of Sobczyk, Perondi and Cunha's paper for the original LuGre law (lugre) and its proposed continuous "
    "approximation (lugre_sobczyk) at k_v = 1e6, 1e7 and 1e8 s/m, with the parameters of the paper's Table 1; then what "
    "the paper states beside what was computed, and what other smooth laws do in the same places.",
    "Every number in the text and the tables was computed when this page was made. Rates that the paper does not give are "
    "this project's choice and stand in the scenario files (stribeck new --list).",
)


def write(folder: Path, progress: Callable[[float, str], None] | None = None) -> dict[str, Any]:
    """Compute every chapter and write report.html, figures/*.svg and *.png, data/*.parquet and summary.json.

    Args:
        folder: where they go.
        progress: told the share of the chapters done and a word on it, as each is done.

    Returns:
        The summary.

    Raises:
        StribeckError: a simulation failed; nothing is written.
        OSError: a file could not be written; files written before it are whole.
    """
    chapters = list(_compute(progress).values())
    paths = []
    for name in ("figures", "data"):
        (folder / name).mkdir(parents=True, exist_ok=True)
    for figure in (figure for chapter in chapters for figure in chapter.figures):
        paths += [folder / "figures" / f"{figure.name}.{kind}" for kind in ("svg", "png")]
        write_text(paths[-2], figure.svg)
        write_with(paths[-1], lambda beside, png=figure.png: beside.write_bytes(png))  # type: ignore[misc]
    for chapter in chapters:
        if chapter.data:
            paths.append(folder / "data" / f"{chapter.key}.parquet")
            write_columns(paths[-1], chapter.data)
    page = folder / "report.html"
    write_text(page, html(TITLE, f"Made by Stribeck {__version__}.", _INTRODUCTION, chapters))
    summary = {
        "status": "done",
        "version": __version__,
        "chapters": {chapter.key: chapter.numbers for chapter in chapters},
        "files": [str(path) for path in (page, *paths, folder / "summary.json")],
    }
    write_json(folder / "summary.json", summary)
    return summary


def _compute(progress: Callable[[float, str], None] | None) -> dict[str, Chapter]:
    """The chapters by key, in order; independent ones in two processes where there are two cores."""
    from concurrent.futures import ProcessPoolExecutor, as_completed

    independent = [name for name in CHAPTERS if name not in _READS_OTHERS]
    independent.sort(key=lambda name: _SLOWEST_FIRST.index(name) if name in _SLOWEST_FIRST else len(_SLOWEST_FIRST))
    done: dict[str, Chapter] = {}
    with ProcessPoolExecutor(min(2, os.cpu_count() or 1)) as pool:
        futures = {pool.submit(_chapter, name, {}): name for name in independent}
        try:
            if progress is not None:
                progress(0.0, f"{len(CHAPTERS)} chapters")
            for future in as_completed(futures):
                done[futures[future]] = future.result()
                if progress is not None:
                    progress(
                        len(done) / len(CHAPTERS), f"{len(done)} of {len(CHAPTERS)} chapters, {futures[future]} done"
                    )
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    for name in _READS_OTHERS:
        done[name] = _chapter(name, done)
    return {name: done[name] for name in CHAPTERS}


def _chapter(name: str, done: dict[str, Chapter]) -> Chapter:
    made: Chapter = importlib.import_module(f"{__name__}.{name}").chapter(done)
    return made

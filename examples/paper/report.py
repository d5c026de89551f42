"""The report: every chapter, and the page and files that they make."""

from __future__ import annotations

import importlib
import os
import pkgutil
import signal
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from examples.paper.common import Chapter
from stribeck.files import parquet_of, together, write_json
from stribeck.mouth.cells import human
from stribeck.mouth.page import html
from stribeck.version import __version__

# In the order of the report; other modules of this folder that have a chapter come after them.
_LISTED = (
    "steady", "smoothing", "presliding", "stick_slip", "sine_force", "limit_cycle", "break_away", "servo", "statements",
    "beyond", "guarantees", "evidence", "which_k_v", "joint",
)  # fmt: skip
_NO_CHAPTERS = ("__main__", "common", "report", "sketches")


def chapters() -> tuple[str, ...]:
    """The names of the chapters' modules."""
    return (
        *_LISTED,
        *sorted({m.name for m in pkgutil.iter_modules([str(Path(__file__).parent)])} - {*_LISTED, *_NO_CHAPTERS}),
    )


CHAPTERS = chapters()
_READS_OTHERS = ("statements",)  # chapters made of what the others computed
_SLOWEST_FIRST = ("guarantees", "servo", "evidence", "which_k_v", "beyond", "stick_slip", "limit_cycle", "break_away")

TITLE = "A continuous approximation of the LuGre friction model: every figure, computed"
_INTRODUCTION = (
    "The figures of Sobczyk, Perondi and Cunha's paper for the original LuGre law (lugre) and its proposed continuous "
    "approximation (lugre_sobczyk) at k_v = 1e6, 1e7 and 1e8 s/m, with the parameters of the paper's Table 1. Then "
    "the paper's statements are compared with computed values, and other smooth laws with these two.",
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
        OSError: a file could not be written; what was in the folder stays as it was.
    """
    chapters = list(_compute(progress).values())
    with together(folder) as place:
        for figure in (figure for chapter in chapters for figure in chapter.figures):
            _new(place / "figures" / f"{figure.name}.svg").write_text(figure.svg, encoding="utf-8")
            _new(place / "figures" / f"{figure.name}.png").write_bytes(figure.png)
        for chapter in chapters:
            if chapter.data:
                content = parquet_of((name, "", "", x) for name, x in chapter.data.items())
                _new(place / "data" / f"{chapter.key}.parquet").write_bytes(content)
        page = html(
            TITLE, f"Made by Stribeck {__version__}.", [_in_short(chapters), *_INTRODUCTION], chapters, "make demo"
        )
        (place / "report.html").write_text(page, encoding="utf-8")
        names = [str(path.relative_to(place)) for path in sorted(place.rglob("*")) if path.is_file()]
        names = ["report.html", *(name for name in names if name != "report.html"), "summary.json"]
        summary = {
            "status": "done",
            "version": __version__,
            "chapters": {chapter.key: chapter.numbers for chapter in chapters},
            "files": [str(folder / name) for name in names],
        }
        write_json(place / "summary.json", summary)
    return summary


def _in_short(chapters: Sequence[Chapter]) -> str:
    """What the figures show, in one line and in units that a person would use."""
    numbers = {chapter.key: chapter.numbers for chapter in chapters}
    cycle = numbers["limit_cycle"]
    verdicts = [str(verdict) for verdict in numbers["statements"].values()]
    return (
        f"LuGre under PID hunts: amplitude {human(cycle['amplitude']['lugre'], 'm')}, period "
        f"{human(cycle['period']['lugre'], 's')}; "
        f"of {len(verdicts)} statements of the paper {sum(v.startswith('confirmed') for v in verdicts)} are confirmed."
    )


def _new(path: Path) -> Path:
    path.parent.mkdir(exist_ok=True)
    return path


def _compute(progress: Callable[[float, str], None] | None) -> dict[str, Chapter]:
    """The chapters by key, in order; independent ones in two processes where there are two cores."""
    from concurrent.futures import ProcessPoolExecutor, as_completed
    from multiprocessing import active_children

    independent = [name for name in CHAPTERS if name not in _READS_OTHERS]
    independent.sort(key=lambda name: _SLOWEST_FIRST.index(name) if name in _SLOWEST_FIRST else len(_SLOWEST_FIRST))
    done: dict[str, Chapter] = {}
    with ProcessPoolExecutor(min(2, os.cpu_count() or 1), initializer=_leave_ctrl_c_to_the_parent) as pool:
        futures = {pool.submit(_chapter, name, {}): name for name in independent}
        try:
            for future in as_completed(futures):
                done[futures[future]] = future.result()
                if progress is not None:
                    progress(
                        len(done) / len(CHAPTERS), f"{len(done)} of {len(CHAPTERS)} chapters, {futures[future]} done"
                    )
        except BaseException:  # a chapter takes up to a minute: nobody waits for it after Ctrl-C or a failure
            for child in active_children():
                child.terminate()
            raise
    for name in _READS_OTHERS:
        done[name] = _chapter(name, done)
    return {name: done[name] for name in CHAPTERS}


def _leave_ctrl_c_to_the_parent() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def _chapter(name: str, done: dict[str, Chapter]) -> Chapter:
    built: Chapter = importlib.import_module(f"examples.paper.{name}").chapter(done)
    return built

"""The page of a comparison: measured and predicted traces over each other, and what is left."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from stribeck.arrays import Array
from stribeck.files import write_text
from stribeck.mouth import plots
from stribeck.mouth.document import Chapter, FigureSvg, Table
from stribeck.mouth.page import html
from stribeck.mouth.quantities import Quantity, scale
from stribeck.version import __version__

_ZOOM = 0.1  # of the record


def figure(
    name: str, time: Array, traces: Mapping[str, tuple[str, Array, Array]], words: tuple[str, str]
) -> list[FigureSvg]:
    """Each trace measured and otherwise, the whole record and the part in which they differ most; and the residuals.

    Args:
        name: of the figures.
        time: s, rising or with files behind each other.
        traces: by label: unit, measured, predicted.
        words: what the two lines are called.
    """
    time = _behind(time)
    found = []
    for part, rows in (("", slice(None)), ("_zoom", _worst(time, traces))):
        with plots.style():
            layout = [[row] for label in traces for row in (label, f"{label} residual")]
            made, axes = plots.figure(layout, 1.7 * len(layout) + 0.4)
            for label, (unit, measured, other) in traces.items():
                missed = (measured - other)[rows]
                of_y = scale([Quantity(label, unit, "", x[rows]) for x in (measured, other)])
                of_missed = scale([Quantity("residual", unit, "", missed)])
                for i, x, word in ((2, measured, words[0]), (1, other, words[1])):
                    plots.line(axes[label], i, *plots.in_time(time[rows], of_y.of(x[rows])), word, linewidth=0.9)
                axes[label].set_ylabel(of_y.label)
                left = axes[f"{label} residual"]
                left.plot(*plots.in_time(time[rows], of_missed.of(missed)), color=plots.COLOURS[2], linewidth=0.7)
                left.set_ylabel(of_missed.label)
            axes[layout[-1][0]].set_xlabel("t (s)")
            plots.legend(made, axes[next(iter(traces))])
            text = "The whole record" if not part else "The tenth of it in which they differ most"
            found.append(plots.finish(made, f"{name}{part}", f"{text}: {words[0]}, {words[1]}, and the difference."))
    return found


def write_overlay(
    folder: Path, name: str, title: str, introduction: Sequence[str], errors: Sequence[Sequence[str]],
    figures: Sequence[FigureSvg], command: str,
) -> str:  # fmt: skip
    """Write the page; its path."""
    chapters = [
        Chapter("errors", "Errors", [], [Table(["of", "error"], errors)]),
        Chapter("overlay", "Measured and predicted", [], figures=figures),
    ]
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / name
    write_text(path, html(title, f"Stribeck {__version__}, {command}", introduction, chapters, command))
    return str(path)


def _behind(time: Array) -> Array:
    steps = np.diff(time)
    return time if np.all(steps >= 0) else np.concatenate([[0.0], np.cumsum(np.maximum(steps, 0.0))])


def _worst(time: Array, traces: Mapping[str, tuple[str, Array, Array]]) -> slice:
    _, measured, other = next(iter(traces.values()))
    length = max(int(_ZOOM * len(time)), min(len(time), 20))
    sums = np.concatenate([[0.0], np.cumsum((measured - other) ** 2)])
    first = int(np.argmax(sums[length:] - sums[:-length])) if length < len(time) else 0
    return slice(first, first + length)

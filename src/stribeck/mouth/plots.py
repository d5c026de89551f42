"""Plots: one style for all, drawn with matplotlib's figures (no pyplot, no screen) and returned as SVG text."""

from __future__ import annotations

import io
import logging
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stribeck.arrays import Array
from stribeck.errors import needed, printable
from stribeck.mouth.document import Figure as Picture
from stribeck.mouth.document import FigureSvg

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Okabe and Ito's colors, which color-blind readers tell apart; lines also differ in their dashes.
COLORS = ("#000000", "#D55E00", "#0072B2", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
DASHES: tuple[object, ...] = (
    "-",
    (0, (5, 1.5)),
    (0, (1.5, 1.5)),
    "-.",
    (0, (8, 2, 1, 2, 1, 2)),
    (0, (1, 3)),
    (0, (10, 3)),
)
GRAY = "#808080"
_STYLE: dict[str, Any] = {
    "font.family": "sans-serif",
    "font.sans-serif": ["Helvetica", "Arial", "DejaVu Sans"],
    "font.size": 9,
    "axes.titlesize": 9,
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.formatter.limits": (-4, 6),
    "axes.formatter.useoffset": False,
    "axes.formatter.use_mathtext": False,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.5,
    "lines.linewidth": 1.3,
    "legend.frameon": False,
    "legend.fontsize": 9,
    "legend.handlelength": 3,
    "svg.fonttype": "none",
    "svg.hashsalt": "stribeck",
}
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_LARGEST = 1e300  # of what is drawn: its axis ends beyond, and is a number too
_LONGEST = 60  # characters of a label
_SHOWN = "\u200b"  # before a label that begins with an underscore, which matplotlib would hide
_IN_AN_INCH = 19  # characters of a label, on average
_BLOCKS = 1500  # a line across a page is drawn from so many stretches: more than print can show
_GAP = 1.5  # usual steps: a longer one is a gap


@contextmanager
def style() -> Iterator[None]:
    """Within, matplotlib draws in the common style."""
    with needed("a plot"):
        logging.getLogger("matplotlib").setLevel(logging.ERROR)  # where it keeps its fonts concerns nobody here
        import matplotlib

    with matplotlib.rc_context(cast(Any, _STYLE)):
        yield


def figure(layout: Sequence[Sequence[str]], height: float) -> tuple[Figure, dict[str, Axes]]:
    """A page-wide figure with panels named as in ``layout``, ``height`` in inches. Call within :func:`style`."""
    from matplotlib.figure import Figure as NewFigure

    blank = NewFigure(figsize=(7.2, height), layout="constrained")
    axes = blank.subplot_mosaic([list(row) for row in layout])
    for axis in axes.values():
        axis.locator_params(nbins=6)
    return blank, axes


def svg(figure: Figure) -> str:
    """The figure as SVG text; the same figure gives the same text. Call within :func:`style`."""
    from matplotlib.backends.backend_svg import FigureCanvasSVG

    buffer = io.StringIO()
    canvas = FigureCanvasSVG(figure)
    _show_as_written(figure)
    _fit_labels(figure)
    if (layout := figure.get_layout_engine()) is not None:
        layout.execute(figure)  # once, and not for every format
        figure.set_layout_engine("none")
    # savefig would draw it twice
    canvas.print_svg(buffer, metadata={"Date": None, "Creator": None})  # type: ignore[no-untyped-call]
    return printable(buffer.getvalue().replace(_SHOWN, ""), but="\n")


def _show_as_written(figure: Figure) -> None:
    """Let every text stand as it was written: no formulae between dollars, and what is not printable as an escape.

    Numbers at an axis are none of a user's words: powers of ten are formulae there.
    """
    from matplotlib.axis import Axis as Scale
    from matplotlib.text import Text

    numbers = {text for axis in figure.findobj(Scale) for text in axis.findobj(Text)}
    numbers -= {axis.label for axis in figure.findobj(Scale)}
    for each in figure.findobj(Text):
        assert isinstance(each, Text)
        if each in numbers:
            continue
        each.set_parse_math(False)
        each.set_text(printable(each.get_text().removeprefix(_SHOWN).replace(r"\$", "$"), but="\n"))


def _fit_labels(figure: Figure) -> None:
    """Shorten labels that are longer than their panel: the middle is left out, since names differ at their ends."""

    def shortened(text: str, room: float) -> str:
        half = max(int(_IN_AN_INCH * room) // 2, 4)
        return text if len(text) <= 2 * half else f"{text[: half - 1]}…{text[1 - half :]}"

    for axis in figure.axes:
        share, (width, height) = axis.get_position(), figure.get_size_inches()
        for place in ("left", "center"):
            if text := axis.get_title(loc=place):
                axis.set_title(shortened(text, share.width * width), loc=place)
        axis.set_xlabel(shortened(axis.get_xlabel(), share.width * width))
        axis.set_ylabel(shortened(axis.get_ylabel(), share.height * height))


def thin(x: Array, y: Array) -> tuple[Array, Array]:
    """A long line reduced to the extremes of each stretch: what print can show, with no peak lost."""
    kept = _kept(x, y)
    return x[kept], y[kept]


def in_time(time: Array, y: Array) -> tuple[Array, Array]:
    """A decimated line over times, with gaps at missing rows and between files.

    Rows are missing at more than 1.5 usual steps. A file begins at a time that does not rise.
    """
    steps = np.diff(time)
    some = steps[:: max(len(steps) // (8 * _BLOCKS), 1)]
    rising = some[some > 0]
    usual = float(np.median(rising)) if len(rising) else 0.0
    return broken(time, y, (steps > _GAP * usual) | (steps <= 0))


def broken(x: Array, y: Array, far: NDArray[np.bool_]) -> tuple[Array, Array]:
    """A thinned line that breaks after the rows that are ``far`` from the next one."""
    kept = _kept(x, y)
    places = np.unique(np.searchsorted(kept, np.flatnonzero(far) + 1))
    return np.insert(x[kept].astype(float), places, np.nan), np.insert(y[kept].astype(float), places, np.nan)


def _kept(x: Array, y: Array) -> NDArray[np.intp]:
    """The rows of a line that print can show: all of a short one."""
    size = len(x) // _BLOCKS
    if size < 8:
        return np.arange(len(x))
    usable = len(x) // size * size
    start = np.arange(0, usable, size)
    extremes = [f(part[:usable].reshape(-1, size), 1) for part in (x, y) for f in (np.argmin, np.argmax)]
    return np.unique(np.concatenate([start, *(start + e for e in extremes), np.arange(usable, len(x))]))


def plain(text: str, longest: int = _LONGEST) -> str:
    """A user's text as a label: no formulae between dollars, no more than fits, never hidden by a leading underscore."""
    text = printable(text)
    text = text if len(text) <= longest else f"{text[: longest - 3]}..."
    text = text.replace("$", r"\$")
    return f"{_SHOWN}{text}" if text.startswith("_") else text


def line(axis: Axes, i: int, x: ArrayLike, y: ArrayLike, label: str, **options: Any) -> None:
    """The figure's line number ``i``: its color and dashes follow from the number."""
    style: dict[str, Any] = {
        "color": COLORS[i % len(COLORS)],
        "linestyle": DASHES[i % len(DASHES)],
        "label": plain(label),
    }
    axis.plot(drawable(x), drawable(y), **style, **options)


def drawable(numbers: ArrayLike) -> Array:
    """The numbers, with nan where they are beyond what an axis can have."""
    given = np.asarray(numbers, float)
    return np.where(abs(given) < _LARGEST, given, np.nan)


def logarithmic(axis: Axes, x: bool = True, y: bool = True) -> None:
    """Make the scales logarithmic, without the small ticks and with labels of plain text: laying these out would take
    most of a figure's time."""
    for wanted, scaled in ((x, axis.xaxis), (y, axis.yaxis)):
        if wanted:
            axis.set(**{f"{scaled.axis_name}scale": "log"})
            scaled.set_major_formatter(_power)
    axis.minorticks_off()


def _power(x: float, _: float = 0.0) -> str:
    """A tick's label, such as 10 to some power."""
    if not x > 0:
        return ""  # a power below all numbers
    exponent = round(np.log10(x))
    return "10" + str(exponent).translate(_RAISED) if np.isclose(x, 10.0**exponent, atol=0) else f"{x:g}"


def number(x: float) -> str:
    """A tick's label: plain digits, or a power of ten where these would be many."""
    if not x or 1e-3 <= abs(x) < 1e4:
        return f"{x:g}".replace("-", "\N{MINUS SIGN}")
    return ("\N{MINUS SIGN}" if x < 0 else "") + _power(abs(x))


def legend(figure: Figure, axis: Axes, names: Sequence[str] | None = None) -> None:
    """One legend for the whole figure, above the panels, from one panel's lines (those of ``names``)."""
    handles, labels = axis.get_legend_handles_labels()
    if names is not None:
        handles, labels = (
            [x for x, label in zip(kind, labels, strict=True) if label in set(map(plain, names))]
            for kind in (handles, labels)
        )
    room = 88  # characters beside each other at the legend's size, a line's sample counted as six
    fits = max(1, room // (6 + max(map(len, labels), default=0)))
    columns = len(labels) if sum(len(label) + 6 for label in labels) <= room else min(fits, (len(labels) + 1) // 2)
    figure.legend(handles, labels, loc="outside upper center", ncols=columns)


def key(axis: Axes, names: Sequence[str], beside: int) -> None:
    """A small legend within one panel: ``names`` of its own line, where it is named, and of the ``beside`` first ones."""
    lines = axis.get_lines()
    handles = [*([lines[beside]] if len(names) > beside else []), *lines[:beside]]
    axis.legend(
        handles, list(map(plain, names)), loc="best", fontsize=8, handlelength=2, borderaxespad=0.2, labelspacing=0.2
    )


def drawn(figure: Picture) -> FigureSvg | None:
    """A document's figure as SVG; None where there is nothing to draw."""
    with style():
        canvas = figure.draw()
        return None if canvas is None else FigureSvg(figure.name, svg(canvas), figure.caption)

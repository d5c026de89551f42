"""The figures of fits and predictions: what was measured, what a fit makes of it, and what is left."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array
from stribeck.constants import rotary_unit, rotary_words
from stribeck.identify.log import Log, Trace
from stribeck.identify.result_parts import FrictionRows
from stribeck.mouth import plots
from stribeck.mouth.quantities import Quantity, Scale, scale

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from stribeck.identify.result import LogFit

_DOTS = 2500  # points of a cloud: more make the page heavy and show nothing new
_SLOWEST = 0.01  # quantile of the speeds: the law's curve begins there, as nobody measured what is slower
_ROOM = 1.5  # times the largest measured friction
_PART = 0.1  # of a record, which is shown larger
_FEWEST = 20  # rows of it
_UNITS = {
    "position": "m", "velocity": "m/s", "force": "N", "friction": "N", "residual": "N", "load": "N", "pressure": "Pa",
}  # fmt: skip
_MEASURED, _FITTED = 2, 1  # numbers of the lines


def _scale(log: Log | None, name: str, *values: Array) -> Scale:
    """The scale of an axis, in the units and words of an axis that turns where the log's does."""
    unit, word = _UNITS[name], name
    if log is not None and log.rotary:
        unit, word = rotary_unit(unit), rotary_words(word)
    return scale([Quantity(word, unit, "", x) for x in values])


def data(log: Log) -> Figure:
    """The columns against time."""
    names = ["position", "velocity", "force", *(n for n in ("pressure", "load") if getattr(log, n) is not None)]
    figure, axes = plots.figure([[name] for name in names], 1.5 * len(names) + 0.4)
    time, label = _in_a_row(log.time)
    for name in names:
        shown = _scale(log, name, getattr(log, name))
        for rows in log.runs():
            x, y = plots.in_time(time[rows], getattr(log, name)[rows])
            axes[name].plot(x, shown.of(y), color=plots.COLORS[_MEASURED], linewidth=0.8)
        axes[name].set_ylabel(shown.label)
    axes[names[-1]].set_xlabel(label)
    return figure


def _in_a_row(time: Array) -> tuple[Array, str]:
    """Times that rise throughout, files following each other; and what to call them."""
    steps = np.diff(time)
    if np.all(steps >= 0):
        return time, "t (s)"
    return np.concatenate([[0.0], np.cumsum(np.maximum(steps, 0.0))]), "t, one file behind the other (s)"


def _some(count: int) -> NDArray[np.intp]:
    return np.linspace(0, count - 1, min(count, _DOTS)).astype(np.intp)


def curve(fit: LogFit, p: FrictionRows) -> Figure:
    """Friction against velocity: measured, fitted, and the law's steady force; below, what the fit leaves."""
    rows = _some(len(p.time))
    of_v, of_f = _scale(fit.log, "velocity", p.velocity), _scale(fit.log, "friction", p.measured)
    of_rest = _scale(fit.log, "residual", p.measured - p.fitted)
    speeds = of_v.of(p.velocity[rows])
    figure, axes = plots.figure([["curve"], ["curve"], ["residual"]], 5.4)
    axis = axes["curve"]
    axis.plot(speeds, of_f.of(p.measured[rows]), ".", color=plots.COLORS[6], markersize=2, label="measured")
    if fit.method == "static":
        axis.plot(speeds, of_f.of(p.fitted[rows]), ".", color=plots.COLORS[1], markersize=2, label="fitted")
    fastest = float(np.max(abs(p.velocity)))
    slowest = float(np.quantile(abs(p.velocity), _SLOWEST))
    half = np.geomspace(max(slowest, 1e-5 * fastest), fastest, 400)
    v = np.concatenate([-half[::-1], half])
    force = fit.law(guessing=True).steady_force(v)
    force = np.where(abs(force) < _ROOM * np.max(abs(p.measured)), force, np.nan)
    axis.plot(of_v.of(v), of_f.of(force), color=plots.COLORS[_MEASURED], label=f"{fit.law_name}, steady")
    left = of_rest.of(p.measured - p.fitted)
    axes["residual"].plot(speeds, left[rows], ".", color=plots.COLORS[_MEASURED], markersize=2)
    axes["residual"].set_ylabel(of_rest.label)
    axes["residual"].set_xlabel(of_v.label)
    axis.set_ylabel(of_f.label)
    plots.legend(figure, axis)
    return figure


def traces(shown: Sequence[Trace], words: tuple[str, str]) -> Figure:
    """Each column measured and computed, the part of it in which they differ most larger, and what is left.

    Args:
        words: what the two lines are called.
    """
    layout = [row for x in shown for row in ([x.column, f"{x.column} part"], [f"{x.column} left"] * 2)]
    figure, axes = plots.figure(layout, 1.9 * len(layout) + 0.4)
    for x in shown:
        time, label = _in_a_row(x.t)
        of_x = scale([Quantity(x.column, x.unit, "", values) for values in (x.measured, x.predicted)])
        of_left = scale([Quantity(f"residual of {x.column}", x.unit, "", x.measured - x.predicted)])
        for panel, rows in ((x.column, slice(None)), (f"{x.column} part", _worst(x))):
            for i, values, word in ((_MEASURED, x.measured, words[0]), (_FITTED, x.predicted, words[1])):
                plots.line(axes[panel], i, *plots.in_time(time[rows], of_x.of(values[rows])), word, linewidth=0.9)
            axes[panel].set_ylabel(of_x.label)
            axes[panel].set_xlabel(label)
        axis, left = axes[f"{x.column} left"], of_left.of(x.measured - x.predicted)
        axis.plot(*plots.in_time(time, left), color=plots.COLORS[_MEASURED], linewidth=0.7)
        axis.set_ylabel(of_left.label)
        axis.set_xlabel(label)
    plots.legend(figure, axes[shown[0].column])
    return figure


def _worst(x: Trace) -> slice:
    """The part of a record in which measured and computed differ most."""
    length = max(int(_PART * len(x.t)), min(len(x.t), _FEWEST))
    sums = np.concatenate([[0.0], np.cumsum((x.measured - x.predicted) ** 2)])
    first = int(np.argmax(sums[length:] - sums[:-length])) if length < len(x.t) else 0
    return slice(first, first + length)

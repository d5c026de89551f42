"""The figures of fits and predictions: what was measured, what a fit makes of it, and what is left."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array
from stribeck.constants import rotary_unit, rotary_words
from stribeck.identify.actuator.result import Trace
from stribeck.identify.log import Log
from stribeck.identify.result import LogFit, Prediction
from stribeck.mouth import plots
from stribeck.mouth.quantities import Quantity, Scale, scale

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Traces = Mapping[str, tuple[str, Array, Array]]  # by label: unit, measured, predicted

_DOTS = 2500  # points of a cloud: more make the page heavy and show nothing new
_SLOWEST = 0.01  # quantile of the speeds
_ROOM = 1.5  # times the largest measured friction
_CLOSE = 2  # reversals shown
_SHARE = 0.04  # of the record, that a close look is wide
_FEWEST = 40  # rows of it
_TURNS = 0.05  # of the largest speed
_EDGE = 1.2  # periods of the filter's cut-off: what its ends spoil
_BUSY = 0.15  # of a recording: the part shown larger
_WORST = 0.1  # of a record that is predicted
_UNITS = {
    "position": "m",
    "velocity": "m/s",
    "force": "N",
    "friction": "N",
    "residual": "N",
    "load": "N",
    "pressure": "Pa",
}
_MEASURED, _FITTED = 2, 1  # numbers of the lines


def _scale(log: Log | None, name: str, *values: Array, called: str = "") -> Scale:
    """The scale of an axis, in the units and words of an axis that turns where the log's does."""
    unit, word = _UNITS[name], called or name
    if log is not None and log.rotary:
        unit, word = rotary_unit(unit), rotary_words(word)
    return scale([Quantity(word, unit, "", x) for x in values])


# -- of a log --------------------------------------------------------------------------------------------------------


def data(log: Log) -> Figure:
    """The columns against time."""
    names = ["position", "velocity", "force", *(n for n in ("pressure", "load") if getattr(log, n) is not None)]
    made, axes = plots.figure([[name] for name in names], 1.5 * len(names) + 0.4)
    time, label = _in_a_row(log.time)
    for name in names:
        shown = _scale(log, name, getattr(log, name))
        for rows in log.runs():
            x, y = plots.in_time(time[rows], shown.of(getattr(log, name)[rows]))
            axes[name].plot(x, y, color=plots.COLOURS[_MEASURED], linewidth=0.8)
        axes[name].set_ylabel(shown.label)
    axes[names[-1]].set_xlabel(label)
    return made


def spectrum(log: Log, frequency: Array, power: Array, floor: float) -> Figure:
    """The spectrum of the measured motion that the cut-off is from."""
    made, axes = plots.figure([["spectrum"]], 2.6)
    axis = axes["spectrum"]
    axis.loglog(frequency, power, color=plots.COLOURS[_MEASURED], label="measured motion")
    axis.axhline(floor, color=plots.GREY, linestyle=plots.DASHES[2], label="noise floor")
    if log.bandwidth:
        axis.axvline(log.bandwidth, color=plots.COLOURS[1], linestyle=plots.DASHES[1], label="cut-off")
    axis.set_xlabel("frequency (Hz)")
    axis.set_ylabel("power spectral density (SI/Hz)")
    plots.legend(made, axis)
    return made


def _in_a_row(time: Array) -> tuple[Array, str]:
    """Times that rise throughout, files following each other; and what to call them."""
    steps = np.diff(time)
    if np.all(steps >= 0):
        return time, "t (s)"
    return np.concatenate([[0.0], np.cumsum(np.maximum(steps, 0.0))]), "t, one file behind the other (s)"


def _some(count: int) -> NDArray[np.intp]:
    return np.linspace(0, count - 1, min(count, _DOTS)).astype(np.intp)


def curve(fit: LogFit, p: Prediction) -> Figure:
    """Friction against velocity: measured, fitted, and the law's steady force."""
    rows = _some(len(p.time))
    of_v = _scale(fit.log, "velocity", p.velocity)
    of_f = _scale(fit.log, "friction", p.measured)
    speeds = of_v.of(p.velocity[rows])
    made, axes = plots.figure([["curve"]], 3.6)
    axis = axes["curve"]
    axis.plot(speeds, of_f.of(p.measured[rows]), ".", color=plots.COLOURS[6], markersize=2, label="measured")
    if fit.method == "static":
        axis.plot(speeds, of_f.of(p.fitted[rows]), ".", color=plots.COLOURS[1], markersize=2, label="fitted")
    fastest = float(np.max(abs(p.velocity)))
    # from the slowest speed that the data hold: what is below nobody measured
    slowest = float(np.quantile(abs(p.velocity), _SLOWEST))
    half = np.geomspace(max(slowest, 1e-5 * fastest), fastest, 400)
    v = np.concatenate([-half[::-1], half])
    force = fit.law(guessing=True).steady_force(v)
    force = np.where(abs(force) < _ROOM * np.max(abs(p.measured)), force, np.nan)
    axis.plot(of_v.of(v), of_f.of(force), color=plots.COLOURS[_MEASURED], label=f"{fit.law_name}, steady")
    axis.set_xlabel(of_v.label)
    axis.set_ylabel(of_f.label)
    plots.legend(made, axis)
    return made


def residuals(fit: LogFit, p: Prediction) -> Figure:
    """Measured less fitted friction, in time and against the velocity."""
    rest, speed = p.measured - p.fitted, p.velocity
    of_v, of_rest = _scale(fit.log, "velocity", speed), _scale(fit.log, "residual", rest)
    rest, speed, rows = of_rest.of(rest), of_v.of(speed), _some(len(rest))
    made, axes = plots.figure([["time"], ["velocity"]], 4.2)
    time, label = _in_a_row(p.time)
    axes["time"].plot(*plots.in_time(time, rest), color=plots.COLOURS[_MEASURED], linewidth=0.7)
    axes["time"].set_xlabel(label)
    axes["velocity"].plot(speed[rows], rest[rows], ".", color=plots.COLOURS[_MEASURED], markersize=2)
    axes["velocity"].set_xlabel(of_v.label)
    for axis in axes.values():
        axis.set_ylabel(of_rest.label)
    return made


def trace(fit: LogFit) -> tuple[str, Mapping[str, Array]] | None:
    """The name of what was fitted and its columns, or None."""
    if "output_trace" in fit.details:
        return str(fit.details["output"]), fit.details["output_trace"]
    p = fit.prediction
    if p is None:
        return None
    return "friction", {"time": p.time, "velocity": p.velocity, "measured": p.measured, "fitted": p.fitted}


def inner_rows(log: Log, time: Array) -> NDArray[np.bool_]:
    """Of the rows at these times, which a thinned record may hold, those away from the ends of runs, where a filter errs; all
    where the times of several files do not tell which row is meant."""
    kept = np.ones(len(time), bool)
    rising = bool(np.all(np.diff(log.time) > 0))
    if not log.bandwidth or not log.step or not (rising or len(time) == len(log)):
        return kept
    edge = round(_EDGE / (log.bandwidth * log.step))
    place = np.searchsorted(log.time, time - 0.5 * log.step) if rising else np.arange(len(log))
    for rows in log.runs():
        if rows.stop - rows.start > 4 * edge:
            near = (place < rows.start + edge) | (place >= rows.stop - edge)
            kept &= ~(near & (place >= rows.start) & (place < rows.stop))
    return kept


def traces(log: Log, name: str, columns: Mapping[str, Array]) -> Figure:
    """Measured and fitted against time, what is left, and close looks at reversals."""
    kept = inner_rows(log, columns["time"]) if name == "friction" else np.ones(len(columns["time"]), bool)
    time, velocity, measured, fitted = (columns[key][kept] for key in ("time", "velocity", "measured", "fitted"))
    time = _in_a_row(time)[0]
    looks = _reversals(velocity)
    layout = [["whole"] * max(len(looks), 1), ["rest"] * max(len(looks), 1)]
    layout += [[f"look {i}" for i in range(len(looks))]] if looks else []
    shown = _scale(log, name, measured, fitted)
    missed = _scale(log, name, measured - fitted, called="measured less fitted")
    made, axes = plots.figure(layout, 2.1 * len(layout) + 0.6)
    for panel, rows in (("whole", slice(None)), *((f"look {i}", rows) for i, rows in enumerate(looks))):
        for label, y, color, dashes in (("measured", measured, _MEASURED, "-"), ("fitted", fitted, _FITTED, "--")):
            x, value = plots.in_time(time[rows], shown.of(y[rows]))
            axes[panel].plot(x, value, dashes, color=plots.COLOURS[color], linewidth=1.0, label=label)
        axes[panel].set_ylabel(shown.label)
    x, value = plots.in_time(time, missed.of(measured - fitted))
    axes["rest"].plot(x, value, color=plots.COLOURS[_MEASURED], linewidth=0.6)
    axes["rest"].set_ylabel(missed.label)
    for axis in axes.values():
        axis.set_xlabel("t (s)")
        axis.locator_params(axis="x", nbins=4 if len(looks) > 1 else 8)
    plots.legend(made, axes["whole"])
    return made


def _reversals(v: Array) -> list[slice]:
    """Rows around a few reversals, evenly over the record."""
    fast = float(np.max(abs(v), initial=0.0))
    clear = np.flatnonzero(abs(v) > _TURNS * fast)
    if fast <= 0 or len(clear) < 2:
        return []
    turned = np.flatnonzero(np.diff(np.sign(v[clear])) != 0)
    if not len(turned):
        return []
    half = max(round(_SHARE * len(v) / 2), _FEWEST)
    places = clear[turned[np.unique(np.linspace(0, len(turned) - 1, _CLOSE + 2)[1:-1].round().astype(int))]]
    return [slice(max(int(i) - half // 2, 0), min(int(i) + half, len(v))) for i in places]


# -- of a recording of a machine ---------------------------------------------------------------------------------------


def recording(shown: Sequence[Trace]) -> Figure:
    """Each column measured and simulated, the part in which most happens larger, and what is left."""
    layout = [[x.column, f"{x.column} zoom"] for x in shown] + [[f"{x.column} left"] * 2 for x in shown]
    made, axes = plots.figure(layout, 1.9 * len(layout) + 0.4)
    for x in shown:
        of_x = scale([Quantity(x.column, x.unit, "", values) for values in (x.measured, x.predicted)])
        of_left = scale([Quantity("residual", x.unit, "", x.predicted - x.measured)])
        for name, part in ((x.column, slice(None)), (f"{x.column} zoom", _busiest(x.t, x.measured))):
            plots.line(axes[name], 0, *plots.thin(x.t[part], of_x.of(x.measured[part])), "measured")
            plots.line(axes[name], 1, *plots.thin(x.t[part], of_x.of(x.predicted[part])), "simulated")
            _label(axes[name], of_x)
        plots.line(axes[f"{x.column} left"], 0, *plots.thin(x.t, of_left.of(x.predicted - x.measured)), "left")
        _label(axes[f"{x.column} left"], of_left)
    plots.legend(made, axes[shown[0].column])
    return made


def _label(axis: Axes, shown: Scale) -> None:
    axis.set_xlabel("t (s)")
    axis.set_ylabel(shown.label)


def _busiest(t: Array, x: Array) -> slice:
    """The part of a record in which most happens."""
    width = max(int(_BUSY * len(t)), 2)
    busy = np.abs(np.diff(np.diff(x), prepend=0.0))
    smooth = np.convolve(busy, np.ones(width), "valid")
    at = int(np.argmax(smooth))
    return slice(at, at + width)


# -- of a prediction -----------------------------------------------------------------------------------------------------


def overlay(time: Array, shown: Traces, words: tuple[str, str], worst: bool = False) -> Figure:
    """Each trace measured and otherwise, and the difference.

    Args:
        time: s, rising or with files behind each other.
        words: what the two lines are called.
        worst: the part alone in which they differ most.
    """
    time = _in_a_row(time)[0]
    rows = _worst(time, shown) if worst else slice(None)
    layout = [[row] for label in shown for row in (label, f"{label} residual")]
    made, axes = plots.figure(layout, 1.7 * len(layout) + 0.4)
    for label, (unit, measured, other) in shown.items():
        missed = (measured - other)[rows]
        of_y = scale([Quantity(label, unit, "", x[rows]) for x in (measured, other)])
        of_missed = scale([Quantity("residual", unit, "", missed)])
        for i, x, word in ((_MEASURED, measured, words[0]), (_FITTED, other, words[1])):
            plots.line(axes[label], i, *plots.in_time(time[rows], of_y.of(x[rows])), word, linewidth=0.9)
        axes[label].set_ylabel(of_y.label)
        left = axes[f"{label} residual"]
        left.plot(*plots.in_time(time[rows], of_missed.of(missed)), color=plots.COLOURS[_MEASURED], linewidth=0.7)
        left.set_ylabel(of_missed.label)
    axes[layout[-1][0]].set_xlabel("t (s)")
    plots.legend(made, axes[next(iter(shown))])
    return made


def _worst(time: Array, shown: Traces) -> slice:
    _, measured, other = next(iter(shown.values()))
    length = max(int(_WORST * len(time)), min(len(time), 20))
    sums = np.concatenate([[0.0], np.cumsum((measured - other) ** 2)])
    first = int(np.argmax(sums[length:] - sums[:-length])) if length < len(time) else 0
    return slice(first, first + length)

"""Measured and fitted traces of a fit, whole and close at reversals."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array
from stribeck.identify.log import Log
from stribeck.identify.result import Fit
from stribeck.mouth import plots
from stribeck.mouth.document import FigureSvg
from stribeck.mouth.quantities import Quantity, scale

_CLOSE = 2  # reversals shown
_SHARE = 0.04  # of the record, that a close look is wide
_FEWEST = 40  # rows of it
_TURNS = 0.05  # of the largest speed
_EDGE = 1.2  # periods of the filter's cut-off: what its ends spoil
_UNITS = {"position": "m", "velocity": "m/s", "friction": "N"}


def trace(fit: Fit) -> tuple[str, Mapping[str, Array]] | None:
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


def figure(fit: Fit, log: Log) -> FigureSvg | None:
    """Measured and fitted against time, what is left, and close looks at reversals."""
    found = trace(fit)
    if found is None:
        return None
    name, columns = found
    kept = inner_rows(log, columns["time"]) if name == "friction" else np.ones(len(columns["time"]), bool)
    time, velocity, measured, fitted = (columns[key][kept] for key in ("time", "velocity", "measured", "fitted"))
    if np.any(np.diff(time) < 0):  # files one behind the other
        time = np.concatenate([[0.0], np.cumsum(np.maximum(np.diff(time), 0.0))])
    looks = _reversals(velocity)
    layout = [["whole"] * max(len(looks), 1), ["rest"] * max(len(looks), 1)]
    layout += [[f"look {i}" for i in range(len(looks))]] if looks else []
    shown = scale([Quantity(name, _UNITS[name], "", x) for x in (measured, fitted)])
    missed = scale([Quantity("measured less fitted", _UNITS[name], "", measured - fitted)])
    with plots.style():
        made, axes = plots.figure(layout, 2.1 * len(layout) + 0.6)
        for panel, rows in (("whole", slice(None)), *((f"look {i}", rows) for i, rows in enumerate(looks))):
            for label, y, colour, dashes in (("measured", measured, 2, "-"), ("fitted", fitted, 1, "--")):
                x, value = plots.in_time(time[rows], shown.of(y[rows]))
                axes[panel].plot(x, value, dashes, color=plots.COLOURS[colour], linewidth=1.0, label=label)
            axes[panel].set_ylabel(shown.label)
        axes["rest"].plot(*plots.in_time(time, missed.of(measured - fitted)), color=plots.COLOURS[2], linewidth=0.6)
        axes["rest"].set_ylabel(missed.label)
        for axis in axes.values():
            axis.set_xlabel("t (s)")
            axis.locator_params(axis="x", nbins=4 if len(looks) > 1 else 8)
        plots.legend(made, axes["whole"])
        text = f"The measured {name} and the fit's, what is left, and a close look at reversals."
        return plots.finish(made, "traces", text)


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

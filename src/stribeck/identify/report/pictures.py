"""The figures of a fit's report."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array
from stribeck.errors import InputError
from stribeck.identify.log import Log
from stribeck.identify.result import Fit
from stribeck.mouth import plots
from stribeck.mouth.document import FigureSvg
from stribeck.mouth.quantities import Quantity, scale

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_DOTS = 2500  # points of a cloud: more make the page heavy and show nothing new
_SLOWEST = 0.01  # quantile of the speeds
_ROOM = 1.5  # times the largest measured friction


def data(log: Log) -> list[FigureSvg]:
    """The columns against time, and the spectrum that the cut-off is from."""
    columns = {"position": "m", "velocity": "m/s", "force": "N"} | {
        n: u for n, u in (("pressure", "Pa"), ("load", "N")) if getattr(log, n) is not None
    }
    with plots.style():
        made, axes = plots.figure([[name] for name in columns], 1.5 * len(columns) + 0.4)
        time, label = _in_a_row(log.time)
        for name, unit in columns.items():
            shown = scale([Quantity(name, unit, "", getattr(log, name))])
            for rows in log.runs():
                x, y = plots.in_time(time[rows], shown.of(getattr(log, name)[rows]))
                axes[name].plot(x, y, color=plots.COLOURS[2], linewidth=0.8)
            axes[name].set_ylabel(shown.label)
        axes[next(reversed(columns))].set_xlabel(label)
        found = [plots.finish(made, "data", "The log as it was fitted.")]
    if log.spectrum is not None:
        found.append(_spectrum(log, *log.spectrum))
    return found


def _spectrum(log: Log, frequency: Array, power: Array, floor: float) -> FigureSvg:
    with plots.style():
        made, axes = plots.figure([["spectrum"]], 2.6)
        axis = axes["spectrum"]
        axis.loglog(frequency, power, color=plots.COLOURS[2], label="measured motion")
        axis.axhline(floor, color=plots.GREY, linestyle=plots.DASHES[2], label="noise floor")
        if log.bandwidth:
            axis.axvline(log.bandwidth, color=plots.COLOURS[1], linestyle=plots.DASHES[1], label="cut-off")
        axis.set_xlabel("frequency (Hz)")
        axis.set_ylabel("power spectral density (SI/Hz)")
        plots.legend(made, axis)
        return plots.finish(
            made, "spectrum", "Spectrum of the measured motion, its noise floor, and the filter's cut-off."
        )


def _in_a_row(time: Array) -> tuple[Array, str]:
    """Times that rise throughout, files following each other; and what to call them."""
    steps = np.diff(time)
    if np.all(steps >= 0):
        return time, "t (s)"
    return np.concatenate([[0.0], np.cumsum(np.maximum(steps, 0.0))]), "t, one file behind the other (s)"


def _some(count: int) -> NDArray[np.intp]:
    return np.linspace(0, count - 1, min(count, _DOTS)).astype(np.intp)


def curve(fit: Fit) -> FigureSvg:
    """Friction against velocity: measured, fitted, and the law's steady force."""
    with plots.style():
        return plots.finish(curve_figure(fit), "curve", "Measured friction and the fitted law at held speeds.")


def curve_figure(fit: Fit) -> Figure:
    """The same as a Matplotlib figure."""
    p = fit.prediction
    if p is None:
        raise InputError("fit: it holds no measured friction; there is nothing to plot")
    rows = _some(len(p.time))
    of_v = scale([Quantity("velocity", "m/s", "", p.velocity)])
    speeds = of_v.of(p.velocity[rows])
    with plots.style():
        made, axes = plots.figure([["curve"]], 3.6)
        axis = axes["curve"]
        axis.plot(speeds, p.measured[rows], ".", color=plots.COLOURS[6], markersize=2, label="measured")
        if fit.method == "static":
            axis.plot(speeds, p.fitted[rows], ".", color=plots.COLOURS[1], markersize=2, label="fitted")
        fastest = float(np.max(abs(p.velocity)))
        # from the slowest speed that the data hold: what is below nobody measured
        slowest = float(np.quantile(abs(p.velocity), _SLOWEST))
        half = np.geomspace(max(slowest, 1e-5 * fastest), fastest, 400)
        v = np.concatenate([-half[::-1], half])
        force = fit.law(guessing=True).steady_force(v)
        force = np.where(abs(force) < _ROOM * np.max(abs(p.measured)), force, np.nan)
        axis.plot(of_v.of(v), force, color=plots.COLOURS[2], label=f"{fit.law_name}, steady")
        axis.set_xlabel(of_v.label)
        axis.set_ylabel("friction (N)")
        plots.legend(made, axis)
        return made


def residuals(fit: Fit) -> FigureSvg:
    """Measured less fitted friction, in time and against the velocity."""
    p = fit.prediction
    assert p is not None
    rest, when, speed = p.measured - p.fitted, p.time, p.velocity
    of_v, of_rest = scale([Quantity("velocity", "m/s", "", speed)]), scale([Quantity("residual", "N", "", rest)])
    rest, speed, rows = of_rest.of(rest), of_v.of(speed), _some(len(rest))
    with plots.style():
        made, axes = plots.figure([["time"], ["velocity"]], 4.2)
        time, label = _in_a_row(when)
        axes["time"].plot(*plots.in_time(time, rest), color=plots.COLOURS[2], linewidth=0.7)
        axes["time"].set_xlabel(label)
        axes["velocity"].plot(speed[rows], rest[rows], ".", color=plots.COLOURS[2], markersize=2)
        axes["velocity"].set_xlabel(of_v.label)
        for axis in axes.values():
            axis.set_ylabel(of_rest.label)
        return plots.finish(
            made, "residuals", "Residuals of the force in time (above) and against the velocity (below)."
        )

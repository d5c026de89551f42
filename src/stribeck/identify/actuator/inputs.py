"""The recorded inputs of a machine.

Between samples they are linear, or constant as the output of a sampled controller.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import CubicSpline

from stribeck.arrays import Array
from stribeck.constants import show
from stribeck.errors import nearest
from stribeck.identify.actuator.recordings import Channel, Recording
from stribeck.recorded.units import si_unit
from stribeck.scenario import Scenario
from stribeck.scenario.changes import entry_at
from stribeck.waveforms.piecewise import PointsSignal
from stribeck.waveforms.trajectories import SplineSignal

_CHORDS = 3  # of a spline between two samples: their distance from it is then a ninth of a straight line's
STILL = {"kind": "points", "t": [0.0, 1.0], "value": [0.0, 0.0]}  # a signal whose place a recorded one takes
# The output column of an element's signal.
_COLUMN_OF = {"loads": "f", "controllers": "r", "motors": "V", "bodies": "v"}


@dataclass(frozen=True)
class RecordedInput:
    """A recorded signal of a machine.

    ``held``: constant between samples. ``spline``: a spline, because a controller with feedforward differentiates it.
    """

    t: Array
    x: Array
    held: bool = False
    spline: bool = False
    noise: float | None = None  # its standard deviation, if given

    def table(self) -> dict[str, object]:
        """The signal as a table of a machine's file."""
        t, x = self._points()
        return {"kind": "spline" if self.spline else "points", "t": t.tolist(), "value": x.tolist()}

    def signal(self) -> SplineSignal | PointsSignal:
        """The signal for a simulation."""
        return SplineSignal(*self._points()) if self.spline else PointsSignal(*self._points())

    def _points(self) -> tuple[Array, Array]:
        """Times and values; two equal times make a jump."""
        return (np.repeat(self.t, 2)[1:], np.repeat(self.x, 2)[:-1]) if self.held else (self.t, self.x)

    def smooth(self) -> RecordedInput:
        """The signal with a cubic spline between samples, approximated by chords.

        Returns the signal itself if it is held, already a spline, or too short.
        """
        gaps = np.diff(self.t)
        if self.held or self.spline or len(self.t) < 4 or not (gaps > 0).all():
            return self
        t = np.append((self.t[:-1, None] + gaps[:, None] * np.arange(_CHORDS) / _CHORDS).ravel(), self.t[-1])
        return replace(self, t=t, x=CubicSpline(self.t, self.x)(t))


def recorded_input(scenario: Scenario, path: str, end: float, channel: Channel) -> RecordedInput:
    """A recorded signal by its samples from time 0 to ``end``."""
    t, x = channel.bridged.t, channel.bridged.x
    rows = slice(max(int(np.searchsorted(t, 0.0, side="right")) - 1, 0), int(np.searchsorted(t, end)) + 1)
    table = entry_at(scenario.data, path.rpartition(".")[0])
    spline = channel.smooth or (isinstance(table, dict) and "feedforward" in table)
    return RecordedInput(t[rows], x[rows], channel.held, spline, channel.noise)


def number_at(scenario: Scenario, path: str) -> float | None:
    """The machine's number at a path, if there is one."""
    value = entry_at(scenario.data, path)
    return float(value) if isinstance(value, int | float) else None


def misread(scenario: Scenario, recording: Recording, log: int) -> list[str]:
    """Errors in the columns of a recording.

    These are columns or signals that the machine does not have, and units of another quantity without a gain to convert
    them.
    """
    units = {c.name: c.unit for c in scenario.system.columns}
    signals = [use.path for use in scenario.elements.signals]
    wrong = []
    measured = {f"outputs.{name}": (name, c.unit) for name, c in recording.outputs.items()}
    for name in recording.outputs:
        if name not in units:
            hint = nearest(name, units) or f" (it has {', '.join(units)})"
            wrong.append(f"log.{log}.outputs.{name}: no such column of the machine{hint}")
    for path, c in recording.inputs.items():
        if not (path.endswith("signal") and entry_at(scenario.data, path.rpartition(".")[0]) is not None):
            hint = nearest(path, signals) or f" (it has {', '.join(signals) or 'none'})"
            wrong.append(f"log.{log}.inputs.{path}: no signal of the machine{hint}")
        words = path.split(".")
        column = f"{words[1]}.{_COLUMN_OF.get(words[0], '')}" if len(words) == 3 else ""
        if "gain" not in (entry_at(scenario.data, ".".join(words[:2])) or {}):  # type: ignore[operator]
            measured[f"inputs.{path}"] = column, c.unit
    for place, (column, unit) in measured.items():
        wanted, given = units.get(column, ""), si_unit(unit)
        scaled = place.startswith("inputs.loads.") and given in ("A", "V", "Pa")  # by a gain that may be fitted
        if wanted and si_unit(wanted) == wanted and given not in ("", wanted) and not scaled:
            text = f"must be a unit of {wanted}, or stand with a gain that turns it into {wanted}"
            wrong.append(f"log.{log}.{place}.unit: {show(unit)}: {text}")
    return wrong

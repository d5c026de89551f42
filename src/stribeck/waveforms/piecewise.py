"""Signals as functions of time: piecewise linear ones, and the sine. All are continuous from the right."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from types import SimpleNamespace
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from stribeck.arrays import Array
from stribeck.constants import Constant, show
from stribeck.errors import InputError, nearest
from stribeck.expressions.ops import Value, pi, sin
from stribeck.recorded import opened_with
from stribeck.recorded.units import ANGLE, FORCE, LENGTH, PRESSURE, SPEED, TIME


@dataclass(frozen=True)
class OfSignal(Constant):
    """A constant in the unit of what the signal is, or in that unit per second (``rate``)."""

    rate: bool = False

    def in_unit(self, unit: str) -> Constant:
        """The declaration where the signal has this unit."""
        return replace(self, unit=f"{unit}/s" if self.rate else unit)


@dataclass(frozen=True)
class Segments:
    """A piecewise linear signal: value + slope (t - start) from each start to the next."""

    start: Array
    value: Array
    slope: Array

    def at(self, t: ArrayLike) -> Array:
        """The signal at the times t, from the right where it jumps."""
        i = np.clip(np.searchsorted(self.start, t, side="right") - 1, 0, None)
        p = Segment(self.start[i], self.value[i], self.slope[i])
        return np.asarray(Segment.equation(p, t))


@dataclass(frozen=True)
class Segment:
    """One piece of :class:`Segments`, or symbols for it."""

    start: Value
    value: Value
    slope: Value

    @staticmethod
    def equation(p: Segment | SimpleNamespace, t: Value) -> Value:
        """The signal within its current segment."""
        return p.value + p.slope * (t - p.start)


class Signal:
    """A signal as a function of time: one equation if ``smooth``, otherwise linear between breakpoints."""

    kind: ClassVar[str]
    constants: ClassVar[dict[str, Constant]] = {}
    smooth: ClassVar[bool] = False

    def __init__(self, values: dict[str, float] | None = None) -> None:
        self.values = values or {}

    @cached_property
    def segments(self) -> Segments:
        """The pieces of a signal that is not smooth."""
        raise NotImplementedError

    @staticmethod
    def equation(p: SimpleNamespace, t: Value) -> Value:
        """The signal at time t, for smooth signals."""
        raise NotImplementedError

    @property
    def longest_step(self) -> float:
        """The longest step that cannot miss a wave of the signal, s."""
        return math.inf

    @property
    def pieces(self) -> list[tuple[float, dict[str, float]]]:
        """Start (s) and constants of each piece of a smooth signal; one piece unless overridden."""
        return [(0.0, self.values)]

    def values_at(self, t: ArrayLike) -> dict[str, Value]:
        """The constants of a smooth signal's equation at the times t."""
        return self.values

    def at(self, t: ArrayLike) -> Array:
        """The signal at the times t (s), as an array of the same shape."""
        if not self.smooth:
            return self.segments.at(t)
        return np.asarray(self.equation(SimpleNamespace(**self.values_at(t)), np.asarray(t, float)))


class RampSignal(Signal):
    """rate * t."""

    kind = "ramp"
    constants: ClassVar[dict[str, Constant]] = {"rate": OfSignal("signal/s", "slope of the signal", rate=True)}

    @cached_property
    def segments(self) -> Segments:
        return Segments(np.zeros(1), np.zeros(1), np.array([self.values["rate"]]))


class StepSignal(Signal):
    """0 before ``time``, ``value`` from then on."""

    kind = "step"
    constants: ClassVar[dict[str, Constant]] = {
        "value": OfSignal("signal", "the signal from time on"),
        "time": Constant("s", "when the signal jumps"),
    }

    @cached_property
    def segments(self) -> Segments:
        return _polyline(np.array([self.values["time"]] * 2), np.array([0.0, self.values["value"]]))


class SquareSignal(Signal):
    """offset + amplitude for half a period, offset - amplitude for the other half, ``cycles`` times; then offset."""

    kind = "square"
    constants: ClassVar[dict[str, Constant]] = {
        "amplitude": OfSignal("signal", "amplitude"),
        "frequency": Constant("Hz", "frequency", above=0),
        "cycles": Constant("", "number of periods", above=0),
        "offset": OfSignal("signal", "mean", default=0.0),
    }

    @cached_property
    def segments(self) -> Segments:
        v, count = self.values, 2 * int(self.values["cycles"])
        side = np.where(np.arange(count) % 2 == 0, v["amplitude"], -v["amplitude"])
        value = v["offset"] + np.append(side, 0.0)
        return Segments(np.arange(count + 1) / (2 * v["frequency"]), value, np.zeros(count + 1))


class SineSignal(Signal):
    """offset + amplitude sin(2 pi frequency t + phase)."""

    kind, smooth = "sine", True
    constants: ClassVar[dict[str, Constant]] = {
        "amplitude": OfSignal("signal", "amplitude"),
        "frequency": Constant("Hz", "frequency", above=0),
        "offset": OfSignal("signal", "mean", default=0.0),
        "phase": Constant("rad", "phase at t = 0", default=0.0),
    }

    @staticmethod
    def equation(p: SimpleNamespace, t: Value) -> Value:
        """The signal at time t."""
        return p.offset + p.amplitude * sin(2 * pi * p.frequency * t + p.phase)

    @property
    def longest_step(self) -> float:
        return 0.125 / self.values["frequency"]


class PointsSignal(Signal):
    """Straight lines between points, constant outside; two equal times make a jump."""

    kind = "points"

    def __init__(self, t: Array, value: Array) -> None:
        super().__init__()
        self.t, self.value = t, value

    @staticmethod
    def problems(t: Array, value: Array) -> list[tuple[str, str]]:
        """Key and message of each mistake in the points."""
        if len(t) == 0:
            return [("t", "[]: must hold at least one time")]
        problems = []
        if len(t) != len(value):
            problems.append(("value", f"a list of {len(value)}: must be as long as t ({len(t)})"))
        for key, x in (("t", t), ("value", value)):
            bad = np.flatnonzero(~np.isfinite(x))
            if len(bad):
                problems.append((f"{key}[{bad[0]}]", f"{x[bad[0]]}: must be a finite number"))
        if not problems and (down := np.flatnonzero(np.diff(t) < 0)).size:
            i = int(down[0]) + 1
            problems.append((f"t[{i}]", f"{show(float(t[i]))}: times must not decrease (the one before is {t[i - 1]})"))
        return problems

    @cached_property
    def segments(self) -> Segments:
        return _polyline(self.t, self.value)


class StaircaseSignal(PointsSignal):
    """Each of ``levels`` is held for ``hold`` s. The way to the next one takes ``ramp`` s. The last one stays."""

    kind = "staircase"

    @classmethod
    def through(cls, levels: Array, hold: float, ramp: float) -> StaircaseSignal:
        """The points at the ends of each level."""
        start = (hold + ramp) * np.arange(len(levels))
        return cls(np.stack([start, start + hold], axis=1).ravel(), np.repeat(levels, 2))


class FileSignal(PointsSignal):
    """Two columns of a recorded table, read as points."""

    kind = "file"
    constants: ClassVar[dict[str, Constant]] = {
        "scale": Constant("", "factor of the values, after their unit", default=1.0)
    }

    @classmethod
    def read(
        cls,
        path: Path,
        time: str,
        value: str,
        unit: str | None = None,
        time_unit: str | None = None,
        scale: float = 1.0,
    ) -> FileSignal:
        """The signal in the columns ``time`` and ``value`` of a CSV, Parquet, MAT or NPZ file.

        Args:
            path: the file; the separator and decimal sign of CSV are detected.
            time: the name of the column of times; ``time_unit`` is its unit (the file's, or s, unless given).
            value: the name of the column of values; ``unit`` is their unit (the file's, or SI, unless given).
            scale: a factor of the values, applied after their unit.

        Raises:
            InputError: if the file or a column is missing, contains a value that is not finite, has decreasing times, or
                a unit is unknown.
        """
        known = {"unit": LENGTH | ANGLE | SPEED | FORCE | PRESSURE, "time_unit": TIME}
        given = {"unit": unit, "time_unit": time_unit}
        if wrong := [name for name, text in given.items() if text is not None and text not in known[name]]:
            raise InputError(
                [
                    f"{name}: {show(given[name])}: no such unit{_nearest_unit(given[name], known[name])}"
                    for name in wrong
                ]
            )
        names = {"time": time, "value": value}
        source = opened_with(path, names)
        columns = source.columns(names)
        unit = unit or source.unit(value, known["unit"])
        time_unit = time_unit or source.unit(time, TIME)
        if empty := [(key, count) for key, x in columns.items() if (count := int(np.isnan(x).sum()))]:
            text = f"this column of {path} has {{}} empty or nan cells"
            raise InputError([f"{key}: {names[key]!r}: {text.format(count)}" for key, count in empty])
        columns["time"] *= TIME[time_unit] if time_unit else 1.0
        columns["value"] *= scale * (known["unit"][unit] if unit else 1.0)
        t = columns["time"]
        if problems := cls.problems(t, columns["value"]) or _constant_time(t):

            def place(where: str) -> str:
                key, _, row = where.partition("[")
                name = names["time" if key == "t" else key]
                return f"column {name!r}, row {row[:-1]}" if row else f"column {name!r}"

            raise InputError([f"path: {path}: {place(where)}: {text}" for where, text in problems])
        return cls(columns["time"], columns["value"])


def _constant_time(t: Array) -> list[tuple[str, str]]:
    """The mistake of a recording with one time in all rows; two rows are a step."""
    return [("t", f"{show(float(t[0]))} s in every row: must rise")] if len(t) > 2 and t[0] == t[-1] else []


def _nearest_unit(unit: str | None, known: Mapping[str, float]) -> str:
    return nearest(str(unit), known) or f" (known: {', '.join([u for u in known if len(u) < 5][:12])}, ...)"


def _polyline(t: Array, value: Array) -> Segments:
    """Pieces of a polyline that is constant outside its points."""
    length = np.diff(t)
    inner = np.flatnonzero(length > 0)
    start = np.concatenate([[min(0.0, t[0])], t[:-1][inner], t[-1:]])
    levels = np.concatenate([value[:1], value[:-1][inner], value[-1:]])
    with np.errstate(over="ignore"):  # a motion that comes there is no longer finite
        slope = np.concatenate([[0.0], np.diff(value)[inner] / length[inner], [0.0]])
    return Segments(start, levels, slope)

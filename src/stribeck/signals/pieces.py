"""Signals as tables of pieces, which the compiled solver walks through: one row of numbers from each breakpoint to the next.

A piece of a straight signal holds start, value and slope; one of a curve its polynomial. A sine has a single equation,
whose constants are those of the run.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array
from stribeck.expressions.emit import python_function
from stribeck.expressions.graph import Expr, derivative, symbol, wrap
from stribeck.expressions.ops import Value
from stribeck.signals.piecewise import Segment, Signal
from stribeck.signals.sums import SumSignal
from stribeck.signals.trajectories import Curve

# Why a trajectory restarts at a breakpoint with a step of unknown length: what it follows jumps, or its slope does. The
# same numbers stand in runtime/method.c.
SMOOTH, JUMP, CORNER = 0, 1, 2
STRAIGHT = ("start", "value", "slope")
DIRECTION = "direction"  # the sign of the signal's rate within the piece, for signals cut where it changes
_ROUNDING = 1e-12
_IN_PIECES = (Curve, SumSignal)  # whose every number belongs to a piece


@dataclass(frozen=True)
class Reference:
    """A signal at one time: its value, its first two derivatives, and the sign of the first within the present piece."""

    value: Value
    rate: Value
    second: Value
    direction: Value = 0.0


@dataclass(frozen=True)
class Pieces:
    """From each start on a row of numbers holds; ``restart`` says how the signal goes on there."""

    start: Array
    rows: Array
    restart: NDArray[np.int8]

    def at(self, t: Array) -> Array:
        """The rows in force at the times t, one for each; a time that misses a start by rounding counts as that start."""
        i = np.searchsorted(self.start, t + _ROUNDING * np.abs(t), side="right") - 1
        return np.asarray(self.rows[np.clip(i, 0, None)])

    def jumps(self) -> Array:
        """Where the signal jumps."""
        return np.asarray(self.start[self.restart == JUMP])


def equation_of(kind: type[Signal] | None) -> type[Signal] | type[Segment]:
    """What holds the equation of a kind of signal; None stands for straight pieces."""
    return Segment if kind is None else kind


def fields(kind: type[Signal] | None, turns: bool = False) -> tuple[str, ...]:
    """The numbers of a piece; with ``turns`` the pieces are cut where the signal turns."""
    own = STRAIGHT if kind is None else tuple(kind.constants) if issubclass(kind, _IN_PIECES) else ()
    return (*own, DIRECTION) if turns else own


def constants(kind: type[Signal] | None) -> tuple[str, ...]:
    """The constants of a run that the signal's equation takes."""
    return () if kind is None or issubclass(kind, _IN_PIECES) else tuple(kind.constants)


def reference(kind: type[Signal] | None, p: SimpleNamespace, t: Expr, direction: Value = 0.0) -> Reference:
    """The signal and its derivatives as expressions of its numbers ``p`` and the time."""
    value = wrap(equation_of(kind).equation(p, t))
    rate = derivative(value, t)
    return Reference(value, rate, derivative(rate, t), direction)


def pieces(signal: Signal, turns: bool = False, t_end: float = np.inf) -> Pieces:
    """The pieces of a signal from t = 0 on."""
    if not signal.smooth:
        found = _straight(signal)
    elif isinstance(signal, _IN_PIECES):
        names = tuple(signal.constants)
        rows = [(start, [values[n] for n in names]) for start, values in signal.pieces]
        start = np.array([start for start, _ in rows])
        jumps = signal.jumps if isinstance(signal, SumSignal) else [False] * (len(start) - 1)
        restart = np.where([isinstance(signal, SumSignal), *jumps], JUMP, CORNER).astype(np.int8)
        found = Pieces(start, np.array([row for _, row in rows]), restart)
    else:
        found = Pieces(np.zeros(1), np.zeros((1, 0)), np.array([JUMP], np.int8))
    return _cut_at_turns(signal, found, t_end) if turns else found


def _straight(signal: Signal) -> Pieces:
    s = signal.segments
    first = max(int(np.searchsorted(s.start, 0.0, side="right")) - 1, 0)
    start, value, slope = s.start[first:], s.value[first:], s.slope[first:]
    before = value[:-1] + slope[:-1] * np.diff(start)
    size = np.maximum(np.abs(before), np.abs(value[1:]))
    jump = np.abs(value[1:] - before) > _ROUNDING * size
    restart = np.where(jump, JUMP, np.where(slope[:-1] != slope[1:], CORNER, SMOOTH))
    return Pieces(start, np.stack([start, value, slope], axis=1), np.concatenate([[JUMP], restart]).astype(np.int8))


def _cut_at_turns(signal: Signal, whole: Pieces, t_end: float) -> Pieces:
    """The same pieces cut where the signal's rate changes its sign, each with that sign as a further number."""
    turns = _turns(signal, whole, t_end)
    start = np.union1d(whole.start, turns)
    at = np.searchsorted(whole.start, start, side="right") - 1
    ends = np.append(start[1:], start[-1] + 1.0)
    middle = 0.5 * (np.maximum(start, 0.0) + ends)
    rate = _rates(signal, whole.rows[at], middle)
    direction = np.sign(rate)
    own = np.where(np.isin(start, whole.start), whole.restart[at], SMOOTH)
    changes = np.append(True, direction[1:] != direction[:-1])
    restart = np.where(changes, JUMP, own).astype(np.int8)
    return Pieces(start, np.column_stack([whole.rows[at], direction]), restart)


def _rates(signal: Signal, rows: Array, t: Array) -> Array:
    """The signal's rate at the times t within the pieces ``rows``, a row for each time."""
    kind = type(signal) if signal.smooth else None
    numbers = dict(zip(fields(kind), rows.T, strict=True)) | {n: signal.values[n] for n in constants(kind)}
    rate = reference(kind, SimpleNamespace(**{n: symbol(n) for n in numbers}), symbol("t")).rate
    (found,) = python_function([*numbers, "t"], [rate])(*numbers.values(), t)
    return np.broadcast_to(found, t.shape)


def _turns(signal: Signal, whole: Pieces, t_end: float) -> Array:
    """The times within the run at which the rate of a smooth signal passes through 0."""
    if isinstance(signal, SumSignal):
        return signal.turns(t_end)
    if isinstance(signal, Curve):
        found = []
        for begin, end, row in zip(whole.start, [*whole.start[1:], t_end], whole.rows, strict=True):
            slope = np.polynomial.Polynomial(row[1:]).deriv()
            if not row[2:].any() or end <= begin:
                continue
            roots = slope.roots()
            real = np.real(roots[np.abs(np.imag(roots)) < 1e-9 * (1 + np.abs(roots))]) + row[0]
            size = max(abs(slope(x)) for x in np.linspace(0, end - begin, 9)) if np.isfinite(end) else 1.0
            # the ends are breakpoints already; where the signal rests there, roots gather that rounding has moved
            low, high = (1e-3 if abs(slope(x)) < 1e-9 * size else 1e-9 for x in (0.0, end - begin))
            length = end - begin
            found += [float(t) for t in real if begin + low * length < t < end - high * length]
        return np.array(found)
    if signal.smooth:
        p = signal.values
        first = (0.5 - p["phase"] / np.pi) / (2 * p["frequency"])
        half = 0.5 / p["frequency"]
        return np.arange(first % half, t_end + half, half)  # to beyond the end: the last piece is judged by its middle
    return np.zeros(0)


def merged(parts: Sequence[Pieces]) -> Pieces:
    """Several signals as one table: a row holds the numbers of all of them, one signal after the other."""
    if len(parts) == 1:
        return parts[0]
    start = np.unique(np.concatenate([np.zeros(1), *(p.start for p in parts)]))
    start = start[max(int(np.searchsorted(start, 0.0, side="right")) - 1, 0) :]
    rows, restart = [], np.zeros(len(start), np.int8)
    for part in parts:
        at = np.clip(np.searchsorted(part.start, start, side="right") - 1, 0, None)
        rows.append(part.rows[at])
        own = np.where(np.isin(start, part.start), part.restart[at], SMOOTH)
        restart = np.where((own == JUMP) | (restart == SMOOTH), own, restart).astype(np.int8)
    return Pieces(start, np.concatenate(rows, axis=1) if rows else np.zeros((len(start), 0)), restart)


def at_times(signal: Signal, table: Pieces, names: Sequence[str], t: Array) -> SimpleNamespace:
    """The numbers of a signal's piece, and its constants, at the times t."""
    rows = table.at(t)
    return SimpleNamespace(**signal.values, **{name: rows[:, i] for i, name in enumerate(names)})

"""Signals as tables of pieces for the compiled solver: one row of numbers from each breakpoint to the next.

A piece of a piecewise linear signal has start, value and slope; a piece of a curve has its polynomial. A sine is a single
equation with constants of the run.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from types import SimpleNamespace

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array, distinct
from stribeck.expressions.emit import python_function
from stribeck.expressions.graph import Expr, derivative, symbol, wrap
from stribeck.expressions.ops import Value
from stribeck.waveforms.piecewise import Segment, Signal
from stribeck.waveforms.sums import SumSignal
from stribeck.waveforms.trajectories import Curve

# How the signal continues at a breakpoint: smoothly, or with a jump of its value or slope. After a jump the integration
# restarts with a step of unknown length. runtime/method.c has the same numbers.
SMOOTH, JUMP, CORNER = 0, 1, 2
STRAIGHT = ("start", "value", "slope")
DIRECTION = "direction"  # the sign of the signal's rate within the piece, for signals cut where it changes
_ROUNDING = 1e-12  # relative: well above the rounding of times and values
_IN_PIECES = (Curve, SumSignal)  # all numbers of these belong to a piece


@dataclass(frozen=True)
class Reference:
    """A signal at one time: value, first two derivatives, and the sign of the first within the piece."""

    value: Value
    rate: Value
    second: Value
    direction: Value = 0.0


@dataclass(frozen=True)
class Pieces:
    """A table of pieces: from each ``start`` on, a row of numbers is valid; ``restart``: SMOOTH, JUMP or CORNER there."""

    start: Array
    rows: Array
    restart: NDArray[np.int8]

    def at(self, t: Array) -> Array:
        """The row that is valid at each of the times t; a time that misses a start by rounding counts as that start."""
        i = np.searchsorted(self.start, t + _ROUNDING * np.abs(t), side="right") - 1
        return np.asarray(self.rows[np.clip(i, 0, None)])

    def jumps(self) -> Array:
        """The times at which the signal jumps."""
        return np.asarray(self.start[self.restart == JUMP])


def fields(kind: type[Signal] | None, turns: bool = False) -> tuple[str, ...]:
    """Names of the numbers of a piece; with ``turns`` the pieces are cut where the signal reverses."""
    names = STRAIGHT if kind is None else tuple(kind.constants) if issubclass(kind, _IN_PIECES) else ()
    return (*names, DIRECTION) if turns else names


def constants(kind: type[Signal] | None) -> tuple[str, ...]:
    """Names of the constants of the signal's equation that are the same in all pieces."""
    return () if kind is None or issubclass(kind, _IN_PIECES) else tuple(kind.constants)


def reference(kind: type[Signal] | None, p: SimpleNamespace, t: Expr, direction: Value = 0.0) -> Reference:
    """The signal and its derivatives as expressions of its numbers ``p`` and the time."""
    value = wrap((Segment if kind is None else kind).equation(p, t))  # None: piecewise linear
    rate = derivative(value, t)
    return Reference(value, rate, derivative(rate, t), direction)


def pieces(signal: Signal, turns: bool = False, t_end: float = np.inf) -> Pieces:
    """The pieces of a signal from t = 0 on; with ``turns`` cut where it reverses before ``t_end``."""
    if not signal.smooth:
        table = _straight(signal)
    elif isinstance(signal, Curve):
        rows = signal.table()
        table = Pieces(rows[:, 0], rows, np.full(len(rows), CORNER, np.int8))
    elif isinstance(signal, SumSignal):
        rows = np.array([[values[n] for n in signal.constants] for _, values in signal.pieces])
        restart = np.where([True, *signal.jumps], JUMP, CORNER).astype(np.int8)
        table = Pieces(np.array([start for start, _ in signal.pieces]), rows, restart)
    else:
        table = Pieces(np.zeros(1), np.zeros((1, 0)), np.array([JUMP], np.int8))
    return _cut_at_turns(signal, table, t_end) if turns else table


def _straight(signal: Signal) -> Pieces:
    s = signal.segments
    first = max(int(np.searchsorted(s.start, 0.0, side="right")) - 1, 0)
    start, value, slope = s.start[first:], s.value[first:], s.slope[first:]
    before = value[:-1] + slope[:-1] * np.diff(start)
    size = np.maximum(np.abs(before), np.abs(value[1:]))
    jump = np.abs(value[1:] - before) > _ROUNDING * size
    restart = np.where(jump, JUMP, np.where(slope[:-1] != slope[1:], CORNER, SMOOTH))
    return Pieces(start, np.stack([start, value, slope], axis=1), np.concatenate([[JUMP], restart]).astype(np.int8))


def _cut_at_turns(signal: Signal, table: Pieces, t_end: float) -> Pieces:
    """The same pieces cut where the signal's rate changes its sign, each with that sign as a further number."""
    turns = _turns(signal, table, t_end)
    start = np.union1d(table.start, turns)
    row = np.searchsorted(table.start, start, side="right") - 1
    ends = np.append(start[1:], start[-1] + 1.0)
    middle = 0.5 * (np.maximum(start, 0.0) + ends)
    rate = _rates(signal, table.rows[row], middle)
    direction = np.sign(rate)
    restart_of_piece = np.where(np.isin(start, table.start), table.restart[row], SMOOTH)
    changes = np.append(True, direction[1:] != direction[:-1])
    restart = np.where(changes, JUMP, restart_of_piece).astype(np.int8)
    return Pieces(start, np.column_stack([table.rows[row], direction]), restart)


def _rates(signal: Signal, rows: Array, t: Array) -> Array:
    """The signal's rate at the times t within the pieces ``rows``, a row for each time."""
    kind = type(signal) if signal.smooth else None
    numbers = [*rows.T, *(signal.values[n] for n in constants(kind))]
    (rates,) = _rate(kind)(*numbers, t)  # type: ignore[arg-type]  # a class can be hashed, though its objects cannot
    return np.broadcast_to(rates, t.shape)


@cache
def _rate(kind: type[Signal] | None) -> Callable[..., tuple[Value, ...]]:
    """The rate of a kind of signal, as a function of the numbers of a piece, the constants and t."""
    names = [*fields(kind), *constants(kind)]
    rate = reference(kind, SimpleNamespace(**{n: symbol(n) for n in names}), symbol("t")).rate
    return python_function([*names, "t"], [rate])


def _turns(signal: Signal, table: Pieces, t_end: float) -> Array:
    """The times before ``t_end`` at which the rate of a smooth signal passes through 0."""
    if isinstance(signal, SumSignal):
        return signal.turns(t_end)
    if isinstance(signal, Curve):
        times = []
        for begin, end, row in zip(table.start, [*table.start[1:], t_end], table.rows, strict=True):
            slope = np.polynomial.Polynomial(row[1:]).deriv()
            roots = slope.roots()
            real = np.real(roots[np.abs(np.imag(roots)) < 1e-9 * (1 + np.abs(roots))]) + row[0]
            size = max(abs(slope(x)) for x in np.linspace(0, end - begin, 9)) if np.isfinite(end) else 1.0
            # the ends are breakpoints already; if the signal rests there, rounding moves its multiple roots inside
            low, high = (1e-3 if abs(slope(x)) < 1e-9 * size else 1e-9 for x in (0.0, end - begin))
            length = end - begin
            times += [float(t) for t in real if begin + low * length < t < end - high * length]
        return np.array(times)
    if signal.smooth:
        p = signal.values
        first = (0.5 - p["phase"] / np.pi) / (2 * p["frequency"])
        half = 0.5 / p["frequency"]
        # beyond the end, since the sign of the last piece is taken at its middle
        return np.arange(first % half, t_end + half, half)
    return np.zeros(0)


def merged(parts: Sequence[Pieces]) -> Pieces:
    """Several signals as one table: a row contains the numbers of all of them, one signal after the other."""
    if len(parts) == 1:
        return parts[0]
    start = distinct(np.concatenate([np.zeros(1), *(p.start for p in parts)]))
    start = start[max(int(np.searchsorted(start, 0.0, side="right")) - 1, 0) :]
    rows, restart = [], np.zeros(len(start), np.int8)
    for part in parts:
        row = np.clip(np.searchsorted(part.start, start, side="right") - 1, 0, None)
        rows.append(part.rows[row])
        restart_of_part = np.where(np.isin(start, part.start), part.restart[row], SMOOTH)
        restart = np.where((restart_of_part == JUMP) | (restart == SMOOTH), restart_of_part, restart).astype(np.int8)
    return Pieces(start, np.concatenate(rows, axis=1) if rows else np.zeros((len(start), 0)), restart)

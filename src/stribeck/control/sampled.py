"""A controller that measures at instants, computes, and holds the valve voltage: what runs on the target."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Generator, Mapping
from dataclasses import dataclass, field
from math import exp, expm1, floor

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stribeck.arrays import Array
from stribeck.control.cascade import MEASURED, PressureCascade
from stribeck.control.observer import START
from stribeck.drives.base import Course
from stribeck.expressions.emit import python_function
from stribeck.expressions.graph import ONE, Expr, derivative, symbol
from stribeck.expressions.ops import Value
from stribeck.signals import Signal
from stribeck.system import System

Interval = tuple[float, dict[tuple[str, str], float]]  # until when, and the constants that change at its begin
_COMPUTED = ("u", "F_hat", "p_d", "z_hat")


@dataclass(frozen=True)
class Sampling:
    """A controller that computes every ``time`` s from measurements and acts ``delay`` s later."""

    time: float
    delay: float
    noise: float  # m, standard deviation of the measured position
    quantisation: float  # m
    bandwidth: float | None  # rad/s, of the filter that estimates velocity and acceleration; None: they are measured
    seed: int


@dataclass
class Held:
    """What the controller held from each of its samples on, and the valve from each change of its voltage on."""

    names: tuple[str, ...] = ()
    t: list[float] = field(default_factory=list)
    rows: list[tuple[float, ...]] = field(default_factory=list)
    voltage: list[tuple[float, float]] = field(default_factory=list)

    def held(self, t: Array) -> dict[str, Array]:
        """What was held at the times t, by name."""

        def last(
            times: ArrayLike,
        ) -> NDArray[np.intp]:  # a time that was computed as i * step may miss k * T by rounding
            return np.clip(np.searchsorted(times, t * (1 + 1e-12), side="right") - 1, 0, None)

        at, u = np.array(self.voltage).T
        rows = np.array(self.rows)[last(self.t)]
        return {**dict(zip(self.names, rows.T, strict=True)), "u": u[last(at)]}


class Filter:
    """Position, velocity and acceleration from a measured position: a critically damped g-h-k filter.

    Its poles all lie at exp(-bandwidth T): gains 1 - q^3, 1.5 (1 - q^2)(1 - q)/T and (1 - q)^3/T^2
    (Brookner, Tracking and Kalman Filtering Made Easy, 1998, section 1.3).
    """

    def __init__(self, bandwidth: float, period: float, y: float, v: float) -> None:
        q, self.period = exp(-bandwidth * period), period
        self.gains = 1 - q**3, 1.5 * (1 - q * q) * (1 - q) / period, (1 - q) ** 3 / period**2
        self.state = (y - period * v, v, 0.0)

    def update(self, measured: float) -> tuple[float, float, float]:
        """The estimates after another measurement."""
        (y, v, a), T = self.state, self.period
        y, v = y + T * v + T * T / 2 * a, v + T * a
        off = measured - y
        self.state = (y + self.gains[0] * off, v + self.gains[1] * off, a + self.gains[2] * off)
        return self.state


def phi_1(x: float) -> float:
    """(e^x - 1)/x."""
    return expm1(x) / x if x else 1.0


class SampledCascade:
    """The controller's equations at an instant, and its states from one sample to the next."""

    def __init__(
        self, cascade: PressureCascade, course: Course, values: Mapping[tuple[str, str], float], signal: Signal
    ) -> None:
        self.states = [state.name for state in cascade.remembered]
        found = cascade.controller(course, {symbol("t"): ONE})
        rates = [found[f"rate.{name}"] for name in self.states]
        slopes = [derivative(rate, symbol(name)) for rate, name in zip(rates, self.states, strict=True)]
        outputs: list[Expr] = [found[name] for name in _COMPUTED]
        fixed = [key for key in values if key[0] != "signal"]
        names = [f"{o}.{n}" for o, n in fixed] + [f"signal.{n}" for n in signal.constants]
        names += [*MEASURED, *self.states]
        self._function: Callable[..., tuple[Value, ...]] = python_function(names, [*outputs, *rates, *slopes])
        self._fixed = [values[key] for key in fixed]
        self.x = [START[name] for name in self.states]

    def sample(self, period: float, path: list[float], measured: tuple[float, ...]) -> tuple[float, ...]:
        """u, F_hat, p_d and z_hat now; the states then go one period on with what was measured held.

        x + T phi_1(J T) f is exact for what is linear in x, as eq. 15 is for the LuGre laws.
        """
        found = [float(value) for value in self._function(*self._fixed, *path, *measured, *self.x)]
        n, last = len(self.states), len(found)
        rates, slopes = found[last - 2 * n : last - n], found[last - n :]
        for i, (rate, slope) in enumerate(zip(rates, slopes, strict=True)):
            self.x[i] += period * rate * phi_1(slope * period)
        return tuple(found[:4])


def held_intervals(
    system: System, sampling: Sampling, values: Mapping[tuple[str, str], float], signal: Signal, end: float, log: Held
) -> Generator[Interval, Array, None]:  # fmt: skip
    """The stretches of a run in which the voltage is held; what is sent back is the plant's state at the end of each."""
    assert isinstance(system.drive, PressureCascade)
    controller = SampledCascade(system.drive, system.reference(symbol("t")), values, signal)
    random = np.random.default_rng(sampling.seed)
    acceleration = _acceleration(system, values)
    T, u = sampling.time, 0.0
    waiting: deque[tuple[float, float]] = deque()  # when a voltage takes effect, and which
    x = yield 0.0, {}
    tracker = Filter(sampling.bandwidth, T, x[0], x[1]) if sampling.bandwidth else None
    log.names = (*_COMPUTED[1:], *(name for name in controller.states if name != "z_hat"))
    log.voltage.append((0.0, u))
    for k in range(floor(end / T * (1 + 1e-12)) + 1):
        t, after = k * T, min((k + 1) * T, end)
        y, v, a = float(x[0]), float(x[1]), acceleration(x)
        if tracker is not None:
            measured = y + sampling.noise * random.standard_normal()
            if sampling.quantisation:
                measured = sampling.quantisation * round(measured / sampling.quantisation)
            y, v, a = tracker.update(measured)
        kept = [x for name, x in zip(controller.states, controller.x, strict=True) if name != "z_hat"]
        path = [float(value) for value in signal.values_at(t).values()]
        voltage, *rest = controller.sample(T, path, (t, y, v, float(x[2]), float(x[3]), a))
        log.t.append(t)
        log.rows.append((*rest, *kept))
        waiting.append((t + sampling.delay, voltage))
        while waiting and waiting[0][0] < after:
            at, new = waiting.popleft()
            if at > t:
                x = yield at, {("drive", "u"): u}
                t = at
            u = new
            log.voltage.append((t, u))
        if t < after:
            x = yield after, {("drive", "u"): u}


def _acceleration(system: System, values: Mapping[tuple[str, str], float]) -> Callable[[Array], float]:
    """The plant's acceleration at a state."""
    known = {f"{owner}.{name}": x for (owner, name), x in values.items() if owner in ("law", "plant")}
    function = python_function([*known, *(state.name for state in system.states)], [system.acceleration()])
    return lambda x: float(function(*known.values(), *x)[0])

"""The quantities of a closed loop that the verdict needs.

These are the time from which all signals are constant, and the slowest time constant.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from copy import deepcopy
from dataclasses import dataclass, field
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import ArrayLike

from stribeck.arrays import Array
from stribeck.errors import InputError
from stribeck.expressions.graph import Expr, derivative, symbol
from stribeck.machine.elements.controllers import Controller
from stribeck.machine.signal import SignalTable
from stribeck.machine.system import MachineSystem
from stribeck.scenario import Scenario
from stribeck.scenario.changes import entry_at
from stribeck.simulation.ensemble import Ensemble, simulate_ensemble
from stribeck.waveforms import Signal, SumSignal
from stribeck.waveforms.trajectories import Curve

MOST_STEPS = 600_000  # per lane, then the run ends: some 200 s of a controller at 1 kHz
_FAST = 1e3  # in natural speeds: every contact is in gross sliding
_POINTS = 48  # of the spline that draws a wave
_ZERO = 1e-9  # of the fastest eigenvalue: a smaller real part counts as 0


@dataclass(frozen=True)
class Loop:
    """A machine whose signals become constant, ready to be judged.

    Attributes:
        scenario: the machine; a signal that never becomes constant is held from the file's ``t_end`` on.
        slowest: the slowest time constant of the loop while all contacts slide, s.
        held: the tables of the signals that are held.
        given: the machine before any signal was held.
        travel: a lower bound of each body's travel, m or rad; the threshold of rest is a share of the travel.
    """

    scenario: Scenario
    slowest: float
    held: tuple[str, ...]
    given: Scenario
    travel: Mapping[str, float] = field(default_factory=dict)

    @cached_property
    def rest(self) -> float:
        """The time from which all signals are constant, s."""
        return max([0.0, *map(rests_at, self.scenario.elements.signals.values())])

    @cached_property
    def lean(self) -> Scenario:
        """The machine without its energies, each run of at most :data:`MOST_STEPS`."""
        data = deepcopy(self.scenario.data)
        data.get("output", {}).pop("energy", None)
        data["solve"]["max_steps"] = MOST_STEPS
        return Scenario(data, folder=self.scenario.folder, trust=True)


def loop_of(scenario: Scenario) -> Loop:
    """The loop of a machine with a controller, or of a single body (schema = 1) under a PID controller.

    Raises:
        InputError: there is no controller, or a servo's, whose loop is not judged.
    """
    if (kind := scenario.called.drive) not in ("", "pid"):
        raise InputError(f"drive.kind: {kind!r}: must be 'pid', a position controller, whose loop is judged")
    scenario = scenario.as_machine()
    if not scenario.system.controllers:
        raise InputError(f"{scenario.name}: controllers: none: a machine with a controller is needed")
    given = scenario
    scenario, held = with_rest(scenario)
    return Loop(scenario, time_constant(scenario), held, given)


def rests_at(signal: Signal) -> float:
    """The time from which a signal is constant, s; inf if it never becomes constant."""
    if isinstance(signal, Curve):
        return max(0.0, signal.pieces[-1][0])
    if isinstance(signal, SumSignal):
        return max(rests_at(part) for part in signal.parts)
    if signal.smooth:
        return 0.0 if not signal.values.get("amplitude") else math.inf
    s = signal.segments
    if s.slope[-1] != 0:
        return math.inf
    first = len(s.start) - 1
    while first and s.slope[first - 1] == 0 and s.value[first - 1] == s.value[first]:
        first -= 1
    return max(0.0, float(s.start[first]))


def with_rest(scenario: Scenario) -> tuple[Scenario, tuple[str, ...]]:
    """The scenario with every endless signal held from ``t_end`` on, and the names of these signals."""
    machine = scenario.elements
    endless = {use.path: signal for use, signal in machine.signals.items() if not rests_at(signal) < math.inf}
    if not endless:
        return scenario, ()
    data = deepcopy(scenario.data)
    for path, signal in endless.items():
        table = entry_at(data, path)
        assert isinstance(table, dict)
        table.clear()
        table.update(_held(signal, scenario.solve.t_end))
    return Scenario(data, folder=scenario.folder, trust=True), tuple(endless)


def _held(signal: Signal, t_end: float) -> dict[str, object]:
    """The signal up to ``t_end``, then constant."""
    if signal.smooth:
        fastest = 0.125 / signal.longest_step if isinstance(signal, SumSignal) else float(signal.values["frequency"])
        waves = max(1.0, fastest * t_end)
        t = np.linspace(0.0, t_end, math.ceil(waves * _POINTS) + 1)
        return {"kind": "spline", "t": t.tolist(), "value": signal.at(t).tolist()}
    s = signal.segments
    t = np.unique(np.concatenate([[0.0], s.start[(s.start > 0) & (s.start < t_end)], [t_end]]))
    return {"kind": "points", "t": t.tolist(), "value": signal.at(t).tolist()}


def time_constant(scenario: Scenario) -> float:
    """The slowest time constant while all contacts slide, s.

    It follows from the eigenvalues of the machine without limits, sampling and compensation. Its speeds are far above
    the Stribeck velocities, and its deflections are steady: the derivative of friction is its viscous part.
    """
    roots = np.linalg.eigvals(SlidingLoop(scenario).jacobian)
    falling = -roots.real[roots.real < -_ZERO * np.abs(roots).max(initial=0.0)]
    return 1 / float(falling.min()) if len(falling) else 1.0


class SlidingLoop:
    """A machine without limits, sampling and compensation while all contacts slide: its states and their Jacobian.

    With a ``shaken`` controller, also the derivative of the rates by its output.
    """

    def __init__(self, scenario: Scenario, shaken: str | None = None) -> None:
        data = deepcopy(scenario.data)
        data.get("output", {}).pop("energy", None)
        for name, each in data.get("controllers", {}).items():
            for key in ("sampling", "compensation", "limit", "dither"):
                each.pop(key, None)
            if name == shaken:
                each["dither"] = {"amplitude": 1.0, "frequency": 0.25}
        for motor in data.get("motors", {}).values():
            motor.pop("voltage", None)
        bare = Scenario(data, folder=scenario.folder, trust=True)
        pieces = bare.pieces
        system, x = bare.system, _sliding(bare)
        names = [state.name for state in system.states]
        segment = dict(zip(system.piece_fields, pieces.rows[-1], strict=True)) | dict.fromkeys(system.held, 0.0)
        values = {key: np.float64(x) for key, x in bare.elements.values.items()}  # which divide by 0 without an error
        rates, slopes = _rates_and_slopes(system)

        def evaluated(quantities: tuple[Expr, ...], t: float) -> Array:
            states = dict(zip(names, x, strict=True))
            return np.array(system.evaluated(quantities, values, segment, np.float64(t), states), float)

        t = 4.0 * math.ceil(float(pieces.start[-1]) / 4.0 + 1.0)
        keep = [i for i, name in enumerate(names) if name not in ("E_in", "E_dissipated")]
        self.states = [names[i] for i in keep]
        self.jacobian = evaluated(slopes, t).reshape(len(x), len(x))[np.ix_(keep, keep)]
        if not np.isfinite(self.jacobian).all():
            raise InputError("the machine's numbers are so large that its rates have no finite derivatives")
        self.by_output = np.zeros(len(keep))
        if shaken is not None:  # a quarter period later the dither is 1
            self.by_output = (evaluated(rates, t + 1.0) - evaluated(rates, t))[keep]

    def response(self, frequency: float) -> dict[str, float]:
        """The gain from the controller's output to each body's position at a frequency, Hz."""
        j_w = 2j * np.pi * frequency * np.eye(len(self.states))
        x = np.linalg.solve(j_w - self.jacobian, self.by_output)
        return {n.removesuffix(".y"): float(abs(v)) for n, v in zip(self.states, x, strict=True) if n.endswith(".y")}


@lru_cache(maxsize=64)
def _rates_and_slopes(system: MachineSystem) -> tuple[tuple[Expr, ...], tuple[Expr, ...]]:
    """The rates of a system's states, and their derivatives by the states, row by row."""
    states, rates = [symbol(state.name) for state in system.states], system.rates()
    return tuple(rates), tuple(derivative(rate, state) for rate in rates for state in states)


def _sliding(scenario: Scenario) -> Array:
    """A state in which every contact slides fast with its steady deflection, and every backlash is closed."""
    machine, system = scenario.elements, scenario.system
    gaps = [machine.values[link.path, "gap"] for link in system.links if link.gap is not None]
    state = dict.fromkeys((s.name for s in system.states), 0.0)
    for i, body in enumerate(system.bodies):
        share = 1 + 0.377 * i  # no two bodies have the same speed
        if f"{body.name}.v" in state:
            state[f"{body.name}.v"] = _FAST * share * machine.scales[body.name].speed
        if f"{body.name}.y" in state:
            state[f"{body.name}.y"] = 10 * share * max([0.0, *gaps])
    arrays = {name: np.array([x]) for name, x in state.items()}
    held = {name: np.zeros(1) for name in system.held}
    columns = scenario.columns(np.zeros(1), arrays, held)
    for contact in system.contacts:
        if contact.has_z:
            w = float(np.ravel(columns[f"{contact.name}.w"])[0])
            state[f"{contact.name}.z"] = float(machine.laws[contact.law_path].steady_deflection(w))
    return np.array([state[s.name] for s in system.states])


def replaced(scenario: Scenario, controller: str, signal: dict[str, object]) -> Scenario:
    """The machine with another signal for a controller."""
    data = deepcopy(scenario.data)
    table = data["controllers"][controller]
    table["signal"] = signal
    if not SignalTable.kinds[str(signal["kind"])].made_by.smooth:
        table.pop("feedforward", None)  # needs a second derivative, like lead
        if table.get("compensation"):
            table["compensation"].pop("lead", None)
    return Scenario(data, folder=scenario.folder, trust=True)


def controller_of(scenario: Scenario, name: str) -> Controller:
    """The controller of that name."""
    return next(c for c in scenario.system.controllers if c.name == name)


def resolution_of(scenario: Scenario, controller: Controller) -> float:
    """The resolution of a controller's encoder, 0 without an encoder."""
    return float(scenario.elements.values.get((f"{controller.path}.sampling", "resolution"), 0.0))


def simulate_lanes(
    scenario: Scenario, values: Mapping[str, ArrayLike] | None, end: float, step: float, count: int = 1
) -> Ensemble:
    """Simulate lanes, however their errors grow. Without ``values``, which a batch needs, a number is given its own value."""
    if not values:
        machine = scenario.elements
        path, key = next((path, key) for path, key in scenario.places.items() if key in machine.values)
        values = {path: np.full(count, machine.values[key])}
    return simulate_ensemble(scenario, values, t_end=end, step=step, growth=False)

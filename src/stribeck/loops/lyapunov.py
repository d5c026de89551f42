"""V and dV/dt along a simulation: where V rises, and where dV/dt exceeds what the proof allows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array
from stribeck.errors import StribeckError, needed
from stribeck.expressions.graph import ONE, symbol, total_derivative
from stribeck.laws.base import Law
from stribeck.loops.gains import at_speed, damping, decay
from stribeck.loops.proof import ERRORS, derive
from stribeck.machine.elements.controllers.pressure_cascade import PressureCascade
from stribeck.machine.pneumatic.cascade import energy
from stribeck.scenario import Scenario
from stribeck.simulation import Solution

_RISE = 1e-9  # of V(0): smaller rises are the solver's errors
_TOLERANCE = 1e-6  # of the largest |dV/dt|: the error of the states at the default rtol, as promised

Span = tuple[float, float]


@dataclass(frozen=True)
class Along:
    """V along a run.

    Attributes:
        t: times of the rows, s.
        V: the Lyapunov function, J.
        dV_dt: its derivative by the states' rates, W; None if the proof does not apply to the controller.
        bound: eq. 19 evaluated for the simulated errors, W; None as before.
        saturated: rows in which the valve saturates.
        noise: V of state errors as large as the solver's relative tolerance, J.
    """

    t: Array
    V: Array
    dV_dt: Array | None
    bound: Array | None
    saturated: NDArray[np.bool_]
    noise: float = 0.0

    @property
    def rises(self) -> NDArray[np.bool_]:
        """True in the rows after which V rises by more than 1e-9 V(0), and by more than the solver's noise."""
        return rises(self.V, self.noise)

    @property
    def excess(self) -> NDArray[np.bool_]:
        """True in the rows where dV/dt is above its bound."""
        if self.dV_dt is None or self.bound is None:
            return np.zeros(len(self.t), bool)
        return np.asarray(self.dV_dt > self.bound + _TOLERANCE * np.max(np.abs(self.dV_dt)), bool)

    @property
    def largest_rise(self) -> float:
        """The largest rise of V from row to row, J."""
        return float(max(np.max(np.diff(self.V), initial=0.0), 0.0))

    @property
    def spans(self) -> dict[str, list[Span]]:
        """Intervals in which V rises, dV/dt is above its bound, and the valve saturates, as (first, last) times."""
        marked = {"rise_times": self.rises, "excess_times": self.excess, "saturated_times": self.saturated}
        return {name: spans(self.t, rows) for name, rows in marked.items()}

    def summary(self) -> dict[str, object]:
        """The result as plain data, for JSON."""
        return {
            "V_0": float(self.V[0]), "V_end": float(self.V[-1]), "rises": int(self.rises.sum()),
            "largest_rise": self.largest_rise, **self.spans,
        }  # fmt: skip


def cascade_of(scenario: Scenario) -> PressureCascade | None:
    """The cascade of a file of schema 1; None under another drive."""
    controller = scenario.elements.controllers.get("")
    return controller if isinstance(controller, PressureCascade) else None


def gains_of(scenario: Scenario) -> dict[str, float]:
    """The gains of that cascade."""
    cascade = cascade_of(scenario)
    assert cascade is not None
    return cascade.gains


def rises(V: Array, noise: float = 0.0) -> NDArray[np.bool_]:
    """True in the rows after which V rises by more than 1e-9 V(0), and by more than ``noise`` in J."""
    return np.append(np.diff(V) > max(_RISE * V[0], noise), False)


def along(solution: Solution) -> Along:
    """V, dV/dt from the states, and the proof's bound, on the rows of a servo's solution.

    Raises:
        StribeckError: if the solution is no servo's, or has no rows.
    """
    scenario = solution.scenario
    system = scenario.system
    cascade = cascade_of(scenario)
    if cascade is None or not len(solution.t):
        raise StribeckError(f"{scenario.name}: V needs the solution of a servo, with rows")
    gains, observer = cascade.gains, cascade.observer_law
    saturated = np.abs(solution["u"]) >= gains["u_max"] * (1 - 1e-9)
    if cascade.sampling is not None or observer is None or not observer.has_z or cascade.adaptive:
        return Along(solution.t, solution["V"], None, None, saturated, _noise(solution))
    segment = dict(zip(system.piece_fields, scenario.pieces.at(solution.t).T, strict=True))
    states = {state.name: solution[state.name] for state in system.states}
    rates = dict(zip(map(symbol, states), system.rates(), strict=True))
    derivative = total_derivative(system.outputs["V"], {symbol("t"): ONE, **rates})
    (dV_dt,) = system.evaluated((derivative,), scenario.elements.values, segment, solution.t, states)
    with np.errstate(all="ignore"):
        bound = _bound(solution, observer, gains)
    return Along(solution.t, solution["V"], np.asarray(dV_dt), bound, saturated, _noise(solution))


def _noise(solution: Solution) -> float:
    scenario = solution.scenario
    v, p_1, p_2, z = (scenario.solve.rtol * float(np.max(np.abs(solution[n]))) for n in ("v", "p_1", "p_2", "z"))
    gains, mass = SimpleNamespace(**gains_of(scenario)), scenario.elements.values["bodies", "mass"]
    return float(energy(gains, mass, v, max(p_1, p_2), z))


def _bound(solution: Solution, observer: Law, gains: Mapping[str, float]) -> Array:
    """Eq. 19 with the errors and speeds of the rows, W."""
    with needed("the proof of a servo's gains"):
        import sympy

    w, sigma_1 = (at_speed(observer, expression)(solution["v"]) for expression in (decay(observer), damping(observer)))
    expr = derive().derivative
    names = sorted(map(str, expr.free_symbols - set(sympy.symbols((*ERRORS, "w"), real=True))))
    known = {**gains, **observer.p.numbers, "sigma_1": sigma_1}
    symbols = [*sympy.symbols((*ERRORS, "w"), real=True), *(sympy.Symbol(n, positive=True) for n in names)]
    function = sympy.lambdify(symbols, expr, "numpy")
    errors = (solution["s"], solution["p_err"], solution["z_hat"] - solution["z"])
    return np.asarray(function(*errors, w, *(known[n] for n in names)))


def spans(t: Array, marked: NDArray[np.bool_]) -> list[Span]:
    """Intervals of consecutive marked rows, as (first, last) times."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], marked.astype(int), [0]])))
    return [(float(t[a]), float(t[b - 1])) for a, b in edges.reshape(-1, 2)]

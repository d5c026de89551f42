"""Cylinder, law, controller and observer -> one system of equations, as :mod:`stribeck.system` does for a single body."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

from stribeck.arrays import Array
from stribeck.constants import Constant
from stribeck.control.cascade import Cascade, Path
from stribeck.control.observer import ETA, SCALES, Z_HAT, Adaptation, Observed, adapt, observe
from stribeck.drives.base import Column
from stribeck.equations import Equations
from stribeck.expressions.emit import python_function
from stribeck.expressions.graph import (
    ONE,
    Expr,
    constant,
    derivative,
    substitute,
    symbol,
    total_derivative,
    wrap,
)
from stribeck.expressions.names import Names
from stribeck.expressions.ops import Value, both, sqrt, where
from stribeck.laws.base import Law
from stribeck.laws.form import Form
from stribeck.laws.values import Constants
from stribeck.plants.cylinder import Cylinder
from stribeck.signals import Signal

_MOTION = (
    Column("y", "m", "position"),
    Column("v", "m/s", "velocity"),
    Column("p_1", "Pa", "pressure in chamber 1"),
    Column("p_2", "Pa", "pressure in chamber 2"),
)
_Z = Column("z", "m", "mean bristle deflection")
_AFTER_Z_HAT = (
    Column("e", "m", "position error y - y_d"),
    Column("s", "m/s", "de/dt + lambda e"),
    Column("p_err", "Pa", "error of the pressure difference"),
    Column("u", "V", "valve voltage"),
    Column("F", "N", "friction force"),
    Column("F_hat", "N", "friction force that the controller assumes"),
    Column("V", "J", "Lyapunov function"),
)
_ADAPTED = (
    Column("sigma_0_hat", "N/m", "adapted bristle stiffness"),
    Column("sigma_1_hat", "N s/m", "adapted bristle damping"),
    Column("sigma_2_hat", "N s/m", "adapted viscous friction"),
    Column("F_c_hat", "N", "adapted Coulomb friction force"),
)
MEASURED = ("t", "y", "v", "p_1", "p_2", "acceleration")  # what the controller measures


@dataclass(frozen=True)
class ServoSystem(Equations):
    """The structure of a pneumatic servo, without any values; a :class:`stribeck.system.System` to codegen and solvers.

    ``sampled``: the controller is not part of the differential equations; the valve voltage is the constant drive.u.
    """

    law: type[Law]
    form: Form
    observer: type[Law] | None
    observer_form: Form
    signal: type[Signal]
    droop: bool = False
    adaptive: bool = False
    sampled: bool = False

    @cached_property
    def controller_states(self) -> tuple[Column, ...]:
        """The states that the controller keeps."""
        if self.observer is None or not self.observer.has_z:
            return ()
        return (Z_HAT, ETA, *SCALES) if self.adaptive else (Z_HAT,)

    @cached_property
    def states(self) -> tuple[Column, ...]:
        """The states in the order in which they are integrated."""
        bristle = (_Z,) if self.law.has_z else ()
        return (*_MOTION, *bristle, *(() if self.sampled else self.controller_states))

    @cached_property
    def columns(self) -> tuple[Column, ...]:
        """The columns of the output after t."""
        return (*_MOTION, _Z, Z_HAT, *_AFTER_Z_HAT, *(_ADAPTED if self.adaptive else ()))

    @cached_property
    def groups(self) -> dict[str, dict[str, Constant]]:
        """The declared constants by owner."""
        drive = {n: c for n, c in Cascade.constants.items() if not c.optional or self.droop}
        if self.sampled:
            drive["u"] = Constant("V", "valve voltage, held")
        groups = {
            "law": self.law.numbers(self.form),
            "plant": Cylinder.constants,
            "drive": drive,
            "observer": self.observer.numbers(self.observer_form) if self.observer else {},
            "model": Cylinder.constants,
            "adaptation": Adaptation.constants if self.adaptive else {},
            "signal": self.signal.constants,
        }
        if self.sampled:
            groups = {n: groups[n] for n in ("law", "plant", "drive")}
        return groups

    @cached_property
    def parameters(self) -> tuple[tuple[str, str], ...]:
        """(group, name) of each run-time constant, in the order in which compiled code takes them."""
        return tuple((owner, name) for owner, constants in self.groups.items() for name in constants)

    def constant(self, owner: str, name: str) -> Constant:
        """The declaration of a run-time constant."""
        return self.groups[owner][name]

    @property
    def heading(self) -> tuple[str, ...]:
        """What this is, for the head of the generated code."""
        observer = self.observer.name if self.observer else "none"
        return (
            f"Law: {self.law.name}. {self.law.__doc__}", f"Source: {self.law.source}",
            f"Drive: {Cascade.kind}; {Cascade.meaning}; friction observer: {observer}.",
        )  # fmt: skip

    # -- the equations as graphs -----------------------------------------------------------------------------------

    def _symbols(self, owner: str, names: Any = None) -> SimpleNamespace:
        return SimpleNamespace(**{n: symbol(f"{owner}.{n}") for n in (names or self.groups.get(owner, ()))})

    def _observer_constants(self, called: Names | None = None) -> Constants:
        assert self.observer is not None
        on_term = None if called is None else called.term
        return self.observer.symbolic(lambda n: symbol(f"observer.{n}"), self.observer_form, on_term)

    def controller(
        self, path: tuple[Expr, Expr, Expr, Expr] | None = None, called: Names | None = None
    ) -> dict[str, Expr]:
        """Eqs 12 to 15 as expressions of what is measured (t, y, v, p_1, p_2, acceleration) and of the controller's states.

        dp_d/dt is the total derivative of p_d along the rates: of time, of the motion, and of the states themselves.
        ``path``: symbols for the desired position and its derivatives; the signal's at time t unless given.
        """
        c, m = self._symbols("drive", Cascade.constants), self._symbols("model", Cylinder.constants)
        t, y, v, p_1, p_2, acceleration = (symbol(n) for n in MEASURED)
        moving = {t: ONE} if path is None else dict(pairwise(path))
        path = path or self.path(t)
        e, s = Cascade.errors(c, path, y, v)
        found = self._observe(c, v, s, called)
        p_d = Cascade.desired_pressure(c, m, path, v, s, found.F)
        rates = {n: wrap(rate) for n, rate in found.rates.items()}
        along = {**moving, y: v, v: acceleration, **{symbol(n): rate for n, rate in rates.items()}}
        p_err = p_1 - p_2 - p_d
        dp_d = total_derivative(wrap(p_d), along)
        u_hat = Cascade.pressure_demand(c, m, y, v, p_1, p_2, s, p_err, dp_d)
        u = Cylinder.voltage(m, y, p_1, p_2, u_hat, c.u_max)
        named = {"e": e, "s": s, "p_d": p_d, "p_err": p_err, "u": u, "F_hat": found.F, "z_hat": found.z}
        return {n: wrap(x) for n, x in named.items()} | {f"rate.{n}": rate for n, rate in rates.items()}

    def path(self, t: Expr) -> Path:
        """The desired position and its first three derivatives."""
        position = wrap(self.signal.equation(self._symbols("signal", self.signal.constants), t))
        speed = derivative(position, t)
        acceleration = derivative(speed, t)
        return position, speed, acceleration, derivative(acceleration, t)

    def _observe(self, c: Any, v: Expr, s: Value, called: Names | None) -> Observed:
        x: dict[str, Value] = {state.name: symbol(state.name) for state in self.controller_states}
        p = self._observer_constants(called) if self.observer else None
        if self.adaptive:
            assert self.observer is not None
            return adapt(self.observer, p, self._symbols("adaptation", Adaptation.constants), c.K, v, s, x)
        return observe(self.observer, p, c.K, v, s, x)

    def motion(self, called: Names | None = None) -> dict[str, Expr]:
        """F, the acceleration and dz/dt of the plant."""
        called = Names() if called is None else called
        q = self.law.symbolic(lambda n: symbol(f"law.{n}"), self.form, called.term)
        v, p_1, p_2 = symbol("v"), symbol("p_1"), symbol("p_2")
        z = symbol("z") if self.law.has_z else constant(0.0)
        dz_dt = wrap(self.law.dz_dt(q, v, z))
        F = wrap(self.law.friction(q, v, z, dz_dt))
        found = {
            "F": F,
            "acceleration": wrap(Cylinder.acceleration(self._symbols("plant"), p_1, p_2, F)),
            "dz_dt": dz_dt,
        }
        for name, value in found.items():
            called.give(value, name)
        return found

    @cached_property
    def _loop(self) -> dict[str, Expr]:
        """The controller's expressions with the plant's acceleration put in; what a sampled controller holds is a symbol."""
        if self.sampled:
            y, v, p_1, p_2 = (symbol(column.name) for column in _MOTION)
            e, s = Cascade.errors(self._symbols("drive", Cascade.constants), self.path(symbol("t")), y, v)
            held = {name: symbol(name) for name in ("u", "F_hat", "z_hat")}
            return {"e": wrap(e), "s": wrap(s), "p_err": p_1 - p_2 - symbol("p_d"), **held}
        control = self.controller()
        return dict(zip(control, substitute(control.values(), {symbol("acceleration"): self.motion()["acceleration"]}),
                        strict=True))  # fmt: skip

    def rates(self, called: Names | None = None) -> list[Expr]:
        """The time derivatives of the states as expressions of ``t``, the states' names and the constants' symbols."""
        p, motion = self._symbols("plant"), self.motion(called)
        y, v, p_1, p_2 = (symbol(column.name) for column in _MOTION)
        u = symbol("drive.u") if self.sampled else self._loop["u"]
        droop = symbol("drive.supply_droop") if self.droop else 0.0
        flows = Cylinder.flows(p, p_1, p_2, u, droop)
        rate_1, rate_2 = Cylinder.pressure_rates(p, y, v, p_1, p_2, *flows)
        # the equations end where the piston meets a cover: the solver then stops there
        inside = both(y >= 0, y <= p.stroke)
        rates = {"y": v, "v": where(inside, motion["acceleration"], float("nan")), "p_1": rate_1, "p_2": rate_2}
        rates["z"] = motion["dz_dt"]
        if not self.sampled:
            rates |= {n.name: self._loop[f"rate.{n.name}"] for n in self.controller_states}
        return [wrap(rates[state.name]) for state in self.states]

    # -- the columns of the output ---------------------------------------------------------------------------------

    def energy(self) -> Expr:
        """V along the loop: with the plant's own mass and deflection, and the errors of adapted parameters."""
        c, loop = self._symbols("drive", Cascade.constants), self._loop
        known = self.law.has_z and self.observer is not None and self.observer.has_z
        z_err: Value = symbol("z_hat") - symbol("z") if known else 0.0
        errors: Value = 0.0
        if self.adaptive:
            a, o = self._symbols("adaptation", Adaptation.constants), self._observer_constants()
            q = self._symbols("law")
            true = {
                "a_0": q.sigma_0 / o.sigma_0, "a_1": q.sigma_1 / o.sigma_1, "a_2": q.sigma_2 / o.sigma_2,
                "a_g": (o.F_c / o.sigma_0) / (q.F_c / q.sigma_0),
            }  # fmt: skip
            off = {n: symbol(n) - value for n, value in true.items()}
            gains = {"a_0": a.gamma_0, "a_1": a.gamma_1, "a_2": a.gamma_2, "a_g": a.gamma_g}
            # a parameter that is not adapted has no part in V
            errors = sum(where(gains[n] > 0, off[n] ** 2 / gains[n], 0.0) for n in off) / 2
            z_err = (z_err - symbol("eta") * off["a_g"]) * sqrt(true["a_0"])
        return wrap(Cascade.energy(c, symbol("plant.mass"), loop["s"], loop["p_err"], z_err) + errors)

    @cached_property
    def outputs(self) -> dict[str, Expr]:
        """Every column as an expression of t, the states and the constants."""
        z = symbol("z") if self.law.has_z else constant(0.0)
        found = {c.name: symbol(c.name) for c in _MOTION} | {"z": z, "F": self.motion()["F"], "V": self.energy()}
        found |= {n: self._loop[n] for n in ("e", "s", "p_err", "u", "F_hat", "z_hat")}
        if self.adaptive:
            o = self._observer_constants()
            found |= {f"sigma_{i}_hat": symbol(f"observer.sigma_{i}") * symbol(f"a_{i}") for i in range(3)}
            found["F_c_hat"] = o.F_c * symbol("a_0") / symbol("a_g")
        return {column.name: found[column.name] for column in self.columns}

    def table(self, values: dict[tuple[str, str], Any], t: Array, states: dict[str, Array]) -> dict[str, Any]:
        """Every column of the output by name, from the constants' values (or arrays over time) and the states."""
        names = [f"{owner}.{name}" for owner, name in values]
        function = compiled(self, (*names, "t", *states), "outputs")
        return dict(zip(self.outputs, function(*values.values(), t, *states.values()), strict=True))

    def ended(self, values: dict[tuple[str, str], float], t: float, x: Array) -> str | None:
        """Why the equations ended in the state x, where the reason is the end of the stroke."""
        y, v, stroke = float(x[0]), float(x[1]), values["plant", "stroke"]
        cover = 0.0 if v < 0 else stroke
        if abs(y - cover) > 1e-6 * stroke:
            return None
        return f"the piston reached the end of its stroke, y = {cover:g} m, at t = {t:.6g} s with v = {v:.4g} m/s"


@lru_cache(maxsize=32)
def compiled(system: ServoSystem, names: tuple[str, ...], sought: str) -> Any:
    """A Python function of the inputs ``names`` for the ``outputs``, the ``controller`` or the ``path`` of a system."""
    if sought == "path":
        return python_function(names, system.path(symbol("t")))
    found = system.controller() if sought == "controller" else system.outputs
    return python_function(names, list(found.values()))

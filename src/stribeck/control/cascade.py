"""The cascade controller of the paper's section 5, with its printing errors put right (docs/explanation/servo.md)."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import pairwise
from types import SimpleNamespace
from typing import ClassVar

from stribeck.constants import Column, Constant
from stribeck.control.cylinder import Cylinder
from stribeck.control.observer import ETA, SCALES, START, Z_HAT, Adaptation, Observed, adapt, observe
from stribeck.control.sampled import Sampled, phi_1, tracked, turned
from stribeck.expressions.graph import ONE, Expr, derivative, substitute, symbol, total_derivative, wrap
from stribeck.expressions.names import Names
from stribeck.expressions.ops import Value, sqrt, where
from stribeck.laws.base import Law
from stribeck.laws.form import USUAL, Form
from stribeck.laws.values import Constants

MEASURED = ("t", "y", "v", "p_1", "p_2", "acceleration")  # what the controller measures

_SHOWN = ("F_hat", "p_d", "z_hat")  # what a sampled one computes beside the voltage
SWINGS, SWING = "swings", 0.02  # how often the valve turned back by more than this share of its limit
_TURNS = ("extreme", "way")
_TRACKED = ("filter_y", "filter_v", "filter_a")
SAMPLING = "sampling"  # the table of period and delay
E = Column("e", "m", "position error y - y_d")
S = Column("s", "m/s", "de/dt + lambda e")
_P_ERR = Column("p_err", "Pa", "error of the pressure difference")
F_HAT = Column("F_hat", "N", "friction force that the controller assumes")
_V = Column("V", "J", "Lyapunov function")
_ADAPTED = (
    Column("sigma_0_hat", "N/m", "adapted bristle stiffness"),
    Column("sigma_1_hat", "N s/m", "adapted bristle damping"),
    Column("sigma_2_hat", "N s/m", "adapted viscous friction"),
    Column("F_c_hat", "N", "adapted Coulomb friction force"),
)


Course = tuple[Expr, Expr, Expr, Expr]  # a desired position and its first three derivatives


def course(position: Expr, t: Expr) -> Course:
    """A desired position as a function of time, with its derivatives."""
    speed = derivative(position, t)
    acceleration = derivative(speed, t)
    return position, speed, acceleration, derivative(acceleration, t)


@dataclass(frozen=True)
class Motion:
    """What the cascade may measure: the signal, the motion, the pressures and its own states, in their order.

    ``z`` is None under a law without bristles; ``p`` and ``law`` hold the constants of the plant and of the law.
    """

    r: Value
    y: Value
    v: Value
    plant: tuple[Value, ...] = ()
    own: tuple[Value, ...] = ()
    z: Value | None = None
    F: Value = 0.0
    acceleration: Value = 0.0
    p: SimpleNamespace = field(default_factory=SimpleNamespace)
    law: SimpleNamespace = field(default_factory=SimpleNamespace)


@dataclass(frozen=True)
class Action:
    """What the cascade does: the voltage of the valve, the rates of its own states, and what it adds to the output."""

    u: Value
    rates: tuple[Value, ...] = ()
    shown: dict[str, Value] = field(default_factory=dict)


@dataclass(frozen=True)
class PressureCascade:
    """A tracking law for the piston that asks for a pressure difference, and one for the valve that provides it.

    Attributes:
        observer: the law that compensates friction, in its form; None: no compensation.
        droop: the supply loses pressure by flow, which the controller does not know.
        adaptive: the observer's parameters are adapted.
        sampled: how it samples; None: it is part of the differential equations.
    """

    observer: type[Law] | None = None
    observer_form: Form = USUAL
    droop: bool = False
    adaptive: bool = False
    sampled: Sampled | None = None

    kind: ClassVar[str] = "cascade"
    meaning: ClassVar[str] = "the signal is the desired position of a pneumatic servo under cascade control, m"
    signal: ClassVar[Column] = Column("y_d", "m", "desired position")
    gives: ClassVar[Column] = Cylinder.takes
    starts: ClassVar[dict[str, float]] = {scale.name: 1.0 for scale in SCALES}
    constants: ClassVar[dict[str, Constant]] = {
        "K_D": Constant("N s/m", "gain of the tracking error s", above=0, example=60.0),
        "K_p": Constant("1/s", "gain of the pressure error", above=0, example=60.0),
        "lambda": Constant("1/s", "s = de/dt + lambda e", above=0, example=20.0),
        "K": Constant("m/N", "gain of the friction observer", above=0, example=1e-5),
        "rho": Constant("m^3/Pa", "weight of the pressure error in the Lyapunov function", above=0, example=4e-10),
        "u_max": Constant("V", "limit of the valve voltage", above=0, example=10.0),
        "supply_droop": Constant(
            "Pa s/kg", "pressure that the supply loses by mass flow, unknown to the controller", at_least=0, optional=True
        ),
    }  # fmt: skip

    @staticmethod
    def errors(c: SimpleNamespace, path: Course, y: Value, v: Value) -> tuple[Value, Value]:
        """The position error e (m) and s = de/dt + lambda e (m/s)."""
        e = y - path[0]
        return e, v - path[1] + getattr(c, "lambda") * e

    @staticmethod
    def desired_pressure(
        c: SimpleNamespace, m: SimpleNamespace, path: Course, v: Value, s: Value, F_hat: Value
    ) -> Value:
        """p_d, eq. 12; ``m`` is the plant as the controller knows it."""
        return (-c.K_D * s + m.mass * (path[2] - getattr(c, "lambda") * (v - path[1])) + F_hat) / m.area

    @staticmethod
    def pressure_demand(
        c: SimpleNamespace,
        m: SimpleNamespace,
        y: Value,
        v: Value,
        p_1: Value,
        p_2: Value,
        s: Value,
        p_err: Value,
        dp_d: Value,
    ) -> Value:
        """u_hat, eq. 13: what the valve is to add to the rate of p_1 - p_2, Pa/s."""
        return -Cylinder.unforced(m, y, v, p_1, p_2) - m.area / c.rho * s - c.K_p * p_err + dp_d

    @staticmethod
    def energy(c: SimpleNamespace, mass: Value, s: Value, p_err: Value, z_err: Value) -> Value:
        """V in J, eq. 17; z_err is z_hat - z."""
        return (mass * s**2 + c.rho * p_err**2 + z_err**2 / c.K) / 2

    # -- what a system asks ----------------------------------------------------------------------------------------

    @property
    def remembered(self) -> tuple[Column, ...]:
        """The states that the controller keeps, whether in the differential equations or from sample to sample."""
        if self.observer is None or not self.observer.has_z:
            return ()
        return (Z_HAT, ETA, *SCALES) if self.adaptive else (Z_HAT,)

    @property
    def kept(self) -> tuple[Column, ...]:
        """The states that are integrated: none of a sampled controller."""
        return () if self.sampled else self.remembered

    @property
    def tables(self) -> dict[str, dict[str, Constant]]:
        """The constants by owner: the gains, the observer's, the plant's as it is known, and the adaptation's."""
        own = {n: c for n, c in self.constants.items() if not c.optional or self.droop}
        observer = self.observer.numbers(self.observer_form) if self.observer else {}
        adaptation = Adaptation.constants if self.adaptive else {}
        found = {"drive": own, "observer": observer, "model": Cylinder.constants, "adaptation": adaptation}
        return {**found, SAMPLING: self.sampled.numbers} if self.sampled else found

    @property
    def shown(self) -> tuple[str, ...]:
        """What a sampled controller computed at its last instant, by the names of columns and states."""
        names = (*_SHOWN, *(state.name for state in self.remembered if state is not Z_HAT), SWINGS)
        return names if self.sampled else ()

    @property
    def memory(self) -> tuple[str, ...]:
        """What a sampled controller remembers: what it shows, its states for the next instant, and its filter's."""
        if not self.sampled:
            return ()
        kept = (*(f"next_{state.name}" for state in self.remembered), *(_TRACKED if self.sampled.bandwidth else ()))
        return (*self.shown, *_TURNS, "readings", *kept)

    @property
    def heading(self) -> tuple[str, ...]:
        """With the friction observer."""
        observer = self.observer.name if self.observer else "none"
        return (f"Drive: {self.kind}; {self.meaning}; friction observer: {observer}.",)

    def listed(self, motion: tuple[Column, ...], plant: tuple[Column, ...]) -> tuple[Column, ...]:
        """The columns: the motion, what the controller computes, the friction force beside its estimate, and V."""
        y, v, z, F = motion
        return (
            y,
            v,
            *plant,
            z,
            Z_HAT,
            E,
            S,
            _P_ERR,
            Cylinder.takes,
            F,
            F_HAT,
            _V,
            *(_ADAPTED if self.adaptive else ()),
        )

    def obeyed(self, plant: SimpleNamespace, p: SimpleNamespace) -> SimpleNamespace:
        """The cylinder is fed by the supply that droops."""
        return SimpleNamespace(**vars(plant), supply_droop=p.supply_droop) if self.droop else plant

    def scales(self, p: SimpleNamespace, length: float, force: float) -> dict[str, float]:
        """Deflections are lengths, scales are of the order of 1."""
        return {state.name: length if state in (Z_HAT, ETA) else 1.0 for state in self.kept}

    def act(self, p: SimpleNamespace, m: Motion, called: Names | None = None) -> Action:
        """The valve voltage now; of a sampled controller that which it holds."""
        t = symbol("t")
        if self.sampled:
            held = {name: symbol(f"memory.{name}") for name in _SHOWN}
            e, s = self.errors(p, course(wrap(m.r), t), m.y, m.v)
            u = symbol("segment.u")
            p_err = m.plant[0] - m.plant[1] - held["p_d"]
            found, rates = {"e": e, "s": s, "p_err": p_err, "u": u, **held}, ()
        else:
            measured = self.controller(course(wrap(m.r), t), {t: ONE})
            known = substitute(measured.values(), {symbol("acceleration"): wrap(m.acceleration)})
            found = dict(zip(measured, known, strict=True))
            rates, u = tuple(found[f"rate.{state.name}"] for state in self.kept), found["u"]
        shown: dict[str, Value] = {n: found[n] for n in ("e", "s", "p_err", "u", "F_hat", "z_hat")}
        shown["V"] = self._lyapunov(p, m, found["s"], found["p_err"])
        if self.adaptive:
            o = self._observer_constants(None)
            shown |= {f"sigma_{i}_hat": symbol(f"observer.sigma_{i}") * self._now(f"a_{i}") for i in range(3)}
            shown["F_c_hat"] = o.F_c * self._now("a_0") / self._now("a_g")
        return Action(u, rates, shown)

    def _now(self, state: str) -> Expr:
        """A state of the controller's: an integrated one, or what a sampled controller shows of it."""
        return symbol(f"memory.{state}" if self.sampled else state)

    def sample(self, path: Course, m: Motion, called: Names) -> tuple[Value, dict[str, Value]]:
        """The valve voltage from then on; the states go one period on with what was measured held.

        x + T phi_1(J T) f is exact for what is linear in x, as eq. 15 is for the LuGre laws.
        """
        assert self.sampled is not None
        p, memory = self.sampled.symbols(SAMPLING), {n: symbol(f"memory.{n}") for n in self.memory}
        first = memory["readings"] <= 0
        after: dict[str, Value] = {"readings": memory["readings"] + 1}
        motion = (m.y, m.v, m.acceleration)
        if self.sampled.bandwidth:
            start = (m.y - p.period * m.v, m.v, 0.0)
            before = [where(first, x, memory[n]) for n, x in zip(_TRACKED, start, strict=True)]
            y, v, a = before
            motion = tracked((y, v, a), self.sampled.reading(p, m.y), p.bandwidth, p.period)
            after |= dict(zip(_TRACKED, motion, strict=True))
        found = self.controller(path, {symbol("t"): ONE}, called)
        rates = {s.name: found[f"rate.{s.name}"] for s in self.remembered}
        slopes = {n: derivative(rate, symbol(n)) for n, rate in rates.items()}
        states = {n: wrap(where(first, START[n], memory[f"next_{n}"])) for n in rates}
        measured = (symbol("t"), *motion[:2], *m.plant, motion[2])
        known = {symbol(n): wrap(x) for n, x in zip(MEASURED, measured, strict=True) if n != "t"}
        known |= {symbol(n): x for n, x in states.items()}
        every = [*(found[n] for n in ("u", *_SHOWN)), *rates.values(), *slopes.values()]
        u, F_hat, p_d, z_hat, *moved = substitute(every, known, called)
        after |= {"F_hat": F_hat, "p_d": p_d, **states, "z_hat": z_hat}
        for (name, x), rate, slope in zip(states.items(), moved[: len(states)], moved[len(states) :], strict=True):
            after[f"next_{name}"] = x + p.period * phi_1(slope * p.period) * rate
        turns = turned(
            u, where(first, u, memory["extreme"]), memory["way"], memory[SWINGS], SWING * symbol("drive.u_max")
        )
        return u, after | dict(zip((*_TURNS, SWINGS), turns, strict=True))

    # -- the equations as graphs -----------------------------------------------------------------------------------

    def _observer_constants(self, called: Names | None) -> Constants:
        assert self.observer is not None
        on_term = None if called is None else called.term
        return self.observer.symbolic(lambda n: symbol(f"observer.{n}"), self.observer_form, on_term)

    def controller(self, path: Course, moving: dict[Expr, Expr], called: Names | None = None) -> dict[str, Expr]:
        """Eqs 12 to 15 as expressions of what is measured and of the controller's states (``rate.NAME``: their rates).

        dp_d/dt is the total derivative of p_d along the rates: of the desired position (``moving``: of time, or of the
        symbols that ``path`` is made of), of the motion, and of the states themselves.
        """
        c, m = _symbols("drive", self.constants), _symbols("model", Cylinder.constants)
        _, y, v, p_1, p_2, acceleration = (symbol(n) for n in MEASURED)
        e, s = self.errors(c, path, y, v)
        found = self._observe(c, v, s, called)
        p_d = self.desired_pressure(c, m, path, v, s, found.F)
        rates = {n: wrap(rate) for n, rate in found.rates.items()}
        along = {**moving, y: v, v: acceleration, **{symbol(n): rate for n, rate in rates.items()}}
        p_err = p_1 - p_2 - p_d
        dp_d = total_derivative(wrap(p_d), along)
        u_hat = self.pressure_demand(c, m, y, v, p_1, p_2, s, p_err, dp_d)
        u = Cylinder.voltage(m, y, p_1, p_2, u_hat, c.u_max)
        named = {"e": e, "s": s, "p_d": p_d, "p_err": p_err, "u": u, "F_hat": found.F, "z_hat": found.z}
        return {n: wrap(x) for n, x in named.items()} | {f"rate.{n}": rate for n, rate in rates.items()}

    def measured(self, path: Course, called: Names | None = None) -> dict[str, Expr]:
        """The controller under a desired position and derivatives that are symbols."""
        return self.controller(path, dict(pairwise(path)), called)

    def _observe(self, c: SimpleNamespace, v: Expr, s: Value, called: Names | None) -> Observed:
        x: dict[str, Value] = {state.name: symbol(state.name) for state in self.remembered}
        p = self._observer_constants(called) if self.observer else SimpleNamespace()
        if self.adaptive:
            assert self.observer is not None
            return adapt(self.observer, p, _symbols("adaptation", Adaptation.constants), c.K, v, s, x)
        return observe(self.observer, p, c.K, v, s, x)

    def _lyapunov(self, c: SimpleNamespace, m: Motion, s: Value, p_err: Value) -> Value:
        """V along the loop: with the plant's own mass and deflection, and the errors of adapted parameters."""
        known = m.z is not None and self.observer is not None and self.observer.has_z
        z_err: Value = self._now("z_hat") - m.z if known else 0.0
        errors: Value = 0.0
        if self.adaptive:
            a, o, q = _symbols("adaptation", Adaptation.constants), self._observer_constants(None), m.law
            true = {
                "a_0": q.sigma_0 / o.sigma_0, "a_1": q.sigma_1 / o.sigma_1, "a_2": q.sigma_2 / o.sigma_2,
                "a_g": (o.F_c / o.sigma_0) / (q.F_c / q.sigma_0),
            }  # fmt: skip
            off = {n: self._now(n) - value for n, value in true.items()}
            gains = {"a_0": a.gamma_0, "a_1": a.gamma_1, "a_2": a.gamma_2, "a_g": a.gamma_g}
            # a parameter that is not adapted has no part in V
            errors = sum(where(gains[n] > 0, off[n] ** 2 / gains[n], 0.0) for n in off) / 2
            z_err = (z_err - self._now("eta") * off["a_g"]) * sqrt(true["a_0"])
        return self.energy(c, m.p.mass, s, p_err, z_err) + errors


def _symbols(owner: str, names: Iterable[str]) -> SimpleNamespace:
    return SimpleNamespace(**{n: symbol(f"{owner}.{n}") for n in names})

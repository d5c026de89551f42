"""The cascade controller of the paper's section 5: it moves the valve of a pneumatic piston (docs/explanation/servo.md)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import lru_cache
from types import EllipsisType, SimpleNamespace
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import Field, PlainValidator, ValidationInfo, WithJsonSchema, WrapValidator, create_model

from stribeck.arrays import Array
from stribeck.constants import Column, Constant, show
from stribeck.errors import NotDifferentiable
from stribeck.expressions.emit import python_function
from stribeck.expressions.graph import ONE, Expr, derivative, substitute, symbol, total_derivative, wrap
from stribeck.expressions.names import Names
from stribeck.expressions.ops import Value, sqrt, where
from stribeck.laws.base import PARAMETERS, BristleLaw, Law, Scales
from stribeck.machine.element import GROUND, State
from stribeck.machine.elements.bodies.cylinder import GAS, Piston
from stribeck.machine.elements.controllers import AnyController, Courses
from stribeck.machine.elements.sampling import Sampling
from stribeck.machine.equations import Sample
from stribeck.machine.law import Friction, problems_below, read_law
from stribeck.machine.pneumatic.cascade import (
    Course,
    course,
    desired_pressure,
    energy,
    pressure_demand,
    tracking_errors,
)
from stribeck.machine.pneumatic.cylinder import Cylinder
from stribeck.machine.pneumatic.observer import ETA, SCALES, START, Z_HAT, Observed, adapt, observe
from stribeck.machine.sampled import phi_1, tracked, turned
from stribeck.machine.signal import SignalTable
from stribeck.machine.table import (
    Aside,
    ConstantField,
    FileTable,
    Held,
    Loc,
    Problem,
    Reading,
    annotation,
    given_as,
    joined,
    no_table,
    problems_at,
    quantity,
    table_path,
    unknown_key,
)
from stribeck.waveforms import Signal

if TYPE_CHECKING:
    from stribeck.machine.assembly import Assembly
    from stribeck.machine.elements.contacts import Contact
    from stribeck.machine.machine import Elements
    from stribeck.machine.reading import Draft

GAINS = ("K_D", "K_p", "lambda", "K", "rho", "u_max", "supply_droop")
NONE = "none"  # the observer's name where friction is not compensated
_T = symbol("t")
_ACCELERATION = symbol("acceleration")  # as measured, in the place of what it is
_HELD = ("F_hat", "p_d", "z_hat")  # what a sampled one computes beside the voltage
_SWINGS, _SWING = "swings", 0.02  # how often the valve turned back by more than this share of its limit
_TURNS = ("extreme", "way")
_TRACKED = ("filter_y", "filter_v", "filter_a")
_MOST_INSTANTS = 1e7  # of a sampled controller: some minutes
_SAMPLES = 4001  # of the path, where it is judged
_MOST_SWINGS = 25  # turns of the valve in a quarter of a run that need no word
_COLUMNS = (
    Z_HAT,
    Column("e", "m", "position error y - y_d"),
    Column("s", "m/s", "de/dt + lambda e"),
    Column("p_err", "Pa", "error of the pressure difference"),
    Column("F_hat", "N", "friction force that the controller assumes"),
    Column("V", "J", "Lyapunov function"),
)
_ADAPTED = (
    Column("sigma_0_hat", "N/m", "adapted bristle stiffness"),
    Column("sigma_1_hat", "N s/m", "adapted bristle damping"),
    Column("sigma_2_hat", "N s/m", "adapted viscous friction"),
    Column("F_c_hat", "N", "adapted Coulomb friction force"),
)


def _known(name: str) -> Held:
    declared = annotation(Piston.model_fields[name], ConstantField).constant
    return float | None, given_as(replace(declared, optional=True))


class KnownPlant(create_model("Known", __base__=FileTable, **{n: _known(n) for n in GAS})):  # type: ignore[misc]
    """Plant constants that the controller takes for true; the piston's own where they are left out."""


class Gains(FileTable):
    """Gains of the adaptation, with adaptive = true."""

    gamma_0: float = quantity("1/J", "adaptation gain of sigma_0", at_least=0, default=2.0)
    gamma_1: float = quantity("1/J", "adaptation gain of sigma_1", at_least=0, default=500.0)
    gamma_2: float = quantity("1/J", "adaptation gain of sigma_2", at_least=0, default=2.0)
    gamma_g: float = quantity("1/J", "adaptation gain of the level F_c, through 1/g", at_least=0, default=0.5)
    range: float = quantity(
        "", "each parameter stays within its known value divided and multiplied by this", above=1, default=4.0
    )


def _complete(value: object, handler: Callable[[object], KnownPlant], info: ValidationInfo) -> KnownPlant:
    """The model with the piston's constants where it gives none."""
    given = handler(value)
    reading: Reading = info.context or Reading()
    piston = reading.others.get("bodies", {}).get(str(info.data.get("on")))
    if not isinstance(piston, Piston):
        return given
    overridden = {n: x for n in piston.constants if (x := getattr(given, n)) is not None}
    whole: KnownPlant = KnownPlant.model_construct(given.model_fields_set, **{**piston.constants, **overridden})
    return whole


def _read_observer(table: object, info: ValidationInfo) -> Friction | EllipsisType | None:
    """The law that the controller assumes, with the plant's parameters where it gives none.

    None for no law, ... where it, or the plant's, is in a file that must not be executed yet.
    """
    if not isinstance(table, Mapping):
        raise problems_at([((), no_table(table))])
    name, others = table.get("name"), [key for key in table if key != "name"]
    if "name" not in table:
        raise problems_at([(("name",), f"missing: must be given (the name of a smooth law, or {NONE!r})")])
    if name == NONE:
        if others:
            raise problems_at([((key,), f"{show(table[key])}: must be left out: no law") for key in others])
        return None
    reading: Reading = info.context or Reading()
    plant, path = _law_on(info.data.get("on"), reading.others.get("contacts", {})), joined(reading.place, "observer")
    inherited = {**plant.machine, **plant.values} if plant is not None else dict.fromkeys(PARAMETERS, 1.0)
    inherited = {n: x for n, x in inherited.items() if n in PARAMETERS and x is not None}
    given = table.get("parameters", {})
    parameters = {**inherited, **given} if isinstance(given, dict) else given
    law, problems = read_law({**table, "parameters": parameters}, path, reading)
    if plant is None and isinstance(given, dict):  # which of its numbers are wrong is unknown
        assumed = {f"{path}.parameters.{n}" for n in inherited if n not in given}
        problems = [(place, text) for place, text in problems if place not in assumed]
    if problems:
        raise problems_below(path, problems)
    if law is None or plant is None:
        return ...
    if text := _useless(law):
        raise problems_at([(("name",), f"{show(name)}: {text}")])
    return Friction.from_law(law, table)


def _contact_on(body: object, contacts: Mapping[str, Contact]) -> Contact | None:
    """A body's first contact with the ground."""
    return next((x for x in contacts.values() if x.start == body and x.end == GROUND), None)


def _law_on(body: object, contacts: Mapping[str, Contact]) -> Law | None:
    contact = _contact_on(body, contacts)
    return None if contact is None or contact.law is None else contact.law.law


def _useless(law: Law) -> str | None:
    """Why a law cannot be an observer, or None: the controller needs dF/dt, also at v = 0, and sigma_0."""
    try:
        scales = law.scales(law.p)
        law.force_rate(0.0, scales.length * np.array([-0.5, 0.0, 0.5]) if law.has_z else 0.0, scales.speed)
    except NotDifferentiable as error:
        return f"cannot be an observer, which needs dF/dt: {error}"
    if law.has_z and "sigma_0" not in law.constants():
        return "cannot be an observer: it has z, but no sigma_0 to weigh the tracking error by"
    return None


def not_linear(law: Law | None) -> str | None:
    """Why an observer is not of the kind that the Lyapunov function is for, or None."""
    if law is None:
        return "there is no observer"
    linear = law.has_z and law.linear
    if not (linear and type(law).friction is BristleLaw.friction):
        return f"of law '{law.name}' dz/dt must be linear in z, and F = sigma_0 z + sigma_1 dz/dt + sigma_2 v"
    return None


def _not_adaptable(law: Law | None) -> str | None:
    """Why an observer cannot be adapted, or None."""
    reason = not_linear(law)
    if reason is None and law is not None:
        if law.values.get("v_d") is not None:
            reason = f"v_d = {law.values['v_d']:g}: sigma_1 must be constant"
        elif zero := [name for name in ("sigma_0", "sigma_1", "sigma_2") if not law.values[name]]:
            reason = f"{zero[0]} = 0: its scale is adapted, so it must be > 0"
    return f"cannot adapt the observer: {reason}" if reason else None


def _sampling(data: dict[str, Held]) -> Sampling | None:
    """When it computes, from the keys of its table; without a filter the motion is measured as it is."""
    if data["sample_time"] is None:
        return None
    read = {"resolution": data["quantization"], "noise": data["noise"]} if data["bandwidth"] is not None else {}
    keys = {"bandwidth": data["bandwidth"], "seed": data["seed"], **{n: x for n, x in read.items() if x > 0}}
    return Sampling(period=data["sample_time"], delay=data["delay"], **keys)


class PressureCascade(AnyController):
    """A tracking law for the piston that asks for a pressure difference, and one for the valve that provides it."""

    kind: Literal["pressure_cascade"] = "pressure_cascade"
    moves_valve, follows_others = True, True
    on: str = Field(description="the piston")
    K_D: float = quantity("N s/m", "gain of the tracking error s", above=0)
    K_p: float = quantity("1/s", "gain of the pressure error", above=0)
    lambda_: float = given_as(Constant("1/s", "s = de/dt + lambda e", above=0), alias="lambda")
    K: float = quantity("m/N", "gain of the friction observer", above=0)
    rho: float = quantity("m^3/Pa", "weight of the pressure error in the Lyapunov function", above=0)
    u_max: float = quantity("V", "limit of the valve voltage", above=0)
    supply_droop: float | None = quantity(
        "Pa s/kg", "pressure that the supply loses by mass flow, unknown to the controller", at_least=0, optional=True
    )
    sample_time: float | None = given_as(
        Constant("", "the controller computes every so many s; off: always", above=0, optional=True), in_code=False
    )
    delay: float = given_as(Constant("", "time from measuring to acting, s", at_least=0, default=0.0), in_code=False)
    noise: float = given_as(
        Constant("", "standard deviation of the measured position, m", at_least=0, default=0.0), in_code=False
    )
    quantization: float = given_as(
        Constant("", "step of the measured position, m", at_least=0, default=0.0), in_code=False
    )
    bandwidth: float | None = given_as(
        Constant("", "of the filter that estimates velocity and acceleration, rad/s", above=0, optional=True),
        in_code=False,
    )
    seed: Annotated[int, Aside(0)] = Field(
        0, ge=0, le=2**32 - 1, description="seed of the noise; the same seed gives the same noise"
    )
    adaptive: bool = Field(False, description="adapt sigma_0, sigma_1, sigma_2 and the level F_c on line")
    observer: Annotated[  # the schema of files has its own in the place of this one
        Held, PlainValidator(_read_observer), WithJsonSchema({"type": "object", "title": "observer"})
    ] = Field(
        description="the law that the controller assumes: name ('none' for no compensation), its own constants, and "
        "parameters where they differ from the plant's"
    )
    model: Annotated[KnownPlant, WrapValidator(_complete)] = Field(
        default_factory=dict, validate_default=True, description="plant constants that the controller assumes"
    )
    adaptation: Gains = Field(default_factory=Gains, description="gains of the adaptation, with adaptive = true")
    signal: SignalTable = Field(description="desired position, m")
    sampling: Sampling | None = Field(default_factory=_sampling, exclude=True)

    @classmethod
    def completed(cls, data: dict[str, Held], reading: Reading) -> dict[str, Held]:
        """Without a table of the sampling, whose keys are the controller's own."""
        if "sampling" in data:
            raise problems_at([(("sampling",), unknown_key("sampling", data["sampling"], cls.file_keys()))])
        return super().completed(data, reading)

    # -- its form ------------------------------------------------------------------------------------------------------

    @property
    def observer_law(self) -> Law | None:
        """The law that it takes for true, with numbers."""
        return None if self.observer is None else self.observer.law

    @property
    def observer_name(self) -> str:
        """The name of the assumed law."""
        return NONE if self.observer is None else str(self.observer.kind.name)

    @property
    def gains(self) -> dict[str, Value]:
        """The gains that are given."""
        gains = {n: getattr(self, "lambda_" if n == "lambda" else n) for n in GAINS}
        return {n: x for n, x in gains.items() if x is not None}

    def whole(self) -> bool:
        """Whether the observer's law has been read."""
        return self.observer is not ...

    def laws(self) -> list[tuple[str, Friction]]:
        """None: what it takes for true acts nowhere."""
        return []

    @property
    def _bristles(self) -> bool:
        return self.observer is not None and self.observer.kind.has_z

    @property
    def _remembered(self) -> tuple[Column, ...]:
        """The states that the controller keeps, whether in the differential equations or from sample to sample."""
        if not self._bristles:
            return ()
        return (Z_HAT, ETA, *SCALES) if self.adaptive else (Z_HAT,)

    def own_states(self, m: Elements) -> tuple[State, ...]:
        """Those that are integrated: none of a sampled controller."""
        kept = () if self.sampling is not None else self._remembered
        return tuple(State(c.name, c.unit, c.meaning, START[c.name]) for c in kept)

    def shown(self) -> tuple[str, ...]:
        """The results of a sampled controller at its last instant, by the names of columns and states."""
        return (*_HELD, *(state.name for state in self._remembered if state is not Z_HAT), _SWINGS)

    def memory(self, m: Elements) -> tuple[str, ...]:
        """The memory of a sampled controller: its outputs, its states for the next instant, and its filter's."""
        assert self.sampling is not None
        tracked = _TRACKED if self.sampling.bandwidth is not None else ()
        return (*self.shown(), *_TURNS, "readings", *(f"next_{state.name}" for state in self._remembered), *tracked)

    def columns(self, m: Elements) -> list[Column]:
        """The desired position, the voltage, what the controller computes, the estimate of friction, and V."""
        columns = (
            Column("r", "m", "desired position"),
            Column("u", "V", "valve voltage"),
            *_COLUMNS,
            *(_ADAPTED if self.adaptive else ()),
        )
        return [replace(c, name=self.name_of(c.name)) for c in columns]

    def heading(self, m: Elements) -> str:
        """With the friction observer."""
        what = "the signal is the desired position of a pneumatic servo under cascade control, m"
        text = f"Drive: cascade; {what}; friction observer: {self.observer_name}."
        return f"{self.name} on {self.on}: {text}" if self.name else text

    def natural(self, scales: Mapping[str, Scales], m: Elements) -> dict[str, Value]:
        """Deflections are lengths, scales are of the order of 1."""
        length = scales[self.on].length
        lengths = (Z_HAT.name, ETA.name)
        return {self.name_of(s.name): length if s.name in lengths else 1.0 for s in self.own_states(m)}

    # -- its equations -------------------------------------------------------------------------------------------------

    def valve(self, a: Assembly, body: Piston, p: SimpleNamespace, F: Expr) -> tuple[SimpleNamespace, Expr]:
        """The plant under its drooping supply, and the valve voltage; a sampled controller holds its voltage.

        ``F`` is the force against the piston: friction and links, less the loads."""
        before = self._acceleration(body, p, F)
        a.called.give(before, body.name_of("acceleration", "_"))
        (y, v), (p_1, p_2) = a.motion(body.name), body.pressures
        path = course(wrap(a.reference(self.signal).value), _T)
        if self.sampling is not None:
            held = {n: self._memory(n) for n in _HELD}
            e, s = tracking_errors(self._c, path, y, v)
            quantities = {
                "e": e,
                "s": s,
                "p_err": p_1 - p_2 - held["p_d"],
                "u": symbol(f"segment.{self.name_of('u', '_')}"),
                **held,
            }
        else:
            computed = self._computed(a.system, path)
            known = substitute(computed.values(), {_ACCELERATION: before})
            quantities = dict(zip(computed, known, strict=True))
            a.rates |= {self.name_of(s.name): quantities[f"rate.{s.name}"] for s in self.own_states(a.system)}
        u = wrap(quantities["u"])
        a.called.give(u, self.name_of("u", "_"))
        shown = {n: quantities[n] for n in ("e", "s", "p_err", "F_hat", "z_hat")}
        shown["V"] = self._lyapunov(a, body, p.mass, quantities["s"], quantities["p_err"])
        if self.adaptive:
            o = self.observer.p
            shown |= {f"sigma_{i}_hat": getattr(o, f"sigma_{i}") * self._now(f"a_{i}") for i in range(3)}
            shown["F_c_hat"] = o.F_c * self._now("a_0") / self._now("a_g")
        states = {s.name: a.state(self, s.name) for s in self.own_states(a.system)}
        every = {"r": path[0], **shown, **states, "u": u}
        a.k |= {self.name_of(n): wrap(x) for n, x in every.items()}
        fed = p if self.supply_droop is None else SimpleNamespace(**vars(p), supply_droop=self.supply_droop)
        return fed, u

    def sample(self, a: Assembly) -> Sample:
        """The valve voltage from then on; the states go one period on with what was measured held.

        x + T phi_1(J T) f is exact for what is linear in x, as eq. 15 is for the LuGre laws.
        """
        assert self.sampling is not None
        body, called, period = a.system.bodies[self.on], a.called, self.sampling.period
        assert isinstance(body, Piston)
        (y, v), pressures = a.motion(body.name), body.pressures
        before = self._acceleration(body, body.gas(a), wrap(-a.force[body.name]))
        memory = {n: self._memory(n) for n in self.memory(a.system)}
        first, motion = memory["readings"] <= 0, (y, v, before)
        after: dict[str, Value] = {"readings": memory["readings"] + 1}
        if self.sampling.bandwidth is not None:
            start = (y - period * v, v, 0.0)
            was = [where(first, x, memory[n]) for n, x in zip(_TRACKED, start, strict=True)]
            motion = tracked((was[0], was[1], was[2]), self.sampling.reading(y), self.sampling.bandwidth, period)
            after |= dict(zip(_TRACKED, motion, strict=True))
        path = course(wrap(a.reference(self.signal).value), _T)
        computed = self._computed(a.system, path, called)
        rates = {s.name: computed[f"rate.{s.name}"] for s in self._remembered}
        slopes = {n: derivative(rate, symbol(self.name_of(n))) for n, rate in rates.items()}
        states = {n: wrap(where(first, START[n], memory[f"next_{n}"])) for n in rates}
        known = dict(
            zip((y, v, *pressures, _ACCELERATION), map(wrap, (*motion[:2], *pressures, motion[2])), strict=True)
        )
        known |= {symbol(self.name_of(n)): x for n, x in states.items()}
        every = [*(computed[n] for n in ("u", *_HELD)), *rates.values(), *slopes.values()]
        u, F_hat, p_d, z_hat, *moved = substitute(every, known, called)
        after |= {"F_hat": F_hat, "p_d": p_d, **states, "z_hat": z_hat}
        for (name, x), rate, slope in zip(states.items(), moved[: len(states)], moved[len(states) :], strict=True):
            after[f"next_{name}"] = x + period * phi_1(slope * period) * rate
        extreme = where(first, u, memory["extreme"])
        turns = turned(u, extreme, memory["way"], memory[_SWINGS], _SWING * self.u_max)
        after |= dict(zip((*_TURNS, _SWINGS), turns, strict=True))
        name = self.name or "cascade"
        return Sample(name, f"{self.path}.sampling", u, {self.name_of(n, "_"): wrap(after[n]) for n in memory})

    @property
    def _c(self) -> SimpleNamespace:
        return SimpleNamespace(**self.gains)

    def _memory(self, name: str) -> Expr:
        return symbol(f"memory.{self.name_of(name, '_')}")

    def _now(self, state: str) -> Expr:
        """A state of the controller's: an integrated one, or what a sampled controller shows of it."""
        return self._memory(state) if self.sampling is not None else symbol(self.name_of(state))

    def _acceleration(self, body: Piston, p: SimpleNamespace, F: Expr) -> Expr:
        """What it measures of the motion's change, which does not depend on the valve at the same instant."""
        return wrap(Cylinder.acceleration(p, 0.0, F, body.pressures))

    def _computed(self, m: Elements, path: Course, called: Names | None = None) -> dict[str, Expr]:
        """Eqs 12 to 15 as expressions of what is measured and of the controller's states (``rate.NAME``: their rates).

        dp_d/dt is the total derivative of p_d along the rates: of time, of the motion, and of the states themselves.
        """
        body, c, model = m.bodies[self.on], self._c, self.model
        assert isinstance(body, Piston)
        y, v, (p_1, p_2) = symbol(body.name_of("y")), symbol(body.name_of("v")), body.pressures
        e, s = tracking_errors(c, path, y, v)
        estimate = self._observed(c, v, s, called)
        p_d = desired_pressure(c, model, path, v, s, estimate.F)
        rates = {n: wrap(rate) for n, rate in estimate.rates.items()}
        along = {_T: ONE, y: v, v: _ACCELERATION, **{symbol(self.name_of(n)): rate for n, rate in rates.items()}}
        p_err = p_1 - p_2 - p_d
        dp_d = total_derivative(wrap(p_d), along)
        u_hat = pressure_demand(c, model, y, v, p_1, p_2, s, p_err, dp_d)
        u = Cylinder.voltage(model, y, p_1, p_2, u_hat, c.u_max)
        named = {"e": e, "s": s, "p_d": p_d, "p_err": p_err, "u": u, "F_hat": estimate.F, "z_hat": estimate.z}
        return {n: wrap(x) for n, x in named.items()} | {f"rate.{n}": rate for n, rate in rates.items()}

    def _observed(self, c: SimpleNamespace, v: Expr, s: Value, called: Names | None) -> Observed:
        x: dict[str, Value] = {state.name: symbol(self.name_of(state.name)) for state in self._remembered}
        if self.observer is None:
            return observe(None, SimpleNamespace(), c.K, v, s, x)
        kind, p = self.observer.kind, self.observer.p if called is None else self.observer.with_named_terms(called.term)
        return adapt(kind, p, self.adaptation, c.K, v, s, x) if self.adaptive else observe(kind, p, c.K, v, s, x)  # type: ignore[arg-type]

    def _lyapunov(self, a: Assembly, body: Piston, mass: Value, s: Value, p_err: Value) -> Value:
        """V along the loop: with the plant's own mass and deflection, and the errors of adapted parameters."""
        contact = _contact_on(body.name, a.system.contacts)
        assert contact is not None
        z_err: Value = self._now("z_hat") - a.k[contact.name_of("z")] if self._bristles and contact.has_z else 0.0
        off_parameters: Value = 0.0
        if self.adaptive:
            g, o, q = self.adaptation, self.observer.p, contact.friction.p
            true = {
                "a_0": q.sigma_0 / o.sigma_0, "a_1": q.sigma_1 / o.sigma_1, "a_2": q.sigma_2 / o.sigma_2,
                "a_g": (o.F_c / o.sigma_0) / (q.F_c / q.sigma_0),
            }  # fmt: skip
            off = {n: self._now(n) - value for n, value in true.items()}
            gains = {"a_0": g.gamma_0, "a_1": g.gamma_1, "a_2": g.gamma_2, "a_g": g.gamma_g}
            # a parameter that is not adapted has no part in V
            off_parameters = sum(where(gains[n] > 0, off[n] ** 2 / gains[n], 0.0) for n in off) / 2
            z_err = (z_err - self._now("eta") * off["a_g"]) * sqrt(true["a_0"])
        return energy(self._c, mass, s, p_err, z_err) + off_parameters

    # -- what is wrong with it -----------------------------------------------------------------------------------------

    def wiring(self, m: Draft) -> list[tuple[Loc, str]]:
        """Problems of its place, and contradictions in its table."""
        body, problems = m.machine.bodies.get(self.on), list[tuple[Loc, str]]()
        before = next(x.name for x in m.machine.controllers.values() if x.moves_valve and x.on == self.on)
        if body is None and self.on in m.names["bodies"]:
            return []  # that body has problems of its own
        if not isinstance(body, Piston):
            return [
                (("on",), f"{show(self.on)}: must be a body with kind = 'pneumatic', whose valve this controller moves")
            ]
        if before != self.name:
            text = f"must be another body: {table_path('controllers', before)} drives it already"
            problems.append((("on",), f"{show(self.on)}: {text}"))
        keys = [key for key in ("delay", "noise", "quantization", "bandwidth") if getattr(self, key)]
        if self.sample_time is None:
            sample_time = f"{m.reading.to_file(self.path)}.sample_time"
            text = f"needs {sample_time}: without it the controller is continuous and measures exactly"
            problems += [((key,), f"{show(getattr(self, key))}: {text}") for key in keys]
        elif (self.noise or self.quantization) and self.bandwidth is None:
            text = "missing: must be given with noise or quantization (rad/s; of the filter that estimates v and dv/dt)"
            problems.append((("bandwidth",), text))
        if self.adaptive and self.observer is not ... and (reason := _not_adaptable(self.observer_law)):
            problems.append((("adaptive",), f"true: {reason}"))
        if _contact_on(self.on, m.machine.contacts) is None and not (problems or m.problems):
            text = f"{show(self.on)}: must have a contact with the ground, whose friction the cascade knows"
            problems.append((("on",), text))
        return problems

    def until(self, m: Elements, t_end: float) -> list[Problem]:
        """The time between samples, and the path."""
        problems, period, piston = (
            list[Problem](),
            t_end if self.sample_time is None else self.sample_time,
            m.bodies.get(self.on),
        )
        if period < t_end / _MOST_INSTANTS:
            text = f"must be at least solve.t_end/{_MOST_INSTANTS:g} ({t_end / _MOST_INSTANTS:g} s)"
            problems.append((f"{self.path}.sample_time", f"{show(period)}: {text}"))
        law = _law_on(self.on, m.contacts)
        if law is None or not isinstance(piston, Piston):
            return problems
        return problems + self._path_problems(piston, law, self.signal.built, t_end)

    def _path_problems(self, p: Piston, law: Law, signal: Signal, t_end: float) -> list[Problem]:
        """Where the path cannot be followed, whatever the gains."""
        room, signal_path = p.supply_pressure - p.atmospheric_pressure, f"{self.path}.signal"
        if not signal.smooth:
            text = f"{show(signal.kind)}: has no three derivatives, which the controller needs"
            return [(f"{signal_path}.kind", f"{text}; must be one of sine, point_to_point, spline")]
        t, (y, v, a) = _path_of(signal, t_end)
        outside = np.flatnonzero((y < 0) | (y > p.stroke))
        if outside.size:
            i = int(outside[0])
            place = f"the path reaches y = {y[i]:.6g} m at t = {t[i]:.4g} s"
            return [(signal_path, f"{place}: must stay within the stroke, 0 to {p.stroke:g} m")]
        friction = law.steady_force(v)
        if "F_s" in law.machine:  # lugre_arctan's steady force grows without limit as v -> 0, which no motion waits for
            most = law.machine["F_s"] + law.machine.get("sigma_2", 0.0) * abs(v)
            friction = np.clip(friction, -most, most)
        needed = abs(p.mass * a + friction) / p.area
        i = int(np.argmax(needed))
        if needed[i] <= room:
            return []
        text = f"the path needs a pressure difference of {needed[i]:.4g} Pa at t = {t[i]:.4g} s"
        text += f", and {room:.4g} Pa above the atmosphere are available; must be higher, or the path slower"
        return [(f"{p.path}.supply_pressure", f"{show(p.supply_pressure)}: {text}")]

    # -- remarks on a run ----------------------------------------------------------------------------------------------

    def remarks(self, rows: Courses, end: float) -> list[str]:
        """Where the valve is at its limit to the end, or goes to and fro."""
        return [text for text in (self._limited(rows), self._swinging(rows, end)) if text]

    def _limited(self, rows: Courses) -> str:
        """That the valve ends at its limit, when it has been there for a tenth of the run."""
        free = np.flatnonzero(np.abs(rows[self.name_of("u")]) < self.u_max * (1 - 1e-9))
        first = free[-1] + 1 if len(free) else 0
        if len(rows.t) - first <= 0.1 * len(rows.t):
            return ""
        since = f"from t = {rows.t[first]:.4g} s to the end"
        return f"the valve is at its limit of {self.u_max:g} V {since}: it saturates"

    def _swinging(self, rows: Courses, end: float) -> str:
        """That the valve of a sampled controller goes to and fro to the end far more often than the path."""
        if self.sampling is None:
            return ""
        late = rows.held[self.name_of(_SWINGS, "_")][rows.t >= 0.75 * end]
        swings = int(late[-1] - late[0]) if len(late) else 0
        waves = 0.25 * end / (8 * self.signal.built.longest_step)
        if swings <= max(_MOST_SWINGS, 6 * waves):
            return ""
        swing = _SWING * self.u_max
        text = f"the valve swings {swings} times by more than {swing:g} V in the last quarter of the run"
        return f"{text}: sample_time, delay or noise are too large for these gains"


def _path_of(signal: Signal, t_end: float) -> tuple[Array, tuple[Array, ...]]:
    """The path and its two derivatives, at times close enough to see every wave and at every point."""
    waves = t_end / signal.longest_step if np.isfinite(signal.longest_step) else 0.0
    t = np.linspace(0, t_end, int(min(max(_SAMPLES, 16 * waves), 200_000)))
    t = np.union1d(t, [start for start, _ in signal.pieces if 0 <= start <= t_end])
    values = signal.values_at(t)
    kind: object = type(signal)
    derivatives = _course_of(kind, tuple(values))(t, *values.values())
    return t, tuple(np.broadcast_to(np.asarray(x, float), t.shape) for x in derivatives)


@lru_cache(maxsize=32)
def _course_of(kind: object, names: tuple[str, ...]) -> Callable[..., tuple[Array, ...]]:
    """The path and its derivatives as a function of t and the signal's constants."""
    assert isinstance(kind, type)
    assert issubclass(kind, Signal)
    constants = SimpleNamespace(**{n: symbol(f"signal.{n}") for n in names})
    return python_function(("t", *(f"signal.{n}" for n in names)), course(wrap(kind.equation(constants, _T)), _T))

"""Controllers: from a signal and what is measured to a force, or to the torque that a motor is asked for."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from types import SimpleNamespace
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, Protocol

from pydantic import Field

from stribeck.arrays import Array
from stribeck.constants import Column, show
from stribeck.expressions.graph import ZERO, Expr, derivative, symbol, wrap
from stribeck.expressions.names import Names
from stribeck.expressions.ops import Value, both, clip, sign, where
from stribeck.laws.base import Scales
from stribeck.machine.element import NONE, Element, Own, State, force_unit
from stribeck.machine.elements.dither import PHASE, WAVES_A_STEP, Dither
from stribeck.machine.elements.sampling import Sampling
from stribeck.machine.equations import Events, Sample
from stribeck.machine.friction import compensation
from stribeck.machine.law import CompensatedLaw, Friction
from stribeck.machine.observed import observed
from stribeck.machine.signal import SignalTable
from stribeck.machine.table import (
    Carrier,
    ConstantLeaf,
    FileTable,
    Held,
    Loc,
    Problem,
    Refers,
    joined,
    quantity,
    table_path,
)
from stribeck.waveforms.pieces import Reference

if TYPE_CHECKING:
    from stribeck.machine.assembly import Assembly
    from stribeck.machine.elements.bodies.cylinder import Piston
    from stribeck.machine.machine import Elements
    from stribeck.machine.reading import Draft

AT_LIMIT = (
    1 - 1e-6
)  # what counts as at a limit: along it an integral slides, which rounding would else make many events
LAYER = 1e-7  # share of a limit over which an integral fades out, so that it slides along the limit
_SAMPLES = 1e8  # in a run
LIMIT: Events = ("limit_reached", "limit_left", "limit_reached", "limit_left")
_T = symbol("t")
Rates = dict[str, Expr]


class Feedforward(FileTable):
    """A feedforward, added to a controller's output."""

    inertia: float = quantity("kg", "force per second derivative of the signal", rotary_unit="kg m^2")


class Compensation(FileTable):
    """Friction compensation of a controller: a law's steady force at the reference's speed, or an observer."""

    contact: Annotated[str | None, Refers(("contacts",))] = Field(None, description="the contact whose friction it is")
    speed: Literal["reference", "measured"] = Field(description="speed for the law: reference or measured")
    law: CompensatedLaw = Field(None, description="the law, if it is not the contact's")
    share: float | None = quantity(
        "", "share of the law's force that the controller adds; 1 unless given", at_least=0, optional=True
    )
    lead: float | None = quantity("s", "time constant of the inner loop: lead dF/dt is added", above=0, optional=True)

    def leaves(self, path: str) -> Iterator[ConstantLeaf]:
        """Those of its law first."""
        if self.law is not None:
            yield from self.law.leaves(joined(path, "law"))
        yield from (leaf for leaf in super().leaves(path) if leaf.key[0] == path)

    def wrong(self) -> list[Problem]:
        """Nothing that it could know friction by."""
        known = self.contact is not None or "law" in self.model_fields_set
        return [] if known else [("contact", "missing: must be given (a contact, or else a law)")]

    def friction(self, m: Elements) -> Friction:
        """The law: its own, or that of the contact, whose constants it then shares."""
        return self.law if self.law is not None else m.contacts[str(self.contact)].friction

    def observes(self, m: Elements) -> bool:
        """Whether a deflection of its own is followed."""
        return self.speed == "measured" and self.friction(m).kind.has_z

    def force(
        self, m: Elements, r: Reference, v: Expr, z: Expr, called: Names, exact: bool
    ) -> tuple[Expr, Expr | None]:
        """Its force, and the rate of the observer's deflection."""
        force, rate = compensation(self.friction(m), self.speed, r, v, z, called, exact, self.lead)  # type: ignore[arg-type]
        return (self.share * force if self.share is not None else force), rate


class Courses(Protocol):
    """The rows of a solution, for remarks."""

    @property
    def t(self) -> Array:
        """The times, s."""

    @property
    def held(self) -> Mapping[str, Array]:
        """The held values of controllers at these times."""

    def __getitem__(self, name: str, /) -> Array:
        """A column."""


class AnyController(Element, family=True):
    """The base of controllers of a force and of controllers of a valve."""

    section, positional = "controllers", ("name",)
    moves_valve: ClassVar[bool] = False
    if TYPE_CHECKING:  # each kind says what they may be
        on: str
        measures: str | None
        signal: Held
        sampling: Held

    def memory(self, m: Elements) -> tuple[str, ...]:
        """The memory of a sampled controller."""
        raise NotImplementedError

    def valve(self, a: Assembly, body: Piston, p: SimpleNamespace, F: Expr) -> tuple[SimpleNamespace, Expr]:
        """Of one that moves a valve: the plant as its supply feeds it, and the voltage of the valve."""
        raise NotImplementedError

    def shown(self) -> tuple[str, ...]:
        """The entries of its memory that an output needs: the first ones."""
        return ()

    def sample(self, a: Assembly) -> Sample:
        """The update of a sampled controller at its instants."""
        raise NotImplementedError

    def longest_step(self) -> Value:
        """The longest step of the solver that cannot miss a wave of it, s."""
        return float("inf")

    def remarks(self, rows: Courses, end: float) -> list[str]:
        """Remarks on a run, from the rows of its solution."""
        return []


class Controller(AnyController, for_users=True):
    """A controller: its unlimited output from the reference, the measured motion and its own states.

    A controller of your own overrides ``output`` (and ``rates``, with ``states``). The limit, the stop of its integrals at
    the limit, the feedforward, the friction compensation, the dither and the sampling are common to all.
    """

    integrals: ClassVar[tuple[str, ...]] = ()  # the states that stop where the limit is exceeded
    on: Annotated[str, Refers(("motors", "bodies"))] = Field(description="a motor or a body")
    measures: Annotated[str | None, Refers(("bodies",))] = Field(None, description="the body that carries the encoder")
    signal: SignalTable = Field(description="the signal: a table with kind and its constants")
    feedforward: Feedforward | None = Field(None, description="added to the output")
    compensation: Compensation | None = Field(None, description="friction compensation")
    sampling: Sampling | None = Field(None, description="sampling of the controller; continuous unless given")
    dither: Dither | None = Field(None, description="a fast oscillation, added to the output")
    limit: float | None = quantity("N", "limit of the output", above=0, optional=True, rotary_unit="N m")

    @classmethod
    def pid(cls, name: str, **keys: Any) -> Pid:
        """u = -K_p (y - r) - K_i I - K_d v."""
        return Pid(name=name, **keys)

    @classmethod
    def cascade(cls, name: str, **keys: Any) -> Cascade:
        """v_r = K_p (r - y) + dr/dt, u = K_v (v_r - v) + (K_v/T_i) I."""
        return Cascade(name=name, **keys)

    def output(self, r: Reference, y: Value, v: Value, x: Own) -> Value:
        """The output without its limit, N or N m."""
        raise NotImplementedError

    def rates(self, r: Reference, y: Value, v: Value, x: Own) -> Own:
        """The time derivatives of its states."""
        return NONE

    def scales(self, length: Value, force: Value) -> Own:
        """Natural magnitudes of its states."""
        return NONE

    def whole(self) -> bool:
        """Whether the law of its compensation has been read."""
        c = self.compensation
        return c is None or c.law is not None or "law" not in c.model_fields_set

    # -- what is common to all -------------------------------------------------------------------------------------

    @property
    def body(self) -> str:
        """The body that carries the encoder; a whole machine says it where the file leaves it out."""
        assert self.measures is not None
        return self.measures

    @property
    def friction_path(self) -> str:
        """The table of the law that its compensation takes: its own, or the contact's."""
        c = self.compensation
        assert c is not None
        return f"{table_path('contacts', str(c.contact))}.law" if c.law is None else f"{self.path}.compensation.law"

    def form_states(self) -> tuple[State, ...]:
        """Its own states in this form of its equations."""
        return self.states

    def all_states(self, m: Elements) -> tuple[str, ...]:
        """Its own states, and its observer's."""
        observes = self.compensation is not None and self.compensation.observes(m)
        return (*(s.name for s in self.form_states()), *(("z_hat",) if observes else ()))

    def own_states(self, m: Elements) -> tuple[State, ...]:
        """Those that are integrated: none of a sampled controller."""
        names = self.all_states(m) if self.sampling is None else ()
        return tuple(State(n, "", f"{n} of the controller") for n in names)

    def carrying(self, path: str, carrier: Carrier) -> Held:
        """A signal whose direction matters is cut where it turns."""
        carried = super().carrying(path, carrier)
        if carrier.structure and self.compensation is not None and self.compensation.speed == "reference":
            return carried.model_copy(update={"signal": replace(carried.signal, turns=True)})
        return carried

    def unlimited(
        self, m: Elements, r: Reference, y: Value, v: Expr, x: Rates, called: Names, exact: bool, shaken: Expr
    ) -> tuple[Expr, Rates]:  # fmt: skip
        """The output without its limit, its dither's force ``shaken`` among it, and the rates of its states."""
        u = wrap(self.output(r, y, v, x))
        rates = {n: wrap(rate) for n, rate in self.rates(r, y, v, x).items()}
        if self.feedforward is not None:
            u = u + self.feedforward.inertia * r.second
        if self.compensation is not None:
            force, rate = self.compensation.force(m, r, v, x.get("z_hat", ZERO), called, exact)
            u = u + force
            rates |= {"z_hat": rate} if rate is not None and "z_hat" in x else {}
        return wrap(u + shaken), rates

    def limited(self, u: Expr) -> Expr:
        """The output within its limit."""
        return u if self.limit is None else wrap(clip(u, -self.limit, self.limit))

    def held_at_limit(self, u: Expr, rates: Rates, x: Rates, layer: float) -> Rates:
        """The rates, with anti-windup: an integral is held if it would increase an exceeded limit.

        With a ``layer``, they fade out over this share of the limit.
        """
        if self.limit is None:
            return rates
        held = dict(rates)
        for name in (n for n in self.integrals if n in rates):
            further = derivative(u, x[name]) * rates[name] * u > 0
            over = abs(u) - self.limit
            share = clip(1 - over / (layer * self.limit), 0.0, 1.0) if layer else 0.0
            held[name] = wrap(where(both(over > 0, further), rates[name] * share, rates[name]))
        return held

    def equations(self, a: Assembly) -> None:
        """Act on a body; a motor takes its current from the output."""
        r = a.reference(self.signal)
        a.k[self.name_of("r")] = wrap(r.value)
        u = symbol(f"segment.{self.name_of('u', '_')}") if self.sampling is not None else self._continuous(a, r)
        a.show(self.name_of("u"), u)
        if self.on in a.system.bodies:
            a.push(self.on, u)
            a.power_in = a.power_in + u * a.motion(self.on)[1]

    def _continuous(self, a: Assembly, r: Reference) -> Expr:
        y, v = a.motion(self.body)
        x = {n: a.state(self, n) for n in self.all_states(a.system)}
        shaken = ZERO if self.dither is None else self.dither.force(self.dither.frequency * _T)
        raw, rates = self.unlimited(a.system, r, y, v, x, a.called, a.exact, shaken)
        a.unlimited[self.name] = raw
        a.rates |= {self.name_of(n): rate for n, rate in self.held_at_limit(raw, rates, x, LAYER).items()}
        return self.limited(raw)

    # -- samples -----------------------------------------------------------------------------------------------------

    def memory(self, m: Elements) -> tuple[str, ...]:
        """The memory of a sampled controller: the number of readings, its last reading, its filter, its states, its dither's
        phase."""
        assert self.sampling is not None
        return ("readings", *self.sampling.memory, *self.all_states(m), *([PHASE] if self.dither is not None else []))

    def sample(self, a: Assembly) -> Sample:
        """Its update at its instants."""
        assert self.sampling is not None
        y = wrap(self.sampling.reading(a.motion(self.body)[0]))
        a.called[y] = self.name_of("reading", "_")
        m = {n: symbol(f"memory.{self.name_of(n, '_')}") for n in self.memory(a.system)}
        u, after = self.stepped(a.system, y, a.reference(self.signal), m, a.called)
        return Sample(self.name, f"{self.path}.sampling", u, {self.name_of(n, "_"): after[n] for n in m})

    def stepped(self, m: Elements, y: Expr, r: Reference, memory: Rates, called: Names) -> tuple[Expr, Rates]:
        """One sample of a controller that reads ``y`` and is asked for ``r``: its output, and what it remembers after it.
        The simulation, the exports and their tests all take it from here."""
        s = self.sampling
        assert s is not None
        after: Rates = {"readings": memory["readings"] + 1}
        v, estimator = s.speed(memory["readings"] <= 0, y, memory)
        after |= estimator
        called[v] = self.name_of("speed", "_")
        x = {n: memory[n] for n in self.all_states(m)}
        r = replace(r, direction=sign(r.rate))  # all that a controller knows of it, and what its export has
        shaken = wrap(0.0)
        if self.dither is not None:
            shaken = self.dither.force(memory[PHASE])
            after[PHASE] = self.dither.next_phase(memory[PHASE], s.period)
        raw, rates = self.unlimited(m, r, y, v, x, called, True, shaken)
        for name, rate in self.held_at_limit(raw, rates, x, 0.0).items():
            if name == "z_hat" and self.compensation is not None:
                law = self.compensation.friction(m)
                after[name] = observed(law, rate, x[name], v, s.period, called)  # type: ignore[arg-type]
            else:
                after[name] = x[name] + s.period * rate
        return wrap(self.limited(raw)), {n: wrap(x) for n, x in after.items()}

    # -- events, steps, columns ---------------------------------------------------------------------------------------

    def watches(self, a: Assembly) -> tuple[Events, Expr] | None:
        """The limit of a continuous controller."""
        return None if self.sampling is not None or self.limit is None else (LIMIT, a.unlimited[self.name])

    def longest_step(self) -> Value:
        """A share of a wave of a continuous controller's dither."""
        continuous = self.dither is not None and self.sampling is None
        return WAVES_A_STEP / self.dither.frequency if continuous and self.dither else float("inf")

    def level(self) -> Value:
        """Nearly the limit."""
        return self.limit * AT_LIMIT if self.limit is not None and self.sampling is None else None

    def natural(self, scales: Mapping[str, Scales], m: Elements) -> dict[str, Value]:
        """See :meth:`scales`; a length where a controller of a user's says nothing."""
        body_scales = scales[self.body]
        sizes = self.scales(body_scales.length, body_scales.force)
        natural = {self.name_of(s.name): sizes.get(s.name, body_scales.length) for s in self.form_states()}
        if self.compensation is not None:
            natural[self.name_of("z_hat")] = self.compensation.friction(m).scales().length
        return natural

    def turning(self, m: Elements) -> bool:
        """As the body that it measures."""
        return m.bodies[self.body].turns

    def columns(self, m: Elements) -> list[Column]:
        """Reference and output."""
        turns = self.turning(m)
        return [
            Column(self.name_of("r"), "rad" if turns else "m", "reference"),
            Column(self.name_of("u"), force_unit(turns), "output of the controller"),
        ]

    def heading(self, m: Elements) -> str:
        """See :class:`Element`."""
        how = "sampled" if self.sampling else "continuous"
        return f"Controller {self.name}: {self.kind}, {how}, on {self.on}, measures {self.measures}."

    def wrong(self) -> list[Problem]:
        """A dither that the sampling cannot follow; a signal that feedforward, or a lead, cannot take."""
        problems: list[Problem] = []
        if self.dither is not None:
            d, s = self.dither, self.sampling
            if s is None and d.kind == "square":
                text = "'square': a continuous controller's must be 'sine'; square needs sampling"
                problems.append(("dither.kind", text))
            if s is not None and d.frequency > (most := 0.5 / s.period):
                problems.append(
                    ("dither.frequency", f"{d.frequency:g}: must be at most {most:g}, half of the sampling's rate")
                )
        led = self.compensation is not None and self.compensation.lead is not None
        signal = self.signal.built
        if (led or self.feedforward is not None) and not signal.smooth and signal.kind != "ramp":
            what = "compensation.lead" if self.feedforward is None else "feedforward"
            text = f"has no second derivative, which {what} needs: must be sine, point_to_point or spline"
            problems.append(("signal.kind", f"{show(signal.kind)}: {text}"))
        return problems

    def until(self, m: Elements, t_end: float) -> list[Problem]:
        """Too many samples."""
        if self.sampling is None or t_end / self.sampling.period <= _SAMPLES:
            return []
        text = f"more than {_SAMPLES:g} samples until solve.t_end = {t_end:g} s; must be larger"
        return [(f"{self.path}.sampling.period", f"{self.sampling.period:g}: {text}")]

    def wiring(self, m: Draft) -> list[tuple[Loc, str]]:
        """A second controller on one thing; a law that cannot be led."""
        problems = m.not_on_driven(self.on)
        before = [x.name for x in m.machine.controllers.values() if x.on == self.on and not x.moves_valve]
        if before[0] != self.name:
            what = "motor" if self.on in m.machine.motors else "body"
            text = f"{show(self.on)}: must be another {what}: controllers.{before[0]} drives it already"
            problems.append((("on",), text))
        c = self.compensation
        if c is None:
            return problems
        contact = m.machine.contacts.get(str(c.contact))
        motor = m.machine.motors.get(str(self.on))
        bodies = m.machine.bodies
        driven = bodies.get(str(self.on if motor is None else motor.on))
        rubs = None if contact is None else bodies.get(contact.start)
        if driven is not None and rubs is not None and rubs.turns != driven.turns:
            has, wanted = (force_unit(each.turns) for each in (rubs, driven))
            text = f"{show(c.contact)}: its friction is in {has}, and {self.on} is driven in {wanted}"
            problems.append((("compensation", "contact"), f"{text}; must be a contact in {wanted}, or give a law"))
        if c.lead is None:
            return problems
        friction = c.law or (contact.law if contact is not None else None)
        if friction is not None and friction.law is not None and not friction.law.differentiable:
            text = f"law '{friction.law.name}' has no dF/dt; must be left out, or the law a smooth one"
            problems.append((("compensation", "lead"), f"{c.lead:g}: {text}"))
        return problems


class Pid(Controller):
    """u = -K_p (y - r) - K_i I - K_d v, dI/dt = y - r."""

    kind: Literal["pid"] = "pid"
    K_p: float = quantity("N/m", "proportional gain", rotary_unit="N m/rad")
    K_i: float = quantity("N/(m s)", "integral gain", default=0.0, rotary_unit="N m/(rad s)")
    K_d: float = quantity("N s/m", "derivative gain", default=0.0, rotary_unit="N m s/rad")
    states = (State("I", "m s", "integral of y - r"),)
    integrals = ("I",)

    def output(self, r: Reference, y: Value, v: Value, x: Own) -> Value:
        """-K_p (y - r) - K_i I - K_d v."""
        return -self.K_p * (y - r.value) - self.K_i * x["I"] - self.K_d * v

    def rates(self, r: Reference, y: Value, v: Value, x: Own) -> Own:
        """dI/dt."""
        return {"I": y - r.value}

    def scales(self, length: Value, force: Value) -> Own:
        """The integral that makes the friction force, or a length for a second."""
        gain = abs(self.K_i)
        return {"I": where(gain > 0, force / where(gain > 0, gain, 1.0), length)}


class Cascade(Controller):
    """Position over speed: v_r = K_p (r - y) + dr/dt, u = K_v (v_r - v) + (K_v/T_i) I, dI/dt = v_r - v."""

    kind: Literal["cascade"] = "cascade"
    K_p: float = quantity("1/s", "gain of the position loop")
    K_v: float = quantity("N s/m", "gain of the speed loop", rotary_unit="N m s/rad")
    T_i: float | None = quantity("s", "integral time of the speed loop", above=0, optional=True)
    states = (State("I", "m", "integral of the speed's error"),)
    integrals = ("I",)

    def form_states(self) -> tuple[State, ...]:
        """Without T_i there is no integral."""
        return self.states if self.T_i is not None else ()

    def _error(self, r: Reference, y: Value, v: Value) -> Value:
        return self.K_p * (r.value - y) + r.rate - v

    def output(self, r: Reference, y: Value, v: Value, x: Own) -> Value:
        """K_v (v_r - v) + (K_v/T_i) I."""
        u = self.K_v * self._error(r, y, v)
        return u if self.T_i is None else u + self.K_v / self.T_i * x["I"]

    def rates(self, r: Reference, y: Value, v: Value, x: Own) -> Own:
        """dI/dt."""
        return NONE if self.T_i is None else {"I": self._error(r, y, v)}

    def scales(self, length: Value, force: Value) -> Own:
        """The integral that makes the friction force, or a length."""
        gain = abs(self.K_v)
        return (
            NONE if self.T_i is None else {"I": where(gain > 0, force * self.T_i / where(gain > 0, gain, 1.0), length)}
        )

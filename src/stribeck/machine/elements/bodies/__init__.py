"""Bodies: one coordinate each."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from inspect import get_annotations
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import BeforeValidator, Field, create_model

from stribeck.constants import Column, Constant, show
from stribeck.expressions.graph import Expr, symbol, wrap
from stribeck.expressions.ops import Value, where
from stribeck.laws.base import Scales
from stribeck.machine.element import NONE, Element, Own, State, ratio_constant
from stribeck.machine.signal import SignalTable
from stribeck.machine.table import Aside, FileTable, Loc, Problem, Refers, quantity

if TYPE_CHECKING:
    from stribeck.machine.assembly import Assembly
    from stribeck.machine.machine import Elements
    from stribeck.machine.reading import Draft


MASS = Constant("kg", "mass of the body", above=0, rotary_unit="kg m^2")


def sum_of_forces(u: Value, F: Value) -> Value:
    """The net force on a body, N: the force u minus the friction force F."""
    return u - F


class Initial(FileTable):
    """Where a body starts."""

    y: float = quantity("m or rad", "position at t = 0", default=0.0)
    v: float = quantity("m/s or rad/s", "velocity at t = 0", default=0.0)


class Velocity(FileTable):
    """A velocity that is given."""

    signal: SignalTable = Field(description="the velocity: a table with kind and its constants, m/s or rad/s")


def _velocity(value: object) -> object:
    return Velocity(signal=value) if isinstance(value, SignalTable) else value


class Body(Element, family=True):
    """A body: ``mass`` (kg) moves straight, ``inertia`` (kg m^2) turns; one whose ``velocity`` is given obeys no force.

    A body of your own derives from this class and declares its constants and ``states``. It overrides ``acceleration``,
    ``rates``, ``stored_energy`` and ``lost_power``, and other equations that differ.
    """

    section, plain = "bodies", "body"
    kind: str = Field("body", exclude=True)
    mass: float | None = quantity("kg", "mass of a body that moves straight", above=0, optional=True)
    inertia: float | None = quantity("kg m^2", "moment of inertia of a body that turns", above=0, optional=True)
    initial: Annotated[Initial | None, Aside()] = Field(None, description="the state at t = 0")
    tied_to: Annotated[str | None, Refers(("bodies",))] = Field(
        None, description="the body to which it is tied rigidly"
    )
    ratio: float | None = ratio_constant("motion per motion of the body that it is tied to; 1 unless given")
    velocity: Annotated[Velocity | None, BeforeValidator(_velocity)] = Field(
        None, description="the prescribed velocity, on which no force acts"
    )
    rotary: bool | None = Field(None, description="whether a body with prescribed velocity turns")

    def __init_subclass__(cls, **more: Any) -> None:
        """Let the table ``initial`` of a class with states of its own also hold these states."""
        super().__init_subclass__(**more)
        own = get_annotations(cls)
        if "states" in vars(cls) and "initial" not in own:
            starts: dict[str, Any] = {
                s.name: (float, quantity(s.unit, f"{s.meaning} at t = 0", default=s.start)) for s in cls.states
            }
            table = create_model(f"{cls.__name__}Initial", __base__=Initial, **starts)
            cls.__annotations__ = {**own, "initial": Annotated[table | None, Aside()]}
            cls.initial = Field(None, description="the state at t = 0")

    @property
    def turns(self) -> bool:
        """Whether it turns: rad and N m."""
        return self.inertia is not None or self.rotary is True

    @property
    def heavy(self) -> Value:
        """Mass, or moment of inertia; None where none is given."""
        return self.inertia if self.mass is None else self.mass

    @property
    def free(self) -> bool:
        """Whether it has a coordinate of its own and obeys forces."""
        return self.tied_to is None and self.velocity is None

    def wrong(self) -> list[Problem]:
        """Contradictions in the table."""
        problems: list[Problem] = []
        given = [n for n in ("mass", "inertia") if getattr(self, n) is not None]
        if self.velocity is not None:
            why = "must be left out: the velocity of this body is given"
            more = [n for n in (*given, "tied_to", "ratio") if getattr(self, n) is not None]
            problems += [(n, f"{show(getattr(self, n))}: {why}") for n in more]
            if self.initial is not None and "v" in self.initial.model_fields_set:
                problems.append(("initial.v", f"{show(self.initial.v)}: {why}"))
            return problems
        if self.rotary is not None:
            text = "must be left out: mass (kg) or inertia (kg m^2) says whether the body turns"
            problems.append(("rotary", f"{show(self.rotary)}: {text}"))
        if len(given) == 2:
            text = "must be left out where mass is given: a body moves straight (mass, kg) or turns (inertia, kg m^2)"
            problems.append(("inertia", f"{show(self.inertia)}: {text}"))
        if not given:
            problems.append(("mass", "missing: must be given (mass in kg, or inertia in kg m^2 for a body that turns)"))
        if self.tied_to is None and self.ratio is not None:
            problems.append(("ratio", f"{show(self.ratio)}: needs tied_to: it says how far the body moves by another"))
        if self.tied_to is not None and self.initial is not None:
            text = "must be left out: a body that is tied to another has no state of its own"
            problems.append(("initial", f"{show(dict(self.initial))}: {text}"))
        return problems

    # -- its equations -------------------------------------------------------------------------------------------------

    def acceleration(self, force: Value, inertia: Value, x: Own = NONE) -> Value:
        """dv/dt in m/s^2 (rad/s^2) under the force on the body, friction included, N (N m).

        ``inertia`` is that of the body and of all that is tied to it."""
        return force / inertia

    def rates(self, y: Value, v: Value, acceleration: Value, x: Own) -> Own:
        """The time derivatives of its own states, beside y and v."""
        return NONE

    def stored_energy(self, y: Value, v: Value, inertia: Value, x: Own = NONE) -> Value:
        """Kinetic and potential energy, J."""
        return inertia * v**2 / 2

    def lost_power(self, y: Value, v: Value, x: Own) -> Value:
        """The power dissipated other than by friction, W."""
        return 0.0

    def inside(self, y: Value) -> Value | None:
        """Where the equations hold, as a condition; None: everywhere. The solver stops where they end."""
        return None

    def ended(self, t: float, y: float, v: float) -> str | None:
        """Why the equations ended there, in words."""
        return None

    def state_scales(self, length: Value, speed: Value, force: Value) -> Own:
        """Natural magnitudes of its own states, for the default tolerances: by their units unless overridden."""
        known = {"m": length, "m/s": speed, "N": force}
        return {s.name: known.get(s.unit, 1.0) for s in self.states}

    # -- how it takes part ---------------------------------------------------------------------------------------------

    def own_states(self, m: Elements) -> tuple[State, ...]:
        """Position and velocity, unless it is tied to another or its velocity is given; and what else it has."""
        y, v = self._motion()
        return (y, v, *self._inner()) if self.free else (y,) if self.tied_to is None else ()

    def _inner(self) -> tuple[State, ...]:
        """Its own states beside these, and where they start."""
        states = self.states if self.velocity is None else ()
        return tuple(replace(s, start=getattr(self.initial, s.name, s.start)) for s in states)

    def _motion(self) -> tuple[State, State]:
        length = "rad" if self.turns else "m"
        y, v = (0.0, 0.0) if self.initial is None else (self.initial.y, self.initial.v)
        return State("y", length, "position", y), State("v", f"{length}/s", "velocity", v)

    def columns(self, m: Elements) -> list[Column]:
        """Position and velocity, and its own states."""
        return [Column(self.name_of(s.name), s.unit, s.meaning) for s in (*self._motion(), *self._inner())]

    def equations(self, a: Assembly) -> None:
        """The motion, before anything acts."""
        if self.tied_to is not None:
            leader, ratio = a.system.leader(self.name), a.system.tie(self.name)
            a.k[self.name_of("y")] = ratio * symbol(leader.name_of("y"))
            a.k[self.name_of("v")] = ratio * a.speed(leader)
            return
        a.k[self.name_of("y")], a.k[self.name_of("v")] = symbol(self.name_of("y")), a.speed(self)
        a.k |= {self.name_of(s.name): symbol(self.name_of(s.name)) for s in self._inner()}

    def obey(self, a: Assembly) -> None:
        """The rates, when all forces are known."""
        if self.tied_to is not None:
            return
        v = a.motion(self.name)[1]
        a.rates[self.name_of("y")] = v
        if self.velocity is None:
            self.obey_force(a)
        else:  # what drives it supplies the forces on it
            a.power_in = a.power_in - a.force[self.name] * v

    def obey_force(self, a: Assembly) -> None:
        """The rates under the forces on it, and its energy."""
        (y, v), force, inertia = a.motion(self.name), a.force[self.name], a.inertia[self.name]
        x = {s.name: a.state(self, s.name) for s in self.states}
        acceleration = wrap(self.acceleration(force, inertia, x))
        self.obey_rates(a, acceleration, self.rates(y, v, acceleration, x))
        if a.system.energy:
            a.lost = a.lost + wrap(self.lost_power(y, v, x))
            a.stored = a.stored + wrap(self.stored_energy(y, v, inertia, x))

    def obey_rates(self, a: Assembly, acceleration: Expr, rates: Own) -> None:
        """Take the rates, as far as the equations hold."""
        if (inside := self.inside(a.motion(self.name)[0])) is not None:
            acceleration = wrap(where(inside, acceleration, float("nan")))
        a.rates[self.name_of("v")] = acceleration
        a.rates |= {self.name_of(n): wrap(rate) for n, rate in rates.items()}

    def natural(self, scales: Mapping[str, Scales], m: Elements) -> dict[str, Value]:
        """Those of its contacts."""
        contact_scales = scales[self.name]
        inner = self.state_scales(contact_scales.length, contact_scales.speed, contact_scales.force).items()
        return {
            self.name_of("y"): contact_scales.length,
            self.name_of("v"): contact_scales.speed,
            **{self.name_of(n): x for n, x in inner},
        }

    def wiring(self, m: Draft) -> list[tuple[Loc, str]]:
        """Bodies that are tied in a ring, each ring once."""
        ring, next_body = [self.name], self.tied_to
        while next_body is not None and next_body in m.machine.bodies and next_body not in ring:
            ring.append(next_body)
            next_body = m.machine.bodies[next_body].tied_to
        if next_body != self.name or self.name != min(ring, key=list(m.machine.bodies).index):
            return []
        text = (
            "a body cannot be tied to itself"
            if len(ring) == 1
            else f"tied in a ring: {' -> '.join([*ring, next_body])}"
        )
        return [(("tied_to",), f"{show(self.tied_to)}: {text}")]

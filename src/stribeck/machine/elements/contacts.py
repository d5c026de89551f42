"""Friction between two bodies: a law, the forces that raise its level, and what its parameters are multiplied by."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import inf
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from pydantic import AfterValidator, BeforeValidator, Field

from stribeck import waveforms
from stribeck.constants import Column, Constant, kind_of, show
from stribeck.errors import nearest
from stribeck.expressions.graph import ZERO, Expr, derivative, wrap
from stribeck.expressions.ops import Value, where
from stribeck.laws.base import Law, Scales
from stribeck.laws.values import Constants
from stribeck.machine.element import GROUND, BetweenBodies, BodyName, BodyOrGround, State, force_unit, ratio_constant
from stribeck.machine.elements.waves import same_length, sum_of_waves
from stribeck.machine.equations import SLIP_AND_STICK, Events
from stribeck.machine.law import Friction, FrictionLaw
from stribeck.machine.signal import SignalTable
from stribeck.machine.table import (
    Aside,
    Carrier,
    ConstantLeaf,
    FileTable,
    Frozen,
    Loc,
    Problem,
    Refers,
    problems_at,
    quantity,
    refused,
)

if TYPE_CHECKING:
    from stribeck.machine.assembly import Assembly
    from stribeck.machine.machine import Elements
    from stribeck.machine.reading import Draft

LEVELS = ("F_c", "F_s")
FORCES = ("links", "motors", "loads")


class Weights(Frozen):
    """The names of forces and their weights, which are run-time constants."""

    def leaves(self, path: str) -> Iterator[ConstantLeaf]:
        """See :class:`FileTable`."""
        owner = path.removesuffix(".force")
        return (ConstantLeaf(f"{path}.{n}", (owner, f"weight_{n}"), _WEIGHT, x) for n, x in self.items())

    def carrying(self, path: str, carrier: Carrier) -> Weights:
        """See :class:`FileTable`."""
        owner = path.removesuffix(".force")
        return Weights({n: carrier.put(owner, f"weight_{n}") for n in self})


_WEIGHT = Constant("", "weight of a force in a load")


def _force(value: object) -> object:
    if isinstance(value, dict):
        if not value:
            raise refused("must be a table that is not empty", value)
        wrong: list[tuple[Loc, str]] = [
            ((n,), f"{show(x)}: {text}") for n, x in value.items() if (text := _WEIGHT.problem(x))
        ]
        if wrong:
            raise problems_at(wrong)
        return Weights({n: float(x) for n, x in value.items()})
    if not isinstance(value, str):
        raise refused(f"must be a link, motor or load, or a table of weights, not {kind_of(value)}", value)
    return value


class Raise(FileTable):
    """A force that raises the level of friction: F_c + F_c |f|, F_s + F_s |f|.

    ``against``: it counts only while that force is larger and of the other sign, and then by the square."""

    force: Annotated[Any, Refers(FORCES), BeforeValidator(_force)] = Field(
        description="a link, motor or load, or a table of weights of these"
    )
    F_c: float | None = quantity("", "rise of the level by the force", at_least=0, optional=True)
    F_s: float | None = quantity("", "rise of the level by the force", at_least=0, optional=True)
    against: Annotated[str | None, Refers(FORCES)] = Field(
        None,
        description="a link, motor or load: the square of the force counts, and only while this other force is larger and of "
        "opposite sign",
    )

    def wrong(self) -> list[Problem]:
        """Nothing that is raised."""
        if self.F_c is not None or self.F_s is not None:
            return []
        return [("F_c", "missing: must be given (the rise of the level by the force; F_s likewise)")]

    @property
    def weights(self) -> Mapping[str, Value]:
        """The forces that count, by name."""
        return self.force if isinstance(self.force, Weights) else {self.force: 1.0}

    def size(self, a: Assembly) -> Value:
        """The magnitude by which levels rise."""
        total: Value = 0.0
        for name, weight in self.weights.items():
            total = total + weight * a.force_of(name)
        size = abs(total)
        if self.against is None:
            return size
        other = a.force_of(self.against)
        return where(total * other < 0, where(size < abs(other), total**2, 0.0), 0.0)


class Factor(FileTable):
    """A factor of a parameter: a signal, or 1 + sum of amplitude sin(waves d + phase)."""

    signal: SignalTable | None = Field(None, description="the factor, > 0 at all times")
    amplitude: tuple[float, ...] | None = quantity("", "amplitude of a wave of the factor", optional=True, many=True)
    waves: tuple[float, ...] | None = quantity(
        "rad/m", "2 pi over a wave's length", optional=True, many=True, rotary_unit="1"
    )
    phase: tuple[float, ...] | None = quantity("rad", "phase of a wave", default=0.0, many=True)

    def wrong(self) -> list[Problem]:
        """A signal, or waves whose magnitudes sum to less than 1."""
        if self.signal is not None:
            given = [n for n in ("amplitude", "waves", "phase") if n in self.model_fields_set]
            return [(n, f"{show(list(getattr(self, n)))}: must be left out: a signal is the factor") for n in given]
        if self.amplitude is None and self.waves is None:
            return [("", f"{show(self.to_table())}: must have a signal, or amplitude and waves (by position)")]
        if self.amplitude is None or self.waves is None:
            missing = "waves" if self.amplitude is not None else "amplitude"
            return [(missing, "missing: must be given (a signal, or amplitude and waves, by position)")]
        problems = same_length(self, "amplitude", "waves", "phase")
        if (size := sum(map(abs, self.amplitude))) >= 1:
            text = f"{show(list(self.amplitude))}: the magnitudes must sum to less than 1 (they do to {size:g})"
            problems.append(("amplitude", text))
        return problems

    def extremes(self) -> tuple[float, float]:
        """The least and the largest value; (1, 1) where a signal begins at 0, which is an error."""
        if self.signal is not None:
            return extremes(self.signal.built) or (1.0, 1.0)
        size = sum(map(abs, self.amplitude or ()))
        return 1 - size, 1 + size

    def value_at(self, a: Assembly, d: Value) -> Value:
        """The factor at one instant."""
        return a.reference(self.signal).value if self.signal is not None else 1 + sum_of_waves(self, d)


def extremes(signal: waveforms.Signal) -> tuple[float, float] | None:
    """The least and the largest value of a signal; None where it begins at 0."""
    if isinstance(signal, waveforms.PointsSignal):
        return float(np.min(signal.value)), float(np.max(signal.value))
    if isinstance(signal, waveforms.SineSignal):
        middle, size = signal.values["offset"], abs(signal.values["amplitude"])
        return middle - size, middle + size
    if isinstance(signal, waveforms.StepSignal) or not signal.smooth:
        return None
    values = signal.at(np.linspace(signal.pieces[0][0], signal.pieces[-1][0], 4001))
    return float(np.min(values)), float(np.max(values))


class Deflected(FileTable):
    """Where the bristles start."""

    z: float = quantity("m or rad", "bristle deflection at t = 0", default=0.0)


class Contact(BetweenBodies, family=True):
    """Friction between a body and another, or the ground."""

    section, plain, positional = "contacts", "contact", ("name", "start", "law")
    kind: str = Field("contact", exclude=True)
    start: BodyName = Field(alias="from", description="a body")
    end: BodyOrGround = Field(GROUND, alias="to", description="a body, or 'ground'")
    ratio: float | None = ratio_constant()
    initial: Annotated[Deflected | None, Aside()] = Field(None, description="the state at t = 0")
    law: FrictionLaw = Field(description="the friction law: a table with name and parameters")
    loads: tuple[Raise, ...] = Field((), description="forces that raise the level", strict=False)
    factors: Annotated[dict[str, Factor], AfterValidator(Frozen)] = Field(Frozen(), description="factors of parameters")

    @property
    def law_path(self) -> str:
        """The table of its law."""
        return f"{self.path}.law"

    @property
    def friction(self) -> Friction:
        """The law, which is there in a whole contact."""
        assert self.law is not None
        return self.law

    def whole(self) -> bool:
        """Whether its law has been read."""
        return self.law is not None

    @property
    def has_z(self) -> bool:
        """Whether the law has bristles."""
        return self.friction.kind.has_z

    def wrong(self) -> list[Problem]:
        """A load that is the contact itself; factors and loads on what the law does not have."""
        law, problems = None if self.law is None else self.law.law, list[Problem]()
        for i, each in enumerate(self.loads):
            if self.name in each.weights:
                text = f"{show(self.name)}: names itself: must be a link, a motor or a load"
                problems.append((f"loads[{i}].force", text))
        if law is None:
            return problems
        if self.initial is not None and self.initial.z and not law.has_z:
            problems.append(("initial.z", f"{self.initial.z}: law '{law.name}' has no z; leave it out"))
        known = law.numbers(law.form)
        if not any(n in law.constants() for n in LEVELS):
            text = f"law '{law.name}' has no level F_c or F_s to raise"
            problems += [(f"loads[{i}]", f"{show(x.to_table())}: {text}") for i, x in enumerate(self.loads)]
        for constant, factor in self.factors.items():
            signal = None if factor.signal is None else factor.signal.built
            if why := _not_to_multiply(constant, law, list(known)):
                problems.append((f"factors.{constant}", why))
            elif signal is not None and (why := _not_positive(signal)):
                problems.append((f"factors.{constant}.signal", why))
        return problems or _beyond(law, {constant: factor.extremes() for constant, factor in self.factors.items()})

    def own_states(self, m: Elements) -> tuple[State, ...]:
        """The deflection of the bristles."""
        start = 0.0 if self.initial is None else self.initial.z
        return (State("z", "rad" if self.turning(m) else "m", "mean bristle deflection", start),) if self.has_z else ()

    def parameters(self, a: Assembly, d: Value) -> Constants:
        """The law's constants at one instant: times the factors, plus what the loads add, times the level's factor."""
        p = self.friction.with_named_terms(
            lambda n, latex, args, value: a.called.term(self.name_of(n, "_"), latex, args, value)
        )
        factors = {constant: factor.value_at(a, d) for constant, factor in self.factors.items()}
        for constant, x in factors.items():
            p = p.replaced({constant: getattr(p, constant) * x}) if constant != "level" else p
        levels = [n for n in LEVELS if hasattr(p, n)]
        for i, each in enumerate(self.loads):
            size = each.size(a)
            if isinstance(size, Expr) and size.args:
                a.called[size] = self.name_of("load", "_") + (f"_{i + 1}" if len(self.loads) > 1 else "")
            p = p.replaced({n: getattr(p, n) + getattr(each, n) * size for n in levels if getattr(each, n) is not None})
        return p.replaced({n: getattr(p, n) * factors["level"] for n in levels if "level" in factors})

    def equations(self, a: Assembly) -> None:
        """Hold both ends back."""
        law, (d, w, ratio) = self.friction.kind, a.along(self)
        z = a.state(self, "z") if self.has_z else ZERO
        p = self.parameters(a, d)
        rate = wrap(law.dz_dt(p, w, z)) if self.has_z else ZERO
        F = wrap(law.friction(p, w, z, rate))
        if rate.args:
            a.called[rate] = self.name_of("dz_dt", "_")
        a.k[self.name_of("z")], a.k[self.name_of("w")] = z, w
        a.show(self.name_of("F"), F)
        a.act(self, ratio, F)
        if a.system.energy:  # a law of one's own may say nothing of what it stores
            stored = wrap(law.stored_energy(self.friction.p, z))
            a.stored = a.stored + stored
            a.lost = a.lost + (F * w - (derivative(stored, z) * rate if self.has_z else ZERO))
        if self.has_z:
            a.rates[self.name_of("z")] = rate

    def watches(self, a: Assembly) -> tuple[Events, Expr]:
        """Slip and stick."""
        return SLIP_AND_STICK, a.k[self.name_of("w")]

    def level(self) -> Value:
        """The speed of slip and stick."""
        return self.friction.slip_speed

    def scales(self) -> Scales:
        """Natural magnitudes of the law."""
        return self.friction.scales()

    def natural(self, scales: Mapping[str, Scales], m: Elements) -> dict[str, Value]:
        """The law's length."""
        return {self.name_of("z"): self.scales().length}

    def columns(self, m: Elements) -> list[Column]:
        """Deflection, force and sliding speed."""
        turns = self.turning(m)
        z, w = ("rad", "rad/s") if turns else ("m", "m/s")
        return [
            Column(self.name_of("z"), z, "mean bristle deflection"),
            Column(self.name_of("F"), force_unit(turns), "friction force"),
            Column(self.name_of("w"), w, "sliding speed"),
        ]

    def heading(self, m: Elements) -> str:
        """See :class:`Element`."""
        return f"Contact {self.name}: {self.between()}, law {self.friction.kind.name}."

    def wiring(self, m: Draft) -> list[tuple[Loc, str]]:
        """A force that jumps at rest."""
        problems = super().wiring(m)
        law = None if self.law is None else self.law.law
        if law is not None and law.jumps_at_rest and any(m.free_leader(x) for x in self.ends):
            text = f"the force of law '{law.name}' jumps at v = 0, so a body under it cannot stick"
            if "k_v" in law.constants():
                problems.append(
                    (("law", "k_v"), f"missing: {text}; give k_v > 0 in s/m for a smooth sign, or a velocity")
                )
            else:
                problems.append((("law", "name"), f"{show(law.name)}: {text}"))
        return problems


def _not_to_multiply(constant: str, law: Law, numbers: list[str]) -> str | None:
    """Why a factor cannot be on a parameter, or None."""
    if constant == "sigma_0":
        why = "a stiffness that changes stores energy at no cost; use level, or F_c and F_s"
        return f"must be left out: sigma_0 cannot be multiplied ({why})"
    known = [n for n in numbers if n != "sigma_0"]
    if constant == "level":
        return None if any(n in known for n in LEVELS) else f"law '{law.name}' has no level F_c or F_s"
    if constant in known:
        return None
    guess = nearest(constant, (*known, "level")) or f" (it has {', '.join(known)}, and level)"
    return f"unknown key: law '{law.name}' has no such constant{guess}"


def _not_positive(signal: waveforms.Signal) -> str | None:
    """Why a signal cannot be a factor, or None."""
    if (reached := extremes(signal)) is None:
        return f"{show(signal.kind)}: begins at 0: a factor must be > 0 at all times"
    return None if reached[0] > 0 else f"reaches {reached[0]:g}: a factor must be > 0 at all times"


def _beyond(law: Law, by: Mapping[str, tuple[float, float]]) -> list[Problem]:
    """Problems of the law at the smallest and largest factors."""
    problems: list[Problem] = []
    for name, (low, _) in by.items():
        declared, value = law.constants().get(name), law.values.get(name)
        if declared is None or value is None or declared.at_least is None or low * value >= declared.at_least:
            continue
        problems.append((f"factors.{name}", f"brings {name} down to {low * value:g}: it must stay {declared.allowed}"))
    z_ba, sigma_0 = law.values.get("z_ba"), law.values.get("sigma_0")
    if z_ba is None or sigma_0 is None:
        return problems
    largest = z_ba * by.get("z_ba", (1.0, 1.0))[1]
    blamed_once: dict[str, str] = {}
    for name in LEVELS:  # sigma_0 g is between them, whichever is the larger
        least = (law.values.get(name) or inf) / sigma_0 * by.get(name, (1.0, 1.0))[0] * by.get("level", (1.0, 1.0))[0]
        blamed = min((n for n in ("level", name, "z_ba") if n in by), key=lambda n: by[n][0], default=None)
        if largest >= least and blamed is not None:
            text = f"z_ba (up to {largest:g}) must stay below {name}/sigma_0, which factors bring down to {least:g}"
            blamed_once.setdefault(f"factors.{blamed}", text)
    return [*problems, *blamed_once.items()]

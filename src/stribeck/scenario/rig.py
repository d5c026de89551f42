"""A machine with its values: what the solvers take of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from types import SimpleNamespace

import numpy as np

from stribeck.arrays import Array
from stribeck.errors import InputError
from stribeck.expressions.emit import python_function
from stribeck.expressions.ops import Value, sqrt
from stribeck.laws.base import Law, Scales
from stribeck.machine.dither import WAVES_A_STEP
from stribeck.machine.parts import LinkPart, LoadPart, SignalUse, joined
from stribeck.machine.system import MachineSystem
from stribeck.scenario.parts import Settings
from stribeck.signals import Signal
from stribeck.signals.pieces import Pieces, merged, pieces

# What counts as at a limit: along it an integral slides, which rounding would else make many events.
AT_LIMIT = 1 - 1e-6
# Natural magnitudes where no contact says any: a millimetre (milliradian) and its tenfold in a second.
_LENGTH, _SPEED, _FORCE = 1e-3, 1e-2, 1.0


@dataclass(frozen=True)
class Rig:
    """A machine's structure with the values of its constants, its signals, its laws by table and its initial state.

    ``settings`` is what each drive has beside its constants and its signal, by the drive's name.
    """

    machine: MachineSystem
    values: dict[tuple[str, str], float]
    signals: dict[SignalUse, Signal]
    laws: dict[str, Law]
    initial: dict[str, float]
    seeds: dict[str, int]
    settings: dict[str, Settings] = field(default_factory=dict)

    @property
    def single(self) -> bool:
        """Whether it is a law on one body under a drive (``schema = 1``)."""
        return self.machine.single

    def with_values(self, values: Mapping[tuple[str, str], Value]) -> Rig:
        """The same with other constants: numbers, arrays of them, or symbols."""
        return replace(self, values={**self.values, **values})

    @property
    def law(self) -> Law:
        """The law of the only contact.

        Raises:
            InputError: there is no contact, or there are several.
        """
        contacts = self.machine.contacts
        if len(contacts) == 1:
            return self.laws[contacts[0].law_path]
        names = ", ".join(contact.name for contact in contacts) or "none"
        raise InputError(f"contacts: {names}: there must be one contact for this, of a machine that has several")

    @property
    def named_laws(self) -> dict[str, Law]:
        """The law of each contact, by its name."""
        return {c.name: self.laws[c.law_path] for c in self.machine.contacts}

    @property
    def compared(self) -> tuple[str, ...]:
        """The columns in which laws are compared: those of each body, contact and link."""
        if self.single:
            return "y", "v", "F"
        found = [f"{body.name}.{x}" for body in self.machine.bodies if body.leader is None for x in ("y", "v")]
        forces = [*(f"{x.name}.F" for x in self.machine.contacts), *(f"{x.name}.f" for x in self.machine.links)]
        return (*found, *forces)

    @property
    def subject(self) -> str:
        """What it is about, in a few words."""
        if self.single:
            return f"law {self.law.name}"
        laws = ", ".join(f"{c.name} {c.law.name}" for c in self.machine.contacts)
        count = len(self.machine.bodies)
        bodies = f"{count} bod{'y' if count == 1 else 'ies'}"
        return f"{bodies}, contacts: {laws}" if laws else f"{bodies}, no contacts"

    @property
    def label(self) -> str:
        """What its line in a plot is called: the law of a single body; empty: by the scenario's name."""
        return self.law.name if self.single else ""

    @property
    def rotary(self) -> bool:
        """Whether the one body without a name turns; else each column says so for itself."""
        return self.single and self.law.rotary

    @property
    def mass(self) -> Value:
        """The mass that the one drive moves without anything between; None where there is no such thing."""
        if not self.single:
            return None
        (body,) = self.machine.bodies
        own = {name: x for (path, name), x in self.values.items() if path == body.path}
        return body.plant.inertia(SimpleNamespace(**own))

    def damping(self) -> Value:
        """The damping ratio of the one body on its bristles at rest; many bodies and contacts have no such number, and
        infinity stands for it."""
        mass, law = self.mass, self.laws.get("law")
        sigma_0 = self.values.get(("law", "sigma_0"))
        if sigma_0 is None or mass is None or law is None or not law.has_z or self.machine.bodies[0].driven is not None:
            return float("inf")
        given = [self.values.get(place) for place in (("law", "sigma_1"), ("law", "sigma_2"), ("drive", "K_d"))]
        return sum(x for x in given if x is not None) / (2 * sqrt(sigma_0 * mass))

    def more_events(self, reached: float) -> list[tuple[float, int]]:
        """Events that no state tells, as far as a run came: where the only velocity is a signal, those of the signal."""
        threshold = self.law.machine.get("v_s", 0.0) if self.machine.given_alone else 0.0
        if not threshold > 0:
            return []
        (signal,) = self.signals.values()
        return [(t, int(not rises)) for t, rises in signal.crossings(threshold, reached)]

    def start(self) -> dict[str, float]:
        """The states at t = 0 that are not 0."""
        names = {state.name for state in self.machine.states}
        found = {name: x for name, x in self.initial.items() if name in names and x}
        parts: tuple[LinkPart | LoadPart, ...] = (*self.machine.links, *self.machine.loads)
        for part in parts:
            found |= {f"{part.name}.{s.name}": s.start for s in part.kind.states if s.start}
        return found

    def pieces(self, t_end: float) -> Pieces:
        """All signals as one table."""
        parts = [self.pieces_of(use, t_end) for use in self.signals]
        if not parts:
            return Pieces(np.zeros(1), np.zeros((1, 0)), np.ones(1, np.int8))
        return merged(parts)

    @property
    def longest_step(self) -> float:
        """The longest step that cannot miss a wave of a signal, s."""
        shaken = [
            WAVES_A_STEP / self.values[each.dither.path, "frequency"]
            for each in self.machine.controllers if each.dither is not None and each.sampling is None
        ]  # fmt: skip
        return min([*shaken, *(signal.longest_step for signal in self.signals.values())], default=np.inf)

    def thresholds(self) -> list[float]:
        """The threshold of each watched quantity: v_s of a contact, half of the play, the limit of a controller."""
        told = {name for name, _ in self.machine.watched}
        found = [self.laws[c.law_path].machine.get("v_s", 0.0) for c in self.machine.contacts if c.name in told]
        found += [self.values[x.path, "gap"] / 2 for x in self.machine.links if "gap" in x.form]
        for each in self.machine.controllers:
            if each.sampling is None and "limit" in each.form:
                found.append(self.values[each.path, "limit"] * AT_LIMIT)
        return found

    def pieces_of(self, use: SignalUse, t_end: float, values: Mapping[str, float] | None = None) -> Pieces:
        """One signal as a table, with other constants if given."""
        signal = self.signals[use]
        changed = type(signal)({**signal.values, **values}) if values else signal
        return pieces(changed, use.turns, t_end)

    def sampling(self) -> list[dict[str, float]]:
        """Period, delay, noise and seed of each sampled controller, in the order of its outputs."""
        found = [x for drive in self.machine.drives for x in self.settings[drive.name].sampling_of()]
        for each in self.machine.controllers:
            if each.sampling is not None:
                path = f"{each.path}.sampling"
                given = {n: self.values[path, n] for n in ("period", "delay")}
                noise = self.values[path, "noise"] if each.sampling.noise else 0.0
                found.append({**given, "noise": noise, "seed": self.seeds[each.name]})
        return found

    # -- the columns of the output ---------------------------------------------------------------------------------

    def columns(self, t: Array, states: dict[str, Array], held: dict[str, Array], pieces: Pieces) -> dict[str, Value]:
        """Every column of the output by name, from the states and what controllers held at the times t."""
        rows = pieces.at(t)
        segment = {name: rows[:, i] for i, name in enumerate(self.machine.piece_fields)}
        return evaluate(self.machine, self.values, segment | held, t, states)

    # -- tolerances ------------------------------------------------------------------------------------------------

    def law_scales(self, path: str) -> Scales:
        """The natural magnitudes of the law in a table, by the present values."""
        law = self.laws[path]
        return law.scales(law.p.replaced({n: self.values[path, n] for n in law.p.numbers}))

    @cached_property
    def scales(self) -> dict[str, Scales]:
        """Natural magnitudes of each body: those of its contacts, else of what it is linked to."""
        found: dict[str, Scales] = {}
        for contact in self.machine.contacts:
            own = self.law_scales(contact.law_path)
            ratio = abs(self.values.get((contact.path, "ratio"), 1.0))
            if isinstance(contact.span.start, str):
                _smallest(found, contact.span.start, Scales(own.length / ratio, own.speed / ratio, own.force * ratio))
            if contact.span.end is not None:
                _smallest(found, contact.span.end, own)
        for _ in self.machine.bodies:  # through links and ties, as far as they reach
            for start, end, ratio in self._joints():
                if start in found and end not in found:
                    s = found[start]
                    found[end] = Scales(s.length * ratio, s.speed * ratio, s.force / ratio)
                elif end in found and start not in found:
                    s = found[end]
                    found[start] = Scales(s.length / ratio, s.speed / ratio, s.force * ratio)
        return {body.name: found.get(body.name, Scales(_LENGTH, _SPEED, _FORCE)) for body in self.machine.bodies}

    def _joints(self) -> list[tuple[str, str, float]]:
        ratio = self.values.get
        found = [
            (link.span.start, link.span.end, abs(ratio((link.path, "ratio"), 1.0)))
            for link in self.machine.links
            if isinstance(link.span.start, str) and link.span.end is not None
        ]
        found += [
            (body.leader, body.name, abs(ratio((body.path, "ratio"), 1.0)))
            for body in self.machine.bodies if body.leader is not None
        ]  # fmt: skip
        return found

    def carried(self, body: str) -> dict[str, float]:
        """How far each body with a coordinate of its own goes by ``body`` while no link is stretched; the leader's first."""
        machine = self.machine
        found = {machine.leader(body).name: 1.0 / self._tie(body)}
        for _ in machine.bodies:
            for link in machine.links:
                start, end = link.span.start, link.span.end
                if not isinstance(start, str) or end is None:
                    continue
                a, b = machine.leader(start).name, machine.leader(end).name
                # ratio y_start = y_end
                ratio = self.values.get((link.path, "ratio"), 1.0) * self._tie(start) / self._tie(end)
                if a in found and b not in found:
                    found[b] = found[a] * ratio
                elif b in found and a not in found:
                    found[a] = found[b] / ratio
        return found

    def _tie(self, name: str) -> float:
        """How far a body moves by its leader."""
        body, total = self.machine.body[name], 1.0
        while body.leader is not None:
            total *= self.values.get((body.path, "ratio"), 1.0)
            body = self.machine.body[body.leader]
        return total

    def _numbers(self, path: str) -> SimpleNamespace:
        return SimpleNamespace(**{name: x for (owner, name), x in self.values.items() if owner == path})

    def natural(self) -> dict[str, Value]:
        """The natural magnitude of each state."""
        found: dict[str, Value] = {}
        machine, scales = self.machine, self.scales
        for body in machine.bodies:
            own = scales[body.name]
            found |= {joined(body.name, "y"): own.length, joined(body.name, "v"): own.speed}
            sizes = body.plant.state_scales(self._numbers(body.path), own.length, own.speed, own.force)
            found |= {joined(body.name, s.name): x for s, x in zip(body.plant.states, sizes, strict=True)}
        for contact in machine.contacts:
            found[joined(contact.name, "z")] = self.law_scales(contact.law_path).length
        for motor in machine.motors:
            found[f"{motor.name}.i"] = scales[motor.on].force / self.values[motor.path, "K"]
        for each in machine.controllers:
            own = scales[each.measures]
            p = each.kind.symbolic(lambda n, path=each.path: self.values[path, n], each.form)  # type: ignore[misc]
            names = [s.name for s in each.kind.states_of(each.form)]
            sizes = each.kind.state_scales(p, own.length, own.force) or (own.length,) * len(names)
            found |= {f"{each.name}.{n}": x for n, x in zip(names, sizes, strict=True)}
            if each.compensation is not None:
                found[f"{each.name}.z_hat"] = self.law_scales(each.compensation.path).length
        for drive in machine.drives:
            own = scales[drive.on]
            kept = drive.drive.scales(self._numbers(drive.path), own.length, own.force)
            found |= {joined(drive.name, n): x for n, x in kept.items()}
        energy = min(s.force * s.length for s in scales.values())
        found |= {"E_in": energy, "E_dissipated": energy}
        return {state.name: found.get(state.name, _LENGTH) for state in machine.states}


def _smallest(found: dict[str, Scales], name: str, scales: Scales) -> None:
    old = found.get(name)
    pick: Callable[[str], float] = lambda n: min(getattr(old, n), getattr(scales, n))  # noqa: E731
    found[name] = scales if old is None else Scales(pick("length"), pick("speed"), pick("force"))


def evaluate(
    machine: MachineSystem, values: Mapping[tuple[str, str], Value], segment: Mapping[str, Value], t: Array,
    states: Mapping[str, Array],
) -> dict[str, Value]:  # fmt: skip
    """Every column by name, from constants, numbers of the signals' pieces and held outputs, times and states; whatever
    shapes go together."""
    inputs: dict[str, Value] = {f"{path}.{name}": values[path, name] for path, name in machine.parameters}
    kind = {**dict.fromkeys(segment, "segment"), **dict.fromkeys(machine.shown, "memory")}
    inputs |= {f"{kind[name]}.{name}": x for name, x in segment.items()} | {"t": t, **states}
    function = output_function(machine, tuple(inputs))
    with np.errstate(all="ignore"):
        return dict(zip((c.name for c in machine.columns), function(*inputs.values()), strict=True))


@lru_cache(maxsize=32)
def output_function(machine: MachineSystem, names: tuple[str, ...]) -> Callable[..., tuple[Value, ...]]:
    """A Python function of the inputs ``names`` for the columns of a machine."""
    return python_function(names, list(machine.outputs.values()))

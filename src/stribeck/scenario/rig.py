"""A machine with its values: what the solvers take of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np

from stribeck.arrays import Array
from stribeck.errors import InputError
from stribeck.expressions.emit import python_function
from stribeck.expressions.ops import Value, sqrt
from stribeck.laws.base import Law, Scales
from stribeck.machine.machine import NATURAL_LENGTH, Elements
from stribeck.machine.signal import SignalUse
from stribeck.machine.system import MachineSystem
from stribeck.signals import Signal
from stribeck.signals.pieces import Pieces, merged, pieces


@dataclass(frozen=True)
class Rig:
    """A machine's structure with the values of its constants, its signals, its laws by table and its initial state."""

    machine: MachineSystem
    values: dict[tuple[str, str], float]
    signals: dict[SignalUse, Signal]
    laws: dict[str, Law]
    initial: dict[str, float]
    seeds: dict[str, int]

    @cached_property
    def elements(self) -> Elements:
        """The elements with the present values: numbers, or arrays of one for each lane."""
        return self.machine.elements.with_values(self.values)

    def with_values(self, values: Mapping[tuple[str, str], Value]) -> Rig:
        """The same with other constants: numbers, arrays of them, or symbols."""
        return replace(self, values={**self.values, **values})

    @property
    def law(self) -> Law:
        """The law of the only contact.

        Raises:
            InputError: there is no contact, or there are several.
        """
        contacts = self.machine.elements.contacts
        if len(contacts) == 1:
            return self.laws[next(iter(contacts.values())).law_path]
        names = ", ".join(contacts) or "none"
        raise InputError(f"contacts: {names}: there must be one contact for this, of a machine that has several")

    @property
    def signal(self) -> Signal:
        """The only signal.

        Raises:
            InputError: there is none, or there are several.
        """
        if len(self.signals) == 1:
            return next(iter(self.signals.values()))
        names = ", ".join(use.path for use in self.signals) or "none"
        raise InputError(f"signals: {names}: there must be one signal for this")

    @property
    def named_laws(self) -> dict[str, Law]:
        """The law of each contact, by its name."""
        return {name: self.laws[c.law_path] for name, c in self.machine.elements.contacts.items()}

    @property
    def compared(self) -> tuple[str, ...]:
        """The columns in which laws are compared: those of each body, contact and link."""
        if self.machine.elements.unnamed:
            return "y", "v", "F"
        e = self.machine.elements
        found = [f"{name}.{x}" for name, body in e.bodies.items() if body.tied_to is None for x in ("y", "v")]
        forces = [*(f"{name}.F" for name in e.contacts), *(f"{name}.f" for name in e.links)]
        return (*found, *forces)

    @property
    def subject(self) -> str:
        """What it is about, in a few words."""
        if self.machine.elements.unnamed:
            return f"law {self.law.name}"
        laws = ", ".join(f"{name} {c.friction.kind.name}" for name, c in self.machine.elements.contacts.items())
        count = len(self.machine.elements.bodies)
        bodies = f"{count} bod{'y' if count == 1 else 'ies'}"
        return f"{bodies}, contacts: {laws}" if laws else f"{bodies}, no contacts"

    @property
    def label(self) -> str:
        """What its line in a plot is called: the law of a single body; empty: by the scenario's name."""
        return self.law.name if self.machine.elements.unnamed else ""

    @property
    def rotary(self) -> bool:
        """Whether the one body without a name turns; else each column says so for itself."""
        return self.machine.elements.unnamed and self.elements.bodies[""].turns

    @property
    def mass(self) -> Value:
        """The mass that the one drive moves without anything between; None where there is no such thing."""
        body = self.elements.bodies.get("")
        return body.heavy if body is not None and body.kind == "body" else None

    def damping(self) -> Value:
        """The damping ratio of the one body on its bristles at rest; many bodies and contacts have no such number, and
        infinity stands for it."""
        contact, mass = self.elements.contacts.get(""), self.mass
        if contact is None or mass is None or not contact.has_z:
            return float("inf")
        sigma_0, *given = (self.values.get((contact.law_path, n)) for n in ("sigma_0", "sigma_1", "sigma_2"))
        if sigma_0 is None:
            return float("inf")
        given += [getattr(each, "K_d", None) for each in self.elements.controllers.values()]
        return sum(x for x in given if x is not None) / (2 * sqrt(sigma_0 * mass))

    def more_events(self, reached: float) -> list[tuple[float, int]]:
        """Events that no state tells, as far as a run came: where the only velocity is a signal, those of the signal."""
        threshold = self.law.machine.get("v_s", 0.0) if self.machine.elements.given_alone else 0.0
        if not threshold > 0:
            return []
        (signal,) = self.signals.values()
        return [(t, int(not rises)) for t, rises in signal.crossings(threshold, reached)]

    def start(self) -> dict[str, float]:
        """The states at t = 0 that are not 0."""
        names = {state.name for state in self.machine.states}
        return {name: x for name, x in self.initial.items() if name in names and x}

    def pieces(self, t_end: float) -> Pieces:
        """All signals as one table."""
        parts = [self.pieces_of(use, t_end) for use in self.signals]
        if not parts:
            return Pieces(np.zeros(1), np.zeros((1, 0)), np.ones(1, np.int8))
        return merged(parts)

    @property
    def longest_step(self) -> float:
        """The longest step that cannot miss a wave of a signal, s."""
        shaken = (each.longest_step() for each in self.elements.controllers.values())
        return min([*shaken, *(signal.longest_step for signal in self.signals.values())], default=np.inf)

    def thresholds(self) -> list[float]:
        """The threshold of each watched quantity: v_s of a contact, half of the play, the limit of a controller."""
        return [self._threshold(each.section, each.name) for each in self.machine.watching]

    def _threshold(self, section: str, name: str) -> Value:
        if section == "contacts":  # which a law may leave to the machine's parameters
            path = self.machine.elements.contacts[name].law_path
            return self.values.get((path, "v_s"), self.laws[path].machine.get("v_s", 0.0))
        return getattr(self.elements, section)[name].level()

    def pieces_of(self, use: SignalUse, t_end: float, values: Mapping[str, float] | None = None) -> Pieces:
        """One signal as a table, with other constants if given."""
        signal = self.signals[use]
        changed = type(signal)({**signal.values, **values}) if values else signal
        return pieces(changed, use.turns, t_end)

    def sampling(self) -> list[dict[str, float]]:
        """Period, delay, noise and seed of each sampled controller, in the order of its outputs."""
        found = []
        for each in self.elements.controllers.values():
            if (s := each.sampling) is not None:
                noise = 0.0 if s.noise is None else s.noise
                found.append({"period": s.period, "delay": s.delay, "noise": noise, "seed": self.seeds[each.name]})
        return found

    # -- the columns of the output ---------------------------------------------------------------------------------

    def columns(self, t: Array, states: dict[str, Array], held: dict[str, Array], pieces: Pieces) -> dict[str, Value]:
        """Every column of the output by name, from the states and what controllers held at the times t."""
        rows = pieces.at(t)
        segment = {name: rows[:, i] for i, name in enumerate(self.machine.piece_fields)}
        return evaluate(self.machine, self.values, segment | held, t, states)

    # -- tolerances ------------------------------------------------------------------------------------------------

    @property
    def scales(self) -> dict[str, Scales]:
        """Natural magnitudes of each body: those of its contacts, else of what it is linked to."""
        return self.elements.scales

    def carried(self, body: str) -> dict[str, float]:
        """How far each body with a coordinate of its own goes by ``body`` while no link is stretched; the leader's first."""
        e = self.elements
        found = {e.leader(body).name: 1.0 / self._tie(body)}
        for _ in e.bodies:
            for link in e.links.values():
                if len(link.ends) < 2:
                    continue
                start, end = link.ends
                a, b = e.leader(start).name, e.leader(end).name
                # ratio y_start = y_end
                ratio = (1.0 if link.ratio is None else link.ratio) * self._tie(start) / self._tie(end)
                if a in found and b not in found:
                    found[b] = found[a] * ratio
                elif b in found and a not in found:
                    found[a] = found[b] / ratio
        return found

    def _tie(self, name: str) -> float:
        """How far a body moves by its leader."""
        body, total = self.elements.bodies[name], 1.0
        while body.tied_to is not None:
            total *= 1.0 if body.ratio is None else body.ratio
            body = self.elements.bodies[body.tied_to]
        return total

    def natural(self) -> dict[str, Value]:
        """The natural magnitude of each state."""
        found = self.elements.natural()
        sizes = {state.name: found.get(state.name, NATURAL_LENGTH) for state in self.machine.states}
        # NumPy's numbers, which choices between numbers give, are written otherwise than Python's
        return {name: x.item() if isinstance(x, np.generic) else x for name, x in sizes.items()}


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

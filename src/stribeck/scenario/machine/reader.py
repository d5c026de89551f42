"""Reads the data of a machine (schema = 2), collecting every problem."""

from __future__ import annotations

import re
from math import inf
from typing import Any

from stribeck.constants import kind_of, show
from stribeck.control.sampled import Sampled
from stribeck.laws.base import Law
from stribeck.machine import controllers, loads
from stribeck.machine.dither import DitherPart
from stribeck.machine.links import LinkElement
from stribeck.machine.parts import (
    BodyPart,
    CompensationPart,
    ContactPart,
    ControllerPart,
    Factor,
    Level,
    LinkPart,
    LoadPart,
    MotorPart,
    SignalUse,
    Span,
)
from stribeck.machine.system import MachineSystem
from stribeck.scenario import tables as common
from stribeck.scenario.changes import SECTIONS
from stribeck.scenario.law import LawReader, no_table, unknown
from stribeck.scenario.machine import servo, tables, wiring
from stribeck.scenario.rig import Rig
from stribeck.scenario.tables import Problem

_NAME = re.compile(r"[A-Za-z0-9_]+")
_SAMPLES = 1e8  # of a controller in a run
TOP = ("schema", "name", *SECTIONS, "solve", "output")


class MachineReader(servo.ServoTables):
    """Reads the tables of a machine; :meth:`read` gives the problems, and ``rig`` holds what was read."""

    def read(self) -> list[Problem]:
        """Everything that is wrong with the tables."""
        self.named = {section: self._section(section) for section in SECTIONS}
        self._names()
        if not self.named["bodies"] and not self.problems:
            self.problems.append(("bodies", "missing: a machine must have at least one body"))
        bodies = tuple(x for n, t in self.named["bodies"].items() if (x := self._body(n, t)) is not None)
        links = self._each("links", self._link)
        loads_ = self._each("loads", self._load)
        motors = self._each("motors", self._motor)
        contacts = self._each("contacts", self._contact)
        controllers_ = self._each("controllers", self._controller)
        self.problems += wiring.problems(bodies, links, contacts, loads_, motors, controllers_, self.named)
        self.problems += wiring.that_jump(contacts, bodies, self.laws)
        if not self.problems:
            parts = (bodies, links, contacts, loads_, motors, controllers_)
            machine = MachineSystem(*parts, tuple(self.signals), self.energy, tuple(self.drives))
            for contact in contacts:
                start = contact.span.start if isinstance(contact.span.start, str) else None
                self.laws[contact.law_path].rotary = machine.rotary(contact.span.end, start)
            self.rig = Rig(machine, self.values, self.signals, self.laws, self.initial, self.seeds, self.settings)
        return self.problems

    def _names(self) -> None:
        seen: dict[str, str] = {}
        for section, names in self.named.items():
            for name in names:
                path = f"{section}.{name}"
                if not _NAME.fullmatch(name):
                    text = f"{name!r}: a name must be letters, digits and underscores"
                    self.problems.append((path if name else section, text))
                elif name == tables.GROUND:
                    self.problems.append((path, f"{name!r}: must be another name: this one is the ground's"))
                elif name in seen:
                    self.problems.append((path, f"{name!r}: must be another name: it is that of {seen[name]} already"))
                else:
                    seen[name] = path

    # -- the elements ----------------------------------------------------------------------------------------------

    def _body(self, name: str, table: object) -> BodyPart | None:
        path = f"bodies.{name}"
        if not isinstance(table, dict):
            self.problems.append((path, no_table(table)))
            return None
        if servo.is_piston(table):
            return self._piston(name, table)
        if "kind" in table:
            text = f"must be left out, or {servo.PISTON!r} for the piston of a cylinder"
            self.problems.append((f"{path}.kind", f"{show(table['kind'])}: {text}"))
            return None
        values = self._validate(tables.BodyTable, table, path)
        if values is None:
            return None
        ratio = self._ratio(values.ratio, path)
        driven = None
        if values.velocity is not None:
            driven = self._signal(values.velocity.signal, f"{path}.velocity.signal", name)
        self.problems += wiring.of_body(path, values)
        for kind in ("mass", "inertia"):
            if (x := getattr(values, kind)) is not None:
                self.values[path, kind] = x
        if values.initial is not None:
            self.initial |= {f"{name}.y": values.initial.y, f"{name}.v": values.initial.v}
        if values.tied_to is not None and not self.refer(f"{path}.tied_to", values.tied_to, ["bodies"]):
            return None
        has = values.mass is not None or values.inertia is not None
        return BodyPart(name, values.inertia is not None, has, values.tied_to, ratio, driven)

    def _span(self, start: object, end: str, given: float | None, path: str, name: str) -> Span | None:
        ratio = self._ratio(given, path)
        begin: str | SignalUse | None
        if isinstance(start, dict):
            self.problems += unknown(start, f"{path}.from", ("signal",))
            if "signal" not in start:
                self.problems.append(
                    (f"{path}.from.signal", "missing: must be given (a table with kind and its constants)")
                )
                return None
            begin = self._signal(start["signal"], f"{path}.from.signal", name)
        elif not isinstance(start, str):
            text = f"must be a body's name, or a table with the signal of a far end, not {kind_of(start)}"
            self.problems.append((f"{path}.from", f"{show(start)}: {text}"))
            return None
        else:
            begin = start if self.refer(f"{path}.from", start, ["bodies"]) else None
        if end != tables.GROUND and not self.refer(f"{path}.to", end, ["bodies"], [tables.GROUND]):
            return None
        if begin is None:
            return None
        if begin == end:
            self.problems.append((f"{path}.to", f"{show(end)}: must be another body than from, or 'ground'"))
            return None
        return Span(begin, None if end == tables.GROUND else end, ratio)

    def _link(self, name: str, path: str, table: dict[str, object]) -> LinkPart | None:
        kind = self._element({"kind": LinkElement.kind, **table}, path, LinkElement, {LinkElement.kind: LinkElement})
        values = self._made(tables.link_table(kind), table, path) if kind else None
        if values is None:
            return None
        span = self._span(values.from_, values.to, values.ratio, path, name)
        off = [n for n in ("gap", "damping") if kind is LinkElement and getattr(values, n, None) == 0]
        form = self._constants(kind, values, path, off)
        return LinkPart(name, kind, form, span) if span is not None and form is not None else None

    def _load(self, name: str, path: str, table: dict[str, object]) -> LoadPart | None:
        kind = self._element(table, path, loads.LoadElement, loads.KINDS)
        values = self._made(tables.load_table(kind), table, path) if kind else None
        if values is None:
            return None
        ok = self.refer(f"{path}.on", values.on, ["bodies"])
        signal = self._signal(values.signal, f"{path}.signal", name) if kind.follows_signal else None
        form = self._constants(kind, values, path)
        if not ok or form is None or (kind.follows_signal and signal is None):
            return None
        return LoadPart(name, kind, form, values.on, signal)

    def _motor(self, name: str, path: str, table: dict[str, object]) -> MotorPart | None:
        values = self._made(tables.motor_table(), table, path)
        if values is None:
            return None
        ok = self.refer(f"{path}.on", values.on, ["bodies"])
        signal = None
        if values.signal is not None:
            signal = self._signal(values.signal, f"{path}.signal", name)
            ok = ok and signal is not None
        form = self._constants(MotorPart.kind, values, path)
        return MotorPart(name, form, values.on, signal) if ok and form is not None else None

    def _contact(self, name: str, path: str, table: dict[str, object]) -> ContactPart | None:
        values = self._made(tables.contact_table(), table, path)
        if values is None:
            return None
        span = self._span(values.from_, values.to, values.ratio, path, name)
        law = self._law(table.get("law"), f"{path}.law")
        levels = [self._level(name, f"{path}.loads.{i}", x, law) for i, x in enumerate(values.loads)]
        factors = [self._factor(name, f"{path}.factors.{of}", of, x, law) for of, x in values.factors.items()]
        if span is None or law is None or None in levels or None in factors:
            return None
        self.problems += wiring.beyond(path, law, {x.of: self._extremes(x) for x in factors if x is not None})
        parts = tuple(x for x in levels if x), tuple(x for x in factors if x)
        return ContactPart(name, type(law), law.form, span, *parts)

    def _law(self, table: object, path: str) -> Law | None:
        reader = LawReader(table, path, self.folder, self.executes)
        law = reader.read()
        self.problems += reader.problems
        if law is not None:
            self.laws[path] = law
            self.values |= {(path, n): x for n, x in law.p.numbers.items()}
        return law

    def _level(self, contact: str, path: str, table: object, law: Law | None) -> Level | None:
        where = re.sub(r"\.(\d+)$", r"[\1]", path)
        if not isinstance(table, dict):
            self.problems.append((where, no_table(table)))
            return None
        if not isinstance(table.get("force", ""), str | dict):
            text = f"must be a link, motor or load, or a table of weights, not {kind_of(table['force'])}"
            self.problems.append((f"{where}.force", f"{show(table['force'])}: {text}"))
            return None
        found = wiring.level_problems(table, where, contact, law)
        values, more = common.validate(tables.level_table(isinstance(table.get("force"), dict)), table, where)
        self.problems += more or found
        if values is None or found:
            return None
        force = dict(values)["force"]
        weights = {force: 1.0} if isinstance(force, str) else force
        sections = ("links", "motors", "loads")
        there = [self.refer(f"{where}.force", source, sections) for source in weights]  # each is told
        against = getattr(values, "against", None)
        there += [self.refer(f"{where}.against", against, sections)] if against is not None else []
        if not all(there):
            return None
        weighted = isinstance(force, dict)
        gains = tuple(n for n in ("F_c", "F_s") if n in table and (law is None or n in law.constants()))
        self.values |= {(path, n): getattr(values, n) for n in gains}
        self.values |= {(path, f"weight_{n}"): x for n, x in weights.items()} if weighted else {}
        return Level(path, tuple(weights), weighted, gains, against)

    def _factor(self, contact: str, path: str, of: str, table: object, law: Law | None) -> Factor | None:
        if not isinstance(table, dict):
            self.problems.append((path, no_table(table)))
            return None
        if law is not None and (text := wiring.not_to_multiply(of, law)):
            self.problems.append((path, text))
            return None
        if not {"signal", "amplitude", "waves"} & set(table):
            text = f"{show(table)}: must have a signal, or amplitude and waves (by position)"
            self.problems.append((path, text))
            return None
        values = self._made(tables.factor_table("signal" in table), table, path)
        if values is None:
            return None
        if "signal" in table:
            use = self._signal(values.signal, f"{path}.signal", f"{contact}_{of}")
            if use is None:
                return None
            if text := wiring.not_positive(self.signals[use]):
                self.problems.append((f"{path}.signal", text))
            return Factor(of, path, use)
        given = {n: getattr(values, n) for n in ("amplitude", "waves", "phase")}
        if not self._lists(given, tuple(given), path):
            return None
        if (size := sum(map(abs, given["amplitude"]))) >= 1:
            text = f"{show(given['amplitude'])}: the magnitudes must sum to less than 1 (they do to {size:g})"
            self.problems.append((f"{path}.amplitude", text))
            return None
        self.values |= {(path, f"{n}_{i}"): x for n, xs in given.items() for i, x in enumerate(xs)}
        return Factor(of, path, None, len(given["waves"]))

    def _extremes(self, factor: Factor) -> tuple[float, float]:
        """The least and the largest value of a factor."""
        if factor.signal is not None:
            return wiring.extremes(self.signals[factor.signal]) or (1.0, 1.0)
        size = sum(abs(self.values[factor.path, f"amplitude_{i}"]) for i in range(factor.waves))
        return 1 - size, 1 + size

    def _controller(self, name: str, path: str, table: dict[str, object]) -> ControllerPart | None:
        if table.get("kind") == servo.CONTROLLER:
            self._servo(name, path, table)
            return None
        known = {**controllers.KINDS, servo.CONTROLLER: controllers.ControllerElement}
        kind = self._element(table, path, controllers.ControllerElement, known)
        values = self._made(tables.controller_table(kind), table, path) if kind else None
        if values is None:
            return None
        ok = self.refer(f"{path}.on", values.on, ["motors", "bodies"])
        measures = values.measures or wiring.carrier(values.on, self.named)
        if values.measures is not None:
            ok = self.refer(f"{path}.measures", values.measures, ["bodies"]) and ok
        compensation = None
        if values.compensation is not None:
            compensation = self._compensation(f"{path}.compensation", values.compensation)
            ok = ok and compensation is not None
        turns = compensation is not None and compensation.speed == "reference"
        signal = self._signal(values.signal, f"{path}.signal", name, turns)
        form = self._constants(kind, values, path)
        if not ok or signal is None or form is None or not isinstance(measures, str):
            return None
        led = compensation is not None and compensation.lead
        if led and values.feedforward is None and (text := wiring.no_second_derivative(self.signals[signal])):
            self.problems.append((f"{path}.signal.kind", text.replace("feedforward", "compensation.lead")))
        if values.feedforward is not None:
            if text := wiring.no_second_derivative(self.signals[signal]):
                self.problems.append((f"{path}.signal.kind", text))
            self.values[f"{path}.feedforward", "inertia"] = values.feedforward.inertia
        sampling = self._sampling(name, f"{path}.sampling", values.sampling)
        dither = self._dither(f"{path}.dither", values.dither, values.sampling and values.sampling.period)
        forward = values.feedforward is not None
        return ControllerPart(name, kind, form, values.on, measures, signal, forward, compensation, sampling, dither)

    def _sampling(self, name: str, path: str, values: Any) -> Sampled | None:
        if values is None:
            return None
        part = Sampled(values.resolution > 0, values.noise > 0, values.bandwidth is not None)
        given = {n: getattr(values, n) for n in part.numbers}
        self.values |= {(path, n): float(x) for n, x in given.items()}
        self.seeds[name] = values.seed
        solve = self.data.get("solve")
        end = solve.get("t_end") if isinstance(solve, dict) else None
        if isinstance(end, int | float) and end < inf and end / values.period > _SAMPLES:
            text = f"more than {_SAMPLES:g} samples until solve.t_end = {end:g} s; must be larger"
            self.problems.append((f"{path}.period", f"{values.period:g}: {text}"))
        return part

    def _dither(self, path: str, values: tables.DitherTable | None, period: float | None) -> DitherPart | None:
        if values is None:
            return None
        if period is None and values.kind == "square":
            self.problems.append(
                (f"{path}.kind", "'square': a continuous controller's must be 'sine'; square needs sampling")
            )
        most = None if period is None else 0.5 / period
        if most is not None and values.frequency > most:
            text = f"{values.frequency:g}: must be at most {most:g}, half of the sampling's rate"
            self.problems.append((f"{path}.frequency", text))
        self.values |= {(path, n): getattr(values, n) for n in DitherPart.constants}
        return DitherPart(values.kind, path)

    def _compensation(self, path: str, table: dict[str, object]) -> CompensationPart | None:
        values = self._validate(tables.CompensationTable, table, path)
        if values is None:
            return None
        if values.contact is not None and not self.refer(f"{path}.contact", values.contact, ["contacts"]):
            return None
        if values.law is not None:
            place, law = f"{path}.law", self._law(values.law, f"{path}.law")
        elif values.contact is not None:
            place = f"contacts.{values.contact}.law"
            law = self.laws.get(place)
        else:
            self.problems.append((f"{path}.contact", "missing: must be given (a contact, or else a law)"))
            return None
        if law is None:
            return None
        if values.share is not None:
            self.values[path, "share"] = values.share
        if values.lead is not None:
            if not law.differentiable:
                text = f"law '{law.name}' has no dF/dt; must be left out, or the law a smooth one"
                self.problems.append((f"{path}.lead", f"{values.lead:g}: {text}"))
            self.values[path, "lead"] = values.lead
        return CompensationPart(
            type(law), law.form, place, values.speed, values.share is not None, values.lead is not None
        )

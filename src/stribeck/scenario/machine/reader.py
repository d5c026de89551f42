"""Reads the data of a machine (schema = 2), collecting every problem."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

from stribeck.constants import show
from stribeck.errors import InputError, nearest
from stribeck.laws.base import Law
from stribeck.machine import controllers, loads
from stribeck.machine.element import Element
from stribeck.machine.links import Link
from stribeck.machine.own import find_element
from stribeck.machine.parts import (
    Body,
    Compensation,
    ContactPart,
    ControllerPart,
    Factor,
    Level,
    LinkPart,
    LoadPart,
    MotorPart,
    Sampled,
    SignalUse,
    Span,
)  # fmt: skip
from stribeck.machine.system import Machine
from stribeck.scenario import tables as common
from stribeck.scenario.law import LawReader, no_table, unknown
from stribeck.scenario.machine import tables, wiring
from stribeck.scenario.machine.rig import Rig
from stribeck.scenario.signal import read_signal
from stribeck.scenario.tables import Problem
from stribeck.scenario.trust import in_a_file
from stribeck.signals import Signal

_NAME = re.compile(r"[A-Za-z0-9_]+")
TOP = ("schema", "name", *tables.SECTIONS, "solve", "output")


class MachineReader:
    """Reads the tables of a machine; :meth:`read` gives the problems, and ``rig`` holds what was read."""

    def __init__(self, data: dict[str, Any], folder: Path, energy: bool, executes: bool = True) -> None:
        self.data, self.folder, self.energy = data, folder, energy
        self.executes = executes  # whether laws and elements in files are; else all but these is judged
        self.problems: list[Problem] = []
        self.values: dict[tuple[str, str], float] = {}
        self.signals: dict[SignalUse, Signal] = {}
        self.laws: dict[str, Law] = {}  # by the table's path
        self.initial: dict[str, float] = {}
        self.seeds: dict[str, int] = {}
        self.rig: Rig | None = None

    def read(self) -> list[Problem]:
        """Everything that is wrong with the tables."""
        self.named = {section: self._section(section) for section in tables.SECTIONS}
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
            machine = Machine(*parts, tuple(self.signals), self.energy)
            self.rig = Rig(machine, self.values, self.signals, self.laws, self.initial, self.seeds)
        return self.problems

    # -- helpers ---------------------------------------------------------------------------------------------------

    def _section(self, section: str) -> dict[str, Any]:
        table = self.data.get(section, {})
        if isinstance(table, dict):
            return table
        self.problems.append((section, no_table(table)))
        return {}

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

    def _each(self, section: str, read: Callable[[str, str, dict[str, Any]], Any]) -> tuple[Any, ...]:
        found = []
        for name, table in self.named[section].items():
            path = f"{section}.{name}"
            if not isinstance(table, dict):
                self.problems.append((path, no_table(table)))
            elif (part := read(name, path, table)) is not None:
                found.append(part)
        return tuple(found)

    def _validate(self, model: type[common.Table], table: dict[str, Any], path: str) -> Any:
        values, found = common.validate(model, table, path)
        self.problems += found
        return values

    def refer(self, path: str, name: str, sections: Iterable[str], also: Iterable[str] = ()) -> bool:
        """Whether there is such an element; else a problem is noted."""
        known = [n for section in sections for n in self.named[section]] + list(also)
        if name in known:
            return True
        what = " or ".join({"bodies": "body"}.get(s, s.rstrip("s")) for s in sections)
        guess = nearest(name, known) or (f" (there is {', '.join(known)})" if known else " (there is none)")
        self.problems.append((path, f"{show(name)}: there is no such {what}{guess}"))
        return False

    def _signal(self, table: Any, path: str, name: str, turns: bool = False) -> SignalUse | None:
        if not isinstance(table, dict):
            self.problems.append((path, no_table(table)))
            return None
        kind = self._kind(table, path, common.SIGNALS, lambda k: common.signal_table(k).model_fields)
        if kind is None:
            return None
        values = self._validate(common.signal_table(kind), table, path)
        if values is None:
            return None
        signal, found = read_signal(kind, values, self.folder)
        self.problems += [(f"{path}.{key}", text) for key, text in found]
        if signal is None:
            return None
        while any(use.name == name for use in self.signals):
            name += "_"
        use = SignalUse(name, path, type(signal) if signal.smooth else None, turns)
        self.signals[use] = signal
        self.values |= {(path, n): float(signal.values[n]) for n in use.constants()}
        return use

    def _kind(
        self, table: dict[str, Any], path: str, kinds: Mapping[str, Any], fields: Callable[[str], Iterable[str]]
    ) -> str | None:
        kind = table.get("kind")
        if isinstance(kind, str) and kind in kinds:
            return kind
        allowed = f"one of {', '.join(kinds)}"
        self.problems += unknown(table, path, (name for each in kinds for name in ("kind", *fields(each))))
        if "kind" not in table:
            self.problems.append((f"{path}.kind", f"missing: must be given ({allowed})"))
        else:
            guess = nearest(kind, kinds) if isinstance(kind, str) else ""
            self.problems.append((f"{path}.kind", f"{show(kind)}: must be {allowed}{guess}"))
        return None

    def _element(self, table: dict[str, Any], path: str, base: type[Element], kinds: Mapping[str, Any]) -> Any:
        """The class of an element, which may be one of the user's own."""
        kind = table.get("kind")
        if isinstance(kind, str) and in_a_file(kind):
            if not self.executes:
                return None
            try:
                return find_element(kind, self.folder, base)
            except InputError as error:
                self.problems += [(f"{path}.kind", text) for text in error.problems]
                return None
        if (name := self._kind(table, path, kinds, lambda each: self._fields(kinds[each]))) is None:
            return None
        return kinds[name]

    @staticmethod
    def _fields(kind: type[Element]) -> list[str]:
        more: tuple[str, ...] = ("on", "signal", "measures", "feedforward", "compensation", "sampling")
        if issubclass(kind, Link):
            more = ("from", "to", "ratio")
        elif not issubclass(kind, controllers.Controller):
            more = more[:2]
        return [*kind.constants(), *kind.lists(), *more]

    def _constants(
        self, kind: type[Element], values: Any, path: str, skip: Iterable[str] = ()
    ) -> tuple[str, ...] | None:
        """Keep an element's numbers; the form of its equations, or None where lists do not go together."""
        given = {n: getattr(values, n) for n in (*kind.constants(), *kind.lists()) if n not in skip}
        if kind.lists() and not self._lists(given, tuple(kind.lists()), path):
            return None
        form = kind.structure(given)
        for name, value in given.items():
            if isinstance(value, list):
                self.values |= {(path, f"{name}_{i}"): float(x) for i, x in enumerate(value)}
            elif value is not None:
                self.values[path, name] = float(value)
        return form

    def _lists(self, given: dict[str, Any], names: tuple[str, ...], path: str) -> bool:
        """Whether lists have one length; phases that are not given are 0."""
        count = len(given[names[0]])
        if "phase" in names and given["phase"] is None:
            given["phase"] = [0.0] * count
        wrong = [n for n in names if len(given[n]) != count]
        for name in wrong:
            text = f"a list of {len(given[name])}: must be as long as {names[0]} ({count})"
            self.problems.append((f"{path}.{name}", text))
        if not count:
            self.problems.append((f"{path}.{names[0]}", "[]: must hold at least one number"))
        return not wrong and bool(count)

    def _ratio(self, values: Any, path: str) -> bool:
        if values.ratio is None:
            return False
        if values.ratio == 0:
            self.problems.append((f"{path}.ratio", "0: must be a finite number other than 0"))
        self.values[path, "ratio"] = values.ratio
        return True

    # -- the elements ----------------------------------------------------------------------------------------------

    def _body(self, name: str, table: Any) -> Body | None:
        path = f"bodies.{name}"
        if not isinstance(table, dict):
            self.problems.append((path, no_table(table)))
            return None
        values = self._validate(tables.BodyTable, table, path)
        if values is None:
            return None
        ratio = self._ratio(values, path)
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
        return Body(name, values.inertia is not None, has, values.tied_to, ratio, driven)

    def _span(self, values: Any, path: str, name: str) -> Span | None:
        ratio, start, end = self._ratio(values, path), values.from_, values.to
        ok = True
        if isinstance(start, dict):
            self.problems += unknown(start, f"{path}.from", ("signal",))
            if "signal" not in start:
                self.problems.append(
                    (f"{path}.from.signal", "missing: must be given (a table with kind and its constants)")
                )
                return None
            found = self._signal(start["signal"], f"{path}.from.signal", name)
            start, ok = found, found is not None
        else:
            ok = self.refer(f"{path}.from", start, ["bodies"])
        if end != tables.GROUND and not self.refer(f"{path}.to", end, ["bodies"], [tables.GROUND]):
            return None
        if ok and start == end:
            self.problems.append((f"{path}.to", f"{show(end)}: must be another body than from, or 'ground'"))
            return None
        return Span(start, None if end == tables.GROUND else end, ratio) if ok else None

    def _link(self, name: str, path: str, table: dict[str, Any]) -> LinkPart | None:
        kind = self._element({"kind": Link.kind, **table}, path, Link, {Link.kind: Link})
        values = self._validate(tables.link_table(kind), table, path) if kind else None
        if values is None:
            return None
        span = self._span(values, path, name)
        off = [n for n in ("gap", "damping") if kind is Link and getattr(values, n, None) == 0]
        form = self._constants(kind, values, path, off)
        return LinkPart(name, kind, form, span) if span is not None and form is not None else None

    def _load(self, name: str, path: str, table: dict[str, Any]) -> LoadPart | None:
        kind = self._element(table, path, loads.Load, loads.KINDS)
        values = self._validate(tables.load_table(kind), table, path) if kind else None
        if values is None:
            return None
        ok = self.refer(f"{path}.on", values.on, ["bodies"])
        signal = self._signal(values.signal, f"{path}.signal", name) if kind.follows_signal else None
        form = self._constants(kind, values, path)
        if not ok or form is None or (kind.follows_signal and signal is None):
            return None
        return LoadPart(name, kind, form, values.on, signal)

    def _motor(self, name: str, path: str, table: dict[str, Any]) -> MotorPart | None:
        values = self._validate(tables.motor_table(), table, path)
        if values is None:
            return None
        ok = self.refer(f"{path}.on", values.on, ["bodies"])
        signal = None
        if values.signal is not None:
            signal = self._signal(values.signal, f"{path}.signal", name)
            ok = ok and signal is not None
        form = self._constants(MotorPart.kind, values, path)
        return MotorPart(name, form, values.on, signal) if ok and form is not None else None

    def _contact(self, name: str, path: str, table: dict[str, Any]) -> ContactPart | None:
        values = self._validate(tables.contact_table(), table, path)
        if values is None:
            return None
        span = self._span(values, path, name)
        law = self._law(table.get("law"), f"{path}.law")
        levels = [self._level(name, f"{path}.loads.{i}", x, law) for i, x in enumerate(values.loads)]
        factors = [self._factor(name, f"{path}.factors.{of}", of, x, law) for of, x in values.factors.items()]
        if span is None or law is None or None in levels or None in factors:
            return None
        parts = tuple(x for x in levels if x), tuple(x for x in factors if x)
        return ContactPart(name, type(law), law.structure, span, *parts)

    def _law(self, table: Any, path: str) -> Law | None:
        reader = LawReader(table, path, self.folder, self.executes)
        law = reader.read()
        self.problems += reader.problems
        if law is not None:
            self.laws[path] = law
            self.values |= {(path, n): x for n, x in law.values.items() if x is not None}
        return law

    def _level(self, contact: str, path: str, table: Any, law: Law | None) -> Level | None:
        where = re.sub(r"\.(\d+)$", r"[\1]", path)
        if not isinstance(table, dict):
            self.problems.append((where, no_table(table)))
            return None
        found = wiring.level_problems(table, where, contact, law)
        values, more = common.validate(tables.level_table(isinstance(table.get("force"), dict)), table, where)
        self.problems += more or found
        if values is None or found:
            return None
        weights = {values.force: 1.0} if isinstance(values.force, str) else values.force
        sections = ("links", "motors", "loads")
        there = [self.refer(f"{where}.force", source, sections) for source in weights]  # each is told
        if not all(there):
            return None
        weighted = isinstance(values.force, dict)
        gains = tuple(n for n in ("F_c", "F_s") if n in table and (law is None or n in law.constants()))
        self.values |= {(path, n): getattr(values, n) for n in gains}
        self.values |= {(path, f"weight_{n}"): x for n, x in weights.items()} if weighted else {}
        return Level(path, tuple(weights), weighted, gains)

    def _factor(self, contact: str, path: str, of: str, table: Any, law: Law | None) -> Factor | None:
        if not isinstance(table, dict):
            self.problems.append((path, no_table(table)))
            return None
        if law is not None and (text := wiring.not_to_multiply(of, law)):
            self.problems.append((path, text))
            return None
        values = self._validate(tables.factor_table("signal" in table), table, path)
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
        self.values |= {(path, f"{n}_{i}"): x for n, xs in given.items() for i, x in enumerate(xs)}
        return Factor(of, path, None, len(given["waves"]))

    def _controller(self, name: str, path: str, table: dict[str, Any]) -> ControllerPart | None:
        kind = self._element(table, path, controllers.Controller, controllers.KINDS)
        values = self._validate(tables.controller_table(kind), table, path) if kind else None
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
        if values.feedforward is not None:
            if text := wiring.no_second_derivative(self.signals[signal]):
                self.problems.append((f"{path}.signal.kind", text))
            self.values[f"{path}.feedforward", "inertia"] = values.feedforward.inertia
        sampling = self._sampling(name, f"{path}.sampling", values.sampling)
        forward = values.feedforward is not None
        return ControllerPart(name, kind, form, values.on, measures, signal, forward, compensation, sampling)

    def _sampling(self, name: str, path: str, values: Any) -> Sampled | None:
        if values is None:
            return None
        part = Sampled(values.resolution > 0, values.noise > 0, values.bandwidth is not None)
        given = {n: getattr(values, n) for n, on in part.numbers.items() if on}
        self.values |= {(path, n): float(x) for n, x in given.items()}
        self.seeds[name] = values.seed
        return part

    def _compensation(self, path: str, table: dict[str, Any]) -> Compensation | None:
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
        return None if law is None else Compensation(type(law), law.structure, place, values.speed)

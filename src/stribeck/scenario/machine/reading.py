"""What reading any table of a machine needs: references, signals, kinds, numbers; every problem is collected."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any, TypeVar

from stribeck.constants import show
from stribeck.errors import InputError, nearest
from stribeck.kinds import find_class
from stribeck.laws.base import Law
from stribeck.laws.form import Form
from stribeck.machine import controllers
from stribeck.machine.element import Element
from stribeck.machine.links import LinkElement
from stribeck.machine.parts import (
    RATIO_ALLOWED,
    RATIO_LARGEST,
    DrivePart,
    SignalUse,
)
from stribeck.scenario import tables as common
from stribeck.scenario.law import kind_of_table, no_table
from stribeck.scenario.parts import Settings
from stribeck.scenario.rig import Rig
from stribeck.scenario.signal import read_signal
from stribeck.scenario.tables import Problem
from stribeck.scenario.trust import in_a_file
from stribeck.signals import Signal

Part = TypeVar("Part")
_NAME = re.compile(r"[A-Za-z0-9_]+")


class Reading:
    """What has been read so far of a machine's tables, and the problems found."""

    def __init__(self, data: dict[str, object], folder: Path, energy: bool, executes: bool = True) -> None:
        self.data, self.folder, self.energy = data, folder, energy
        self.executes = executes  # whether laws and elements in files are; else all but these is judged
        self.problems: list[Problem] = []
        self.named: dict[str, dict[str, object]] = {}  # the tables by section and name
        self.values: dict[tuple[str, str], float] = {}
        self.signals: dict[SignalUse, Signal] = {}
        self.laws: dict[str, Law] = {}  # by the table's path
        self.initial: dict[str, float] = {}
        self.seeds: dict[str, int] = {}
        self.pistons: dict[str, common.StrictTable] = {}
        self.drives: list[DrivePart] = []
        self.settings: dict[str, Settings] = {}
        self.rig: Rig | None = None

    def _section(self, section: str) -> dict[str, object]:
        table = self.data.get(section, {})
        if isinstance(table, dict):
            return table
        self.problems.append((section, no_table(table)))
        return {}

    def _each(self, section: str, read: Callable[[str, str, dict[str, object]], Part | None]) -> tuple[Part, ...]:
        found = []
        for name, table in self.named[section].items():
            path = f"{section}.{name}"
            if not isinstance(table, dict):
                self.problems.append((path, no_table(table)))
            elif (part := read(name, path, table)) is not None:
                found.append(part)
        return tuple(found)

    def _validate(self, model: type[common.Table], table: dict[str, object], path: str) -> common.Table | None:
        values, found = common.validate(model, table, path)
        self.problems += found
        return values

    def _made(self, model: type[common.StrictTable], table: dict[str, object], path: str) -> Any:
        """The values by a model made at run time, whose keys no type tells."""
        return self._validate(model, table, path)

    def refer(self, path: str, name: str, sections: Iterable[str], also: Iterable[str] = ()) -> bool:
        """Whether there is such an element; else a problem is noted."""
        known = [n for section in sections for n in self.named[section]] + list(also)
        if name in known:
            return True
        if any(self.told(section) for section in sections):
            return False
        what = " or ".join({"bodies": "body"}.get(s, s.rstrip("s")) for s in sections)
        guess = nearest(name, known) or (f" (there is {', '.join(known)})" if known else " (there is none)")
        self.problems.append((path, f"{show(name)}: there is no such {what}{guess}"))
        return False

    def told(self, section: str) -> bool:
        """Whether a section as a whole is wrong, so that nothing more need be said of what it lacks."""
        return not isinstance(self.data.get(section, {}), dict) or (section == "bodies" and not self.named["bodies"])

    def _signal(self, table: object, path: str, name: str, turns: bool = False) -> SignalUse | None:
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
        self, table: dict[str, object], path: str, kinds: Mapping[str, object], fields: Callable[[str], Iterable[str]]
    ) -> str | None:
        return kind_of_table(table, path, kinds, lambda each: ("kind", *fields(each)), self.problems)

    def _element(
        self, table: dict[str, object], path: str, base: type[Element], kinds: Mapping[str, type[Element]]
    ) -> Any:
        """The class of an element, which may be one of the user's own."""
        kind = table.get("kind")
        if isinstance(kind, str) and in_a_file(kind):
            if not self.executes:
                return None
            try:
                return find_class(kind, self.folder, base)
            except InputError as error:
                self.problems += [(f"{path}.kind", text) for text in error.problems]
                return None
        if (name := self._kind(table, path, kinds, lambda each: self._fields(kinds[each]))) is None:
            return None
        return kinds[name]

    @staticmethod
    def _fields(kind: type[Element]) -> list[str]:
        more: tuple[str, ...] = ("on", "signal", "measures", "feedforward", "compensation", "sampling", "dither")
        if issubclass(kind, LinkElement):
            more = ("from", "to", "ratio")
        elif not issubclass(kind, controllers.ControllerElement):
            more = more[:2]
        return [*kind.constants(), *kind.lists(), *more]

    def _constants(self, kind: type[Element], values: object, path: str, skip: Iterable[str] = ()) -> Form | None:
        """Keep an element's numbers; the form of its equations, or None where lists do not go together."""
        given = {n: getattr(values, n) for n in (*kind.constants(), *kind.lists()) if n not in skip}
        if kind.lists() and not self._lists(given, tuple(kind.lists()), path):
            return None
        form = kind.form_of(given)
        for name, value in given.items():
            if isinstance(value, list):
                self.values |= {(path, f"{name}_{i}"): float(x) for i, x in enumerate(value)}
            elif value is not None:
                self.values[path, name] = float(value)
        return form

    def _lists(self, given: dict[str, list[float]], names: tuple[str, ...], path: str) -> bool:
        """Whether lists have one length; phases that are not given are 0."""
        count = len(given[names[0]])
        if "phase" in names and given["phase"] is None:
            given["phase"] = [0.0] * count
        if not count:
            self.problems.append((f"{path}.{names[0]}", "[]: must hold at least one number"))
            return False
        wrong = [n for n in names if len(given[n]) != count]
        for name in wrong:
            text = f"a list of {len(given[name])}: must be as long as {names[0]} ({count})"
            self.problems.append((f"{path}.{name}", text))
        return not wrong

    def _ratio(self, ratio: float | None, path: str) -> bool:
        if ratio is None:
            return False
        if not 1 / RATIO_LARGEST <= abs(ratio) <= RATIO_LARGEST:
            self.problems.append((f"{path}.ratio", f"{ratio:g}: must be {RATIO_ALLOWED}"))
        self.values[path, "ratio"] = ratio
        return True

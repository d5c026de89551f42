"""Reads the tables of a machine's elements, from a file or from Python, collecting every problem."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cache
from importlib import import_module
from pkgutil import iter_modules

from pydantic import ValidationError

from stribeck.constants import show
from stribeck.errors import nearest
from stribeck.machine.element import GROUND, SECTIONS, Element, everything
from stribeck.machine.elements.bodies import Body
from stribeck.machine.family import NotExecuted
from stribeck.machine.machine import Elements
from stribeck.machine.signal import File
from stribeck.machine.table import (
    Frozen,
    Held,
    Loc,
    Problem,
    Reading,
    below,
    no_table,
    problems_of,
    table_path,
    unknown_key,
)

_NAME = re.compile(r"[A-Za-z0-9_]+")
_WHAT = {"bodies": "body"}  # one of a section, in words; else without its s


@cache
def family_of(section: str) -> type[Element]:
    """The class of a section's tables, imported at first use as it costs some milliseconds; modules inside are further kinds."""
    home = import_module(f"stribeck.machine.elements.{section}")
    for module in iter_modules(getattr(home, "__path__", ()), f"{home.__name__}."):
        import_module(module.name)
    family: type[Element] = next(x.family for x in vars(home).values() if getattr(x, "section", None) == section)
    return family


class Draft:
    """The tables of a machine while they are read: every problem is collected, also beside tables that are not valid.

    Attributes:
        machine: the valid elements.
        whole: whether these are all, as where no file of code had to be left aside.
        problems: path and message of each.
    """

    def __init__(self, tables: Mapping[str, Held], reading: Reading, energy: bool = False) -> None:
        self.reading, self.problems, self.whole = replace(reading, of_file=True), list[Problem](), True
        self.tables = {section: self._table(section, tables.get(section, {})) for section in SECTIONS}
        self.names: dict[str, list[str]] = {section: list(table) for section, table in self.tables.items()}
        self.wrong = {s for s in SECTIONS if not isinstance(tables.get(s, {}), Mapping)}
        self._check_names()
        if not self.names["bodies"] and not self.problems:
            self.problems.append(("bodies", "missing: a machine must have at least one body"))
            self.wrong.add("bodies")
        sections: dict[str, Held] = {}
        self.reading = replace(self.reading, others=sections)
        for section in SECTIONS:
            sections[section] = Frozen(self._section(section, family_of(section)) if self.tables[section] else {})
        self.machine = self._with_encoders(Elements(**sections, energy=energy))
        self._wire()

    def _table(self, path: str, value: Held) -> Mapping[str, Held]:
        if isinstance(value, Mapping):
            return value
        self.problems.append((path, no_table(value)))
        return {}

    def _section(self, section: str, family: type[Element]) -> dict[str, Element]:
        """The valid elements of a section."""
        elements = {}
        for name, table in self.tables[section].items():
            path = table_path(section, name)
            given = _in_folder(table)
            try:
                if isinstance(given, dict) and "name" in given:
                    given.pop("name")
                    self.problems.append((f"{path}.name", unknown_key("name", table["name"], family.file_keys())))
                given = {**given, "name": name} if isinstance(given, dict) else given
                elements[name] = family.model_validate(given, context=replace(self.reading, place=path))
                self.whole = self.whole and elements[name].whole()
            except ValidationError as error:
                self.problems += problems_of(error, path)
            except NotExecuted:
                self.whole = False
        return elements

    def _check_names(self) -> None:
        """Names are letters, digits and underscores, each once in the machine."""
        if self.reading.unnamed:
            return
        seen: dict[str, str] = {}
        for section, names in self.names.items():
            for name in names:
                path = f"{section}.{name}"
                if not _NAME.fullmatch(name):
                    text = f"{name!r}: a name must be letters, digits and underscores"
                    self.problems.append((path if name else section, text))
                elif name == GROUND:
                    self.problems.append((path, f"{name!r}: must be another name: this one is the ground's"))
                elif name in seen:
                    self.problems.append((path, f"{name!r}: must be another name: it is that of {seen[name]} already"))
                seen.setdefault(name, path)

    def _with_encoders(self, machine: Elements) -> Elements:
        """Controllers that say nothing measure the body that they act on, or that their motor is on."""
        controllers = {}
        for name, each in machine.controllers.items():
            if each.moves_valve:
                controllers[name] = each
                continue
            body = each.on if each.on in self.names["bodies"] else getattr(machine.motors.get(each.on), "on", None)
            measures = each.measures if each.measures is not None else body if body in self.names["bodies"] else None
            controllers[name] = each.model_copy(update={"measures": measures})
        return replace(machine, controllers=Frozen(controllers))

    def _wire(self) -> None:
        """Names of other elements, and what elements say of their neighbors."""
        for each in self.machine:
            if missing := list(self._missing(each)):
                self.problems += missing
            else:
                self.problems += [(below(each.path, loc), text) for loc, text in each.wiring(self)]
        codes = {name for section in SECTIONS for name in self.names[section]}
        for contact in self.machine.contacts.values():
            for constant, factor in contact.factors.items():
                if factor.signal is not None and (name := f"{contact.name}_{constant}") in codes:
                    text = f"{contact.name!r}: must be another name: the numbers of this signal are called {name!r} in the "
                    self.problems.append(
                        (f"{contact.path}.factors.{constant}.signal", f"{text}code, as another element is")
                    )

    def _missing(self, each: Element) -> Iterator[Problem]:
        for path, name, refers in each.references():
            known = [n for s in refers.sections for n in self.names[s]] + list(refers.also)
            if name in known or self.wrong & {*refers.sections}:
                continue
            what = " or ".join(_WHAT.get(s, s.rstrip("s")) for s in refers.sections)
            guess = nearest(name, known) or (f" (there is {', '.join(known)})" if known else " (there is none)")
            yield path, f"{show(name)}: there is no such {what}{guess}"

    # -- what elements ask ---------------------------------------------------------------------------------------------

    def raw(self, section: str, key: str) -> list[Held]:
        """A key of every table of a section, also of those that are not valid."""
        tables = (t for t in self.tables[section].values() if isinstance(t, dict | Element))
        return [t.get(key) if isinstance(t, dict) else getattr(t, key) for t in tables]

    def free_leader(self, name: str) -> bool:
        """Whether a body, or what it is tied to, obeys forces."""
        return name in self.machine.bodies and self._leader(name).velocity is None

    def _leader(self, name: str) -> Body:
        body, seen = self.machine.bodies[name], set[str]()
        while body.tied_to in self.machine.bodies and body.name not in seen:
            seen.add(body.name)
            body = self.machine.bodies[str(body.tied_to)]
        return body

    def not_on_driven(self, on: str) -> list[tuple[Loc, str]]:
        """That nothing acts on a body whose velocity is given."""
        if on not in self.machine.bodies or (leader := self._leader(on)).velocity is None:
            return []
        text = f"{show(on)}: must be another body: the velocity of {leader.name} is given, and nothing acts on it"
        return [(("on",), text)]


def _in_folder(table: Held) -> Held:
    """A table of a file, or an element of Python, which stays unchanged.

    An element that names a recording or follows another element is read again.
    """
    if not isinstance(table, Element):
        return dict(table) if isinstance(table, Mapping) else table
    unread = table.follows_others or any(
        isinstance(x, File) and x.folder is None for _, x in everything(table, table.path)
    )
    return table.to_table() if unread else table

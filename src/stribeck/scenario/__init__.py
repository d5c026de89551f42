"""A scenario: which law, on what, driven how, solved and written how. docs/reference/scenario.md describes the file."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from copy import copy, deepcopy
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from stribeck.arrays import Array
from stribeck.constants import Constant, kind_of, path_of, show
from stribeck.errors import InputError, arg, printable
from stribeck.expressions.ops import Value
from stribeck.laws.base import Law
from stribeck.machine.machine import Elements
from stribeck.machine.system import MachineSystem
from stribeck.machine.table import FileTable, Key, refuse
from stribeck.parameter_sets import read_toml
from stribeck.parameter_sets.assignments import parse_assignment, parse_assignments
from stribeck.scenario import tables
from stribeck.scenario.changes import changed, plain_table, unfolds
from stribeck.scenario.reader import Reader
from stribeck.scenario.schema1 import Called, ElementNames, translated
from stribeck.scenario.tables import Output, Solve
from stribeck.scenario.trust import named
from stribeck.waveforms import Signal
from stribeck.waveforms.pieces import Pieces
from stribeck.waveforms.piecewise import OfSignal

__all__ = ["Scenario", "parse_assignment", "parse_assignments"]

_FLOATS = np.finfo(float).tiny, np.finfo(float).max  # tolerances that errors can be divided by
# In presliding all of the motion is a few natural scales: a tenth keeps y and v within 1e-6 of their peaks there too.
_ATOL_SHARE = 0.1


class Scenario:
    """A validated scenario; its values do not change.

    Args:
        data: the tables as in a scenario file; they may also be given as keywords
            (``Scenario(law={...}, plant={...}, drive={...}, solve={...}, output={...})``).
        folder: where relative paths begin; the working directory unless given.
        trust: execute laws in files wherever these lie (docs/reference/scenario.md); the data are taken for the caller's own. A
            collection of names trusts these laws only, beside those in the folder.

    Raises:
        InputError: whatever is unknown, missing, of the wrong type, not finite or unphysical; one line for each.
    """

    def __init__(
        self,
        data: Mapping[str, object] | None = None,
        *,
        folder: str | Path | None = None,
        trust: bool | Collection[str] = True,
        **tables_: object,
    ) -> None:
        if data is not None and not isinstance(data, Mapping):
            raise InputError(f"{arg('data')}: {show(data)}: must hold the tables; Scenario.load reads a file")
        given = {"schema": 1, **tables_} if data is None else {**data, **tables_}
        if isinstance(law := given.get("law"), Law) and law.rotary:
            given.setdefault("rotary", True)
        objects = {name: x for name, x in given.items() if _holds_objects(x)}
        reader = Reader(plain_table(given), Path(folder or ""), _trusted(trust), objects)
        refuse(reader.read())
        self.__dict__.update(
            data=reader.data, folder=reader.folder, elements=reader.elements, called=reader.called, solve=reader.solve,
            output=reader.output,
        )  # fmt: skip

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"{name}: a Scenario does not change; replace({{PATH: VALUE}}) makes another")

    __delattr__ = __setattr__  # type: ignore[assignment]

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Scenario) and (self.data, self.folder) == (other.data, other.folder)

    def __hash__(self) -> int:
        return hash((self.name, self.folder))

    def __repr__(self) -> str:
        return f"<Scenario {self.name}: {self.subject}, t_end {self.solve.t_end:g} s>"

    def with_rtol(self, rtol: float) -> Scenario:
        """This scenario with another relative tolerance, not judged. Its ``data`` stay as they are."""
        return self._with(solve=self.solve.model_copy(update={"rtol": rtol}))

    def with_signals(self, signals: Mapping[str, Signal]) -> Scenario:
        """This scenario with other signals of the same kinds, by their paths, not judged. Its ``data`` stay as they are."""
        return self._with(elements=self.elements.with_values({}, signals))

    def _with(self, **changed: object) -> Scenario:
        other = copy(self)
        known = {
            n: x for n, x in vars(self).items() if n in ("data", "folder", "elements", "called", "solve", "output")
        }
        other.__dict__.clear()  # what it found out about itself it finds anew
        other.__dict__.update(known | changed)
        return other

    @classmethod
    def load(
        cls, path: str | Path, set: Mapping[str, object] | None = None, *, trust: bool | Collection[str] = False
    ) -> Scenario:
        """Read the scenario or machine of a TOML file.

        A law in a file (``FILE.py:NAME``) is a program. It is executed last, if everything else is valid. It must be in the
        scenario's folder or below, unless ``set`` names it or ``trust`` is given (docs/reference/scenario.md).

        Args:
            path: the file.
            set: values that replace those at paths of the file: ``{"law.k_v": 1e6}``.
            trust: whether laws in files outside the scenario's folder may be executed; or names of such laws.

        Raises:
            InputError: if the file cannot be read, is not TOML, or is not a valid scenario; one line for each problem.
        """
        path = path_of(path, "path")
        data = read_toml(path)
        if not data:
            raise InputError(f"{path}: is empty; 'stribeck new' writes a scenario to start from")
        data.setdefault("name", path.stem)
        changes, folder, trusted = set or {}, path.parent, _trusted(trust)
        strange = named(data).values()
        if strange and any(map(unfolds, changes)):
            # to unfold the set's name the law must be known, and so executed: see first whether that is allowed
            others = {place: x for place, x in changes.items() if not unfolds(place)}
            bare = changed(data, others, folder)
            named_by_changes = {*named(bare).values()} - {*strange}
            refuse(Reader(bare, folder, None if trusted is None else {*trusted, *named_by_changes}).judge())
        new = changed(data, changes, folder)
        named_by_changes = {*named(new).values()} - {*strange}
        return cls(new, folder=folder, trust=True if trusted is None else {*trusted, *named_by_changes})

    @classmethod
    def of(cls, given: Scenario | str | Path | Mapping[str, object]) -> Scenario:
        """A scenario as it is, from the path of its file or from its tables.

        Raises:
            InputError: it is something else, or no valid scenario.
        """
        if isinstance(given, Scenario):
            return given
        if isinstance(given, str | Path):
            return cls.load(given)
        if isinstance(given, Mapping):
            return cls(given if "schema" in given else {"schema": 1, **given})
        raise InputError(f"scenario: must be a Scenario, the path of its file or its tables, not {kind_of(given)}")

    def with_changes(self, changes: Mapping[str, object]) -> Scenario:
        """This scenario with the values at some paths replaced: ``{"law.name": "lugre", "drive.signal.rate": 0.1}``."""
        return Scenario(changed(self.data, changes, self.folder), folder=self.folder, trust=True)

    replace = with_changes

    # -- what Reader found -----------------------------------------------------------------------------------------

    data: dict[str, Any]
    folder: Path
    elements: Elements
    called: Called
    solve: Solve
    output: Output

    @property
    def initial(self) -> dict[str, float]:
        """The states at t = 0 that are not 0."""
        return self.elements.initial

    @property
    def law(self) -> Law:
        """The friction law; of a machine, that of its only contact.

        Raises:
            InputError: the scenario is a machine with no contact, or with several.
        """
        contacts = self.elements.contacts
        if len(contacts) == 1:
            return self.elements.laws[next(iter(contacts.values())).law_path]
        names = ", ".join(contacts) or "none"
        raise InputError(f"contacts: {names}: there must be one contact for this, of a machine that has several")

    @property
    def signal(self) -> Signal:
        """The only signal.

        Raises:
            InputError: there is none, or there are several.
        """
        signals = self.elements.signals
        if len(signals) == 1:
            return next(iter(signals.values()))
        names = ", ".join(use.path for use in signals) or "none"
        raise InputError(f"signals: {names}: there must be one signal for this")

    @property
    def subject(self) -> str:
        """A short description: the law, or the machine."""
        if self.elements.unnamed:
            return f"law {self.law.name}"
        laws = ", ".join(f"{name} {c.friction.kind.name}" for name, c in self.elements.contacts.items())
        count = len(self.elements.bodies)
        bodies = f"{count} bod{'y' if count == 1 else 'ies'}"
        return f"{bodies}, contacts: {laws}" if laws else f"{bodies}, no contacts"

    @property
    def label(self) -> str:
        """The label of its line in a plot: the name of the law or of the machine."""
        return self.law.name if self.elements.unnamed else self.name

    @property
    def name(self) -> str:
        """The scenario's name, with control characters escaped."""
        return printable(str(self.data.get("name", "scenario")))

    @property
    def rotary(self) -> bool:
        """Whether the only body turns. Its columns are then in rad and N m. In a machine, each body states it itself."""
        return self.elements.unnamed and self.elements.bodies[""].turns

    @cached_property
    def rows(self) -> int:
        """The number of rows of the output: i * step for i = 0 ... floor(t_end/step + 1e-9)."""
        return tables.rows(self.solve.t_end, self.output.step)

    @property
    def end(self) -> float:
        """When the simulation ends, s: t_end, or the last row where rounding puts it behind t_end."""
        return max(self.solve.t_end, (self.rows - 1) * self.output.step)

    @property
    def system(self) -> MachineSystem:
        """The structure of the equations, without values."""
        return self.elements.system

    @cached_property
    def pieces(self) -> Pieces:
        """The signals as a table of pieces."""
        return self.elements.pieces(self.end)

    def columns(self, t: Array, states: dict[str, Array], held: dict[str, Array]) -> dict[str, Value]:
        """Every column of the output by name, from the states and what controllers held at the times t."""
        segment = dict(zip(self.system.piece_fields, self.pieces.at(t).T, strict=True))
        return self.system.output_columns(self.elements.values, segment | held, t, states)

    @cached_property
    def places(self) -> dict[str, Key]:
        """Every number in which lanes can differ, by its path in the file (:attr:`Elements.places`)."""
        return {self.called.to_file(path): key for path, key in self.elements.places.items()}

    def declared(self, path: str) -> Constant | None:
        """The declaration of the number at a path, with the unit that it has there; None where no table declares it."""
        words = self.called.to_machine(path).split(".")
        cut = max((i for i, word in enumerate(words) if not word.isdigit()), default=0)
        group, name = ".".join(words[:cut]), ".".join(words[cut:])
        owner, key = group.removesuffix(".parameters"), name.replace(".", "_")
        if owner in self.system.tables and key in self.system.tables[owner][0]:
            return self.system.constant(owner, key)
        for use, signal in self.elements.signals.items():
            if name in signal.constants and group == use.path:
                constant = signal.constants[name]
                return replace(constant, unit="") if isinstance(constant, OfSignal) else constant
        return None

    def as_machine(self) -> Scenario:
        """A law on a body (schema 1) as a file of schema 2: ``body``, ``contact``, and what moves the body; a machine itself."""
        if not self.elements.unnamed:
            return self
        sections, _, _ = translated(deepcopy(self.data), self.rotary, ElementNames.by_drive(self.called.drive))
        given = {
            "schema": 2, "name": self.name, **sections,
            "solve": {"t_end": self.solve.t_end}, "output": {"step": self.output.step},
        }  # fmt: skip
        return Scenario(given, folder=self.folder, trust=True)

    def path_in_machine(self, path: str) -> str:
        """A path of the file as :meth:`as_machine` has it."""
        if not self.elements.unnamed:
            return path
        return translated(self.data, self.rotary, ElementNames.by_drive(self.called.drive))[1].to_machine(path)

    def atol(self, machine: Elements | None = None, rtol: Value = None) -> dict[str, Any]:
        """The absolute tolerance of each state: given ones, else a tenth of rtol times the state's natural scale.

        With ``machine`` it is that of the same machine with other values, with ``rtol`` that of another relative tolerance.
        """
        natural = (self.elements if machine is None else machine).natural
        rtol = self.solve.rtol if rtol is None else rtol
        return {n: self.solve.atol.get(n, np.clip(_ATOL_SHARE * rtol * x, *_FLOATS)) for n, x in natural.items()}


def _holds_objects(section: object) -> bool:
    """Whether elements in a section were made in Python, and checked there."""
    return isinstance(section, Mapping) and any(isinstance(x, FileTable) for x in section.values())


def _trusted(trust: bool | Collection[str]) -> Collection[str] | None:
    """Names of laws that may lie anywhere; None: all."""
    return (None if trust else ()) if isinstance(trust, bool) else trust


load = Scenario.load

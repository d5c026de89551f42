"""Reads the data of a scenario, collecting every problem."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace
from pathlib import Path
from sys import float_info
from typing import TypeVar

from pydantic import ValidationError

from stribeck import platforms
from stribeck.constants import Column, kind_of, rotary_words, show
from stribeck.errors import corrected, nearest
from stribeck.machine.element import SECTIONS
from stribeck.machine.law import unknown
from stribeck.machine.machine import Elements
from stribeck.machine.reading import Draft
from stribeck.machine.table import FileTable, Problem, Reading, problems_of
from stribeck.scenario import schema1, tables, trust
from stribeck.scenario.schema1 import Called
from stribeck.scenario.tables import Output, Solve

T = TypeVar("T", bound=FileTable)
_ABOUT = {1: "a law on a body", 2: "a machine"}  # by schema


class Reader:
    """Reads a scenario's data, collecting every problem.

    Args:
        data: the tables of the file.
        folder: where relative paths begin.
        trusted: laws in files that may lie anywhere; None: all.
        objects: sections of a machine whose elements were made in Python, and checked there.

    Attributes:
        elements: the machine; None where something is wrong.
        called: what the file calls otherwise than the machine.
        solve, output: these tables; None where they are not valid.
    """

    elements: Elements | None
    called: Called
    solve: Solve | None
    output: Output | None

    def __init__(
        self, data: Mapping[str, object], folder: Path, trusted: Collection[str] | None = None,
        objects: Mapping[str, object] | None = None,
    ) -> None:  # fmt: skip
        self.data, self.folder, self.objects = dict(data), folder, objects or {}
        self.problems: list[Problem] = []
        self.trusted, self.executes = trusted, False

    def read(self) -> list[Problem]:
        """Read all; the problems found."""
        if trust.named(self.data):
            if self.judge():
                return self.problems
            self.executes = True
        return self._everything()

    def judge(self) -> list[Problem]:
        """The problems found without executing a law in a file."""
        self.executes = False
        self._everything()
        if not self.problems and self.trusted is not None:
            self.problems += trust.problems(self.data, self.folder, self.trusted)
        return self.problems

    def _everything(self) -> list[Problem]:
        single = not self._is_machine()
        known = schema1.TOP if single else ("schema", "name", *SECTIONS, "solve", "output")
        self._top(1 if single else 2, known)
        self.solve, self.output = self._table(Solve, "solve"), self._table(Output, "output")
        sections: Mapping[str, object] = {s: self.data[s] for s in SECTIONS if s in self.data} | dict(self.objects)
        self.called = Called()
        if single:
            sections, self.called, problems = schema1.translated(self.data, schema1.turns(self.data, self.folder))
            self.problems += problems
        reading = Reading(self.folder, self.executes, unnamed=single, to_file=self.called.to_file)
        self.elements, problems = self._machine(sections, reading)
        reported = {path for path, _ in self.problems}
        self.problems += [(path, text) for path, text in problems if path not in reported]
        if self.elements is not None:
            self._tolerances([state.name for state in self.elements.system.states])
        self._rows(len(self.elements.system.columns) if self.elements is not None else 1)
        if single:  # in the order of the file
            order = {key: i for i, key in enumerate(known)}
            self.problems.sort(key=lambda problem: order.get(problem[0].partition(".")[0], -1))
        return self.problems

    def _machine(self, sections: Mapping[str, object], reading: Reading) -> tuple[Elements | None, list[Problem]]:
        """The machine, and all problems by the file's paths; None if there is one, or if a file of code was not executed."""
        draft = Draft(sections, reading, energy := self.output is not None and self.output.energy)
        by_path, solve, to_file = list(draft.problems), self.data.get("solve"), self.called.to_file
        t_end = solve.get("t_end") if isinstance(solve, Mapping) else None
        if (
            isinstance(t_end, int | float) and 0 < t_end <= float_info.max
        ):  # a whole number may be larger than any float
            by_path += [problem for each in draft.machine for problem in each.until(draft.machine, float(t_end))]
        problems = [(to_file(path), text) for path, text in by_path]
        if energy:
            pistons = [to_file(x.path) for x in draft.machine.bodies.values() if x.kind == "pneumatic"]
            problems += [("output.energy", f"true: must be false with {x}, a pneumatic piston") for x in pistons]
        if problems or not draft.whole:
            return None, problems
        elements = draft.machine
        return replace(elements, listed=self._listed(elements) if elements.unnamed else ()), problems

    def _listed(self, elements: Elements) -> tuple[tuple[Column, str], ...]:
        """The columns of a file of schema 1, and their quantities.

        They are the motion, the friction, the drive's columns and the body's own states; a servo has its own order."""
        called = self.called
        if called.order:
            known = {c.name: c for each in elements for c in each.columns(elements)}
            return tuple((known[name], name) for name in called.order if name in known)
        columns = [c for each in (elements.bodies[""], elements.contacts[""]) for c in each.columns(elements)]
        if elements.bodies[""].turns:
            columns = [replace(c, meaning=rotary_words(c.meaning)) for c in columns]
        y, v, *inner, z, F, _ = columns
        return (*((c, c.name) for c in (y, v, z, F)), *called.columns, *((c, c.name) for c in inner))

    def _is_machine(self) -> bool:
        """Whether it is a machine file, also where its schema is wrong."""
        if "bodies" in self.data:
            return self.data.get("schema") == 2 or "law" not in self.data
        return self.data.get("schema") == 2 and not {"law", "drive", "plant"} & self.data.keys()

    def _top(self, version: int, known: tuple[str, ...]) -> None:
        """The keys that are no tables."""
        self.problems += unknown(self.data, "", known)
        self.data = corrected(self.data, known)
        schema = self.data.get("schema")
        if "schema" not in self.data:
            text = f"missing: must be given (schema = {version}, the version of the file format: {_ABOUT[version]})"
            self.problems.append(("schema", text))
        elif schema != version or isinstance(schema, bool | float):
            self.problems.append(("schema", f"{show(schema)}: must be 1 (a law on a body) or 2 (a machine)"))
        if not isinstance(name := self.data.get("name", ""), str):
            self.problems.append(("name", f"{show(name)}: must be text, not {kind_of(name)}"))

    def _table(self, kind: type[T], name: str) -> T | None:
        if name not in self.data:
            keys = ", ".join(k for k, f in kind.model_fields.items() if f.is_required())
            self.problems.append((name, f"missing: the table [{name}] must be given (with {keys})"))
            return None
        try:
            return kind.model_validate(self.data[name], context=Reading(self.folder))
        except ValidationError as error:
            self.problems += problems_of(error, name)
            return None

    def _tolerances(self, states: list[str]) -> None:
        for name, value in (self.solve.atol if self.solve else {}).items():
            if name not in states:
                guess = nearest(name, states) or f" (the states are {', '.join(states)})"
                self.problems.append((f"solve.atol.{name}", f"{value}: there is no such state{guess}"))

    def _rows(self, columns: int) -> None:
        """Refuse an output that memory cannot hold: the states are kept beside the columns."""
        if self.solve is None or self.output is None:
            return
        step = self.output.step
        rows = tables.rows(self.solve.t_end, step)
        needed = float(rows) * 8 * 2 * (1 + columns)
        if needed > (room := platforms.free_memory()):
            more = "more than " if rows >= tables.ROWS_LARGEST else ""
            text = f"{more}{rows:.3g} rows would take {more}{platforms.size_of(needed)} of memory"
            free = f"{platforms.size_of(room)} are free; must be larger"
            self.problems.append(("output.step", f"{show(step)}: {text}, and {free}"))

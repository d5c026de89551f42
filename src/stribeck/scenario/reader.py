"""Reads the data of a scenario, collecting every problem."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from pydantic import ValidationError

from stribeck import memory
from stribeck.constants import kind_of, show
from stribeck.errors import nearest
from stribeck.kinds import in_a_file
from stribeck.machine.law import LawReader, kind_of_table, unknown
from stribeck.machine.signal import SignalTable
from stribeck.machine.table import Reading, no_table, problems_of
from stribeck.plants import Mass
from stribeck.scenario import tables, trust
from stribeck.scenario.drives import DRIVES, drive_table, find_plant, settings
from stribeck.scenario.parts import Parts
from stribeck.scenario.single import structure

_TABLES = ("law", "plant", "drive", "solve", "output")


class Reader:
    """Reads a scenario's data, collecting every problem; ``trusted``: laws in files that lie anywhere (None: all);
    ``objects``: sections of a machine whose elements were made in Python, and checked there."""

    def __init__(
        self, data: Mapping[str, object], folder: Path, trusted: Collection[str] | None = None,
        objects: Mapping[str, object] | None = None,
    ) -> None:  # fmt: skip
        self.data, self.folder, self.objects = dict(data), folder, objects or {}
        self.problems: list[tables.Problem] = []
        self.trusted, self.executes = trusted, False
        self.parts = Parts()
        self.drive_table: tables.StrictTable | None = None

    def read(self) -> list[tables.Problem]:
        """Fill in the ``parts``; the problems found."""
        if trust.named(self.data):
            if self.judge():
                return self.problems
            self.executes = True
        return self._everything()

    def judge(self) -> list[tables.Problem]:
        """The problems found without executing a law in a file."""
        self.executes = False
        self._everything()
        if not self.problems and self.trusted is not None:
            self.problems += trust.problems(self.data, self.folder, self.trusted)
        return self.problems

    def _found(self, **parts: Any) -> None:
        self.parts = replace(self.parts, **parts)

    def _everything(self) -> list[tables.Problem]:
        self.parts, self.drive_table = Parts(), None
        if self._is_machine():
            return self._machine()
        self._top()
        self._law()
        self._drive()
        self._plant()
        self._found(solve=self._table(tables.Solve, "solve"), output=self._table(tables.Output, "output"))
        self._together()
        return self.problems

    def _is_machine(self) -> bool:
        """Whether it is a machine file, also where its schema is wrong."""
        if "bodies" in self.data:
            return self.data.get("schema") == 2 or "law" not in self.data
        return self.data.get("schema") == 2 and not {"law", "drive", "plant"} & self.data.keys()

    def _machine(self) -> list[tables.Problem]:
        """A machine: bodies, and elements between them."""
        from stribeck.scenario.machine import (  # costs a fifth of a start, which other files need not pay
            read_machine,
            top,
        )

        self._unknown(self.data, "", top())
        self._schema(2)
        self._name()
        solve, output = self._table(tables.Solve, "solve"), self._table(tables.Output, "output")
        self._found(solve=solve, output=output)
        energy = output is not None and output.energy
        rig, elements, problems = read_machine({**self.data, **self.objects}, self.folder, self.executes, energy)
        self.problems += problems
        if rig is not None and elements is not None:
            self._found(rig=rig, elements=elements, initial=rig.start())
            self._tolerances([state.name for state in rig.machine.states])
            self._rows(len(rig.machine.columns))
        return self.problems

    def _schema(self, version: int) -> None:
        schema, about = self.data.get("schema"), {1: "a law on a body", 2: "a machine"}[version]
        if "schema" not in self.data:
            text = f"missing: must be given (schema = {version}, the version of the file format: {about})"
            self.problems.append(("schema", text))
        elif schema != version or isinstance(schema, bool | float):
            self.problems.append(("schema", f"{show(schema)}: must be 1 (a law on a body) or 2 (a machine)"))

    def _name(self) -> None:
        name = self.data.get("name", "")
        if not isinstance(name, str):
            self.problems.append(("name", f"{show(name)}: must be text, not {kind_of(name)}"))

    def _tolerances(self, states: list[str]) -> None:
        for name, value in (self.parts.solve.atol if self.parts.solve else {}).items():
            if name not in states:
                guess = nearest(name, states) or f" (the states are {', '.join(states)})"
                self.problems.append((f"solve.atol.{name}", f"{value}: there is no such state{guess}"))

    def _table(self, model: type[tables.Table], name: str) -> tables.Table | None:
        if name not in self.data:
            keys = ", ".join(k for k, f in model.model_fields.items() if f.is_required())
            self.problems.append((name, f"missing: the table [{name}] must be given (with {keys})"))
            return None
        table, found = tables.validate(model, self.data[name], name)
        self.problems += found
        return table

    def _unknown(self, table: Mapping[str, object], path: str, known: Iterable[str]) -> None:
        """Name the keys that are not known."""
        self.problems += unknown(table, path, known)

    def _top(self) -> None:
        self._unknown(self.data, "", ("schema", "name", "rotary", *_TABLES))
        self._schema(1)
        if not isinstance(rotary := self.data.get("rotary", False), bool):
            self.problems.append(("rotary", f"{show(rotary)}: must be true or false, not {kind_of(rotary)}"))
        self._name()

    def _law(self) -> None:
        reader = LawReader(self.data.get("law"), "law", self.folder, self.executes)
        law = reader.read()
        self.problems += reader.problems
        if law is not None:
            law.rotary = self.data.get("rotary", reader.rotary) is True
            self._found(law=law)

    def _drive(self) -> None:
        table = self.data.get("drive")
        if not isinstance(table, dict):
            kinds = ", ".join(DRIVES)
            text = f"missing: the table [drive] must be given (with kind, one of {kinds}, and signal)"
            self.problems.append(("drive", text if table is None else no_table(table)))
            return
        kind = self._kind(table, "drive", DRIVES, drive_table)
        if kind is not None:
            values, found = tables.validate(drive_table(kind), table, "drive")
            self.problems += [p for p in found if p[0] != "drive.signal" or "signal" not in table]
            self._found(drive=DRIVES[kind])
            if values is not None:
                given = {n: getattr(values, n) for n in DRIVES[kind].constants}
                self._found(drive_values={n: x for n, x in given.items() if x is not None})
                self.drive_table = values
        if "signal" in table:
            self._signal(table["signal"])

    def _kind(
        self,
        table: Mapping[str, object],
        path: str,
        kinds: Mapping[str, object],
        model: Callable[[str], type[tables.StrictTable]],
    ) -> str | None:
        return kind_of_table(table, path, kinds, lambda each: model(each).model_fields, self.problems)

    def _signal(self, table: object) -> None:
        try:
            made = SignalTable.model_validate(table, context=Reading(self.folder, of_file=True))
        except ValidationError as error:
            self.problems += problems_of(error, "drive.signal")
        else:
            self._found(signal=made.built)

    def _plant(self) -> None:
        drive = self.parts.drive
        moved = drive is not None and drive.sets_velocity
        if moved and "plant" not in self.data:
            self.data["plant"] = {}
        if drive is None:  # whether a mass must be given depends on the drive
            if "plant" in self.data:
                found = tables.validate(tables.plant_table(Mass, False), self.data["plant"], "plant")[1]
                self.problems += [p for p in found if not p[1].startswith("missing")]
            return
        given = self.data.get("plant")
        name = given.get("kind") if isinstance(given, dict) else None
        if in_a_file(name) and not self.executes:
            return  # what it takes is not known yet
        plant, text = find_plant(name, drive, self.folder)
        if text is not None:
            self.problems.append(("plant.kind", text))
            return
        if self.data.get("rotary") is True and plant.straight:
            self.problems.append(("rotary", f"true: must be left out: {plant.straight}"))
        own = str(name) if in_a_file(name) else ""
        table = self._table(tables.plant_table(plant, moved, own), "plant")
        if table is not None:
            values = {} if moved else {n: getattr(table, n) for n in plant.constants}
            self._found(
                plant=plant, plant_values=values, initial={**drive.starts, "v": 0.0, **dict(dict(table)["initial"])}
            )
        read, whole = settings(drive).read, self.data["drive"]
        assert isinstance(whole, dict)
        beside, problems = read(self.drive_table, whole, self.parts.law, table, self.folder, self.executes)
        self.problems += problems
        self._found(settings=beside)

    def _together(self) -> None:
        """What can only be judged with several tables in hand, as far as they are valid."""
        s = self.parts
        law, drive, plant, initial = s.law, s.drive, s.plant, s.initial or {}
        if law is not None and not law.has_z and initial.get("z"):
            self.problems.append(("plant.initial.z", f"{initial['z']}: law '{law.name}' has no z; leave it out"))
        if law is None or drive is None:
            return
        if s.output is not None and s.output.energy and drive.no_energy:
            self.problems.append(("output.energy", f"true: must be false {drive.no_energy}"))
        if s.settings is None:
            return
        if not self.problems and s.signal is not None and s.solve is not None and plant is not None:
            whole = SimpleNamespace(**s.plant_values or {})
            self.problems += [(f"plant.{key}", text) for key, text in plant.problems(whole, initial)]
            self.problems += s.settings.judge(s)
        system = structure(s)
        self._tolerances([state.name for state in system.states])
        if law.jumps_at_rest and not drive.sets_velocity:
            smooth = "k_v" in law.constants()
            text = f"the force of law '{law.name}' jumps at v = 0, so a body under it cannot stick"
            text = f"missing: {text}; give k_v > 0 in s/m for a smooth sign" if smooth else f"{show(law.name)}: {text}"
            self.problems.append(("law.k_v" if smooth else "law.name", f"{text}, or use drive.kind = 'velocity'"))
        self._rows(len(system.columns))

    def _rows(self, columns: int) -> None:
        """Refuse an output that memory cannot hold: the states are kept beside the columns."""
        if self.parts.solve is None or self.parts.output is None:
            return
        step = self.parts.output.step
        rows = memory.rows(self.parts.solve.t_end, step)
        needed = float(rows) * 8 * 2 * (1 + columns)
        if needed > (room := memory.available()):
            more = "more than " if rows >= memory.ROWS_LARGEST else ""
            text = f"{more}{rows:.3g} rows would take {more}{memory.size(needed)} of memory"
            free = f"{memory.size(room)} are free; must be larger"
            self.problems.append(("output.step", f"{show(step)}: {text}, and {free}"))

"""A scenario: which law, on what, driven how, solved and written how. docs/scenario.md describes the file."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

from stribeck import drives, laws, parameter_sets, signals
from stribeck.constants import kind_of, show
from stribeck.drives import Drive
from stribeck.errors import InputError, nearest
from stribeck.laws.base import PARAMETERS, Law
from stribeck.scenario import memory, tables
from stribeck.scenario.changes import changed, parse_assignment
from stribeck.signals import Signal
from stribeck.system import Groups, System

__all__ = ["Scenario", "parse_assignment"]

_TABLES = ("law", "plant", "drive", "solve", "output")
# In presliding all of the motion is a few natural scales: a tenth keeps y and v within 1e-6 of their peaks there too.
_ATOL_SHARE = 0.1
_ROWS_LARGEST = 10**15  # more than any machine holds, and still exact in a float


class Scenario:
    """A validated scenario; its values do not change.

    Args:
        data: the tables as in a scenario file; they may also be given as keywords
            (``Scenario(law={...}, plant={...}, drive={...}, solve={...}, output={...})``).
        folder: where relative paths begin; the working directory unless given.

    Raises:
        InputError: whatever is unknown, missing, of the wrong type, not finite or unphysical; one line for each.
    """

    def __init__(
        self, data: Mapping[str, Any] | None = None, *, folder: str | Path | None = None, **tables_: Any
    ) -> None:
        self.data: dict[str, Any] = {"schema": 1, **tables_} if data is None else {**data, **tables_}
        self.folder = Path(folder) if folder is not None else Path()
        self.law: Law
        self.drive: type[Drive]
        self.signal: Signal
        problems = _Reader(self).read()
        if problems:
            raise InputError([f"{path}: {text}" if path else text for path, text in problems])

    @classmethod
    def load(cls, path: str | Path, changes: Mapping[str, Any] | None = None) -> Scenario:
        """The scenario in a TOML file, with the values at some paths replaced (``{"law.k_v": 1e6}``).

        Raises:
            InputError: the file cannot be read, is not TOML, or is no valid scenario; one line for each problem.
        """
        path = Path(path)
        try:
            data = tomllib.loads(path.read_text(encoding="utf-8"))
        except OSError as error:
            raise InputError(f"{path}: cannot be read: {error.strerror}") from None
        except UnicodeDecodeError:
            raise InputError(f"{path}: is not text in UTF-8") from None
        except (tomllib.TOMLDecodeError, ValueError, RecursionError) as error:
            raise InputError(f"{path}: is not TOML: {str(error) or type(error).__name__}") from None
        if not data:
            raise InputError(f"{path}: is empty; 'stribeck new' writes a scenario to start from")
        data.setdefault("name", path.stem)
        return cls(changed(data, changes or {}, path.parent), folder=path.parent)

    def with_changes(self, changes: Mapping[str, Any]) -> Scenario:
        """This scenario with the values at some paths replaced: ``{"law.name": "lugre", "drive.signal.rate": 0.1}``."""
        return Scenario(changed(self.data, changes, self.folder), folder=self.folder)

    # -- filled in by _Reader --------------------------------------------------------------------------------------

    mass: float | None
    initial: dict[str, float]
    drive_values: dict[str, float]
    solve: tables.Solve
    output: tables.Output

    @property
    def name(self) -> str:
        """The scenario's name."""
        return str(self.data.get("name", "scenario"))

    @cached_property
    def rows(self) -> int:
        """How many rows the output has: i * step for i = 0 ... floor(t_end/step + 1e-9)."""
        return _row_count(self.solve.t_end, self.output.step)

    @property
    def end(self) -> float:
        """When the simulation ends, s: t_end, or the last row where rounding puts it behind t_end."""
        return max(self.solve.t_end, (self.rows - 1) * self.output.step)

    @cached_property
    def system(self) -> System:
        """The structure of the equations, without values."""
        smooth = type(self.signal) if self.signal.smooth else None
        return System(type(self.law), self.law.structure, self.drive, smooth, self.output.energy)

    @cached_property
    def threshold(self) -> float:
        """The speed that slip and stick are told by: v_s, or 0 (none) where the parameters have no v_s."""
        return self.law.machine.get("v_s", 0.0)

    def groups(self) -> Groups:
        """The constants by owner, for evaluating the system's equations with NumPy."""
        plant = SimpleNamespace(mass=self.mass)
        return Groups(self.law.p, plant, SimpleNamespace(**self.drive_values), SimpleNamespace(**self.signal.values))

    def values(self) -> dict[tuple[str, str], float]:
        """The system's run-time constants by (group, name)."""
        found = {("law", n): v for n, v in self.law.values.items() if v is not None}
        found |= {("drive", n): v for n, v in self.drive_values.items()}
        found |= {("signal", n): v for n, v in self.signal.values.items()} if self.signal.smooth else {}
        return found if self.mass is None else {**found, ("plant", "mass"): self.mass}

    def atol(self) -> dict[str, float]:
        """The absolute tolerance of each state: given ones, else a tenth of rtol times the state's natural scale."""
        scales = self.law.scales(self.law.p)
        natural = {"y": scales.length, "v": scales.speed, "z": scales.length}
        own = self.drive.state_scales(SimpleNamespace(**self.drive_values), scales.length, scales.force)
        natural |= dict(zip((s.name for s in self.drive.states), own, strict=True))
        natural |= dict.fromkeys(("E_in", "E_dissipated"), scales.force * scales.length)
        rtol = self.solve.rtol
        return {s.name: self.solve.atol.get(s.name, _ATOL_SHARE * rtol * natural[s.name]) for s in self.system.states}


def _row_count(t_end: float, step: float) -> int:
    ratio = t_end / step + 1e-9
    return math.floor(ratio) + 1 if ratio < _ROWS_LARGEST else _ROWS_LARGEST


class _Reader:
    """Reads a scenario's data, collecting every problem."""

    def __init__(self, scenario: Scenario) -> None:
        self.scenario, self.data, self.folder = scenario, scenario.data, scenario.folder
        self.problems: list[tables.Problem] = []

    def read(self) -> list[tables.Problem]:
        """Fill in the scenario; the problems found."""
        self._top()
        self._law()
        self._drive()
        self._plant()
        s = self.scenario
        s.solve = self._table(tables.Solve, "solve")
        s.output = self._table(tables.Output, "output")
        if not self.problems:
            self._together()
        return self.problems

    def _table(self, model: type[tables.Table], name: str) -> Any:
        if name not in self.data:
            keys = ", ".join(k for k, f in model.model_fields.items() if f.is_required())
            self.problems.append((name, f"missing: the table [{name}] must be given (with {keys})"))
            return None
        table, found = tables.validate(model, self.data[name], name)
        self.problems += found
        return table

    def _top(self) -> None:
        known = ("schema", "name", *_TABLES)
        for key, value in self.data.items():
            if key not in known:
                guess = nearest(key, known) or f" (known here: {', '.join(known)})"
                self.problems.append((key, f"{show(value)}: unknown key{guess}"))
        schema, name = self.data.get("schema"), self.data.get("name", "")
        if "schema" not in self.data:
            self.problems.append(("schema", "missing: must be given (schema = 1, the version of the file format)"))
        elif schema != 1 or isinstance(schema, bool | float):
            self.problems.append(("schema", f"{show(schema)}: must be 1"))
        if not isinstance(name, str):
            self.problems.append(("name", f"{show(name)}: must be text, not {kind_of(name)}"))

    def _law(self) -> None:
        table = self.data.get("law")
        if not isinstance(table, dict):
            text = "missing: the table [law] must be given (with name and parameters)"
            self.problems.append(("law", text if table is None else f"{show(table)}: must be a table"))
            return
        if "name" not in table:
            self.problems.append(("law.name", "missing: must be given (the name of a law)"))
            return
        try:
            law = laws.find(table["name"], self.folder)
        except InputError as error:
            self.problems += [("law.name", text) for text in error.problems]
            return
        parameters = self._parameters(table, law)
        if parameters is None:
            return
        own = {name: value for name, value in table.items() if name not in ("name", "parameters")}
        paths = {name: f"law.parameters.{name}" for name in (*PARAMETERS, *parameters)} | {n: f"law.{n}" for n in own}
        for name in [name for name in own if name in PARAMETERS or name in parameters]:
            text = "belongs in law.parameters" if name in PARAMETERS else "stands in law.parameters too"
            self.problems.append((f"law.{name}", f"{show(own.pop(name))}: {text}"))
        values = {**parameters, **own}
        found = law.problems(values)
        self.problems += [(paths.get(name, f"law.{name}"), text) for name, text in found]
        if not found:
            self.scenario.law = law(values)

    def _parameters(self, table: dict[str, Any], law: type[Law]) -> dict[str, Any] | None:
        given = table.get("parameters")
        if given is None:
            if any(law.constants()[name].required for name in law.uses):
                needs = ", ".join(law.uses)
                text = f"missing: must be a table of numbers or the name of a set; law '{law.name}' needs {needs}"
                self.problems.append(("law.parameters", text))
                return None
            return {}
        if isinstance(given, dict):
            return dict(given)
        if not isinstance(given, str):
            text = f"must be a table of numbers or the name of a set, not {kind_of(given)}"
            self.problems.append(("law.parameters", f"{show(given)}: {text}"))
            return None
        try:
            values = parameter_sets.load(given, self.folder).values
        except InputError as error:
            self.problems += [("law.parameters", text) for text in error.problems]
            return None
        # a set belongs to a machine and may hold more than this law knows
        return {name: value for name, value in values.items() if name in PARAMETERS or name in law.constants()}

    def _drive(self) -> None:
        table = self.data.get("drive")
        if not isinstance(table, dict):
            kinds = ", ".join(drives.KINDS)
            text = f"missing: the table [drive] must be given (with kind, one of {kinds}, and signal)"
            self.problems.append(("drive", text if table is None else f"{show(table)}: must be a table"))
            return
        kind = self._kind(table, "drive", list(drives.KINDS))
        if kind is not None:
            values, found = tables.validate(tables.drive_table(kind), table, "drive")
            self.problems += [p for p in found if not p[0].startswith("drive.signal") or "signal" not in table]
            self.scenario.drive = drives.KINDS[kind]
            if values is not None:
                self.scenario.drive_values = {n: getattr(values, n) for n in drives.KINDS[kind].constants}
        if "signal" in table:
            self._signal(table["signal"])

    def _kind(self, table: dict[str, Any], path: str, kinds: list[str]) -> str | None:
        kind = table.get("kind")
        if isinstance(kind, str) and kind in kinds:
            return kind
        allowed = f"one of {', '.join(kinds)}"
        if "kind" not in table:
            self.problems.append((f"{path}.kind", f"missing: must be given ({allowed})"))
        else:
            guess = nearest(kind, kinds) if isinstance(kind, str) else ""
            self.problems.append((f"{path}.kind", f"{show(kind)}: must be {allowed}{guess}"))
        return None

    def _signal(self, table: Any) -> None:
        path = "drive.signal"
        if not isinstance(table, dict):
            self.problems.append((path, f"{show(table)}: must be a table, not {kind_of(table)}"))
            return
        kind = self._kind(table, path, list(signals.KINDS))
        if kind is None:
            return
        values, found = tables.validate(tables.signal_table(kind), table, path)
        self.problems += found
        if values is None:
            return
        cls = signals.KINDS[kind]
        if cls is signals.File:
            try:
                self.scenario.signal = signals.File.read(self.folder / values.path, values.time, values.value)
            except InputError as error:
                self.problems += [(path, text) for text in error.problems]
        elif cls is signals.Points:
            t, value = np.array(values.t, float), np.array(values.value, float)
            wrong = signals.Points.problems(t, value)
            self.problems += [(f"{path}.{key}", text) for key, text in wrong]
            if not wrong:
                self.scenario.signal = signals.Points(t, value)
        else:
            self.scenario.signal = cls({name: getattr(values, name) for name in cls.constants})

    def _plant(self) -> None:
        drive = getattr(self.scenario, "drive", None)
        moved = drive is not None and drive.sets_velocity
        if moved and "plant" not in self.data:
            self.data["plant"] = {}
        if drive is None and isinstance(self.data.get("plant"), dict):
            return  # which keys are allowed depends on the drive
        table = self._table(tables.plant_table(not moved), "plant")
        if table is not None:
            self.scenario.mass = None if moved else table.mass
            self.scenario.initial = {"v": 0.0, **dict(table.initial)}

    def _together(self) -> None:
        """What can only be judged with every table in hand."""
        s = self.scenario
        states = [state.name for state in s.system.states]
        for name in s.solve.atol:
            if name not in states:
                text = f"{s.solve.atol[name]}: there is no such state (the states are {', '.join(states)})"
                self.problems.append((f"solve.atol.{name}", text))
        if not s.law.has_z and s.initial["z"] != 0:
            self.problems.append(("plant.initial.z", f"{s.initial['z']}: law '{s.law.name}' has no z; leave it out"))
        if s.law.jumps_at_rest and not s.drive.sets_velocity:
            text = f"missing: the force of law '{s.law.name}' jumps at v = 0, and a body under it cannot come to rest"
            self.problems.append(
                ("law.k_v", f"{text}; give k_v > 0 in s/m for a smooth sign, or drive.kind = 'velocity'")
            )
        needed = float(s.rows) * 8 * 2 * (1 + len(s.system.columns))
        if needed > (room := memory.available()):
            more = "more than " if s.rows >= _ROWS_LARGEST else ""
            text = f"{s.solve.t_end / s.output.step:.3g} rows would take {more}{memory.size(needed)} of memory"
            free = f"{memory.size(room)} are free; must be larger"
            self.problems.append(("output.step", f"{show(s.output.step)}: {text}, and {free}"))

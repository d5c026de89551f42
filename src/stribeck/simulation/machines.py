"""A machine with some of its numbers given lane by lane."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stribeck.arrays import Array
from stribeck.constants import Constant
from stribeck.errors import InputError
from stribeck.laws.base import PARAMETERS, Law
from stribeck.machine.dither import WAVES_A_STEP
from stribeck.machine.parts import SignalUse
from stribeck.scenario import Scenario
from stribeck.scenario.machine import Rig
from stribeck.scenario.machine.rig import AT_LIMIT, evaluate
from stribeck.signals.pieces import Pieces, merged
from stribeck.simulation.variations import LaneByLane, Place, Tables, Variations, arrays

_IN_PIECES = ("ramp", "step")  # signals whose constants make pieces


def vary_machine(scenario: Scenario, values: Mapping[str, ArrayLike]) -> Variations | LaneByLane:
    """A machine with values for each lane: in lanes where only numbers differ, one by one where the form does."""
    given = arrays(values)
    missing = {path: float(x[0]) for path, x in given.items() if path not in machine_places(scenario)}
    if missing:  # constants that are off, such as a play that is not given
        try:
            scenario = scenario.with_changes(missing)
        except InputError:
            return LaneByLane(scenario, values)
    if all(path in machine_places(scenario) for path in given):
        return MachineVariations(scenario, values)
    return LaneByLane(scenario, values)


def machine_places(scenario: Scenario) -> dict[str, Place]:
    """Every path that can be varied in lanes, and the constant it stands for."""
    rig = _rig(scenario)
    found: dict[str, Place] = {}
    for path, name in rig.values:
        found[_written(scenario, rig, path, name)] = (path, name)
    for body in rig.machine.bodies:
        if body.leader is None:
            found[f"{body.path}.initial.y"] = ("initial", f"{body.name}.y")
            if body.driven is None:
                found[f"{body.path}.initial.v"] = ("initial", f"{body.name}.v")
    for use, signal in rig.signals.items():
        if signal.kind in _IN_PIECES:
            found |= {f"{use.path}.{name}": (use.path, name) for name in signal.constants}
    return found


def _written(scenario: Scenario, rig: Rig, path: str, name: str) -> str:
    """How the file names a constant: parameters of a law stand in a table of their own, numbers of a list have a number."""
    if path in rig.laws:
        table: Any = scenario.data
        for word in path.split("."):
            table = table[word]
        inside = table.get("parameters")
        listed = name in PARAMETERS or (isinstance(inside, dict) and name in inside)
        return f"{path}.parameters.{name}" if listed else f"{path}.{name}"
    if name.startswith("weight_"):
        return f"{path}.force.{name.removeprefix('weight_')}"
    stem, _, number = name.rpartition("_")
    if number.isdigit() and stem in ("amplitude", "waves", "phase"):
        return f"{path}.{stem}.{number}"
    return f"{path}.{name}"


def _rig(scenario: Scenario) -> Rig:
    assert scenario.rig is not None
    return scenario.rig


class MachineVariations(Variations):
    """A machine and, by path, the values of some of its numbers: one for each lane."""

    def __init__(self, scenario: Scenario, values: Mapping[str, ArrayLike]) -> None:
        self.values, self.scenario, self.rig = arrays(values), scenario, _rig(scenario)
        self.places = machine_places(scenario)

    def part(self, lanes: NDArray[np.int64]) -> MachineVariations:
        """Some of the lanes."""
        return MachineVariations(self.scenario, {path: x[lanes] for path, x in self.values.items()})

    def columns(self, t: Array, states: Array, held: Array) -> dict[str, Array]:
        """The columns of the output, (lanes, times), from states and held outputs, (lanes, times, each)."""
        machine, shape = self.rig.machine, states.shape[:2]
        named = {state.name: states[:, :, i] for i, state in enumerate(machine.states)}
        tables, which = self._tables
        rows = np.stack([table.at(t) for table in tables])[which]
        segment = {name: rows[:, :, i] for i, name in enumerate(machine.piece_fields)}
        segment |= {name: held[:, :, i] for i, name in enumerate(machine.held)}
        values = {key: self.constant(*key) for key in machine.parameters}
        shaped = {key: x[:, np.newaxis] if isinstance(x, np.ndarray) else x for key, x in values.items()}
        found = evaluate(machine, shaped, segment, t, named)
        return {name: np.broadcast_to(np.asarray(x, float), shape) for name, x in found.items()}

    def atol(self) -> Array:
        """The absolute tolerance of each state."""
        names = [state.name for state in self.rig.machine.states]
        if not self._varied.keys() & set(self.rig.values):
            nominal = self.scenario.atol()
            return self._table([nominal[name] for name in names])
        rows = (self.scenario.atol_of(self._rig_of(lane)) for lane in range(len(self)))
        return np.array([[row[name] for name in names] for row in rows])

    def _rig_of(self, lane: int) -> Rig:
        own = {key: float(x[lane]) for key, x in self._varied.items() if key in self.rig.values}
        return replace(self.rig, values={**self.rig.values, **own})

    def thresholds(self) -> Array:
        """The threshold of each watched quantity, 0 for none."""
        rig, found = self.rig, list[Any](self.rig.thresholds())
        j = 0
        for contact in rig.machine.contacts:
            found[j] = self._varied.get((contact.law_path, "v_s"), found[j])
            j += 1
        for link in rig.machine.links:
            if "gap" in link.form:
                found[j] = self.constant(link.path, "gap") / 2
                j += 1
        for each in rig.machine.controllers:
            if each.sampling is None and "limit" in each.form:
                found[j] = self.constant(each.path, "limit") * AT_LIMIT
                j += 1
        return self._table(found) if found else np.zeros((len(self), 0))

    def more_events(self, lane: int, reached: float) -> list[tuple[float, int]]:
        """Events that no watched quantity tells: none."""
        return []

    def sampling(self) -> list[list[dict[str, float]]]:
        """Period, delay, noise and seed of the sampled controllers of each lane."""
        if not self.rig.machine.held:
            return []
        varied = any(path.endswith(".sampling") for path, _ in self._varied)
        return [self._rig_of(lane).sampling() for lane in range(len(self) if varied else 1)]

    def longest_step(self) -> Array:
        """The longest step that cannot miss a wave of a signal, s."""
        found = np.full(len(self), self.rig.longest_step)
        for use, signal in self.rig.signals.items():
            if (use.path, "frequency") in self._varied and signal.kind == "sine":
                found = np.minimum(found, 0.125 / self._varied[use.path, "frequency"])
        for each in self.rig.machine.controllers:
            if each.dither is not None and each.sampling is None and (each.dither.path, "frequency") in self._varied:
                found = np.minimum(found, WAVES_A_STEP / self._varied[each.dither.path, "frequency"])
        return found

    def pieces(self) -> Tables:
        """The signals as tables of pieces."""
        return Tables.of(*self._tables)

    @cached_property
    def _tables(self) -> tuple[list[Pieces], NDArray[np.int64]]:
        """The tables that occur, and which of them each lane has."""
        end = self.scenario.end
        varied: list[tuple[SignalUse, str]] = [
            (use, name)
            for use, signal in self.rig.signals.items() if use.turns or signal.kind in _IN_PIECES
            for name in signal.constants if (use.path, name) in self._varied
        ]  # fmt: skip
        if not varied:
            return [self.rig.pieces(end)], np.zeros(len(self), np.int64)
        table = self._table([self._varied[use.path, name] for use, name in varied])
        each, which = np.unique(table, axis=0, return_inverse=True)
        found = []
        for row in each:
            changes: dict[SignalUse, dict[str, float]] = {}
            for (use, name), x in zip(varied, row, strict=True):
                changes.setdefault(use, {})[name] = float(x)
            found.append(merged([self.rig.pieces_of(use, end, changes.get(use)) for use in self.rig.signals]))
        return found, np.asarray(which, np.int64).reshape(-1)

    def laws(self) -> dict[str, Law]:
        """The laws by the table of their constants."""
        return self.rig.laws

    def problems(self) -> list[str | None]:
        """What is wrong with each lane's values; None where nothing is."""
        found = super().problems()
        for path, x in self.values.items():
            if self.places[path][1] == "ratio":
                for lane in map(int, np.flatnonzero(x == 0)):
                    found[lane] = found[lane] or f"{path}: 0: must be a finite number other than 0"
        return found

    def _declared(self, path: str) -> Constant:
        owner, name = self.places[path]
        tables = self.rig.machine.tables
        if owner in self.rig.laws:
            return {**PARAMETERS, **self.rig.laws[owner].constants()}[name]
        known = tables[owner][0] if owner in tables else {}
        return known.get(name, Constant("", ""))

    @cached_property
    def _fixed(self) -> dict[Place, float | None]:
        found: dict[Place, float | None] = dict(self.rig.values)
        for path, law in self.rig.laws.items():
            found |= {(path, name): x for name, x in law.machine.items() if (path, name) not in found}
        return found

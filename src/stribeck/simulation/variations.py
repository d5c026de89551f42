"""A scenario in which some numbers have one value per lane. A lane is one simulation of an ensemble."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from types import SimpleNamespace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stribeck.arrays import Array
from stribeck.constants import Constant, kind_of, show
from stribeck.errors import InputError, arg, nearest
from stribeck.laws.base import PARAMETERS, STATIC_ABOVE_COULOMB, Law
from stribeck.machine.machine import INITIAL, Elements
from stribeck.machine.signal import SignalUse
from stribeck.machine.table import Key
from stribeck.scenario import Scenario
from stribeck.waveforms import Signal
from stribeck.waveforms.pieces import Pieces

_SHIFT = "shift."  # prefix of a state's name: an offset of its initial value


@dataclass(frozen=True)
class Tables:
    """The tables of signal pieces in one array, and the range of each lane's table."""

    whole: Pieces
    first: NDArray[np.int64]
    end: NDArray[np.int64]

    @classmethod
    def of(cls, tables: list[Pieces], which: NDArray[np.int64]) -> Tables:
        """Join the tables; ``which`` is the index of each lane's table."""
        end = np.cumsum([len(table.start) for table in tables])
        first = np.concatenate([[0], end[:-1]]).astype(np.int64)
        start = np.concatenate([table.start for table in tables])
        rows = np.concatenate([table.rows for table in tables])
        return cls(Pieces(start, rows, np.concatenate([t.restart for t in tables])), first[which], end[which])


def vary(scenario: Scenario, values: Mapping[str, ArrayLike]) -> Variations | LaneByLane:
    """A scenario with values for each lane.

    If only numbers differ, the lanes are simulated in parallel; if the structure differs, one by one.

    Raises:
        InputError: a path cannot be varied, or its values are not arrays of numbers of equal length.
    """
    given, unnamed = arrays(values), scenario.elements.unnamed
    if shared := [path for path in given if path.startswith("output.") or path == "solve.t_end"]:
        raise InputError([f"{path}: cannot be varied: the lanes share their times" for path in shared])
    if any(each.follows_others for each in scenario.elements):
        return LaneByLane(scenario, values)  # the controller's model of the plant changes with the plant
    known = scenario.places
    if all(path in known for path in given):
        return Variations(scenario, values)
    try:  # constants that are off, such as an omitted backlash
        scenario = scenario.with_changes({path: float(x[0]) for path, x in given.items() if path not in known})
    except InputError:
        return (Variations if unnamed else LaneByLane)(scenario, values)
    known = scenario.places
    unknown = [path for path in given if path not in known]
    numbers = not unnamed or all(path.startswith("law.") for path in unknown)  # a law may leave these unused
    return (LaneByLane if unknown and numbers else Variations)(scenario, values)


class Variations:
    """A scenario and, by path, the values of some of its numbers: one for each lane.

    Args:
        scenario: the scenario that all lanes share.
        values: arrays of equal length by path, such as ``{"law.k_v": [1e6, 1e7]}``; a single number holds for all.
            ``shift.NAME`` is added to a state at t = 0.

    Raises:
        InputError: a path cannot be varied, or its values are not such arrays.
    """

    def __init__(self, scenario: Scenario, values: Mapping[str, ArrayLike]) -> None:
        given = arrays(values)
        self.shift = {path.removeprefix(_SHIFT): x for path, x in given.items() if path.startswith(_SHIFT)}
        self.values = {path: x for path, x in given.items() if not path.startswith(_SHIFT)}
        self.played: Mapping[str, Sequence[Signal]] = {}  # by path, the signal of each lane
        self.scenario = scenario
        self.machine, self.places = scenario.elements, scenario.places
        if unknown := [path for path in self.values if path not in self.places]:
            known = f" (what can be: {', '.join(self.places)})"
            raise InputError([f"{n}: cannot be varied{nearest(n, self.places) or known}" for n in unknown])

    def __len__(self) -> int:
        return len(next(iter(self.values.values())))

    @property
    def numbers(self) -> dict[str, Array]:
        """The given values of all numbers that differ between lanes."""
        return self.values | {f"{_SHIFT}{name}": x for name, x in self.shift.items()}

    def part(self, lanes: NDArray[np.int64]) -> Variations:
        """Some of the lanes."""
        selection = Variations(self.scenario, {path: x[lanes] for path, x in self.numbers.items()})
        selection.played = {path: [each[i] for i in lanes] for path, each in self.played.items()}
        return selection

    def changes(self, lane: int) -> dict[str, float]:
        """The changes that turn the scenario into one lane's, for :meth:`Scenario.with_changes`."""
        return {path: float(x[lane]) for path, x in self.values.items()}

    def columns(self, t: Array, states: Array, held: Array, wanted: Sequence[str] = ()) -> dict[str, Array]:
        """The columns of the output, (lanes, times), from states and held outputs, (lanes, times, each).

        Args:
            wanted: some of the columns; all unless given.
        """
        machine, shape = self.scenario.system, states.shape[:2]
        named = {state.name: states[:, :, i] for i, state in enumerate(machine.states)}
        tables, which = self._tables
        rows = np.stack([table.at(t) for table in tables])
        rows = rows[which] if len(tables) > 1 else rows
        segment = {name: rows[:, :, i] for i, name in enumerate(machine.piece_fields)}
        segment |= {name: held[:, :, i] for i, name in enumerate((*machine.held, *machine.shown))}
        values = self._carried.values
        shaped = {key: x[:, np.newaxis] if isinstance(x, np.ndarray) else x for key, x in values.items()}
        columns = machine.output_columns(shaped, segment, t, named, wanted)
        return {name: np.broadcast_to(np.asarray(x, float), shape) for name, x in columns.items()}

    # -- inputs of the equations, a row for each lane --------------------------------------------------------------

    @cached_property
    def _carried(self) -> Elements:
        """The machine of all lanes: each constant that varies is an array with one value per lane."""
        return self.machine.with_values(self._constants) if self._constants else self.machine

    def parameters(self) -> Array:
        """The run-time constants of the compiled system."""
        return self._table([self._carried.values[key] for key in self.scenario.system.parameters])

    def initial(self) -> Array:
        """The states at t = 0."""
        given = self.scenario.initial
        names = [state.name for state in self.scenario.system.states]
        begin: Array = self._table([self._varied.get((INITIAL, name), given.get(name, 0.0)) for name in names])
        return begin + self._table([self.shift.get(name, 0.0) for name in names])

    def atol(self) -> Array:
        """The absolute tolerance of each state."""
        names = [state.name for state in self.scenario.system.states]
        try:
            tolerances = self.scenario.atol(self._carried)
            return self._table([tolerances[name] for name in names])
        except (TypeError, ValueError):  # a user's law whose scales do not accept arrays
            lanes = ({key: float(x[lane]) for key, x in self._constants.items()} for lane in range(len(self)))
            rows = (self.scenario.atol(self.machine.with_values(values)) for values in lanes)
            return np.array([[row[name] for name in names] for row in rows])

    def thresholds(self) -> Array:
        """The threshold of each watched quantity, 0 for none."""
        thresholds = self._carried.thresholds()
        return self._table(thresholds) if thresholds else np.zeros((len(self), 0))

    def sampling(self) -> list[list[dict[str, float]]]:
        """Period, delay, noise and seed of the sampled controllers of each lane."""
        if not self.scenario.system.held:
            return []
        varied = any(path.endswith("sampling") for path, _ in self._varied)
        every, lanes = self._carried.sampling(), range(len(self) if varied else 1)
        return [[{n: x[lane] if isinstance(x, np.ndarray) else x for n, x in each.items()} for each in every]
                for lane in lanes]  # fmt: skip

    def _signals(self, use: SignalUse, in_pieces: bool = False) -> tuple[Sequence[Signal], NDArray[np.int64]]:
        """The distinct signals of one place, and the index of each lane's; ``in_pieces``: distinct by their pieces."""
        if use.path in self.played:
            return self.played[use.path], np.arange(len(self))
        signal, in_code = self.machine.signals[use], set() if use.turns or not in_pieces else self.machine.values.keys()
        names = [n for n in signal.constants if (use.path, n) in self._varied and (use.path, n) not in in_code]
        if not names:
            return [signal], np.zeros(len(self), np.int64)
        table = self._table([self._varied[use.path, name] for name in names])
        each, which = np.unique(table, axis=0, return_inverse=True)
        rows = [dict(zip(names, map(float, row), strict=True)) for row in each]
        return [type(signal)({**signal.values, **row}) for row in rows], np.asarray(which, np.int64).reshape(-1)

    def longest_step(self) -> Array:
        """The longest step that cannot skip a wave of a signal, s."""
        longest = np.full(len(self), np.inf)
        for use in self.machine.signals:
            signals, which = self._signals(use)
            longest = np.minimum(longest, np.array([signal.longest_step for signal in signals])[which])
        for each in self._carried.controllers.values():
            longest = np.minimum(longest, each.longest_step())
        return longest

    def pieces(self) -> Tables:
        """The signals as tables of pieces."""
        return Tables.of(*self._tables)

    @cached_property
    def _tables(self) -> tuple[list[Pieces], NDArray[np.int64]]:
        """The distinct tables, and the index of each lane's."""
        parts = {use: self._signals(use, in_pieces=True) for use in self.machine.signals}
        rows = np.stack([np.zeros(len(self), np.int64), *(which for _, which in parts.values())], axis=1)
        each, lanes = np.unique(rows, axis=0, return_inverse=True)
        tables = []
        for row in each:
            signals = {use: parts[use][0][i] for use, i in zip(parts, row[1:], strict=True)}
            own = all(signals[use] is signal for use, signal in self.machine.signals.items())
            tables.append(self.scenario.pieces if own else self.machine.pieces(self.scenario.end, signals))
        return tables, np.asarray(lanes, np.int64).reshape(-1)

    # -- values that no scenario may have --------------------------------------------------------------------------

    def problems(self) -> list[str | None]:
        """The error of each lane's values, worded as in the validation of a scenario; None for a valid lane."""
        problems: list[str | None] = [None] * len(self)
        for path, x in self.values.items():
            constant = self.scenario.declared(path) or Constant("", "")
            for lane, value in enumerate(x.tolist()):
                if text := constant.problem(value):
                    problems[lane] = problems[lane] or f"{path}: {value}: {text}"
        for owner, law in self.machine.laws.items():
            self._relations(owner, law, problems)
        return problems

    def _relations(self, owner: str, law: Law, problems: list[str | None]) -> None:
        """Add the violated relations between the constants of a law."""
        paths = {place: path for path, place in self.places.items()}
        fixed, names = law.machine | law.values, {**PARAMETERS, **law.constants()}
        values = {name: self._carried.values.get((owner, name), fixed.get(name)) for name in names}
        for relation in dict.fromkeys((*law.relations, *STATIC_ABOVE_COULOMB)):
            needs = {name: values[name] for name in relation.needs}
            if any(x is None for x in needs.values()) or not any((owner, name) in self._varied for name in needs):
                continue
            for lane, row in enumerate(self._table([x for x in needs.values() if x is not None])):
                numbers = dict(zip(needs, map(float, row), strict=True))
                if problems[lane] is None and not relation.holds(SimpleNamespace(**numbers)):
                    stated = ", ".join(f"{name} = {x}" for name, x in numbers.items() if name != relation.key)
                    path = paths.get((owner, relation.key), relation.key)
                    problems[lane] = f"{path}: {numbers[relation.key]}: must be {relation.allowed} ({stated})"

    # -- helpers ---------------------------------------------------------------------------------------------------

    @cached_property
    def _constants(self) -> dict[Key, Array]:
        """The run-time constants that vary."""
        return {key: x for key, x in self._varied.items() if key in self.machine.values}

    @cached_property
    def _varied(self) -> dict[Key, Array]:
        return {self.places[path]: x for path, x in self.values.items()}

    def _table(self, columns: Sequence[float | Array]) -> Array:
        return np.stack([np.broadcast_to(np.asarray(x, float), (len(self),)) for x in columns], axis=1)


class LaneByLane:
    """Variations of a scenario whose structure depends on its numbers: each lane is a scenario of its own.

    Every number of the scenario can vary. Lanes are validated one by one.
    """

    def __init__(self, scenario: Scenario, values: Mapping[str, ArrayLike]) -> None:
        self.scenario, self.values = scenario, arrays(values)
        if unknown := [text for text in self._wrong(0) if "unknown key" in text or "no such" in text]:
            raise InputError(unknown)

    def __len__(self) -> int:
        return len(next(iter(self.values.values())))

    def changes(self, lane: int) -> dict[str, float]:
        """The changes that turn the scenario into one lane's."""
        return {path: self._number(path, float(x[lane])) for path, x in self.values.items()}

    def _number(self, path: str, x: float) -> float:
        """The number as an integer where the scenario has one, such as a seed."""
        now: object = self.scenario.data
        for name in path.split("."):
            now = now.get(name) if isinstance(now, dict) else None
        whole = path.endswith((".seed", ".max_steps")) or (isinstance(now, int) and not isinstance(now, bool))
        return int(x) if whole and x.is_integer() else x

    def problems(self) -> list[str | None]:
        """The error of each lane's values; None for a valid lane."""
        return [next(iter(self._wrong(lane)), None) for lane in range(len(self))]

    def _wrong(self, lane: int) -> list[str]:
        try:
            self.scenario.with_changes(self.changes(lane))
        except InputError as error:
            return list(error.problems)
        return []


def arrays(values: Mapping[str, ArrayLike]) -> dict[str, Array]:
    """The values as arrays of one length."""
    if not isinstance(values, Mapping):
        raise InputError(f"{arg('vary')}: {show(values)}: must be a mapping of paths to values, not {kind_of(values)}")
    if not values:
        raise InputError("nothing is varied: give a path with its values, such as {'law.k_v': [1e6, 1e7]}")
    columns, problems = {}, []
    for path, given in values.items():
        try:
            x = np.asarray(np.ma.filled(given, np.nan) if np.ma.isMaskedArray(given) else given)
        except ValueError:  # lists of several lengths
            x = np.zeros((0, 0))
        if x.dtype.kind not in "iuf" or x.ndim > 1 or x.size == 0:
            problems.append(f"{path}: must be a list of numbers with one for each lane, not {kind_of(given)}")
        else:
            columns[str(path)] = x.astype(float)
    if problems:
        raise InputError(problems)
    lengths = {path: len(x) for path, x in columns.items() if x.ndim}
    count = max(lengths.values(), default=1)
    if wrong := [
        f"{path}: {n} values: must be as many as the others have ({count})" for path, n in lengths.items() if n != count
    ]:
        raise InputError(wrong)
    return {path: np.ascontiguousarray(np.broadcast_to(x, (count,))) for path, x in columns.items()}

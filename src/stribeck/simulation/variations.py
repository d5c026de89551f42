"""A scenario with some of its numbers given lane by lane: what an ensemble simulates."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from types import SimpleNamespace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stribeck.arrays import Array
from stribeck.constants import Constant, kind_of
from stribeck.errors import InputError, nearest
from stribeck.expressions.ops import Value
from stribeck.laws.base import PARAMETERS, STATIC_ABOVE_COULOMB, Law
from stribeck.scenario import Scenario
from stribeck.signals import Signal
from stribeck.signals.pieces import Pieces
from stribeck.signals.pieces import pieces as pieces_of
from stribeck.system import Groups, System

Place = tuple[str, str]  # owner and name of a constant; the owner "initial" has the states at t = 0


@dataclass(frozen=True)
class Tables:
    """The tables of signal pieces that occur, one after the other, and where that of each lane stands."""

    whole: Pieces
    first: NDArray[np.int64]
    end: NDArray[np.int64]

    @classmethod
    def of(cls, tables: list[Pieces], which: NDArray[np.int64]) -> Tables:
        """From the tables and which of them each lane has."""
        end = np.cumsum([len(table.start) for table in tables])
        first = np.concatenate([[0], end[:-1]]).astype(np.int64)
        start = np.concatenate([table.start for table in tables])
        rows = np.concatenate([table.rows for table in tables])
        return cls(Pieces(start, rows, np.concatenate([t.restart for t in tables])), first[which], end[which])


def vary(scenario: Scenario, values: Mapping[str, ArrayLike]) -> Variations | LaneByLane:
    """A scenario with values for each lane.

    Raises:
        InputError: a path is none that can be varied, or its values are no arrays of numbers of equal length.
    """
    if scenario.rig is not None:
        from stribeck.simulation.machines import vary_machine

        return vary_machine(scenario, values)
    return (LaneByLane if scenario.drive.differentiates else Variations)(scenario, values)


class Variations:
    """A scenario of a single body and, by path, the values of some of its numbers: one for each lane.

    Args:
        scenario: what all lanes share.
        values: arrays of equal length by path, such as ``{"law.k_v": [1e6, 1e7]}``; a single number holds for all.

    Raises:
        InputError: a path is none that can be varied, or its values are no such arrays.
    """

    def __init__(self, scenario: Scenario, values: Mapping[str, ArrayLike]) -> None:
        self.values = arrays(values)
        off = {
            f"law.{name}": 1.0 for name, x in scenario.law.values.items() if x is None and f"law.{name}" in self.values
        }
        self.scenario = scenario.with_changes(off) if off else scenario  # on; the lanes have their own values
        self.places = _places(self.scenario)
        if unknown := [path for path in self.values if path not in self.places]:
            raise InputError([f"{path}: cannot be varied{_guess(path, self.places)}" for path in unknown])

    def __len__(self) -> int:
        return len(next(iter(self.values.values())))

    def part(self, lanes: NDArray[np.int64]) -> Variations:
        """Some of the lanes."""
        return Variations(self.scenario, {path: x[lanes] for path, x in self.values.items()})

    def changes(self, lane: int) -> dict[str, float]:
        """What makes the scenario that of one lane, for :meth:`Scenario.with_changes`."""
        return {path: float(x[lane]) for path, x in self.values.items()}

    def columns(self, t: Array, states: Array, held: Array) -> dict[str, Array]:
        """The columns of the output, (lanes, times), from the states, (lanes, times, states), and held outputs."""
        system, shape = self.scenario.system, states.shape[:2]
        assert isinstance(system, System)
        named = {state.name: states[:, :, i] for i, state in enumerate(system.states)}
        signals, which = self.signals
        signal = np.stack([each.at(t) for each in signals])[which]
        with np.errstate(all="ignore"):
            found = system.quantities(self.groups(lambda x: x[:, np.newaxis]), signal, named)
        return {c.name: np.broadcast_to(np.asarray(found[c.name], float), shape) for c in system.columns}

    # -- what the equations take, a row for each lane --------------------------------------------------------------

    def constant(self, owner: str, name: str) -> Value:
        """A constant: an array over the lanes where it varies, else a number, or None."""
        return self._varied.get((owner, name), self._fixed.get((owner, name)))

    def groups(self, shape: Callable[[Array], Array] = lambda x: x) -> Groups:
        """The constants by owner; those that vary are arrays over the lanes, which ``shape`` may reshape."""
        fixed = self.scenario.groups()
        varied = {owner: {n: shape(x) for (o, n), x in self._varied.items() if o == owner} for owner in vars(fixed)}
        return Groups(**{owner: SimpleNamespace(**{**vars(p), **varied[owner]}) for owner, p in vars(fixed).items()})

    def parameters(self) -> Array:
        """The run-time constants of the compiled system."""
        return self._table([self.constant(*key) for key in self.scenario.system.parameters])

    def initial(self) -> Array:
        """The states at t = 0."""
        given = self.scenario.initial
        names = [state.name for state in self.scenario.system.states]
        return self._table([self._varied.get(("initial", name), given.get(name, 0.0)) for name in names])

    def atol(self) -> Array:
        """The absolute tolerance of each state."""
        names = [state.name for state in self.scenario.system.states]
        try:
            found = self.scenario.atol(self.groups())
            return self._table([found[name] for name in names])
        except (TypeError, ValueError):  # scales that are written for numbers
            rows = (self.scenario.atol(self.groups(lambda x, lane=i: x[lane])) for i in range(len(self)))  # type: ignore[misc]
            return np.array([[row[name] for name in names] for row in rows])

    def threshold(self) -> Array:
        """The speed that slip and stick are told by; 0 for none."""
        return self._table([self._varied.get(("law", "v_s"), self.scenario.threshold)])[:, 0]

    def thresholds(self) -> Array:
        """The threshold of each watched quantity, 0 for none."""
        return np.repeat(self.threshold()[:, np.newaxis], len(self.scenario.system.watched), axis=1)

    def more_events(self, lane: int, reached: float) -> list[tuple[float, int]]:
        """Events of a lane that no state tells, as far as it came (:meth:`Single.more_events`)."""
        if not self.scenario.single.drive.sets_velocity or not (threshold := float(self.threshold()[lane])) > 0:
            return []
        signals, which = self.signals
        return [(t, int(not rises)) for t, rises in signals[which[lane]].crossings(threshold, reached)]

    def sampling(self) -> list[list[dict[str, float]]]:
        """Period, delay, noise and seed of the sampled controllers of each lane."""
        return []

    @cached_property
    def signals(self) -> tuple[list[Signal], NDArray[np.int64]]:
        """The signals that occur, and which of them each lane has."""
        signal = self.scenario.signal
        names = [name for owner, name in self._varied if owner == "signal"]
        if not names:
            return [signal], np.zeros(len(self), np.int64)
        table = self._table([self._varied["signal", name] for name in names])
        each, which = np.unique(table, axis=0, return_inverse=True)
        rows = [dict(zip(names, map(float, row), strict=True)) for row in each]
        return [type(signal)({**signal.values, **row}) for row in rows], np.asarray(which, np.int64).reshape(-1)

    def longest_step(self) -> Array:
        """The longest step that cannot miss a wave of the signal, s."""
        signals, which = self.signals
        return np.array([signal.longest_step for signal in signals])[which]

    def pieces(self) -> Tables:
        """The signals as tables of pieces."""
        signals, which = self.signals
        return Tables.of([pieces_of(signal) for signal in signals], which)

    # -- values that no scenario may have --------------------------------------------------------------------------

    def problems(self) -> list[str | None]:
        """What is wrong with each lane's values, in the words of a scenario's validation; None where nothing is."""
        found: list[str | None] = [None] * len(self)
        for path, x in self.values.items():
            constant = self._declared(path)
            bad = ~np.isfinite(x)
            if constant.above is not None:
                bad |= ~(x > constant.above)
            if constant.at_least is not None:
                bad |= ~(x >= constant.at_least)
            for lane in map(int, np.flatnonzero(bad)):
                found[lane] = found[lane] or f"{path}: {x[lane]}: must be {constant.allowed}"
        for owner, law in self.laws().items():
            self._relations(owner, law, found)
        return found

    def laws(self) -> dict[str, Law]:
        """The laws by the owner of their constants."""
        return {"law": self.scenario.law}

    def _relations(self, owner: str, law: Law, found: list[str | None]) -> None:
        """What is wrong with the constants of a law taken together."""
        paths = {place: path for path, place in self.places.items()}
        values = {name: self.constant(owner, name) for name in {**PARAMETERS, **law.constants()}}
        for relation in dict.fromkeys((*law.relations, *STATIC_ABOVE_COULOMB)):
            needs = {name: values[name] for name in relation.needs}
            if any(x is None for x in needs.values()) or not any((owner, name) in self._varied for name in needs):
                continue
            for lane, row in enumerate(self._table(list(needs.values()))):
                own = dict(zip(needs, map(float, row), strict=True))
                if found[lane] is None and not relation.holds(SimpleNamespace(**own)):
                    stated = ", ".join(f"{name} = {x}" for name, x in own.items() if name != relation.key)
                    path = paths.get((owner, relation.key), relation.key)
                    found[lane] = f"{path}: {own[relation.key]}: must be {relation.allowed} ({stated})"

    def _declared(self, path: str) -> Constant:
        owner, name = self.places[path]
        s = self.scenario
        tables: dict[str, Mapping[str, Constant]] = {
            "law": {**PARAMETERS, **s.law.constants()}, "drive": s.drive.constants, "signal": s.signal.constants,
            "plant": s.plant.constants, "initial": {},
        }  # fmt: skip
        return tables[owner].get(name, Constant("", ""))

    # -- helpers ---------------------------------------------------------------------------------------------------

    @cached_property
    def _varied(self) -> dict[Place, Array]:
        return {self.places[path]: x for path, x in self.values.items()}

    @cached_property
    def _fixed(self) -> dict[Place, float | None]:
        s = self.scenario
        found: dict[Place, float | None] = {("law", name): x for name, x in (s.law.machine | s.law.values).items()}
        return {**found, **s.values(), **{("signal", name): x for name, x in s.signal.values.items()}}

    def _table(self, columns: list[Array | float]) -> Array:
        return np.stack([np.broadcast_to(np.asarray(x, float), (len(self),)) for x in columns], axis=1)


class LaneByLane:
    """The same for scenarios that are more than a body under a drive: each lane is a scenario of its own.

    Whatever is a number in the scenario can vary; lanes are validated one by one.
    """

    def __init__(self, scenario: Scenario, values: Mapping[str, ArrayLike]) -> None:
        self.scenario, self.values = scenario, arrays(values)
        if unknown := [text for text in self._wrong(0) if "unknown key" in text]:
            raise InputError(unknown)

    def __len__(self) -> int:
        return len(next(iter(self.values.values())))

    def changes(self, lane: int) -> dict[str, float]:
        """What makes the scenario that of one lane."""
        return {path: self._number(path, float(x[lane])) for path, x in self.values.items()}

    def _number(self, path: str, x: float) -> float:
        """A whole number where the scenario has one, such as a seed."""
        now: object = self.scenario.data
        for name in path.split("."):
            now = now.get(name) if isinstance(now, dict) else None
        seed = path.endswith(".seed") or (isinstance(now, int) and not isinstance(now, bool))
        return int(x) if seed and x.is_integer() else x

    def problems(self) -> list[str | None]:
        """What is wrong with each lane's values; None where nothing is."""
        return [next(iter(self._wrong(lane)), None) for lane in range(len(self))]

    def _wrong(self, lane: int) -> list[str]:
        try:
            self.scenario.with_changes(self.changes(lane))
        except InputError as error:
            return list(error.problems)
        return []


def arrays(values: Mapping[str, ArrayLike]) -> dict[str, Array]:
    """The values as arrays of one length."""
    if not values:
        raise InputError("nothing is varied: give a path with its values, such as {'law.k_v': [1e6, 1e7]}")
    found, problems = {}, []
    for path, given in values.items():
        try:
            x = np.asarray(given)
        except ValueError:  # lists of several lengths
            x = np.zeros((0, 0))
        if x.dtype.kind not in "iuf" or x.ndim > 1 or x.size == 0:
            problems.append(f"{path}: must be a list of numbers with one for each lane, not {kind_of(given)}")
        else:
            found[str(path)] = x.astype(float)
    if problems:
        raise InputError(problems)
    lengths = {path: len(x) for path, x in found.items() if x.ndim}
    count = max(lengths.values(), default=1)
    if wrong := [
        f"{path}: {n} values: must be as many as the others have ({count})" for path, n in lengths.items() if n != count
    ]:
        raise InputError(wrong)
    return {path: np.ascontiguousarray(np.broadcast_to(x, (count,))) for path, x in found.items()}


def _places(scenario: Scenario) -> dict[str, Place]:
    """Every path that can be varied, and the constant it stands for."""
    s, table = scenario, scenario.data["law"].get("parameters")
    inside = {*PARAMETERS, *(table if isinstance(table, dict) else ())}
    names = [*s.law.values, *(name for name in s.law.machine if name not in s.law.values)]
    places: dict[str, Place] = {f"law.{'parameters.' if n in inside else ''}{n}": ("law", n) for n in names}
    places |= {f"plant.{name}": ("plant", name) for name in s.plant_values}
    allowed = [
        state.name for state in s.system.states if state.name in ("y", "v", "z", *(x.name for x in s.plant.states))
    ]
    places |= {f"plant.initial.{name}": ("initial", name) for name in allowed}
    places |= {f"drive.{name}": ("drive", name) for name in s.drive.constants}
    return places | {f"drive.signal.{name}": ("signal", name) for name in s.signal.constants}


def _guess(path: str, known: Mapping[str, object]) -> str:
    return nearest(path, known) or f" (what can be: {', '.join(known)})"

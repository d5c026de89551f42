"""What each number of a machine's file does to what the solver is given, measured: no formula is written a second time.

The scenario is made anew with the number changed, and the arrays are compared. Where they change in proportion to the
change of the number it becomes a slider; what does more (another table of pieces, another structure) stays as it is.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from stribeck.arrays import Array
from stribeck.constants import Constant
from stribeck.errors import InputError, StribeckNote
from stribeck.explore.numbers import MOST_POINTS, Number, number_of, of_run
from stribeck.scenario import Scenario
from stribeck.scenario.declared import declared
from stribeck.simulation.native import solver_input

Arrays = dict[str, Array]
# How far a slider goes: as far as the file stays valid and the effect in proportion.
_REACHES = (10.0, 3.0, 1.5, 1.1, 1.01)
_INSIDE = (0.0, 0.37, 0.71)  # shares of the slider at which the effect measured at its upper end is tested
_ROUNDING = 1e-12
_COUNTS = ("solve.t_end", "solve.max_steps", "output.step")  # of the run, which the page counts itself


@dataclass(frozen=True)
class Measured:
    """A machine with its parameter sets written out, its numbers that can be turned, the others, and the file's arrays."""

    scenario: Scenario
    numbers: list[Number]
    fixed: dict[str, float]
    arrays: Arrays


def measured(scenario: Scenario) -> Measured:
    """Every number of a machine's file with what it does."""
    scenario = _written_out(scenario)
    base = arrays_of(scenario)
    numbers: list[Number] = []
    fixed: dict[str, float] = {}
    for path, value in _leaves(scenario.data):
        found = None if path.startswith(("solve.", "output.")) else _measure(scenario, base, path, value)
        if found is not None:
            numbers.append(found)
        elif not path.startswith(("solve.", "output.")) or path.startswith("solve.atol."):
            fixed[path] = value
    for number in of_run(scenario):
        if number.path == "solve.max_steps":
            numbers.append(number)
            continue
        same = _measure(scenario, base, number.path, number.value, number)
        if same is not None:
            numbers.append(same)
        else:
            fixed[number.path] = number.value
    for number in _coupled(scenario, base, numbers):
        numbers.remove(number)
        fixed[number.path] = number.value
    return Measured(scenario, numbers, fixed, base)


def arrays_of(scenario: Scenario) -> Arrays:
    """What the solver is given, as flat arrays; of the longest step its inverse, to which frequencies are in proportion."""
    given = solver_input(scenario)
    found = {name: array.ravel() for name, array in given.doubles.items()}
    found |= {"rtol": np.array([given.numbers["rtol"]]), "least_rate": np.array([1 / given.numbers["h_limit"]])}
    return found | {"restart": given.restart.astype(float), "queue_room": np.array([float(given.queue_room)])}


def moved(arrays: Arrays, numbers: list[Number], values: Mapping[str, float]) -> Arrays:
    """The arrays after the numbers at some paths have been turned, as the page makes them."""
    found = {name: array.copy() for name, array in arrays.items()}
    for number in numbers:
        for name, i, rate in number.effects:
            found[name][i] += rate * (values.get(number.path, number.value) - number.value)
    return found


def _written_out(scenario: Scenario) -> Scenario:
    """With the constants in the file where it names a set of them."""
    rig = scenario.rig
    paths = {scenario.called.to_file(path): law for path, law in rig.laws.items()}
    changes = {f"{path}.parameters.{n}": x for path, law in paths.items() for n, x in law.machine.items()}
    named = {path: x for path, x in changes.items() if isinstance(_table(scenario.data, path), str)}
    return scenario.with_changes(named) if named else scenario


def _table(data: Mapping[str, object], path: str) -> object:
    found: object = data
    for word in path.split(".")[:-1]:
        found = found.get(word) if isinstance(found, Mapping) else None
    return found


def _leaves(table: object, path: str = "") -> Iterator[tuple[str, float]]:
    if isinstance(table, list | tuple) and len(table) > MOST_POINTS:
        return  # a record, not numbers to turn
    if isinstance(table, Mapping | list | tuple):
        pairs = table.items() if isinstance(table, Mapping) else enumerate(table)
        for key, value in pairs:
            if path or key not in ("schema", "name"):
                yield from _leaves(value, f"{path}.{key}" if path else str(key))
    elif isinstance(table, int | float) and not isinstance(table, bool):
        yield path, float(table)


def _declared(scenario: Scenario, path: str, value: float) -> Number:
    """The number with its unit and meaning, where a table of the machine declares them."""
    words = path.split(".")
    cut = len(words) - 1
    while words[cut].isdigit():
        cut -= 1
    group, name = ".".join(words[:cut]), ".".join(words[cut:])
    constant, size = _constant(scenario, group, name)
    return number_of(group, name, value, constant, size, "")


def _constant(scenario: Scenario, group: str, name: str) -> tuple[Constant, float]:
    own = declared(scenario, f"{group}.{name}")
    if own is not None:
        return own, 1.0
    rig = scenario.rig
    machine = rig.machine
    column, words = f"{group.split('.')[1]}.{name}" if "." in group else "", {"y": "position", "v": "velocity"}
    if group.endswith(".initial") and name in words:
        unit = next((c.unit for c in machine.columns if c.name == column), "")
        return Constant(unit, f"{words[name]} at t = 0"), 10 * rig.natural().get(column, 0.1)
    first, _, index = name.partition(".")
    if index.isdigit() and ".signal" in f".{group}":
        words = {"t": "time of point", "value": "the signal at point"}
        return Constant("s" if first == "t" else "", f"{words.get(first, first)} {int(index) + 1}"), 1.0
    return Constant("", ""), 1.0


def _changed(scenario: Scenario, changes: Mapping[str, float]) -> Arrays | None:
    """The arrays with other numbers; None where the file would not be valid, or another machine."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", StribeckNote)
            other = scenario.with_changes(changes)
    except InputError:
        return None
    return arrays_of(other) if other.system == scenario.system else None


def _same_shape(base: Arrays, found: Arrays | None) -> bool:
    return found is not None and (
        all(found[name].shape == array.shape for name, array in base.items())
        and all(np.array_equal(found[name], base[name]) for name in ("restart", "queue_room"))
    )


def _measure(scenario: Scenario, base: Arrays, path: str, value: float, given: Number | None = None) -> Number | None:
    whole = _declared(scenario, path, value) if given is None else given
    for reach in _REACHES:
        number = _narrower(whole, reach)
        effects = _effects(scenario, base, number)
        if effects is not None:
            of_law = scenario.called.to_machine(whole.group.removesuffix(".parameters")) in scenario.rig.laws
            found = whole if of_law else replace(number, closed=True)  # the page tests a law's own conditions
            return replace(found, effects=effects) if effects or path in _COUNTS else None
    return None


def _narrower(number: Number, reach: float) -> Number:
    """With a slider that goes less far from the number of the file."""
    value = number.value
    if number.log:
        return replace(number, low=max(number.low, value / reach), high=min(number.high, value * reach))
    share = reach / _REACHES[0]
    return replace(number, low=value + share * (number.low - value), high=value + share * (number.high - value))


def _effects(scenario: Scenario, base: Arrays, number: Number) -> tuple[tuple[str, int, float], ...] | None:
    """What the arrays change by for each unit of the number, if that is the same all along the slider."""
    upper = _changed(scenario, {number.path: number.high})
    if upper is None or not _same_shape(base, upper):
        return None
    found = []
    for name, array in base.items():
        if name == "atol" and number.group != "solve":
            continue  # tolerances follow natural scales: they stay those of the file
        rate = (upper[name] - array) / (number.high - number.value)
        found += [(name, int(i), float(rate[i])) for i in np.flatnonzero(rate)]
    made = [replace(number, effects=tuple(found))]
    for share in _INSIDE:
        value = number.low + share * (number.high - number.low)
        if not _as_predicted(scenario, base, made, {number.path: value}):
            return None
    return tuple(found)


def _as_predicted(scenario: Scenario, base: Arrays, numbers: list[Number], values: Mapping[str, float]) -> bool:
    found = _changed(scenario, values)
    if found is None or not _same_shape(base, found):
        return False
    expected = moved(base, numbers, values)
    names = [name for name in base if name != "atol" or all(n.group == "solve" for n in numbers)]
    return all(_close(found[name], expected[name], base[name]) for name in names)


def _close(found: Array, expected: Array, base: Array) -> bool:
    size = np.maximum(np.maximum(np.abs(found), np.abs(expected)), np.abs(base))
    return bool(np.all((found == expected) | (np.abs(found - expected) <= _ROUNDING * size)))


def _coupled(scenario: Scenario, base: Arrays, numbers: list[Number]) -> list[Number]:
    """Numbers that act on the same entry as another one, and not each by itself: a factor of what another one sets."""
    places = {n.path: {(name, i) for name, i, _ in n.effects} for n in numbers}
    for number in numbers:
        if number.group.endswith(".sampling"):  # a short period and a long delay: more outputs wait
            places[number.path].add(("queue_room", 0))
    found: list[Number] = []
    for first, second in combinations(numbers, 2):
        if first in found or second in found or not places[first.path] & places[second.path]:
            continue
        pair = first, second
        tested = [[n.value + 0.13 * (n.high - n.value) for n in pair]]
        if first.group.endswith(".sampling"):
            tested += [[first.low, second.high], [first.high, second.low]]
        if not all(_as_predicted(scenario, base, [*pair], {first.path: a, second.path: b}) for a, b in tested):
            found.append(second)
    return found

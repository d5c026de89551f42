"""The effect of each number of a machine's file on the solver's input, by finite differences.

The scenario is built again with the number changed, and the arrays are compared. So no formula is written twice. If the
arrays change in proportion to the number, it becomes a slider. A number with other effects (another table of pieces, another
structure) stays fixed.
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
from stribeck.explorer.numbers import MOST_POINTS, Number, number_of, of_run
from stribeck.scenario import Scenario
from stribeck.scenario.changes import entry_at
from stribeck.simulation.native import solver_input

Arrays = dict[str, Array]
# Reaches of a slider, tried in turn: the first for which the file is valid and the effect proportional.
_REACHES = (10.0, 3.0, 1.5, 1.1, 1.01)
_INSIDE = (0.0, 0.37, 0.71)  # shares of the slider at which proportionality is tested; no simple fractions
_TOLERANCES = ("atol", "fixed_atol")  # they stay those of the file, unless the solver's numbers are turned
_ROUNDING = 1e-12  # relative: well above the rounding of a few operations
_COUNTS = ("solve.t_end", "solve.max_steps", "output.step")  # the page itself computes their effects


@dataclass(frozen=True)
class Measured:
    """A machine with its numbers.

    Attributes:
        scenario: the machine, with its parameter sets written out.
        numbers: the numbers with a slider.
        fixed: the other numbers, by path.
        arrays: the solver's input at the file's numbers.
    """

    scenario: Scenario
    numbers: list[Number]
    fixed: dict[str, float]
    arrays: Arrays


def measured(scenario: Scenario) -> Measured:
    """Every number of a machine's file, with its effect on the solver's input."""
    scenario = _without_sets(scenario)
    base = arrays_of(scenario)
    numbers: list[Number] = []
    fixed: dict[str, float] = {}
    for path, value in _leaves(scenario.data):
        slider = None if path.startswith(("solve.", "output.")) else _measure(scenario, base, path, value)
        if slider is not None:
            numbers.append(slider)
        elif not path.startswith(("solve.", "output.")) or path.startswith("solve.atol."):
            fixed[path] = value
    for number in of_run(scenario):
        if number.path == "solve.max_steps":
            numbers.append(number)
            continue
        slider = _measure(scenario, base, number.path, number.value, number)
        if slider is not None:
            numbers.append(slider)
        else:
            fixed[number.path] = number.value
    for number in _coupled(scenario, base, numbers):
        numbers.remove(number)
        fixed[number.path] = number.value
    return Measured(scenario, numbers, fixed, base)


def arrays_of(scenario: Scenario) -> Arrays:
    """The solver's input as flat arrays; with the inverse of the longest step, which is proportional to frequencies."""
    given = solver_input(scenario)
    arrays = {name: array.ravel() for name, array in given.doubles.items()}
    arrays |= {"rtol": np.array([given.numbers["rtol"]]), "least_rate": np.array([1 / given.numbers["h_limit"]])}
    return arrays | {"restart": given.restart.astype(float), "queue_room": np.array([float(given.queue_room)])}


def moved(arrays: Arrays, numbers: list[Number], values: Mapping[str, float]) -> Arrays:
    """The arrays for other values at some paths, as the page computes them."""
    moved_arrays = {name: array.copy() for name, array in arrays.items()}
    for number in numbers:
        for name, i, rate in number.effects:
            moved_arrays[name][i] += rate * (values.get(number.path, number.value) - number.value)
    return moved_arrays


def _without_sets(scenario: Scenario) -> Scenario:
    """The scenario with the constants of its parameter sets written out."""
    paths = {scenario.called.to_file(path): law for path, law in scenario.elements.laws.items()}
    changes = {f"{path}.parameters.{n}": x for path, law in paths.items() for n, x in law.machine.items()}
    named = {p: x for p, x in changes.items() if isinstance(entry_at(scenario.data, p.rpartition(".")[0]), str)}
    return scenario.with_changes(named) if named else scenario


def _leaves(table: object, path: str = "") -> Iterator[tuple[str, float]]:
    if isinstance(table, list | tuple) and len(table) > MOST_POINTS:
        return  # a record, not numbers for sliders
    if isinstance(table, Mapping | list | tuple):
        pairs = table.items() if isinstance(table, Mapping) else enumerate(table)
        for key, value in pairs:
            if path or key not in ("schema", "name"):
                yield from _leaves(value, f"{path}.{key}" if path else str(key))
    elif isinstance(table, int | float) and not isinstance(table, bool):
        yield path, float(table)


def _declared_number(scenario: Scenario, path: str, value: float) -> Number:
    """The number with its unit and meaning, if a table of the machine declares them."""
    words = path.split(".")
    cut = len(words) - 1
    while words[cut].isdigit():
        cut -= 1
    group, name = ".".join(words[:cut]), ".".join(words[cut:])
    constant, size = _constant(scenario, group, name)
    return number_of(group, name, value, constant, size, "")


def _constant(scenario: Scenario, group: str, name: str) -> tuple[Constant, float]:
    constant = scenario.declared(f"{group}.{name}")
    if constant is not None:
        return constant, 1.0
    column, words = f"{group.split('.')[1]}.{name}" if "." in group else "", {"y": "position", "v": "velocity"}
    if group.endswith(".initial") and name in words:
        unit = next((c.unit for c in scenario.system.columns if c.name == column), "")
        return Constant(unit, f"{words[name]} at t = 0"), 10 * scenario.elements.natural.get(column, 0.1)
    first, _, index = name.partition(".")
    if index.isdigit() and ".signal" in f".{group}":
        words = {"t": "time of point", "value": "the signal at point"}
        return Constant("s" if first == "t" else "", f"{words.get(first, first)} {int(index) + 1}"), 1.0
    return Constant("", ""), 1.0


def _changed(scenario: Scenario, base: Arrays, changes: Mapping[str, float]) -> Arrays | None:
    """The arrays with other numbers; None if the file is invalid, or has another structure or arrays of other shapes."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", StribeckNote)
            other = scenario.with_changes(changes)
    except InputError:
        return None
    if other.system != scenario.system:
        return None
    arrays = arrays_of(other)
    same = all(arrays[name].shape == array.shape for name, array in base.items())
    return arrays if same and all(np.array_equal(arrays[n], base[n]) for n in ("restart", "queue_room")) else None


def _measure(scenario: Scenario, base: Arrays, path: str, value: float, given: Number | None = None) -> Number | None:
    full = _declared_number(scenario, path, value) if given is None else given
    for reach in _REACHES:
        number = _narrower(full, reach)
        effects = _effects(scenario, base, number)
        if effects is not None:
            of_law = scenario.called.to_machine(full.group.removesuffix(".parameters")) in scenario.elements.laws
            slider = full if of_law else replace(number, closed=True)  # the page tests a law's own conditions
            return replace(slider, effects=effects) if effects or path in _COUNTS else None
    return None


def _narrower(number: Number, reach: float) -> Number:
    """The number with a slider of smaller reach."""
    value = number.value
    if number.log:
        return replace(number, low=max(number.low, value / reach), high=min(number.high, value * reach))
    share = reach / _REACHES[0]
    return replace(number, low=value + share * (number.low - value), high=value + share * (number.high - value))


def _effects(scenario: Scenario, base: Arrays, number: Number) -> tuple[tuple[str, int, float], ...] | None:
    """The change of the arrays per unit of the number; None unless it is the same over the whole slider."""
    upper = _changed(scenario, base, {number.path: number.high})
    if upper is None:
        return None
    effects = []
    for name, array in base.items():
        if name in _TOLERANCES and number.group != "solve":
            continue
        rate = (upper[name] - array) / (number.high - number.value)
        effects += [(name, int(i), float(rate[i])) for i in np.flatnonzero(rate)]
    predicted = [replace(number, effects=tuple(effects))]
    for share in _INSIDE:
        value = number.low + share * (number.high - number.low)
        if not _as_predicted(scenario, base, predicted, {number.path: value}):
            return None
    return tuple(effects)


def _as_predicted(scenario: Scenario, base: Arrays, numbers: list[Number], values: Mapping[str, float]) -> bool:
    changed = _changed(scenario, base, values)
    if changed is None:
        return False
    expected = moved(base, numbers, values)
    names = [name for name in base if name not in _TOLERANCES or all(n.group == "solve" for n in numbers)]
    return all(_close(changed[name], expected[name], base[name]) for name in names)


def _close(changed: Array, expected: Array, base: Array) -> bool:
    size = np.maximum(np.maximum(np.abs(changed), np.abs(expected)), np.abs(base))
    return bool(np.all((changed == expected) | (np.abs(changed - expected) <= _ROUNDING * size)))


def _coupled(scenario: Scenario, base: Arrays, numbers: list[Number]) -> list[Number]:
    """Numbers whose effect depends on another number, such as two factors of the same entry."""
    places = {n.path: {(name, i) for name, i, _ in n.effects} for n in numbers}
    for number in numbers:
        if number.group.endswith(".sampling"):  # a short period with a long delay needs a longer queue
            places[number.path].add(("queue_room", 0))
    coupled: list[Number] = []
    for first, second in combinations(numbers, 2):
        if first in coupled or second in coupled or not places[first.path] & places[second.path]:
            continue
        pair = first, second
        tested = [[n.value + 0.13 * (n.high - n.value) for n in pair]]
        if first.group.endswith(".sampling"):
            tested += [[first.low, second.high], [first.high, second.low]]
        if not all(_as_predicted(scenario, base, [*pair], {first.path: a, second.path: b}) for a, b in tested):
            coupled.append(second)
    return coupled

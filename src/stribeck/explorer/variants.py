"""A scenario under every law that accepts its numbers, for the choice of laws in the page."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable, Mapping
from os.path import isfile
from pathlib import Path

from stribeck import examples, laws, parameter_sets
from stribeck.errors import InputError, StribeckNote
from stribeck.laws.base import PARAMETERS, Law
from stribeck.parameter_sets import read_toml
from stribeck.scenario import Scenario

_TURNED = ("points", "file", "ramp", "sine", "step")  # signals whose pieces the page rebuilds as their numbers change
_SET = "canudas1995"  # parameters of a law for which the scenario has none
# Initial values, from the machine's parameters, of constants that the scenario's law does not have.
_GUESSES: dict[str, Callable[[Mapping[str, float]], float]] = {
    "k_v": lambda p: 1e4 / p["v_s"],
    "z_ba": lambda p: 0.7 * p["F_c"] / p["sigma_0"],
    "g1": lambda p: p["F_s"] - p["F_c"],
    "g2": lambda p: 100 / p["v_s"],
    "g3": lambda p: 1 / p["v_s"],
    "g4": lambda p: p["F_c"],
    "g5": lambda p: 100 / p["v_s"],
    "g6": lambda p: p["sigma_2"],
}


def subject(
    given: Scenario | str | Path | Mapping[str, object] | None,
    changes: Mapping[str, object] | None = None,
    trust: bool = False,
) -> Scenario:
    """The scenario to explore: as it is, a file's, or the built-in stick-slip run under a law.

    Raises:
        InputError: there is no such file or law.
    """
    if isinstance(given, Scenario | Mapping):
        return Scenario.of(given)
    is_name = isinstance(given, str) and not (given.endswith(".toml") or isfile(given))  # noqa: PTH113 (Path raises for long names)
    if isinstance(given, str | Path) and not is_name:
        return Scenario.load(given, changes, trust=trust)
    # in the working directory, from where a law in a file is seen
    scenario = Scenario(read_toml(examples.path("stick_slip")))
    if given is not None:
        scenario = under(scenario, laws.find(given))
    return scenario.with_changes(changes) if changes else scenario


def measured_whole(scenario: Scenario) -> bool:
    """Whether the effect of each number is measured when the page is made; otherwise its place in the file implies it."""
    return not scenario.elements.unnamed or scenario.called.drive == "cascade" or scenario.signal.kind not in _TURNED


def variants(scenario: Scenario, wanted: Iterable[str] | None = None) -> dict[str, Scenario]:
    """The scenario under its own law, then under each other law offered, by the law's name.

    Args:
        scenario: the scenario to explore.
        wanted: names of the laws to offer beside the scenario's own; all of the package unless given.

    Raises:
        InputError: a law is unknown, or does not accept the scenario's numbers.
    """
    own_kind = type(scenario.law)
    by_law = {scenario.law.name: scenario}
    for name in laws.builtin() if wanted is None else wanted:
        kind = laws.find(name, scenario.folder)
        if kind is own_kind or kind.name in by_law:
            continue
        try:
            by_law[kind.name] = under(scenario, kind)
        except InputError:
            if wanted is not None:
                raise
    return by_law


def under(scenario: Scenario, kind: type[Law]) -> Scenario:
    """The scenario under another law. Constants of the same name keep their values."""
    law = scenario.law
    given = {**law.machine, **law.p.numbers}
    machine = {**parameter_sets.load(_SET).values, **{n: x for n, x in given.items() if n in PARAMETERS}}
    constants: dict[str, float | str | None] = {n: word for n, word in law.choices.items() if n in kind.constants()}
    for name, constant in kind.own_constants().items():
        if constant.choices:
            continue
        if name in given:
            constants[name] = given[name]
        elif constant.required or name == "k_v":
            constants[name] = _GUESSES[name](machine) if name in _GUESSES else constant.example or 1.0
    used = {n: x for n, x in machine.items() if n in PARAMETERS and (n in kind.uses or n in law.machine)}
    table = {
        "name": kind({**used, **constants}).to_dict()["name"],
        **constants,
        **({"parameters": used} if used else {}),
    }
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", StribeckNote)
        return Scenario({**scenario.data, "law": table}, folder=scenario.folder, trust=True)

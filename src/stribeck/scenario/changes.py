"""Changes to a scenario's data: ``--set PATH=VALUE`` and another law."""

from __future__ import annotations

import re
from collections.abc import Container, Mapping
from pathlib import Path, PurePath

import numpy as np

from stribeck import laws, parameter_sets
from stribeck.errors import InputError, nearest, note
from stribeck.laws.base import PARAMETERS
from stribeck.machine.element import SECTIONS
from stribeck.machine.table import FileTable

_DEEPEST = 8  # tables or lists within each other: a valid file has five (contacts.a.loads[0].force, and its weights)
_OBSERVER = "drive.observer"
_LAW_NAME = re.compile(rf"(.+\.)?law\.name|{_OBSERVER}\.name")
_INSIDE = ".parameters."


def unused_prefix(data: Mapping[str, object], prefix: str) -> str:
    """A prefix with which no name in a machine's tables begins: elements that are added under it replace none."""
    names = [name for section in SECTIONS if isinstance(table := data.get(section), Mapping) for name in table]
    while any(name.startswith(prefix) for name in names):
        prefix = f"_{prefix}"
    return prefix


def plain(value: object, path: str = "", depth: int = 0) -> object:
    """A copy made of plain Python values, as a file gives them: NumPy's become numbers and lists, a law its table.

    Raises:
        InputError: the value is nested deeper than any scenario.
    """
    if depth > _DEEPEST:
        raise InputError(f"{path}: nested too deeply: must be at most {_DEEPEST} tables or lists deep")
    if isinstance(value, laws.Law):
        return value.to_dict()
    if isinstance(value, FileTable):
        return plain_table(value.to_table(), path, depth)
    if isinstance(value, Mapping):
        return plain_table(value, path, depth)
    if isinstance(value, np.ndarray | np.generic):
        return plain(value.tolist(), path, depth)
    if isinstance(value, list | tuple):
        return [inner if type(inner) is float else plain(inner, path, depth + 1) for inner in value]
    return str(value) if isinstance(value, PurePath) else value


def plain_table(table: Mapping[str, object], path: str = "", depth: int = 0) -> dict[str, object]:
    """Such a copy of a table."""
    return {str(key): plain(inner, path or str(key), depth + 1) for key, inner in table.items()}


def changed(data: Mapping[str, object], changes: Mapping[str, object], folder: Path) -> dict[str, object]:
    """The data of a scenario with the values at the given paths replaced.

    A new ``law.name`` drops the constants of the old law that the new one does not have, and a note lists them. The same
    holds for ``contacts.NAME.law.name`` of a machine and for ``drive.observer.name``.
    """
    new = plain_table(data)
    _refuse_unknown_elements(new, changes)
    renamed = [path for path in changes if _LAW_NAME.fullmatch(path)]
    for path in renamed:
        _set(new, path, changes[path])
        _drop_foreign_constants(new, path.removesuffix(".name"), folder)
    for path in sorted(changes, key=lambda path: path.count(".")):  # a table before what is in it
        if path in renamed:
            continue
        law = path.partition(_INSIDE)[0] or "law"
        given = {other.removeprefix(f"{law}{_INSIDE}") for other in changes}
        if unfolds(path) and not _unfold_parameters(new, law, folder, given):
            continue
        _set(new, path, plain(changes[path], path))
    return new


def _refuse_unknown_elements(data: Mapping[str, object], changes: Mapping[str, object]) -> None:
    """A misspelt name would add an element: a body of which one constant is enough would go unnoticed.

    Raises:
        InputError: a path leads into an element that the machine does not have and that no other change adds.
    """
    problems = []
    for path in changes:
        section, _, rest = path.partition(".")
        name, inside, _ = rest.partition(".")
        there = data.get(section)
        if section not in SECTIONS or not inside or not isinstance(there, dict):
            continue
        if name not in there and f"{section}.{name}" not in changes:
            has = nearest(name, there) or f" (it has {', '.join(there) or 'none'})"
            problems.append(f"{path}: {section} has no {name!r}{has}")
    if problems:
        raise InputError(problems)


def unfolds(path: str) -> bool:
    """Whether a change of the value at a path takes a set of parameters apart."""
    return f".{path}".startswith(f".law{_INSIDE}") or f".law{_INSIDE}" in path


def entry_at(data: object, path: str) -> object:
    """What stands at a path; a number in it counts the entries of a list. None where there is nothing."""
    for name in path.split("."):
        if isinstance(data, list) and name.isdecimal():
            data = data[int(name)] if int(name) < len(data) else None
        else:
            data = data.get(name) if isinstance(data, Mapping) else None
    return data


def _unfold_parameters(data: dict[str, object], path: str, folder: Path, given: Container[str]) -> bool:
    """Put the values of a set in the place of its name; False where there is no such set, as validation will say.

    Args:
        given: parameters that are given beside the set.
    """
    law = entry_at(data, path)
    if not isinstance(law, dict) or not isinstance(law.get("parameters"), str):
        return True
    try:
        known: type[laws.Law] | None = laws.find(str(law.get("name")), folder)
    except InputError:
        known = None
    try:
        rotary = parameter_sets.load(law["parameters"], folder, ()).rotary
        law["parameters"] = laws.parameters_for(known, law["parameters"], folder, given)
    except InputError:
        return False
    if rotary and path == "law":
        data.setdefault("rotary", True)  # the set's name said so; bodies of a machine say it themselves
    return True


def _set(data: dict[str, object], path: str, value: object) -> None:
    """Put a value at a path; a number in the path counts the entries of a list from 0."""
    *parents, last = path.split(".")
    table: dict[str, object] | list[object] = data
    for i, name in enumerate(parents):
        inner = table[_entry(table, name, path)] if isinstance(table, list) else table.setdefault(name, {})
        if not isinstance(inner, dict | list):
            raise InputError(f"{path}: {'.'.join(parents[: i + 1])} is not a table, so it has no key '{last}'")
        table = inner
    if isinstance(table, list):
        table[_entry(table, last, path)] = value
    else:
        table[last] = value


def _entry(table: list[object], name: str, path: str) -> int:
    if not (name.isdigit() and int(name) < len(table)):
        raise InputError(f"{path}: {name!r}: must be a number from 0 to {len(table) - 1}, an entry of the list")
    return int(name)


def _drop_foreign_constants(data: dict[str, object], path: str, folder: Path) -> None:
    table, plant = entry_at(data, path), data.get("plant")
    if not isinstance(table, dict):
        return
    if path == _OBSERVER and table["name"] == "none":
        return _drop(path, table, {"name"}, "none")
    try:
        law = laws.find(table["name"], folder)
    except InputError:
        return  # named by the validation that follows
    _drop(path, table, {"name", "parameters", *law.constants()}, law.name)
    if isinstance(parameters := table.get("parameters"), dict):
        _drop(f"{path}.parameters", parameters, {*PARAMETERS, *law.constants()}, law.name)
    initial = plant.get("initial") if isinstance(plant, dict) else None
    if path == "law" and not law.has_z and isinstance(initial, dict) and "z" in initial:
        note(f"plant.initial.z: dropped: law '{law.name}' has no z")
        del initial["z"]


def _drop(path: str, table: dict[str, object], known: set[str], law: object) -> None:
    """Drop what is not known from the table at a path, with a note of each."""
    for name in [name for name in table if name not in known]:
        note(f"{path}.{name}: dropped: law '{law}' has no such constant")
        del table[name]

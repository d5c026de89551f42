"""Changes to a scenario's data: ``--set PATH=VALUE`` and another law."""

from __future__ import annotations

import copy
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from stribeck import laws, parameter_sets
from stribeck.errors import InputError, note
from stribeck.laws.base import PARAMETERS


def parse_assignment(text: str) -> tuple[str, Any]:
    """``PATH=VALUE`` as a path and a TOML value; what is no TOML is text.

    Raises:
        InputError: there is no '=' or no path.
    """
    path, sign, value = text.partition("=")
    path = path.strip()
    if not sign or not all(path.split(".")):
        raise InputError(f"--set {text!r}: must be PATH=VALUE, such as law.parameters.F_s=2.0")
    try:
        return path, tomllib.loads(f"x = {value}")["x"]
    except tomllib.TOMLDecodeError:
        return path, value.strip()


def changed(data: Mapping[str, Any], changes: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """The data of a scenario with the values at the given paths replaced.

    A new ``law.name`` drops the constants of the old law that the new one does not have, and says so.
    """
    new: dict[str, Any] = copy.deepcopy(dict(data))
    if "law.name" in changes:
        _set(new, "law.name", changes["law.name"])
        _drop_foreign_constants(new, folder)
    for path, value in changes.items():
        if path.startswith("law.parameters.") and isinstance(new.get("law", {}).get("parameters"), str):
            new["law"]["parameters"] = dict(parameter_sets.load(new["law"]["parameters"], folder).values)
        if path != "law.name":
            _set(new, path, value)
    return new


def _set(data: dict[str, Any], path: str, value: Any) -> None:
    *parents, last = path.split(".")
    table: Any = data
    for i, name in enumerate(parents):
        table = table.setdefault(name, {})
        if not isinstance(table, dict):
            raise InputError(f"{path}: {'.'.join(parents[: i + 1])} is not a table, so it has no key '{last}'")
    table[last] = value


def _drop_foreign_constants(data: dict[str, Any], folder: Path) -> None:
    table = data["law"]
    try:
        law = laws.find(table["name"], folder)
    except InputError:
        return  # named by the validation that follows
    parameters = table.get("parameters")
    places = [("law", table, {"name", "parameters"})]
    if isinstance(parameters, dict):
        places.append(("law.parameters", parameters, set(PARAMETERS)))
    for where, place, keep in places:
        for name in [name for name in place if name not in keep and name not in law.constants()]:
            note(f"{where}.{name}: dropped: law '{law.name}' has no such constant")
            del place[name]
    initial = data.get("plant", {}).get("initial") if isinstance(data.get("plant"), dict) else None
    if not law.has_z and isinstance(initial, dict) and "z" in initial:
        note(f"plant.initial.z: dropped: law '{law.name}' has no z")
        del initial["z"]

"""The drives that a file may name, and what of [drive] each of them reads."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Literal

from pydantic import Field

from stribeck import control, drives, plants
from stribeck.constants import show
from stribeck.errors import InputError
from stribeck.kinds import find_class, in_a_file
from stribeck.scenario.cascade import CascadeSettings
from stribeck.scenario.parts import Settings
from stribeck.scenario.tables import Fields, StrictTable, made, number

DRIVES: dict[str, type[drives.Drive]] = {**drives.KINDS, **control.KINDS}
_SETTINGS: dict[str, type[Settings]] = {control.PressureCascade.kind: CascadeSettings}


def settings(drive: type[drives.Drive]) -> type[Settings]:
    """What a drive has beside its constants and its signal."""
    return _SETTINGS.get(drive.kind, Settings)


def plants_of(drive: type[drives.Drive]) -> dict[str, type[plants.Plant]]:
    """The plants that a drive can move, by kind."""
    return {kind: plant for kind, plant in plants.KINDS.items() if plant.takes == drive.gives}


def find_plant(name: object, drive: type[drives.Drive], folder: Path) -> tuple[type[plants.Plant], str | None]:
    """The plant of that kind under a drive (FILE.py:NAME: a class of one's own), and what is wrong with it; where there
    is no such kind, the first that the drive can move."""
    known = plants_of(drive)
    first = next(iter(known.values()))
    if not in_a_file(name):
        return known.get(name if isinstance(name, str) else "", first), None
    try:
        found = find_class(name, folder, plants.Plant)
    except InputError as error:
        return first, "; ".join(error.problems)
    if found.takes != drive.gives:
        what = f"{found.takes.meaning}, {found.takes.unit}"
        return first, f"{show(name)}: takes {what}, which drive.kind = '{drive.kind}' does not give"
    return found, None


@cache
def drive_table(kind: str) -> type[StrictTable]:
    """The model of [drive] for a kind of drive; its signal is a table of its own."""
    drive = DRIVES[kind]
    fields: Fields = {"kind": (Literal[kind], Field(description=drive.meaning))}
    fields |= {name: number(constant) for name, constant in drive.constants.items()}
    fields |= settings(drive).fields()
    fields["signal"] = (dict[str, object], Field(description=f"{drive.signal.meaning}, {drive.signal.unit}"))
    return made(f"{kind.capitalize()}Drive", fields, drive.meaning)

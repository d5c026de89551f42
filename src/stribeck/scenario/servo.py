"""The pressure cascades of a machine file: each moves the valve of a pneumatic piston, which is one of the bodies."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from sys import float_info
from typing import Any

from pydantic import ValidationError

from stribeck.constants import show
from stribeck.control.cascade import PressureCascade
from stribeck.control.cylinder import Cylinder
from stribeck.laws.base import Law
from stribeck.machine.driving import DrivePart
from stribeck.machine.element import GROUND
from stribeck.machine.elements.cylinder import Piston
from stribeck.machine.law import unknown
from stribeck.machine.machine import Elements
from stribeck.machine.reading import Draft
from stribeck.machine.signal import SignalTable, SignalUse
from stribeck.machine.table import SYMBOLS, Key, Problem, Reading, joined, problems_of, table_path
from stribeck.scenario import tables
from stribeck.scenario.cascade import CascadeSettings, Places, cascade_table
from stribeck.signals import Signal

PISTON = Cylinder.kind
CONTROLLER = "pressure_cascade"
_NOT_OWN = ("on", "kind")  # of the controller's keys, what the cascade of schema 1 does not have


def split(tables_: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, Mapping[str, Any]]]:
    """The controllers of a file without its pressure cascades, and these."""
    servos = {n: t for n, t in tables_.items() if isinstance(t, Mapping) and t.get("kind") == CONTROLLER}
    return {n: t for n, t in tables_.items() if n not in servos}, servos


@dataclass
class Servos:
    """What the pressure cascades add to a machine; ``problems`` says what is wrong with them."""

    problems: list[Problem] = field(default_factory=list)
    drives: list[DrivePart] = field(default_factory=list)
    settings: dict[str, CascadeSettings] = field(default_factory=dict)
    signals: dict[SignalUse, Signal] = field(default_factory=dict)
    values: dict[Key, float] = field(default_factory=dict)
    initial: dict[str, float] = field(default_factory=dict)


def read(servos: Mapping[str, Mapping[str, Any]], draft: Draft, t_end: object) -> Servos:
    """The pressure cascades of a machine whose other elements have been read."""
    found = Servos()
    for name, table in servos.items():
        _read(found, name, table, draft, t_end)
    return found


def _read(found: Servos, name: str, table: Mapping[str, Any], draft: Draft, t_end: object) -> None:
    path, on = table_path("controllers", name), table.get("on")
    body = draft.tables["bodies"].get(on) if isinstance(on, str) else None
    kind = body.get("kind") if isinstance(body, Mapping) else getattr(body, "kind", None)
    if kind != PISTON:
        if isinstance(body, Mapping) and "kind" in body:
            return  # which is told
        text = f"{show(on)}: must be a body with kind = {PISTON!r}, whose valve this controller moves"
        found.problems.append((f"{path}.on", "missing: must be given (the piston)" if on is None else text))
        return
    assert isinstance(on, str)
    if other := next((drive for drive in found.drives if drive.on == on), None):
        text = f"{show(on)}: must be another body: {other.path} drives it already"
        found.problems.append((f"{path}.on", text))
    at, law, before = (
        Places(path, table_path("bodies", on), draft.reading.to_file(path)),
        _law_of(draft.machine, on),
        len(found.problems),
    )
    piston = draft.machine.bodies.get(on)
    model, own = cascade_table(), {k: x for k, x in table.items() if k not in _NOT_OWN}
    own["kind"] = PressureCascade.kind
    values, wrong = tables.validate(model, own, path)
    found.problems += unknown(own, path, model.model_fields) or wrong
    settings, more = CascadeSettings.read(values, own, law, piston, draft.reading.folder, draft.reading.executes, at)
    found.problems += more
    signal, use = _signal(found, table.get("signal"), name, draft.reading)
    if law is None and not (found.problems or draft.problems):
        text = f"{show(on)}: must have a contact with the ground, whose friction the cascade knows"
        found.problems.append((f"{path}.on", text))
    if not isinstance(settings, CascadeSettings) or not isinstance(piston, Piston) or len(found.problems) > before:
        return
    if values is None or law is None or signal is None or use is None:
        return
    if isinstance(t_end, int | float) and 0 < t_end <= float_info.max:
        found.problems += settings.judge(law, signal, piston.constants, float(t_end), at)
    given = {n: x for n in PressureCascade.constants if (x := getattr(values, n)) is not None}
    drive = DrivePart(name, settings.drive(given), on, use)
    found.drives.append(drive)
    found.settings[name], found.signals[use] = settings, signal
    numbers = {**{("drive", n): x for n, x in given.items()}, **settings.values()}
    found.values |= {(drive.table(owner), n): x for (owner, n), x in numbers.items()}
    found.values |= {(use.path, n): float(signal.values[n]) for n in use.constants()}
    found.initial |= {joined(name, n): x for n, x in drive.drive.starts.items()}


def _signal(
    found: Servos, table: object, name: str, reading: Reading
) -> tuple[Signal | None, SignalUse | None]:  # fmt: skip
    path = f"{table_path('controllers', name)}.signal"
    if not isinstance(table, Mapping):
        return None, None  # which is told
    try:
        made = SignalTable.model_validate(dict(table), context=reading)
    except ValidationError as error:
        found.problems += problems_of(error, path)
        return None, None
    return made.built, made.carrying(path, replace(SYMBOLS, name=name))


def _law_of(machine: Elements, body: str) -> Law | None:
    """The law of a body's first contact with the ground."""
    on = (x for x in machine.contacts.values() if x.start == body and x.end == GROUND)
    contact = next(on, None)
    return None if contact is None or contact.law is None else contact.law.law

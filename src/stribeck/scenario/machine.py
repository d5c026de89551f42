"""The machine of a file: its elements, and what the solvers take of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from sys import float_info
from typing import Any

from stribeck.constants import Column, rotary_words
from stribeck.laws.base import Law
from stribeck.machine.driving import DrivePart
from stribeck.machine.element import everything
from stribeck.machine.law import Friction
from stribeck.machine.machine import Elements
from stribeck.machine.reading import Draft
from stribeck.machine.system import MachineSystem
from stribeck.machine.table import Problem, Reading
from stribeck.scenario import servo
from stribeck.scenario.rig import Rig
from stribeck.scenario.schema1 import Called

_SAMPLES = 1e8  # of a controller in a run


@lru_cache(maxsize=64)
def same(machine: MachineSystem) -> MachineSystem:
    """The first of equal structures: what it finds out about itself, it finds once."""
    return machine


def read_machine(
    sections: Mapping[str, Any], reading: Reading, t_end: object, energy: bool, called: Called
) -> tuple[Rig | None, Elements | None, list[Problem]]:
    """The machine of a file's sections; None where something is wrong, or a file of code was not executed; all that is wrong,
    by the file's paths."""
    sections, servos = dict(sections), dict[str, Any]()
    if isinstance(sections.get("controllers"), Mapping):
        sections["controllers"], servos = servo.split(sections["controllers"])
    draft = Draft(sections, reading, energy)
    more = servo.read(servos, draft, t_end)
    found = draft.problems + more.problems + _too_many_samples(draft.machine, t_end)
    problems = [(called.to_file(path), text) for path, text in found]
    pistons = [called.to_file(x.path) for x in draft.machine.bodies.values() if x.kind == servo.PISTON]
    if energy:
        problems += [("output.energy", f"true: must be false with {x}, a pneumatic piston") for x in pistons]
    if problems or not draft.whole:
        return None, None, problems
    elements = draft.machine
    signals = elements.signals | more.signals
    listed = _listed(elements, called, more.drives) if elements.unnamed else ()
    system = same(MachineSystem(elements.symbolic, tuple(signals), tuple(more.drives), listed))
    initial = {each.of(s.name): s.start for each in elements for s in each.own_states(elements)}
    seeds = {n: x.sampling.seed for n, x in elements.controllers.items() if x.sampling is not None}
    rig = Rig(
        system, elements.values | more.values, signals, _laws(elements), initial | more.initial, seeds, more.settings
    )
    return rig, elements, problems


def _listed(elements: Elements, called: Called, drives: list[DrivePart]) -> tuple[tuple[Column, str], ...]:
    """The columns of a file of schema 1, and their quantities: the motion, the friction, what the drive adds, and the body's
    own states."""
    found = [c for each in (elements.bodies[""], elements.contacts[""]) for c in each.columns(elements)]
    if elements.bodies[""].turns:
        found = [replace(c, meaning=rotary_words(c.meaning)) for c in found]
    y, v, *inner, z, F, _ = found
    if drives:
        return tuple((c, c.name) for c in drives[0].drive.listed((y, v, z, F), tuple(inner)))
    return (*((c, c.name) for c in (y, v, z, F)), *called.columns, *((c, c.name) for c in inner))


def _laws(elements: Elements) -> dict[str, Law]:
    """The laws by their tables, each with the units of where it acts."""
    found: dict[str, Law] = {}
    for each in elements:
        for path, inside in everything(each, each.path):
            if isinstance(inside, Friction) and inside.law is not None:
                found[path] = inside.law.of_motion(each.turning(elements))
    return found


def _too_many_samples(elements: Elements, t_end: object) -> list[Problem]:
    # a whole number of a file may be larger than any float
    if not isinstance(t_end, int | float) or not t_end <= float_info.max:
        return []
    return [
        (f"{x.path}.sampling.period", f"{x.sampling.period:g}: more than {_SAMPLES:g} samples until solve.t_end = "
         f"{t_end:g} s; must be larger")
        for x in elements.controllers.values()
        if x.sampling is not None and t_end / x.sampling.period > _SAMPLES
    ]  # fmt: skip

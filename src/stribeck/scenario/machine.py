"""A machine file (``schema = 2``): its elements, and what the solvers take of them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from sys import float_info
from typing import Any

from stribeck.laws.base import Law
from stribeck.machine.element import everything
from stribeck.machine.law import Friction
from stribeck.machine.machine import SECTIONS, Elements
from stribeck.machine.reading import Draft
from stribeck.machine.system import MachineSystem
from stribeck.machine.table import Problem, Reading
from stribeck.scenario import servo
from stribeck.scenario.rig import Rig
from stribeck.scenario.single import same

_SAMPLES = 1e8  # of a controller in a run


def top() -> tuple[str, ...]:
    """The keys of a machine file."""
    return ("schema", "name", *SECTIONS, "solve", "output")


def read_machine(
    data: Mapping[str, Any], folder: Path, executes: bool, energy: bool
) -> tuple[Rig | None, Elements | None, list[Problem]]:
    """The machine of a file's tables; None where something is wrong, or a file of code was not executed; all that is wrong."""
    sections, servos = {s: data[s] for s in SECTIONS if s in data}, dict[str, Any]()
    if isinstance(sections.get("controllers"), Mapping):
        sections["controllers"], servos = servo.split(sections["controllers"])
    draft = Draft(sections, Reading(folder, executes), energy)
    solve = data.get("solve")
    t_end = solve.get("t_end") if isinstance(solve, Mapping) else None
    more = servo.read(servos, draft, t_end)
    problems = draft.problems + more.problems + _too_many_samples(draft.machine, t_end)
    pistons = [x for x in draft.machine.bodies.values() if x.kind == servo.PISTON]
    if energy:
        problems += [("output.energy", f"true: must be false with {x.path}, a pneumatic piston") for x in pistons]
    if problems or not draft.whole:
        return None, None, problems
    elements = draft.machine
    signals = elements.signals | more.signals
    system = same(MachineSystem(elements.symbolic, tuple(signals), tuple(more.drives)))
    initial = {each.of(s.name): s.start for each in elements for s in each.own_states(elements)}
    seeds = {n: x.sampling.seed for n, x in elements.controllers.items() if x.sampling is not None}
    rig = Rig(
        system, elements.values | more.values, signals, _laws(elements), initial | more.initial, seeds, more.settings
    )
    return rig, elements, problems


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

"""The machine of a file, from its sections."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from sys import float_info
from typing import Any

from stribeck.constants import Column, rotary_words
from stribeck.machine.machine import Elements
from stribeck.machine.reading import Draft
from stribeck.machine.table import Problem, Reading
from stribeck.scenario.schema1 import Called


def read_machine(
    sections: Mapping[str, Any], reading: Reading, t_end: object, energy: bool, called: Called
) -> tuple[Elements | None, list[Problem]]:
    """The machine of a file's sections, and all problems by the file's paths.

    The machine is None if there is a problem, or if a file of code was not executed.
    """
    draft = Draft(sections, reading, energy)
    by_path = list(draft.problems)
    if (
        isinstance(t_end, int | float) and 0 < t_end <= float_info.max
    ):  # a whole number of a file may be larger than any float
        by_path += [problem for each in draft.machine for problem in each.until(draft.machine, float(t_end))]
    problems = [(called.to_file(path), text) for path, text in by_path]
    pistons = [called.to_file(x.path) for x in draft.machine.bodies.values() if x.kind == "pneumatic"]
    if energy:
        problems += [("output.energy", f"true: must be false with {x}, a pneumatic piston") for x in pistons]
    if problems or not draft.whole:
        return None, problems
    elements = draft.machine
    return replace(elements, listed=_listed(elements, called) if elements.unnamed else ()), problems


def _listed(elements: Elements, called: Called) -> tuple[tuple[Column, str], ...]:
    """The columns of a file of schema 1, and their quantities.

    They are the motion, the friction, the drive's columns and the body's own states; a servo has its own order."""
    if called.order:
        known = {c.name: c for each in elements for c in each.columns(elements)}
        return tuple((known[name], name) for name in called.order if name in known)
    columns = [c for each in (elements.bodies[""], elements.contacts[""]) for c in each.columns(elements)]
    if elements.bodies[""].turns:
        columns = [replace(c, meaning=rotary_words(c.meaning)) for c in columns]
    y, v, *inner, z, F, _ = columns
    return (*((c, c.name) for c in (y, v, z, F)), *called.columns, *((c, c.name) for c in inner))

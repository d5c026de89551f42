"""A machine made in Python: elements, which are checked where they are written, and how they are put together.

::

    machine = Machine(
        Body("rotor", inertia=3.1e-5), Body("arm", inertia=0.35),
        Link("gear", "rotor", "arm", ratio=0.01, stiffness=9e3, damping=2.0, gap=2e-4),
        Contact("mesh", "arm", law("lugre_majorant", parameters="canudas1995", k_v=1e6)),
        Controller.cascade("axis", on="rotor", signal=Step(1.0, at=0.1), K_p=30, K_v=0.05),
    )
    solution = simulate(machine, t_end=4.0, step=1e-3)
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from stribeck.constants import kind_of
from stribeck.errors import InputError
from stribeck.machine.element import SECTIONS, Element
from stribeck.machine.reading import Draft
from stribeck.machine.table import Reading, refuse
from stribeck.scenario import Scenario
from stribeck.scenario.changes import changed, plain_table


class Machine:
    """A machine made of elements; it does not change.

    Args:
        *elements: bodies, links, contacts, loads, motors and controllers.
        name: what it is called.
        folder: where relative paths begin; the working directory unless given.

    Raises:
        InputError: whatever is wrong with the machine, one line for each problem: its path, the value and what is allowed.
    """

    def __init__(self, *elements: Element, name: str = "machine", folder: str | Path | None = None) -> None:
        sections: dict[str, dict[str, Any]] = {}
        seen: dict[str, str] = {}
        for each in elements:
            if not isinstance(each, Element):
                raise InputError(f"machine: must be made of bodies, links, contacts and so on, not {kind_of(each)}")
            if each.name in seen:
                text = f"{each.name!r}: must be another name: it is that of {seen[each.name]} already"
                raise InputError(f"{each.path}: {text}")
            seen[each.name] = each.path
            sections.setdefault(each.section, {})[each.name] = each
        folder = Path(folder or "")
        refuse(Draft(sections, Reading(folder)).problems)
        self.__dict__.update(_name=name, _sections=sections, _folder=folder)

    _name: str
    _sections: dict[str, dict[str, Any]]
    _folder: Path

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"{name}: a Machine does not change; replace({{PATH: VALUE}}) makes another")

    @property
    def name(self) -> str:
        """Its name."""
        return self._name

    def __getitem__(self, name: str) -> Element:
        """An element by its name."""
        element: Element = next(section[name] for section in self._sections.values() if name in section)
        return element

    def to_dict(self) -> dict[str, object]:
        """The tables of a machine file, without [solve] and [output]."""
        return plain_table({"schema": 2, "name": self.name, **self._sections})

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Machine) and self.to_dict() == other.to_dict()

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        sections = (f"{s} {', '.join(self._sections[s])}" for s in SECTIONS if s in self._sections)
        return f"<Machine {self.name}: {'; '.join(sections)}>"

    def replace(self, changes: Mapping[str, object]) -> Machine:
        """The same machine with other values at some paths: ``{"bodies.arm.inertia": 0.4}``; a path of two words with a table
        adds an element.

        Raises:
            InputError: a path leads into an element that the machine does not have, or what comes out is no valid machine.
        """
        data = changed(self.to_dict(), changes, self._folder)
        draft = Draft({section: data[section] for section in SECTIONS if section in data}, Reading(self._folder))
        refuse(draft.problems)
        return Machine(*draft.machine, name=self.name, folder=self._folder)

    def scenario(self, t_end: float, step: float | None = None, *, energy: bool = False, **solve: object) -> Scenario:
        """The scenario to simulate, until ``t_end`` (s), with a row every ``step`` (s; t_end/1000 unless given).

        Further arguments are those of [solve], such as ``rtol``.

        Raises:
            InputError: whatever is wrong with the times, one line for each problem.
        """
        output = {"step": t_end / 1000 if step is None else step, "energy": energy}
        given = {"schema": 2, "name": self.name, **self._sections, "solve": {"t_end": t_end, **solve}, "output": output}
        return Scenario(given, folder=self._folder)

    def show(self) -> str:
        """The machine as text, as 'stribeck run --show' prints it."""
        from stribeck.scenario import schematic  # of no use to what is simulated

        return schematic.text(self.scenario(1.0).elements, self.name)


def scenario_of(
    given: Machine | Scenario | str | Path | Mapping[str, object], t_end: float | None, step: float | None, **solve: Any
) -> Scenario:
    """The scenario that ``simulate`` is given, with other times if these are given.

    Raises:
        InputError: it is no valid scenario, or a machine without ``t_end``.
    """
    if isinstance(given, Machine):
        if t_end is None:
            raise InputError("t_end: missing: must be given for a Machine (the end of the simulation, s)")
        return given.scenario(t_end, step, **solve)
    scenario = Scenario.of(given)
    times = {"solve.t_end": t_end, "output.step": step, **{f"solve.{name}": x for name, x in solve.items()}}
    changes = {path: x for path, x in times.items() if x is not None}
    return scenario.with_changes(changes) if changes else scenario

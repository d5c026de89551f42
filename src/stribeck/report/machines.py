"""The plot page of a machine: a row of panels for each body, contact, link, load, motor and controller."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from stribeck.machine.system import Machine
from stribeck.report import plots
from stribeck.simulation import Solution

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_ROW, _HEAD = 1.55, 0.6  # inches
Panel = tuple[str, str, tuple[str, ...]]  # title, the column of the abscissa, those of the ordinate


def panels(machine: Machine) -> list[tuple[Panel, Panel | None]]:
    """The rows of the page; the second panel of a row may be missing, and the first then has its width."""
    rows: list[tuple[Panel, Panel | None]] = []
    for body in machine.bodies:
        if body.leader is None:  # what is tied moves in proportion
            tied = [other.name for other in machine.bodies if machine.leader(other.name) is body and other is not body]
            title = f"{body.name} (tied to it: {', '.join(tied)})" if tied else body.name
            rows.append(((title, "t", (f"{body.name}.y",)), ("", "t", (f"{body.name}.v",))))
    for contact in machine.contacts:
        force = (f"{contact.name}.F",)
        rows.append(((f"{contact.name}, {contact.law.name}", "t", force), ("", f"{contact.name}.w", force)))
    names = [*(link.name for link in machine.links), *(load.name for load in machine.loads)]
    forces: list[Panel] = [(name, "t", (f"{name}.f",)) for name in names]
    rows += [(forces[i], forces[i + 1] if i + 1 < len(forces) else None) for i in range(0, len(forces), 2)]
    rows += [((m.name, "t", (f"{m.name}.i",)), ("", "t", (f"{m.name}.V",))) for m in machine.motors]
    for each in machine.controllers:
        first = (f"{each.name} and what it measures", "t", (f"{each.name}.r", f"{each.measures}.y"))
        rows.append((first, ("", "t", (f"{each.name}.u",))))
    if machine.energy:
        rows.append((("energy", "t", ("E_in", "E_stored", "E_dissipated")), None))
    return rows


def overview(solutions: Mapping[str, Solution]) -> str:
    """Every part of a machine against time, and the friction against the sliding speed, as SVG."""
    scenario = next(iter(solutions.values())).scenario
    assert scenario.rig is not None
    rows = panels(scenario.rig.machine)
    layout = [[f"{i}a", f"{i}b" if second else f"{i}a"] for i, (_, second) in enumerate(rows)]
    failed = [label for label, solution in solutions.items() if solution.status != "done"]
    with plots.style():
        made, axes = plots.figure(layout, _HEAD + _ROW * len(rows))
        for i, row in enumerate(rows):
            for side, panel in zip("ab", row, strict=True):
                if panel is not None:
                    _draw(axes[f"{i}{side}"], solutions, panel, last=i == len(rows) - 1)
        early = f" (failed early: {', '.join(failed)})" if failed else ""
        made.suptitle(f"{scenario.name}{early}", x=0.01, ha="left", fontsize=11)
        if len(solutions) > 1:
            plots.legend(made, axes["0a"])
        return plots.svg(made)


def _draw(axis: Axes, solutions: Mapping[str, Solution], panel: Panel, last: bool) -> None:
    title, x, names = panel
    first = next(iter(solutions.values()))
    units = {column.name: column.unit for column in first.columns} | {"t": "s"}
    for i, (label, solution) in enumerate(solutions.items()):
        for j, name in enumerate(names):
            text = name if len(solutions) == 1 else label
            plots.line(axis, i * len(names) + j, *plots.thin(solution[x], solution[name]), text)
    if title:
        axis.set_title(title, fontweight="bold")
    if x != "t" or last:
        axis.set_xlabel(f"{x} ({units[x]})")
    axis.set_ylabel(f"{names[0]} ({units[names[0]]})" if len(names) == 1 else units[names[0]])
    if len(names) > 1:
        axis.legend(loc="best", fontsize=8)

"""Terms that a machine's friction has not, as small forces that play beside it: how the residuals move with each.

A term of size 0 adds nothing to the slopes of the machine itself, so to first order it is the force that it would have along
the motion as it is, from outside. All terms are lanes of one machine, whatever law they belong to.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.actuator.coordinates import MachineCoordinate
from stribeck.identify.actuator.problem import MachineProblem
from stribeck.identify.actuator.runs import Compared, RecordedRun
from stribeck.laws.terms import stribeck_level

_SPEEDS = (0.02, 0.05, 0.12, 0.3, 0.6)  # of the fastest: where a Stribeck curve may bend
_ON = "lacks"  # how the loads are called through which terms play
_STEP = 1e-3  # of the contact's friction: the size of a term that is tried
_GROWS, _FORCES = "level by ", (".f", ".torque")  # the columns of forces
_TURNED = 0.3  # rad: on less way a weight is a constant


@dataclass(frozen=True)
class Probe:
    """A term of a contact, and the residuals' slopes by it: for a term as large, in the mean square, as the contact's
    friction."""

    contact: str
    term: str
    slopes: Array

    @property
    def force(self) -> str:
        """The element with whose force the level grows in this term, if it does."""
        name = self.term.removeprefix(_GROWS)
        return name.rpartition(".")[0] if name != self.term and name.endswith(_FORCES) else ""


def probes(problem: MachineProblem, u: Array) -> list[Probe]:
    """The terms that the contacts of a machine may lack, each with the residuals' slopes by it."""
    ways = [_motion(problem, run, k, u) for k, run in enumerate(problem.runs)]
    terms, sizes = dict[str, tuple[str, str, list[Array]]](), dict[str, float]()
    for contact in problem.runs[0].scenario.data.get("contacts", {}):
        friction = _mean([x[f"{contact}.F"] for x in ways])
        for term, rows in _terms(problem, u, ways, contact) if _ends(problem.runs[0], contact) else ():
            if friction > 0 and (size := _mean(rows)) > 0:
                name = f"{_ON}.{contact}.{term}"
                terms[name], sizes[name] = (contact, term, rows), friction / size
    if not terms:
        return []
    runs = []
    for k, run in enumerate(problem.runs):
        whole = run.scenario.with_changes(_loads(run))
        played = {name: _played(run, contact, rows[k]) for name, (contact, _, rows) in terms.items()}
        runs.append(replace(run, scenario=whole, played=played, otherwise=()))
    added = [MachineCoordinate(name, -x, x, 0.0, None, {name: 1.0}) for name, x in sizes.items()]
    own = replace(problem, runs=runs, sought=[*problem.sought, *added], noise=dict(problem.noise))
    points = np.repeat(np.append(u, [c.inner(0.0) for c in added])[None], len(added) + 1, axis=0)
    for i, c in enumerate(added):
        points[i + 1, len(u) + i] = c.inner(_STEP * c.high)
    r = own.residuals(points)
    slopes = (r[1:] - r[0]) / _STEP
    return [
        Probe(contact, term, row)
        for (contact, term, _), row in zip(terms.values(), slopes, strict=True)
        if np.isfinite(row).all() and row @ row > 0
    ]


def _mean(rows: list[Array]) -> float:
    """The root mean square."""
    return float(np.sqrt(np.mean(np.concatenate(rows) ** 2)))


def _ends(run: RecordedRun, contact: str) -> dict[str, tuple[str, float]]:
    """The bodies at a contact on which a force acts, and what of the friction acts on each; what is driven feels none."""
    table, data = run.scenario.data["contacts"][contact], run.scenario.data["bodies"]
    found = {"from": (table["from"], -table.get("ratio", 1.0)), "to": (table.get("to", "ground"), 1.0)}
    return {end: x for end, x in found.items() if x[0] != "ground" and "velocity" not in data[x[0]]}


def _motion(problem: MachineProblem, run: RecordedRun, k: int, u: Array) -> dict[str, Array]:
    """The columns of a run that terms are made of, on its grid, and the times."""
    grid: Array = np.arange(run.scenario.rows, dtype=float) * run.scenario.output.step
    columns = [c.name for c in run.scenario.rig.machine.columns if c.name.endswith((".y", ".v", ".w", ".F", *_FORCES))]
    wanted = replace(run, targets=[Compared(name, grid, grid) for name in columns])
    found = {name: x[0] for name, x in zip(columns, problem.predicted(wanted, k, u[None]), strict=True)}
    return {**found, "t": grid + float(run.piece or 0.0), "grid": grid}


def _loads(run: RecordedRun) -> dict[str, object]:
    """The loads through which terms play, one for each body at a contact."""
    still = {"kind": "points", "t": [0.0, 1.0], "value": [0.0, 0.0]}
    return {
        f"loads.{_ON}_{contact}_{end}": {"on": body, "kind": "signal", "signal": still}
        for contact in run.scenario.data["contacts"]
        for end, (body, _) in _ends(run, contact).items()
    }


def _played(run: RecordedRun, contact: str, force: Array) -> dict[str, Array]:
    """A friction force as what plays in the loads on the bodies at a contact."""
    return {f"loads.{_ON}_{contact}_{end}.signal": share * force for end, (_, share) in _ends(run, contact).items()}


def _terms(
    problem: MachineProblem, u: Array, ways: list[dict[str, Array]], contact: str
) -> Iterator[tuple[str, list[Array]]]:
    """The terms of a contact by name, each the force of one unit in every run."""
    scenario = problem.runs[0].scenario
    table = scenario.data["contacts"][contact]
    start, end, ratio = table["from"], table.get("to", "ground"), table.get("ratio", 1.0)
    w = [x[f"{contact}.w"] for x in ways]
    d = [ratio * x[f"{start}.y"] - (x[f"{end}.y"] if end != "ground" else 0.0) for x in ways]
    path = f"contacts.{contact}.law"
    found = problem.values(u)
    sigma_2 = found.get(f"{path}.parameters.sigma_2", scenario.rig.values.get((path, "sigma_2"), 0.0)) or 0.0
    level = [x[f"{contact}.F"] - sigma_2 * x[f"{contact}.w"] for x in ways]
    fastest = max(float(np.max(abs(x))) for x in w)
    if not (np.isfinite(fastest) and fastest > 0 and all(np.isfinite(x).all() for x in level)):
        return
    for share in _SPEEDS:
        p = SimpleNamespace(F_c=0.0, F_s=1.0, v_s=share * fastest)
        yield f"bump below {share * fastest:.2g}", [x * stribeck_level(p, v) for x, v in zip(level, w, strict=True)]
    yield "offset", [np.ones_like(x) for x in w]
    yield "direction", [abs(x) for x in level]
    if not sigma_2:
        yield "viscous friction", w
    yield "viscous by direction", [abs(x) for x in w]
    yield "drag", [x * abs(x) for x in w]
    yield "cubic drag", [x**3 for x in w]
    yield "spring", d
    yield "level by position", [x * y for x, y in zip(level, d, strict=True)]
    if scenario.rig.machine.elements.bodies[start].turns and max(float(np.ptp(x)) for x in d) > _TURNED:
        for name, wave in (("sin", np.sin), ("cos", np.cos)):
            yield f"weight {name}", [wave(y) for y in d]
            yield f"level by {name}", [x * wave(y) for x, y in zip(level, d, strict=True)]
    yield "level by time", [x * y["t"] for x, y in zip(level, ways, strict=True)]
    for name in ways[0]:
        if name.endswith(_FORCES) and np.ptp(abs(ways[0][name])) > 0:
            yield f"{_GROWS}{name}", [x * abs(y[name]) for x, y in zip(level, ways, strict=True)]

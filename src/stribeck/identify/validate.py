"""A scenario against a measured record: the same drive, and what the simulated motion is off."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from stribeck.arrays import Array
from stribeck.constants import rotary_unit
from stribeck.errors import InputError, arg, note
from stribeck.identify import said
from stribeck.identify.data.read import ColumnNames, read
from stribeck.identify.log import Trace
from stribeck.mouth.document import Document
from stribeck.mouth.terminal import Told
from stribeck.scenario import Scenario
from stribeck.simulation import simulate
from stribeck.waveforms.piecewise import FileSignal

_COLUMNS = {"position": ("y", "m"), "velocity": ("v", "m/s"), "force": ("F", "N")}


@dataclass(frozen=True)
class Validated(Told):
    """A simulation beside a record.

    Attributes:
        status, reason: of the simulation; what it reached is compared.
        traces: what was measured, and the same simulated.
        title: what was compared.
    """

    status: str
    reason: str | None
    traces: list[Trace]
    title: str

    @property
    def rows(self) -> int:
        """The number of rows of the recording that were reached."""
        return len(self.traces[0].t)

    @property
    def errors(self) -> dict[str, dict[str, Any]]:
        """By what was measured: RMS and largest difference in ``unit``, and RMS relative to the changes of what was measured."""
        return {
            x.column: {
                "unit": x.unit, "rms": x.rms, "largest": float(np.max(abs(x.measured - x.predicted), initial=0.0)),
                "relative": x.relative if np.isfinite(x.relative) else None,
            }
            for x in self.traces
        }  # fmt: skip

    @property
    def message(self) -> str:
        """Why the simulation failed; else that it is done."""
        return self.reason or self.status

    def document(self) -> Document:
        """The document of the comparison, for the terminal and for a page."""
        return said.of_validation(self)

    def to_dict(self) -> dict[str, object]:
        """The JSON of ``stribeck predict --machine --json``."""
        return {"status": self.status, "reason": self.reason, "rows": self.rows, "errors": self.errors}


def validate(
    scenario: Scenario,
    data: Path,
    columns: Mapping[str, str],
    units: Mapping[str, str] | None = None,
    force_gain: float | str | None = None,
) -> Validated:
    """Simulate a scenario for as long as a record lasts, and a drive that was recorded, and compare.

    Args:
        columns: of the record: time; position, velocity or force (friction), which are compared; ``command``, which replaces
            the drive's signal, the motion then beginning as the record does.

    Raises:
        InputError: the record cannot be read, or has nothing to compare with; the scenario is a machine.
    """
    names = dict(columns)
    measured = [role for role in _COLUMNS if role in names]
    if not measured:
        raise InputError(f"{arg('position')}, {arg('velocity')} or {arg('force')}: one must be given: what is compared")
    if not scenario.elements.unnamed:
        raise InputError(
            f"{arg('machine')}: {scenario.name}: is a machine; must be a law on a single body (schema = 1)"
        )
    raw = read(data, ColumnNames(names, dict(units or {}), force_gain), needs_force=False)
    rows = np.all([np.isfinite(x) for x in raw.values()], axis=0)
    raw = {role: x[rows] for role, x in raw.items()}
    time = raw["time"] - raw["time"][0]
    if len(time) < 2 or np.any(np.diff(time) < 0) or time[-1] <= 0:
        raise InputError(f"{arg('time')}: must rise, over two rows or more")
    end = time[-1] if "command" in raw else _driven_until(scenario)
    if time[-1] > end:
        note(
            f"{data}: lasts {time[-1]:g} s, and the recorded drive ends at {end:g} s: what comes after is not compared"
        )
        raw, time = {role: x[time <= end] for role, x in raw.items()}, time[time <= end]
        if len(time) < 2:
            raise InputError(f"{arg('time')}: the recorded drive ends before the second row")
    solution = simulate(scenario.with_changes(_changes(scenario, raw, time)))
    reached = time <= float(solution.t[-1]) * (1 + 1e-9)
    traces = []
    for role in measured:
        name, unit = _COLUMNS[role]
        unit = rotary_unit(unit) if scenario.rotary else unit
        simulated = np.interp(time[reached], solution.t, solution[name])
        traces.append(Trace(role, unit, time[reached], raw[role][reached], simulated))
    return Validated(solution.status, solution.reason, traces, f"{scenario.name} against {data.name}")


def _driven_until(scenario: Scenario) -> float:
    """When the first recorded signal ends, s; one value alone is a constant."""
    recorded = [x for x in scenario.elements.signals.values() if isinstance(x, FileSignal) and len(x.t) > 1]
    return min((float(x.t[-1]) * (1 + 1e-9) for x in recorded), default=np.inf)


def _changes(scenario: Scenario, raw: Mapping[str, Array], time: Array) -> dict[str, object]:
    """The parts of the scenario that the recording replaces: its length, and with a command its signal and the start."""
    changes: dict[str, object] = {"solve.t_end": float(time[-1])}
    step = float(np.median(np.diff(time)))
    if step > 0:
        changes["output.step"] = step
    if "command" in raw:
        changes["drive.signal"] = {"kind": "points", "t": time.tolist(), "value": raw["command"].tolist()}
        if "position" in raw:
            changes["plant.initial.y"] = float(raw["position"][0])
        if "velocity" in raw and scenario.called.drive != "velocity":
            changes["plant.initial.v"] = float(raw["velocity"][0])
    return changes

"""``stribeck fit MACHINE.toml --logs LOGS.toml``: estimates a machine's parameters from its recordings."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from stribeck.constants import show
from stribeck.errors import InputError, arg
from stribeck.identify.actuator import checks, choice, judge
from stribeck.identify.actuator.coordinates import MachineCoordinate, coordinates
from stribeck.identify.actuator.estimate import BestPoint, Estimation
from stribeck.identify.actuator.recordings import Logs, read_logs, sought_of
from stribeck.identify.actuator.runs import recorded_run
from stribeck.identify.actuator.traces import traces
from stribeck.identify.data.quality import unwrapped, unwrapping_note
from stribeck.identify.result import MachineFit
from stribeck.identify.result_parts import LogResult
from stribeck.identify.work import Stopped, Work
from stribeck.scenario import Scenario
from stribeck.scenario.changes import changed

STOPPED = "Ctrl-C: the best values so far, without intervals"


def fit_machine(
    machine: Scenario | str | Path | Mapping[str, Any],
    logs: Logs | str | Path,
    *,
    laws: Mapping[str, Sequence[str]] | None = None,
    unknown: Mapping[str, object] | None = None,
    starts: int = 20,
    seed: int = 0,
    baselines: bool = True,
    progress: Callable[[float], None] | None = None,
) -> MachineFit:
    """Estimate the unknown parameters of a machine from its recordings, each with an interval, a model range and a state.

    Args:
        machine: the machine (``schema = 2``): its structure and all known numbers.
        logs: LOGS.toml, or the result of :func:`read_logs` (docs/reference/fit-files.md).
        laws: laws to try, by contact; the one that predicts held-out recordings best is chosen.
        unknown: further parameters to fit: by path low and high, or a table as in LOGS.toml. Replaces the same path in
            [unknown] of the logs.
        starts: number of starts of the search; ``seed`` makes them reproducible.
        baselines: also fit no friction, Coulomb and viscous, and Coulomb, Stribeck and viscous friction.
        progress: called with the share done, 0 to 1.

    Returns:
        The fit. ``status`` is "stopped" after Ctrl-C, and "missed" if the machine does not describe its recordings.

    Raises:
        InputError: the machine, the logs or a path are invalid; a line for each problem.
    """
    logs = seeking(logs if isinstance(logs, Logs) else read_logs(logs, not unknown), unknown or {})
    scenario = Scenario.of(machine)
    fitting = Fitting(scenario, _unwrapped(scenario, logs), starts, seed, progress)
    tried = {name: list(names) for name, names in {**logs.laws, **(laws or {})}.items()}
    choice.check(fitting.scenario, tried, {name for names in (laws or {}).values() for name in names})
    with threadpool_limits(1):
        return fitting.run(tried, baselines)


def _unwrapped(scenario: Scenario, logs: Logs) -> Logs:
    """The recordings with their wrapped angles unwrapped."""
    angles = {c.name for c in scenario.system.columns if c.unit == "rad"}
    recordings = []
    for recording in logs.recordings:
        outputs, notes = dict(recording.outputs), list(recording.notes)
        for name in angles & outputs.keys():
            x, turns = unwrapped(outputs[name].t, outputs[name].x)
            outputs[name] = replace(outputs[name], x=x)
            notes += [f"{recording.file}: {name} {text}" for text in unwrapping_note(turns)]
        recordings.append(replace(recording, outputs=outputs, notes=tuple(notes)))
    return replace(logs, recordings=tuple(recordings))


def seeking(logs: Logs, unknown: Mapping[str, object]) -> Logs:
    """The recordings with further parameters to fit.

    Raises:
        InputError: an entry is wrong, or no recording is for fitting; a line for each problem.
    """
    if not unknown:
        return logs
    more, problems = sought_of(unknown, argument=True)
    if all(r.hold_out for r in logs.recordings):
        problems.append("log.0.hold_out: true: at least one recording must be for fitting")
    if problems:
        raise InputError(problems)
    return replace(logs, sought=(*(s for s in logs.sought if s.path not in unknown), *more))


def checked(scenario: Scenario, logs: Logs) -> list[MachineCoordinate]:
    """The coordinates to fit, after all references of the recordings to the machine are checked.

    Raises:
        InputError: a line for each mistake.
    """
    problems: list[str] = []
    for i, recording in enumerate(logs.recordings):
        try:
            recorded_run(scenario, recording, i)
        except InputError as error:
            problems += error.problems
    sought: list[MachineCoordinate] = []
    if not scenario.elements.unnamed:
        try:
            sought = coordinates(scenario, logs)
        except InputError as error:
            problems += error.problems
    for i, r in enumerate(logs.recordings):
        problems += [
            f"unknown.{c.name}: is known of log.{i} ({r.file}): must be one or the other"
            for c in sought for path in c.targets if path in r.known and c.log in (None, i)
        ]  # fmt: skip
    problems += _still(logs)
    if problems:
        raise InputError(list(dict.fromkeys(problems)))
    return sought


def _still(logs: Logs) -> list[str]:
    """The measured columns of the fitted recordings, if none of them ever changes."""
    fitted = [
        (f"log.{i}.outputs.{name}", c)
        for i, r in enumerate(logs.recordings) if not r.hold_out for name, c in r.outputs.items()
    ]  # fmt: skip
    if any(np.nanmax(c.x) > np.nanmin(c.x) for _, c in fitted):
        return []
    return [f"{place}: {show(c.column)}: never changes: some measured column must" for place, c in fitted]


@dataclass
class Fitting:
    """One run of the command; arguments as of :func:`fit_machine`.

    Args:
        advised: whether recordings that would identify open parameters are looked for.

    Raises:
        InputError: the logs or a path are invalid; a line for each problem.
    """

    scenario: Scenario
    logs: Logs
    starts: int
    seed: int
    progress: Callable[[float], None] | None = None
    advised: bool = True

    def __post_init__(self) -> None:
        self.sought = checked(self.scenario, self.logs)
        if self.starts < 1:
            raise InputError(f"{arg('starts')}: {show(self.starts)}: must be a whole number >= 1")
        self.work = Work(self.progress)
        self.numbered = list(enumerate(self.logs.recordings))
        self.fitted = [(i, r) for i, r in self.numbered if not r.hold_out]
        self.held_out = [(i, r) for i, r in self.numbered if r.hold_out]

    def run(self, laws: Mapping[str, Sequence[str]], baselines: bool) -> MachineFit:
        """All steps, in order."""
        best, picked, notes = choice.among_laws(self, laws) if laws else (self.searched().best(), None, [])
        result = self.reported(best, notes)
        result.laws = picked
        self.work.section(0.95)
        if baselines and not self.held_out:
            result.notes.append("no recording is held out (hold_out = true): the errors are those of the fit itself")
        try:
            if result.status == "done" and baselines:
                result.baselines = choice.baselines(self, result)
        except (KeyboardInterrupt, Stopped):
            result.status, result.reason = "stopped", "Ctrl-C: the analysis after the fit is missing"
        self.work.section(1.0)
        return result

    def searched(self) -> Estimation:
        """The fit of the machine's own laws, at the end of its search."""
        self.work.section(0.6)
        return Estimation(self.scenario, self.fitted, self.sought, self.starts, self.seed, self.work)

    def reported(self, best: BestPoint, notes: list[str]) -> MachineFit:
        """The result: the estimate with both uncertainties, states and errors."""
        self.work.section(0.8)
        notes = [*checks.before(self.logs), *notes]
        values = best.values()
        missed = [] if best.stopped else best.missed()
        status, reason = ("stopped", STOPPED) if best.stopped else ("done", "")
        if missed:
            status = "missed"
            reason = f"the machine does not follow its recordings ({'; '.join(missed)}): no parameter is identified"
        try:
            if best.stopped or any("cannot be simulated" in text for text in missed):
                judged = judge.blank(best, self.scenario, reason)
            else:
                judged = judge.judged(best, self.scenario, not missed, self.advised, self.logs.words)
        except (KeyboardInterrupt, Stopped):
            self.work.stop()
            status, reason = "stopped", "Ctrl-C: the best values, without intervals"
            judged = judge.blank(best, self.scenario, reason)
        notes += judged.notes + best.notes
        result = MachineFit(
            status, reason, judged.estimates, judged.correlated, self.errors(best, values), notes,
            dict(best.problem.noise), filled(self.scenario, self.sought, values), judged.levels, judged.speeds,
            relation=judged.relation, name=self.scenario.name, folder=self.scenario.folder,
            source=self.logs.path,
        )  # fmt: skip
        result.nuisance = {c.name: values[c.name] for c in best.problem.sought if c.nuisance}
        return result

    def errors(self, best: BestPoint, values: dict[str, float]) -> list[LogResult]:
        """The errors of each recording's simulation with these values."""
        sought = best.problem.sought
        return [
            LogResult(r.file, r.hold_out, traces(self.scenario, r, i, sought, values, best.bandwidth))
            for i, r in self.numbered
        ]


def filled(scenario: Scenario, sought: Sequence[MachineCoordinate], values: Mapping[str, float]) -> dict[str, object]:
    """The machine's tables with the fitted values."""
    changes = {
        path: scale * values[c.name]
        for c in sought if c.log is None and c.name in values
        for path, scale in c.targets.items()
    }  # fmt: skip
    return changed(scenario.data, changes, scenario.folder)

"""Transfer to another unit or another day: its recordings are predicted, then fitted, and the parameters compared."""

from __future__ import annotations

from typing import TYPE_CHECKING

from stribeck.errors import InputError, arg
from stribeck.identify.actuator import judge
from stribeck.identify.actuator.estimate import estimate
from stribeck.identify.actuator.recordings import Logs
from stribeck.identify.actuator.residuals import beyond_noise
from stribeck.identify.actuator.result import LogResult, MachineFit, Moved, Transfer
from stribeck.identify.actuator.runs import recorded_run
from stribeck.identify.actuator.traces import traces

if TYPE_CHECKING:
    from stribeck.identify.actuator.api import Fitting


def transferred(fit: Fitting, other: Logs, result: MachineFit) -> Transfer:
    """The errors of predicting other recordings, and the parameters that differ there beyond both intervals."""
    problems: list[str] = []
    for i, recording in enumerate(other.recordings):
        try:
            recorded_run(fit.scenario, recording, i)
        except InputError as error:
            problems += [f"{arg('transfer')}: {line}" for line in error.problems]
    if problems:
        raise InputError(problems)
    sought = [c for c in fit.sought if c.log is None]
    values = {name: p.value for name, p in result.estimates.items()}
    numbered = list(enumerate(other.recordings))
    logs = [LogResult(r.file, True, traces(fit.scenario, r, i, sought, values)) for i, r in numbered]
    own = estimate(fit.scenario, numbered, sought, 1, 0, fit.work, values)
    doubted = own.stopped or own.missed() or beyond_noise(own.problem, own.u, own.found.agreeing)
    found = judge.judged(own, fit.scenario, not doubted)
    moved, same, open_ = list[Moved](), list[str](), list[str]()
    for name, there in found.estimates.items():
        here = result.estimates[name]
        if not (here.identifiable and there.identifiable):
            open_.append(name)
        elif here.interval[1] < there.interval[0] or there.interval[1] < here.interval[0]:
            moved.append({"name": name, "from": here.to_dict(), "to": there.to_dict()})
        else:
            same.append(name)
    return {
        "logs": [log.to_dict() for log in logs], "moved": moved, "same": same, "not_told": open_,
        "parameters": {name: p.to_dict() for name, p in found.estimates.items()},
    }  # fmt: skip

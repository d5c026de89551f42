"""The initial states of recordings and of their stretches."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from stribeck.identify.actuator.coordinates import MachineCoordinate
from stribeck.identify.actuator.recordings import Channel, Recording
from stribeck.identify.actuator.runs import RecordedRun, recorded_run, roughness
from stribeck.scenario import Scenario

_NEAR, _FEWEST = 12, 4  # most and fewest samples for the estimate of a state
_BENDS = 2.0  # times the noise: a larger residual shows that a parabola does not describe the samples
_ROOM = 6.0  # bounds of an initial state, in standard deviations of its estimate
_MOVES = 3.0
_STILL = 6.0  # times the noise: largest range of the first samples of a body at rest
_SLOPE = 2.5  # standard deviations: largest slope of these samples


def state_at(channel: Channel, at: float) -> tuple[float, float, float, float]:
    """A measured position and its rate at a time, and their standard deviations.

    Both come from a parabola through the nearest samples, as many as it describes.
    """
    good = np.isfinite(channel.x)
    t, x = channel.t[good], channel.x[good]
    order = np.argsort(abs(t - at))[:_NEAR]
    noise = roughness([x[np.sort(order)]])
    for count in range(len(order), 0, -2):
        near = np.sort(order[:count])
        s, span = t[near] - at, max(np.ptp(t[near]), 1e-12)
        A = np.stack([np.ones(len(s)), s / span, (s / span) ** 2], axis=1)
        found, *_ = np.linalg.lstsq(A, x[near], rcond=None)
        left = x[near] - A @ found
        rough = float(np.sqrt(left @ left / max(len(s) - 3, 1)))
        if rough <= _BENDS * noise or count <= _FEWEST:
            break
    step = np.diff(np.unique(x[near])).min(initial=np.inf)
    rough = max(rough, step / 3 if np.isfinite(step) else 0.0)
    spread = rough * np.sqrt(np.diag(np.linalg.pinv(A.T @ A)))
    spread[:2] += np.ptp(x[near]) / _ROOM  # the motion may bend more than a parabola: bounds must not cut it off
    return float(found[0]), float(found[1] / span), float(spread[0]), float(spread[1] / span)


def moves(channel: Channel) -> bool:
    """Whether the first samples of a measured position or speed show a motion: a large range or a significant slope."""
    x = channel.x[np.isfinite(channel.x)][:_NEAR]
    steps = np.diff(np.unique(channel.x[np.isfinite(channel.x)])).min(initial=np.inf)
    noise = max(roughness([x]), float(steps) / np.sqrt(12) if np.isfinite(steps) else 0.0)
    if channel.noise is not None:
        noise = max(noise, channel.noise)
    if not np.ptp(x) > 0:
        return False
    index = np.arange(len(x)) - (len(x) - 1) / 2
    slope = abs(float(index @ x)) / np.sqrt(float(index @ index))
    return bool(np.ptp(x) > _STILL * noise or slope > _SLOPE * noise)


def begun(
    scenario: Scenario, recording: Recording, log: int, named: set[str], span: tuple[float, float] | None = None
) -> tuple[RecordedRun, list[MachineCoordinate]]:
    """A recording, or a stretch of it, to simulate, and the coordinates of its initial state.

    If the file, the recording or the user gives a body's initial state, it is used. Otherwise the first samples give an
    estimate, which the fit refines.
    """
    late = any((n.startswith("outputs.") and n.endswith((".delay", ".clock"))) or ".outputs." in n for n in named)
    run = recorded_run(scenario, recording, log, span, late)
    at = span[0] if span else 0.0
    found: list[MachineCoordinate] = []
    told: set[str] = set()
    for column, channel in sorted(recording.outputs.items(), key=lambda each: each[0].endswith(".v")):
        name, _, what = column.rpartition(".")
        if (
            what not in ("y", "v")
            or not _free(scenario, name)
            or {f"outputs.{column}.offset", f"log.{log}.outputs.{column}.offset"} & named
        ):
            continue
        carried = {b: f for b, f in scenario.elements.carried(name).items() if b not in told}
        told |= set(carried)
        x0, rate, dx0, drate = state_at(channel, at)
        states = (("y", x0, dx0), ("v", rate, drate)) if what == "y" else (("v", x0, dx0),)
        for kind, x, dx in states:
            targets = {
                f"bodies.{b}.initial.{kind}": f
                for b, f in carried.items()
                if not _given(scenario, recording, log, named, b, kind, span)
            }
            if not targets or (kind == "v" and span is None and not (what == "v" or moves(channel))):
                continue
            if kind == "y" and span is None and abs(x) < 1e-12 * max(1.0, float(np.nanmax(abs(channel.x)))):
                continue
            room = _ROOM * max(dx, 1e-9 * max(abs(x), 1e-3))
            label = f"log.{log}.{'' if span is None else f'{at:g}s.'}initial.{name}.{kind}"
            still = kind == "v" and span is None and abs(x) < _MOVES * dx
            first = 0.0 if still else x  # rest unless motion is significant: a false speed would deflect bristles
            low, high = min(x - room, first), max(x + room, first)
            run.start |= {path: f * first for path, f in targets.items()}
            found.append(MachineCoordinate(label, low, high, first, None, targets, None, log, True, run.piece))
    return run, [replace(c, prior=None) for c in found]


def prepared(
    scenario: Scenario, recordings: Sequence[tuple[int, Recording]], named: set[str], window: float | None = None
) -> tuple[list[RecordedRun], list[MachineCoordinate]]:  # fmt: skip
    """The runs, whole or in stretches, and the coordinates of their initial states."""
    runs: list[RecordedRun] = []
    starts: list[MachineCoordinate] = []
    for log, recording in recordings:
        length = recording.window or window
        spans: list[tuple[float, float] | None] = [None]
        if length is not None and length < 0.9 * recording.t[-1]:
            spans = list(stretches(recording, length))
        for span in spans:
            run, own = begun(scenario, recording, log, named, span)
            if run.size:
                runs.append(run)
                starts += own
    return runs, starts


def _free(scenario: Scenario, body: str) -> bool:
    machine = scenario.system
    return body in machine.elements.bodies and machine.leader(body).velocity is None


def _given(
    scenario: Scenario, recording: Recording, log: int, named: set[str], body: str, kind: str,
    span: tuple[float, float] | None,
) -> bool:  # fmt: skip
    """Whether a body's initial state is given."""
    path = f"bodies.{body}.initial.{kind}"
    if span is not None and span[0] > 0:
        return False
    inside = scenario.data["bodies"].get(body, {}).get("initial", {})
    return kind in inside or path in recording.known or bool({path, f"log.{log}.initial.{body}.{kind}"} & named)


def stretches(recording: Recording, window: float) -> list[tuple[float, float]]:
    """The times at which stretches of about ``window`` seconds begin and end.

    They begin where the speed is large, so unmeasured states (bristles, currents) soon become steady.
    """
    length = float(recording.t[-1])
    count = max(1, round(length / window))
    if count == 1:
        return [(0.0, length)]
    position = next((c for n, c in recording.outputs.items() if n.endswith(".y")), None)
    cuts = [0.0]
    for i in range(1, count):
        at = i * length / count
        if position is not None:
            t = recording.t[abs(recording.t - at) < 0.25 * length / count]
            x = np.interp(t, position.t[np.isfinite(position.x)], position.x[np.isfinite(position.x)])
            wide = max(len(t) // 20, 1)
            speed = abs(x[2 * wide :] - x[: -2 * wide])
            at = float(t[wide + int(np.argmax(speed))]) if len(speed) else at
        cuts.append(float(recording.t[np.argmin(abs(recording.t - at))]))
    return list(zip(cuts, [*cuts[1:], length], strict=True))

"""Cogging of a machine's motor (a load of kind ripple on its body) as a table over one turn."""

from __future__ import annotations

import numpy as np

from stribeck.arrays import Array
from stribeck.errors import InputError, arg
from stribeck.expressions.emit import python_function
from stribeck.expressions.graph import symbols, wrap
from stribeck.machine.balance import Balance
from stribeck.scenario import Scenario
from stribeck.scenario.rig import Rig

_WHOLE = 1e-6  # waves a turn: how near to a whole number


def torque_over_a_turn(scenario: Scenario | None, points: int) -> tuple[str, float, Array]:
    """The motor, its K (N m/A), and the torque that cancels its cogging at so many angles from 0, N m.

    Raises:
        InputError: no machine with one motor that turns and a ripple on its body, or one that is not periodic in a turn.
    """
    if scenario is None or scenario.rig.single:
        raise InputError(f"{arg('scenario')}: part 'cogging' needs a machine (schema = 2) with a motor")
    rig = scenario.rig
    ripples = {load.on: load for load in rig.machine.loads if load.kind.kind == "ripple"}
    found = [motor for motor in rig.machine.motors if motor.on in ripples and rig.machine.rotary(motor.on)]
    if len(found) != 1:
        raise InputError(
            f"{scenario.name}: {len(found)} motors that turn have a load of kind 'ripple' on their body: must be one"
        )
    load, motor = ripples[found[0].on], found[0]
    for name, waves in _waves(rig, load.path):
        if abs(waves - round(waves)) > _WHOLE:
            raise InputError(f"{load.path}.{name}: {waves:g}: must be a whole number: a table repeats every turn")
    angle = np.arange(points) * 2 * np.pi / points
    force = wrap(Balance(rig.machine).k[f"{load.name}.f"])
    names = sorted(symbols([force]) - {f"{load.on}.y"})
    values = {f"{path}.{n}": x for (path, n), x in rig.values.items()}
    (torque,) = python_function([f"{load.on}.y", *names], [force])(angle, *(values[n] for n in names))
    return motor.name, rig.values[motor.path, "K"], -np.broadcast_to(torque, angle.shape)


def _waves(rig: Rig, path: str) -> list[tuple[str, float]]:
    return [(n, x) for (owner, n), x in rig.values.items() if owner == path and n.startswith("waves")]


def rows(values: Array) -> str:
    """Numbers for an initialiser, eight on a line."""
    texts = [f"{x:.6g}F" if "." in f"{x:.6g}" or "e" in f"{x:.6g}" else f"{x:.6g}.0F" for x in values]
    return ",\n    ".join(", ".join(texts[i : i + 8]) for i in range(0, len(texts), 8))

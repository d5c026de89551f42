"""``--target table``: the steady friction as a short table of velocity and force, for controllers that interpolate."""

from __future__ import annotations

import numpy as np

from stribeck.arrays import Array
from stribeck.errors import InputError, arg
from stribeck.exports.controller.block import Block
from stribeck.exports.request import Content, Part, Request, Target, made_by, wrapped
from stribeck.laws.base import Law

POINTS = 20  # at most: 160 bytes in single precision, and less than 0.2 % error for the laws with canudas1995
_DEFLECTION = "The law at the measured speed follows a deflection, which no table has."
_RANGE = 100.0  # the last velocity in multiples of the law's own (v_s)


def files(request: Request) -> Content:
    """A CSV of two columns, its header in lines that begin with #."""
    v, force, error = fit(request.law)
    law = request.law
    size = float(np.max(abs(law.steady_force(_grid(law)))))
    N, speed = request.unit("N"), request.unit("m/s")
    rest = [
        f"Steady friction at v >= 0: F(-v) = -F(v). At v = 0 the force jumps: 0 there, {force[0]:.6g} {N} next to it."
        if force[0] > 1e-3 * size
        else "Steady friction at v >= 0: F(-v) = -F(v).",
        f"Interpolate linearly; extrapolate linearly beyond the last point. {len(v)} points, fitted by minimax.",
        f"Greatest error for 0 < v <= {v[-1]:g} {speed}: {error:.3g} {N} ({100 * error / size:.2g} % of the greatest force).",
        "The table has no memory: no presliding, no hysteresis, no varying break-away.",
        f"v in {speed}, F in {N}",
    ]
    return _csv(request.name, wrapped([*request.about(), *rest]), v, force)


def _csv(name: str, head: list[str], v: Array, force: Array) -> Content:
    lines = "".join(f"# {line}".rstrip() + "\n" for line in head)
    rows = "".join(f"{x!r},{y!r}\n" for x, y in zip(v.tolist(), force.tolist(), strict=True))
    return {f"{name}.csv": f"{lines}v,F\n{rows}"}


def notes(request: Request) -> list[str]:
    """Notes about the limits of every table."""
    if not request.law.has_z or request.step is None:
        return []
    return [f"{arg('step')}: a table keeps none of the law's dynamics at any step: it is the steady friction alone"]


def fit(law: Law) -> tuple[Array, Array, float]:
    """Velocities and forces of at most :data:`POINTS` points, and the greatest error between 0 and the last one.

    Raises:
        InputError: the law's steady friction is not odd in v, or not bounded; its speeds or forces are beyond what a
            table's numbers can be.
    """
    with np.errstate(all="ignore"):
        v, force, error = _fit(law)
    right = np.all(np.isfinite([*v, *force, error])) and np.all(np.diff(v) > 0) and error < 0.5 * np.max(abs(force))
    if not right:
        text = f"the speeds of law '{law.name}' with these constants ({law.scales(law.p).speed:g}) leave no table of numbers"
        raise InputError(f"{arg('target')}: 'table': {text}")
    return v, force, error


def _fit(law: Law) -> tuple[Array, Array, float]:
    x = _grid(law)
    y = np.asarray(law.steady_force(x))
    size = np.max(abs(y))
    if not np.isfinite(size) or np.max(abs(y + law.steady_force(-x))) > 1e-9 * size:
        raise InputError(
            f"{arg('target')}: 'table': the steady friction of law '{law.name}' must be finite and odd in v"
        )
    if abs(y[0]) > 10 * np.max(abs(y[x > 1e-3 * x[-1]])):
        raise InputError(
            f"{arg('target')}: 'table': the steady friction of law '{law.name}' grows without limit as v goes to 0"
        )
    low, high = 0.0, float(size)
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (low, middle) if len(_polygon(x, y, middle)[0]) <= POINTS else (middle, high)
    v, force = _polygon(x, y, high)
    fine = np.concatenate([x, np.sqrt(x[1:] * x[:-1]), np.linspace(x[0], x[-1], 20001)])
    error = np.max(abs(np.interp(fine, v, force) - law.steady_force(fine)))
    return v, force, float(error)


def _grid(law: Law) -> Array:
    speed = law.scales(law.p).speed
    return np.unique(
        np.concatenate([speed * np.logspace(-18, np.log10(_RANGE), 6000), speed * np.linspace(0.01, _RANGE, 4000)])
    )


def _polygon(x: Array, y: Array, error: float) -> tuple[Array, Array]:
    """A polygon that stays within ``error`` of the points: each side goes on while some slope serves all it passes."""
    speed, force = 0.0, float(y[0])
    corners = [(speed, force)]
    i = 0
    while i < len(x):
        with np.errstate(all="ignore"):
            steepest = np.minimum.accumulate((y[i:] + error - force) / (x[i:] - speed))
            flattest = np.maximum.accumulate((y[i:] - error - force) / (x[i:] - speed))
        count = int(np.argmin(steepest >= flattest)) if not (steepest >= flattest).all() else len(steepest)
        count = max(count, 1)
        slope = (steepest[count - 1] + flattest[count - 1]) / 2
        speed, force = float(x[i + count - 1]), float(force + slope * (x[i + count - 1] - speed))
        corners.append((speed, force))
        i += count
        if len(corners) > POINTS:
            break
    points = np.array(corners)
    return points[:, 0], points[:, 1]


def _compensation(block: Block) -> Content:
    """A CSV of speed and of the share of the steady friction that is added at it."""
    machine, compensation = block.scenario.elements, block.controller.compensation
    assert compensation is not None
    if compensation.lead is not None:
        path = f"{block.controller.path}.compensation.lead"
        raise InputError(f"{path}: must be left out: target 'table' cannot carry it")
    law = machine.laws[block.controller.friction_path]
    v, force, error = fit(law)
    share = machine.values[f"{block.controller.path}.compensation", "share"] if compensation.share is not None else 1.0
    speed, unit = ("rad/s", "N m") if block.rotary else ("m/s", "N")
    head = [
        f"{block.name}: {share:g} of the steady friction of {law.name}, to be added at the {compensation.speed} speed.",
        "F(-v) = -F(v), and 0 at v = 0. Interpolate linearly; extrapolate linearly beyond the last point.",
        f"Greatest error for 0 < v <= {v[-1]:g} {speed}: {share * error:.3g} {unit}.",
        *((_DEFLECTION,) if compensation.observes(machine) else ()),
        f"v in {speed}, F in {unit}", made_by(),
    ]  # fmt: skip
    return _csv(block.name, head, v, share * force)


def _notes_of_compensation(block: Block) -> list[str]:
    """Notes about settings that a table of a compensation cannot represent."""
    compensation = block.controller.compensation
    assert compensation is not None
    if compensation.speed == "reference":
        return []
    return [f"{block.controller.path}.compensation.speed: 'measured': the table is the steady friction at that speed"]


TARGET = Target(
    "table", "a table of velocity and force, at most 20 points",
    {"law": Part(files, notes), "compensator": Part(_compensation, _notes_of_compensation)}, folder=False,
)  # fmt: skip

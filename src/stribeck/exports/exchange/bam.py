"""Servo actuators in the JSON files of BAM (Rhoban; models m1 to m6) as machines.

In BAM, friction = base + viscous |v| + load terms + exp(-|v/v_s|^alpha) (stribeck + load terms). The loads are the motor's
torque and the external torque. Source: Duclusaud, Passault, Padois, Daniel, Rouxel, "Extended friction models for the
physics simulation of servo actuators", 2024.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from stribeck.constants import Constant, show
from stribeck.errors import InputError, note
from stribeck.files import json_of

STEEPNESS = 200.0  # s/rad: BAM's sign is exact; this smooth sign saturates within about 0.01 rad/s
_NEEDED = ("armature", "friction_base", "friction_viscous")
_NUMBERS = (
    "kt", "R", "q_offset", "friction_stribeck", "dtheta_stribeck", "alpha", "load_friction_base", "load_friction_stribeck",
    "load_friction_motor", "load_friction_external", "load_friction_motor_stribeck", "load_friction_external_stribeck",
    "load_friction_motor_quad", "load_friction_external_quad",
)  # fmt: skip
_SQUARES = (  # the square of the weaker load adds to the Stribeck part
    ("load_friction_external_quad", "gravity", "drive"), ("load_friction_motor_quad", "drive", "gravity"),
)  # fmt: skip
_LEAST = 1e-9  # N m: laws need a friction level above 0


def from_bam(source: str | Path | Mapping[str, Any]) -> dict[str, Any]:
    """The tables of a machine: body ``joint``, motor ``drive``, load ``gravity`` and contact ``friction``.

    The quadratic terms of m6 become entries with ``against``, which act if motor and load oppose each other.

    Raises:
        InputError: if the file cannot be read, or a number is missing or invalid; one line for each problem.
    """
    data = dict(source) if isinstance(source, Mapping) else _read(Path(source))
    problems = [f"{n}: missing: must be given" for n in _NEEDED if n not in data]
    known = {*_NEEDED, *_NUMBERS}
    problems += [
        f"{n}: {show(x)}: must be a finite number" for n, x in data.items() if n in known and Constant("", "").problem(x)
    ]  # fmt: skip
    strange = [n for n in data if n not in known and n not in ("model", "actuator")]
    omitted = [n for n in strange if "friction" not in n]
    problems += [f"{n}: unknown key: a machine has no such thing" for n in strange if "friction" in n]
    for suffix in ("", "_stribeck"):
        pair = {f"load_friction_motor{suffix}", f"load_friction_external{suffix}"}
        problems += [f"{n}: missing: must be given with {m}" for n in pair - set(data) for m in pair & set(data)]
    if "load_friction_stribeck" in data and "load_friction_base" not in data:
        problems.append("load_friction_base: missing: must be given with load_friction_stribeck")
    problems += [
        f"{n}: {show(data[n])}: must be text" for n in ("model", "actuator") if not isinstance(data.get(n, ""), str)
    ]
    if "friction_stribeck" in data:
        problems += [
            f"{n}: missing: must be given with friction_stribeck" for n in ("dtheta_stribeck", "alpha") if n not in data
        ]
    if problems:
        raise InputError(problems)
    if omitted:
        note(f"{', '.join(omitted)}: left out: a machine has no such number (of BAM's firmware or bench)")
    n = {name: float(data[name]) for name in known if name in data}
    machine: dict[str, Any] = {
        "schema": 2, "name": str(data.get("actuator", "servo")), "bodies": {"joint": {"inertia": n["armature"]}},
        "contacts": {"friction": {"from": "joint", "law": _law(n)}},
        "loads": {"gravity": {"on": "joint", "kind": "pendulum", "amplitude": 0.0, "phase": n.get("q_offset", 0.0)}},
        "solve": {"t_end": 1.0}, "output": {"step": 0.005},
    }  # fmt: skip
    still = {"kind": "points", "t": [0.0, 1.0], "value": [0.0, 0.0]}
    if "kt" in n and "R" in n:
        machine["motors"] = {"drive": {"on": "joint", "K": n["kt"], "R": n["R"], "signal": still}}
    else:  # current drive: its torque is a load, kt times the signal
        machine["loads"]["drive"] = {"on": "joint", "kind": "signal", "signal": still}
        machine["loads"]["drive"] |= {"gain": n["kt"]} if "kt" in n else {}
    if levels := _levels(n):
        machine["contacts"]["friction"]["loads"] = levels
    return machine


def _read(path: Path) -> dict[str, Any]:
    try:
        data = json_of(path)
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror or error}") from None
    except ValueError as error:
        raise InputError(f"{path}: is not JSON: {error}") from None
    if not isinstance(data, dict):
        raise InputError(f"{path}: must be a table of numbers, as BAM writes it")
    return data


def _law(n: Mapping[str, float]) -> dict[str, object]:
    base = n["friction_base"] or _LEAST
    if "friction_stribeck" not in n:
        parameters = {"F_c": base, "sigma_2": n["friction_viscous"]}
        if not any(name.startswith("load_") for name in n):
            return {"name": "coulomb_viscous", "k_v": STEEPNESS, "parameters": parameters}
        return {"name": "stribeck", "k_v": STEEPNESS, "parameters": {**parameters, "F_s": base, "v_s": 1.0}}
    parameters = {
        "F_c": base, "F_s": base + n["friction_stribeck"], "v_s": n["dtheta_stribeck"], "sigma_2": n["friction_viscous"]
    }  # fmt: skip
    return {"name": "stribeck", "k_v": STEEPNESS, "delta": n["alpha"], "parameters": parameters}


def _levels(n: Mapping[str, float]) -> list[dict[str, object]]:
    """The load terms of the friction level; F_s contains both parts, and the Stribeck part is the difference."""
    levels: list[dict[str, Any]] = []
    if "load_friction_base" in n:
        base, more = n["load_friction_base"], n.get("load_friction_stribeck", 0.0)
        levels.append({"force": {"gravity": 1.0, "drive": -1.0}, "F_c": base, "F_s": base + more})
    for suffix, gains in (("", ("F_c", "F_s")), ("_stribeck", ("F_s",))):
        if f"load_friction_motor{suffix}" in n:
            weights = {"gravity": n[f"load_friction_external{suffix}"], "drive": -n[f"load_friction_motor{suffix}"]}
            levels.append({"force": weights, **dict.fromkeys(gains, 1.0)})
    for name, force, against in _SQUARES:
        if name in n:
            levels.append({"force": force, "against": against, "F_s": n[name]})
    return levels

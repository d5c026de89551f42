"""Small valid scenarios that together use every kind of drive and signal, and what is allowed at each of their keys."""

from __future__ import annotations

import copy
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from tests.shared import SHARED

SCENARIOS = SHARED / "scenarios"

CANUDAS = {"sigma_0": 1e5, "sigma_1": 316.2, "sigma_2": 0.4, "F_c": 1.0, "F_s": 1.5, "v_s": 1e-3}
MAKKAR = {"g1": 0.25, "g2": 100.0, "g3": 10.0, "g4": 0.1, "g5": 100.0, "g6": 0.01}
POINTS = {"kind": "points", "t": [0.0, 0.5, 0.5, 1.0], "value": [0.0, 1.0, 2.0, 0.0]}
RECORD = {"kind": "file", "path": "record.csv", "time": "time (s)", "value": "v (m/s)"}

VALID: dict[str, dict[str, Any]] = {
    "force_points": {
        "schema": 1, "name": "force_points",
        "law": {"name": "lugre_sobczyk", "k_v": 1e6, "parameters": CANUDAS},
        "plant": {"kind": "mass", "mass": 1.0, "initial": {"y": 0.1, "v": -0.2, "z": 1e-6}},
        "drive": {"kind": "force", "signal": POINTS},
        "solve": {"t_end": 1.0, "rtol": 1e-6, "atol": {"y": 1e-9, "v": 1e-9}, "max_steps": 1000},
        "output": {"step": 0.01, "energy": True},
    },
    "spring_ramp": {
        "schema": 1,
        "law": {
            "name": "elastoplastic_majorant", "k_v": 1e6, "z_ba": 7e-6, "v_d": 0.02, "smooth_abs": "compact",
            "parameters": CANUDAS,
        },
        "plant": {"mass": 1},
        "drive": {"kind": "spring", "stiffness": 2.0, "signal": {"kind": "ramp", "rate": 0.1}},
        "solve": {"t_end": 1.0},
        "output": {"step": 0.01},
    },
    "pid_step": {
        "schema": 1,
        "law": {"name": "elastoplastic", "z_ba": 7e-6, "parameters": "canudas1995"},
        "plant": {"mass": 1.0},
        "drive": {
            "kind": "pid", "K_p": 3.0, "K_i": 4.0, "K_d": 6.0, "signal": {"kind": "step", "value": 1.0, "time": 0.1},
        },
        "solve": {"t_end": 1.0},
        "output": {"step": 0.01},
    },
    "velocity_sine": {
        "schema": 1,
        "law": {"name": "stribeck", "delta": 1.5, "k_v": 1e6, "parameters": CANUDAS},
        "plant": {"mass": 1.0, "initial": {"y": 0.1}},
        "drive": {
            "kind": "velocity",
            "signal": {"kind": "sine", "amplitude": 0.001, "frequency": 1.5, "offset": 0.0015, "phase": 1.57},
        },
        "solve": {"t_end": 1.0},
        "output": {"step": 0.01},
    },
    "velocity_file": {
        "schema": 1,
        "law": {"name": "makkar", **MAKKAR},
        "drive": {"kind": "velocity", "signal": RECORD},
        "solve": {"t_end": 1.0},
        "output": {"step": 0.01},
    },
}  # fmt: skip

# What is allowed at a key: a number (of any sign, > 0, >= 0), text, one of some words, ...
_ANY, _POSITIVE, _NOT_NEGATIVE = "any", "positive", "not negative"
ALLOWED: dict[str, str] = {
    "schema": "one", "name": "text", "law.name": "word", "law.parameters": "table or word",
    **dict.fromkeys(("law.k_v", "law.z_ba", "law.v_d", "law.delta", "law.g2", "law.g5"), _POSITIVE),
    "law.smooth_abs": "word",
    **dict.fromkeys(("law.g1", "law.g3", "law.g4", "law.g6"), _NOT_NEGATIVE),
    **{f"law.parameters.{n}": _NOT_NEGATIVE if n in ("sigma_1", "sigma_2") else _POSITIVE for n in CANUDAS},
    "plant.kind": "word", "plant.mass": _POSITIVE,
    **dict.fromkeys(("plant.initial.y", "plant.initial.v", "plant.initial.z"), _ANY),
    "drive.kind": "word", "drive.stiffness": _NOT_NEGATIVE, "drive.signal.kind": "word",
    **{f"drive.{n}": _ANY for n in ("K_p", "K_i", "K_d")},
    **{f"drive.signal.{n}": _ANY for n in ("rate", "time", "amplitude", "offset", "phase")},
    "drive.signal.frequency": _POSITIVE, "drive.signal.t": "list", "drive.signal.path": "path",
    "solve.t_end": _POSITIVE, "solve.rtol": _POSITIVE, "solve.max_steps": "whole", "output.step": _POSITIVE,
    "solve.atol.y": _POSITIVE, "solve.atol.v": _POSITIVE, "output.energy": "switch",
    **dict.fromkeys(("law", "plant", "plant.initial", "drive", "drive.signal"), "table"),
    **dict.fromkeys(("solve", "solve.atol", "output"), "table"),
}  # fmt: skip
# by kind of signal
ALLOWED_VALUE = {"points": "list", "step": _ANY, "file": "column"}

OPTIONAL = {
    "name", "law.delta", "law.v_d", "law.smooth_abs", "plant.kind", "plant.initial",
    "plant.initial.y", "plant.initial.v", "plant.initial.z",
    "drive.K_i", "drive.K_d", "drive.signal.offset", "drive.signal.phase",
    "solve.rtol", "solve.atol", "solve.atol.y", "solve.atol.v",
    "solve.max_steps", "output.energy",
}  # fmt: skip


def optional(data: dict[str, Any], path: str) -> bool:
    """True where the key may be left out."""
    velocity = data["drive"]["kind"] == "velocity"
    curve = ("law.k_v", "law.parameters.sigma_0", "law.parameters.sigma_1")  # what the Stribeck curve does not need
    law_decides = path in curve and data["law"]["name"] == "stribeck"
    return path in OPTIONAL or law_decides or (velocity and path in ("plant", "plant.mass"))


def allowed(data: dict[str, Any], path: str) -> str:
    """What is allowed at a key."""
    if path in ("drive.signal.value", "drive.signal.time"):
        kind = data["drive"]["signal"]["kind"]
        return "column" if kind == "file" else ALLOWED_VALUE[kind] if path.endswith("value") else _ANY
    return ALLOWED[path]


def examples() -> dict[str, dict[str, Any]]:
    """The valid scenarios of this file, and those of the shared folder where it is present."""
    shared = {f"shared_{p.stem}": tomllib.loads(p.read_text()) for p in sorted(SCENARIOS.glob("*.toml"))}
    shared.pop("shared_pneumatic_servo", None)
    return {**VALID, **shared}


def keys(table: dict[str, Any], path: str = "") -> Iterator[str]:
    """The path of every key."""
    for name, value in table.items():
        full = f"{path}.{name}" if path else name
        yield full
        if isinstance(value, dict):
            yield from keys(value, full)


def edited(data: dict[str, Any], path: str, **change: Any) -> dict[str, Any]:
    """A copy with the key at a path set to ``value``, renamed to ``name``, deleted, or joined by the key ``beside``."""
    new = copy.deepcopy(data)
    *parents, last = path.split(".")
    table = new
    for name in parents:
        table = table[name]
    if "beside" in change:
        table[change["beside"]] = 1.0
    else:
        old = table.pop(last)
        if "value" in change or "name" in change:
            table[change.get("name", last)] = change.get("value", old)
    return new


def write(data: dict[str, Any], folder: Path, name: str = "scenario") -> Path:
    """Write a scenario file, and beside it the recorded signal that one of the examples reads."""
    (folder / RECORD["path"]).write_text(f"{RECORD['time']},{RECORD['value']},note\n0,0.0,a\n0.5,1e-3,b\n1,0.0,c\n")
    path = folder / f"{name}.toml"
    path.write_text(toml(data), encoding="utf-8")
    return path


def toml(data: dict[str, Any]) -> str:
    """A scenario as TOML, tables written in line."""
    return "".join(f"{_key(name)} = {_value(value)}\n" for name, value in data.items())


def _key(name: str) -> str:
    return name if name.replace("_", "a").isascii() and name.replace("_", "a").isalnum() else _value(name)


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, dict):
        return "{" + ", ".join(f"{_key(name)} = {_value(inner)}" for name, inner in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_value, value)) + "]"
    if isinstance(value, str):
        return '"' + "".join(c if c.isprintable() and c not in '"\\' else f"\\u{ord(c):04x}" for c in value) + '"'
    return str(value)

"""Small valid scenarios that together use every kind of drive and signal."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import tomli_w

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


def write(data: dict[str, Any], folder: Path, name: str = "scenario") -> Path:
    """Write a scenario file, and beside it the recorded signal that one of the examples reads."""
    (folder / RECORD["path"]).write_text(f"{RECORD['time']},{RECORD['value']},note\n0,0.0,a\n0.5,1e-3,b\n1,0.0,c\n")
    path = folder / f"{name}.toml"
    path.write_text(tomli_w.dumps(data), encoding="utf-8")
    return path

"""Friction in MuJoCo at its own steps: its dcmotor's LuGre and the exported callback, beside Stribeck's simulation."""

from __future__ import annotations

import ctypes
import math
import re
import tempfile
from collections.abc import Callable, Iterator
from functools import lru_cache
from importlib import metadata
from pathlib import Path
from time import process_time
from typing import Any

import mujoco
import numpy as np
from measure import compiled, finish, options, say

import stribeck
from stribeck.exports import export
from stribeck.exports.request import Request
from stribeck.exports.targets.mujoco import files

STEPS = (1e-4, 1e-3, 4e-3)
WAYS = (
    ("dcmotor", "Euler"),
    ("dcmotor", "implicitfast"),
    ("dcmotor", "RK4"),
    ("callback", "implicitfast"),
    ("C callback", "implicitfast"),
)
LAW = {"name": "lugre", "parameters": "canudas1995"}
DITHER = {"kind": "sine", "offset": 0.4, "amplitude": 0.25, "frequency": 5.0}


def load(way: str, integrator: str, step: float) -> tuple[Any, Any]:
    """The exported model, its callback installed if that is the way."""
    mujoco.set_mjcb_act_dyn(None)
    mujoco.set_mjcb_act_bias(None)
    content = files(Request(stribeck.law("lugre", "canudas1995"), step=step))
    text = content["lugre_dcmotor.xml" if way == "dcmotor" else "lugre.xml"]
    model = mujoco.MjModel.from_xml_string(text)
    model.opt.integrator = getattr(mujoco.mjtIntegrator, f"mjINT_{integrator.upper()}")
    if way == "callback":
        scope: dict[str, Any] = {}
        exec(compile(content["lugre_mujoco.py"], "lugre_mujoco.py", "exec"), scope)
        scope["install"](model)
    elif way == "C callback":
        in_c().install()
    return model, mujoco.MjData(model)


@lru_cache(maxsize=1)
def in_c() -> ctypes.CDLL:
    """The callback of docs/reference/tools.md with the exported C, compiled."""
    document = Path(__file__).parent.parent / "docs" / "reference" / "tools.md"
    (code,) = re.findall(r"```c\n(.*?)```", document.read_text(encoding="utf-8"), re.S)
    folder, home = Path(tempfile.mkdtemp()), Path(mujoco.__file__).parent
    export(stribeck.law("lugre", "canudas1995"), "c", folder)
    (folder / "callback.c").write_text(code.replace("lugre_majorant", "lugre"))
    (library,) = home.glob("libmujoco.so.*")
    return compiled(folder / "callback.c", f"-I{home / 'include'}", f"-Wl,-rpath,{home}", "lugre.c", str(library))


def run(model: Any, data: Any, push: Callable[[float, float], float], t_end: float) -> tuple[Any, ...]:
    """Times, positions, velocities and the friction that the body felt in each step."""
    count = round(t_end / model.opt.timestep)
    y, v, u = (np.zeros(count + 1) for _ in range(3))
    for k in range(count):
        u[k] = data.qfrc_applied[0] = push(data.time, data.qpos[0])
        mujoco.mj_step(model, data)
        y[k + 1], v[k + 1] = data.qpos[0], data.qvel[0]
    return np.arange(count + 1) * model.opt.timestep, y, v, u[:-1] - np.diff(v) / model.opt.timestep


def scenario(drive: dict[str, Any], t_end: float, step: float) -> stribeck.Scenario:
    """The same rig for Stribeck."""
    return stribeck.Scenario(law=LAW, plant={"mass": 1.0}, drive=drive, solve={"t_end": t_end}, output={"step": step})


def references() -> dict[str, Any]:
    """Stribeck's own simulations."""
    slip = {"kind": "spring", "stiffness": 2.0, "signal": {"kind": "ramp", "rate": 0.1}}
    pull = {"kind": "force", "signal": {"kind": "ramp", "rate": 5.0}}
    solutions = {
        "stick_slip": stribeck.simulate(scenario(slip, 40.0, 4e-3)),
        "break_away": stribeck.simulate(scenario(pull, 0.5, 1e-4)),
        "dither": stribeck.simulate(scenario({"kind": "force", "signal": DITHER}, 16.0, 4e-3)),
    }
    assert all(s.status == "done" for s in solutions.values())
    return solutions


def measure() -> Iterator[dict[str, Any]]:
    """One row for each way and step."""
    known = references()
    top = first_maximum(known["break_away"]["F"])
    drift = known["dither"]["y"][-1]
    for way, integrator in WAYS:
        for step in STEPS:
            started = process_time()
            _, y, _, _ = run(*load(way, integrator, step), lambda t, y: 2 * (0.1 * t - y), 40.0)
            seconds = process_time() - started
            every = round(4e-3 / step)
            error = np.max(abs(y[::every] - known["stick_slip"]["y"]))
            _, _, _, force = run(*load(way, integrator, step), lambda t, y: 5 * t, 0.5)
            _, moved, _, _ = run(
                *load(way, integrator, step), lambda t, y: 0.4 + 0.25 * math.sin(2 * math.pi * 5 * t), 16.0
            )
            yield {
                "way": way, "integrator": integrator, "step": step,
                "stick_slip_max_error": float(error), "break_away_error": first_maximum(force) - top,
                "drift_error": float(moved[-1] - drift), "microseconds_a_step": 1e6 * seconds * step / 40.0,
            }  # fmt: skip
    mujoco.set_mjcb_act_dyn(None)
    mujoco.set_mjcb_act_bias(None)


def first_maximum(force: Any) -> float:
    """The first local maximum: the break-away force."""
    falls = np.flatnonzero(np.diff(force) < 0)
    return float(force[falls[0]] if len(falls) else force[-1])


def main() -> None:
    """Print a table, and write the results."""
    given = options(__doc__, "in_mujoco")
    known = references()
    rows = []
    for row in measure():
        rows.append(row)
        say(str(row))
    reference = {
        "stick_slip_peak": known["stick_slip"].peaks["y"],
        "break_away": first_maximum(known["break_away"]["F"]),
        "drift": float(known["dither"]["y"][-1]),
    }
    finish(given, {"mujoco": metadata.version("mujoco"), "reference": reference, "rows": rows})


if __name__ == "__main__":
    main()

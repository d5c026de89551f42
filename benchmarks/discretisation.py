"""The exported C in discrete time: drift, energy balance and accuracy at 0.1, 1 and 4 ms, beside MuJoCo's LuGre."""

from __future__ import annotations

import ctypes
import json
import math
import tempfile
from collections.abc import Callable, Iterator
from importlib import metadata
from pathlib import Path
from typing import Any

import in_mujoco
import mujoco
import numpy as np
from measure import compiled, finish, options, say

import stribeck

STEPS = (1e-4, 1e-3, 4e-3)
MASS = 1.0
LAWS = {
    "lugre": stribeck.law("lugre", "canudas1995"),
    "elastoplastic_majorant": stribeck.law("elastoplastic_majorant", "canudas1995", k_v=1e7, z_ba=7e-6),
}
WAYS = (
    ("lugre", "step"), ("lugre", "body_step"), ("lugre", "MuJoCo Euler"), ("lugre", "MuJoCo implicitfast"),
    ("lugre", "MuJoCo RK4"), ("elastoplastic_majorant", "step"), ("elastoplastic_majorant", "body_step"),
)  # fmt: skip

Push = Callable[[float, float], float]


class Exported:
    """The exported C as a library."""

    def __init__(self, name: str) -> None:
        folder = Path(tempfile.mkdtemp())
        stribeck.export(LAWS[name], "c", folder)
        library = compiled(folder / f"{name}.c", "-std=c99")
        real, pointer = ctypes.c_double, ctypes.c_void_p
        self.step, self.body_step = library[f"{name}_step"], library[f"{name}_body_step"]
        self.step.argtypes = [pointer, pointer, real, real, pointer]
        self.body_step.argtypes = [pointer, pointer, real, real, real, pointer]
        self.parameters = (real * 32)()
        library[f"{name}_defaults"](self.parameters)

    def run(self, way: str, push: Push, t_end: float, dt: float) -> tuple[Any, ...]:
        """t, y, v and the friction of each step, as in_mujoco.run gives them."""
        count = round(t_end / dt)
        y, v, force = np.zeros(count + 1), np.zeros(count + 1), np.zeros(count)
        state, F = (ctypes.c_double * 3)(), ctypes.c_double()
        out = ctypes.byref(F)
        for k in range(count):
            u = push(k * dt, y[k])
            if way == "body_step":
                status = self.body_step(self.parameters, state, MASS, u, dt, out)
                y[k + 1], v[k + 1] = state[0], state[1]
            else:  # the measured velocity moves the bristle, its force the body
                status = self.step(self.parameters, state, v[k], dt, out)
                v[k + 1] = v[k] + dt * (u - F.value) / MASS
                y[k + 1] = y[k] + dt * v[k + 1]
            if status or not abs(v[k + 1]) < 1e6:  # unstable: the rest stays nan
                y[k + 1 :] = v[k + 1 :] = force[k:] = math.nan
                break
            force[k] = F.value
        return np.arange(count + 1) * dt, y, v, force


def lost(y: Any, v: Any, force: Any, work: float) -> float:
    """Energy that the method itself takes (or, below 0, makes), as a share of the drive's work."""
    kinetic = MASS * (v[-1] ** 2 - v[0] ** 2) / 2
    return float((work - np.sum(force * np.diff(y)) - kinetic) / work)


def measure() -> Iterator[dict[str, Any]]:
    """One row for each law, way and step."""
    slip = {"kind": "spring", "stiffness": 2.0, "signal": {"kind": "ramp", "rate": 0.1}}
    for name, way in WAYS:
        exported = Exported(name)
        for dt in STEPS:

            def run(push: Push, t_end: float, dt: float = dt, way: str = way, c: Exported = exported) -> Any:
                if way.startswith("MuJoCo"):
                    return in_mujoco.run(*in_mujoco.load("dcmotor", way.split()[1], dt), push, t_end)
                return c.run(way, push, t_end, dt)

            law = LAWS[name]
            own = {
                "name": name,
                **{n: law.values[n] for n in law.own_constants() if n in law.values},
                "parameters": "canudas1995",
            }
            rig = {"law": own, "plant": {"mass": MASS}, "solve": {"t_end": 40.0}, "output": {"step": 4e-3}}
            exact = stribeck.simulate(stribeck.Scenario(drive=slip, **rig))["y"]
            t, y, v, force = run(lambda t, y: 2 * (0.1 * t - y), 40.0)
            work = float(np.sum(2 * (0.1 * t[:-1] - y[:-1]) * np.diff(y)))
            every = round(4e-3 / dt)
            _, moved, _, _ = run(lambda t, y: 0.4 + 0.25 * math.sin(2 * math.pi * 5 * t), 16.0)
            yield {
                "law": name, "way": way, "step": dt, "stick_slip_max_error": float(np.max(abs(y[::every] - exact))),
                "energy_lost": lost(y, v, force, work), "drift": float(moved[-1] - moved[round(0.2 / dt)]),
            }  # fmt: skip
    mujoco.set_mjcb_act_dyn(None)
    mujoco.set_mjcb_act_bias(None)


def main() -> None:
    """Print a table, write the results."""
    given = options(__doc__, "discretisation")
    rows = []
    for row in measure():
        rows.append(row)
        say(str(row))
    result = {"mujoco": metadata.version("mujoco"), "rows": rows}
    finish(given, json.loads(json.dumps(result), parse_constant=lambda word: None))


if __name__ == "__main__":
    main()

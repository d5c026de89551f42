"""A law in discrete time, at 0.1, 1 and 4 ms: the exported C, MuJoCo's own dcmotor and the exported callbacks in MuJoCo.

Accuracy in stick-slip and at break-away, energy that the method takes or makes, drift under a load below break-away, and the
time of a step, beside Stribeck's own simulation. The results are discretization.json and, of MuJoCo's ways, in_mujoco.json.
"""

from __future__ import annotations

import ctypes
import json
import math
import re
import tempfile
from collections.abc import Callable, Iterator
from functools import lru_cache, partial
from importlib import metadata
from pathlib import Path
from time import process_time
from typing import Any

import mujoco
import numpy as np
from measure import Given, compiled, finish, run, say

import stribeck
from tests.exports import in_mujoco

STEPS = (1e-4, 1e-3, 4e-3)
MASS = 1.0
LAWS = {
    "lugre": stribeck.law("lugre", "canudas1995"),
    "elastoplastic_majorant": stribeck.law("elastoplastic_majorant", "canudas1995", k_v=1e7, z_ba=7e-6),
}
MUJOCO = (
    ("dcmotor", "Euler"), ("dcmotor", "implicitfast"), ("dcmotor", "RK4"), ("callback", "implicitfast"),
    ("C callback", "implicitfast"),
)  # fmt: skip
WAYS = [(name, way, "") for name in LAWS for way in ("step", "body_step")] + [("lugre", *way) for way in MUJOCO]

Push = Callable[[float, float], float]
Motion = tuple[np.ndarray, ...]  # times, positions, velocities, and the friction of each step


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

    def run(self, way: str, push: Push, t_end: float, dt: float) -> Motion:
        """A motion from rest."""
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


@lru_cache(maxsize=1)
def in_c() -> ctypes.CDLL:
    """The callback of docs/reference/tools.md with the exported C, compiled."""
    document = Path(__file__).parent.parent / "docs" / "reference" / "tools.md"
    (code,) = re.findall(r"```c\n(.*?)```", document.read_text(encoding="utf-8"), re.S)
    folder, home = Path(tempfile.mkdtemp()), Path(mujoco.__file__).parent
    stribeck.export(LAWS["lugre"], "c", folder)
    (folder / "callback.c").write_text(code.replace("lugre_majorant", "lugre"))
    (library,) = home.glob("libmujoco.so.*")
    return compiled(folder / "callback.c", f"-I{home / 'include'}", f"-Wl,-rpath,{home}", "lugre.c", str(library))


def run_in_mujoco(way: str, integrator: str, push: Push, t_end: float, step: float) -> Motion:
    """The same in MuJoCo; the friction is what the body felt."""
    with tempfile.TemporaryDirectory() as folder:
        model, data, _ = in_mujoco.load(LAWS["lugre"], Path(folder), step, own=way == "dcmotor")
    model.opt.integrator = getattr(mujoco.mjtIntegrator, f"mjINT_{integrator.upper()}")
    if way == "C callback":
        in_c().install()
    return in_mujoco.run(model, data, push, t_end)


def references(law: stribeck.Law) -> dict[str, Any]:
    """Stribeck's own simulations."""
    signals = {
        "stick_slip": {"kind": "spring", "stiffness": 2.0, "signal": {"kind": "ramp", "rate": 0.1}},
        "break_away": {"kind": "force", "signal": {"kind": "ramp", "rate": 5.0}},
        "dither": {"kind": "force", "signal": {"kind": "sine", "offset": 0.4, "amplitude": 0.25, "frequency": 5.0}},
    }
    ends = {"stick_slip": (40.0, 4e-3), "break_away": (0.5, 1e-4), "dither": (16.0, 4e-3)}
    solutions = {}
    for name, drive in signals.items():
        solve, output = {"t_end": ends[name][0]}, {"step": ends[name][1]}
        rig = stribeck.Scenario(law=law.to_dict(), plant={"mass": MASS}, drive=drive, solve=solve, output=output)
        solutions[name] = stribeck.simulate(rig)
        assert solutions[name].status == "done"
    return solutions


def lost(y: Any, v: Any, force: Any, work: float) -> float:
    """Energy that the method itself takes (or, below 0, makes), as a share of the drive's work."""
    kinetic = MASS * (v[-1] ** 2 - v[0] ** 2) / 2
    return float((work - np.sum(force * np.diff(y)) - kinetic) / work)


def first_maximum(force: Any) -> float:
    """The first local maximum: the break-away force."""
    falls = np.flatnonzero(np.diff(force) < 0)
    return float(force[falls[0]] if len(falls) else force[-1])


def measure(known: dict[str, dict[str, Any]]) -> Iterator[dict[str, Any]]:
    """One row for each law, way and step, beside what is ``known`` of each law."""
    for name, way, integrator in WAYS:
        exported, exact = Exported(name), known[name]
        for step in STEPS:
            moved = partial(run_in_mujoco, way, integrator) if integrator else partial(exported.run, way)
            started = process_time()
            t, y, v, force = moved(lambda t, y: 2 * (0.1 * t - y), 40.0, step)
            seconds, every = process_time() - started, round(4e-3 / step)
            work = float(np.sum(2 * (0.1 * t[:-1] - y[:-1]) * np.diff(y)))
            top = first_maximum(moved(lambda t, y: 5 * t, 0.5, step)[3])
            dithered = moved(lambda t, y: 0.4 + 0.25 * math.sin(2 * math.pi * 5 * t), 16.0, step)[1]
            yield {
                "law": name, "way": way, "integrator": integrator, "step": step,
                "stick_slip_max_error": float(np.max(abs(y[::every] - exact["stick_slip"]["y"]))),
                "energy_lost": lost(y, v, force, work), "drift": float(dithered[-1] - dithered[round(0.2 / step)]),
                "break_away_error": top - first_maximum(exact["break_away"]["F"]),
                "drift_error": float(dithered[-1] - exact["dither"]["y"][-1]), "microseconds_a_step": 1e6 * seconds * step / 40.0,
            }  # fmt: skip
    mujoco.set_mjcb_act_dyn(None)
    mujoco.set_mjcb_act_bias(None)


def benchmark(given: Given) -> dict[str, Any]:
    """All ways beside Stribeck; those of MuJoCo's also are a table of their own."""
    known = {name: references(law) for name, law in LAWS.items()}
    rows = []
    for row in measure(known):
        rows.append(row)
        say(str(row))
    about = {"mujoco": metadata.version("mujoco")}
    finish(given, {**about, "rows": [r for r in rows if r["integrator"]]}, stem="in_mujoco")
    named = [{**r, "way": f"MuJoCo {r['integrator']}"} if r["way"] == "dcmotor" else r for r in rows]
    without = {**about, "rows": [r for r in named if "callback" not in r["way"]]}
    return json.loads(json.dumps(without), parse_constant=lambda word: None)


if __name__ == "__main__":
    run(benchmark, __doc__, "discretization")

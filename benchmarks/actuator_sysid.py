"""One joint with gravity: MuJoCo's own identification (``pip install 'mujoco[sysid]'``) beside ``stribeck fit``, in one run.

The recordings come from SciPy on equations written here, so neither program fits what it simulated itself: once Coulomb and
viscous friction, which both know, and once LuGre friction, which MuJoCo's joint has not. Both begin at the same place; MuJoCo
moves armature, damping and frictionloss.

    python benchmarks/actuator_sysid.py --out build/actuator_sysid.json
"""

from __future__ import annotations

import argparse
import json
import math
import time
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

from stribeck.identify.actuator import Logs, fit_machine
from stribeck.identify.actuator.recordings import Channel, Recording, Sought

STEP, T_END, NOISE, K_V = 0.002, 4.0, 2e-4, 1e3
INERTIA, PULL = 0.03, 1.2
TRUTH = {"armature": 0.02, "viscous": 0.04, "coulomb": 0.3}
LUGRE = {"sigma_0": 400.0, "sigma_1": 1.0, "F_s": 0.6, "v_s": 0.3}
FIRST = 1.6  # times the truth, where both begin
XML = f"""<mujoco><option timestep="0.001" integrator="implicitfast"><flag contact="disable"/></option>
<worldbody><body name="arm"><inertial pos="0 0 {-PULL / 9.81}" mass="1" diaginertia="0.01 {INERTIA - (PULL / 9.81) ** 2} 0.01"/>
<joint name="elbow" type="hinge" axis="0 -1 0" armature="0.03" damping="0.06" frictionloss="0.5"/></body></worldbody>
<actuator><motor name="drive" joint="elbow"/></actuator>
<sensor><jointpos name="position" joint="elbow"/></sensor></mujoco>"""


def recorded(seed: int, lugre: bool) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times, torque and encoder."""
    rng, t = np.random.default_rng(seed), np.arange(round(T_END / STEP) + 1) * STEP
    push = 2.0 * np.sin(2 * np.pi * (0.5 + 0.2 * seed) * t) * (1 + 0.4 * np.sin(2 * np.pi * 1.7 * t))

    def rates(s: float, x: np.ndarray) -> list[float]:
        y, v, z = x
        sign, dz = 2 / math.pi * math.atan(K_V * v), 0.0
        friction = TRUTH["coulomb"] * sign
        if lugre:
            level = TRUTH["coulomb"] + (LUGRE["F_s"] - TRUTH["coulomb"]) * math.exp(
                -min((v / LUGRE["v_s"]) ** 2, 700.0)
            )
            dz = v - (v * sign + 2 / (math.pi * K_V)) * LUGRE["sigma_0"] / level * z
            friction = LUGRE["sigma_0"] * z + LUGRE["sigma_1"] * dz
        free = float(np.interp(s, t, push)) - PULL * math.sin(y) - friction - TRUTH["viscous"] * v
        return [v, free / (INERTIA + TRUTH["armature"]), dz]

    found = solve_ivp(rates, (0.0, T_END), [0.0, 0.0, 0.0], "LSODA", t, rtol=1e-10, atol=1e-12, max_step=STEP)
    return t, push, found.y[0] + NOISE * rng.standard_normal(len(t))


def with_mujoco(logs: list[tuple[np.ndarray, np.ndarray, np.ndarray]]) -> dict[str, object]:
    """MuJoCo's optimiser from one start."""
    import mujoco
    from mujoco import sysid

    spec = mujoco.MjSpec.from_string(XML)
    model = spec.compile()
    data = mujoco.MjData(model)
    start = sysid.create_initial_state(model, data.qpos, data.qvel, data.act)
    begin, params = time.process_time(), sysid.ParameterDict()
    names = {"armature": "armature", "viscous": "damping", "coulomb": "frictionloss"}
    for name, attribute in names.items():
        x = TRUTH[name]

        def change(s, p, a=attribute) -> None:  # type: ignore[no-untyped-def]
            old = getattr(s.joint("elbow"), a)
            setattr(s.joint("elbow"), a, p.value[0] if np.isscalar(old) else [p.value[0], *np.asarray(old)[1:]])

        params.add(sysid.Parameter(name, nominal=FIRST * x, min_value=x / 5, max_value=5 * x, modifier=change))
    sequences = sysid.ModelSequences(
        "joint", spec, [f"run{i}" for i in range(len(logs))], [start] * len(logs),
        [sysid.TimeSeries(t, u[:, None]) for t, u, _ in logs],
        [sysid.TimeSeries.from_names(t, y[:, None], model) for t, _, y in logs],
    )  # fmt: skip
    residual = sysid.build_residual_fn(models_sequences=[sequences])
    found, result = sysid.optimize(params, residual, "mujoco", verbose=False)
    left, _, _ = residual(result.x, found)
    _, half = sysid.calculate_intervals(left, result.jac)
    numbers = {
        n: {"value": float(x), "low": float(x - h), "high": float(x + h), "truth": TRUTH[n]}
        for n, x, h in zip(names, result.x, half, strict=True)
    }  # fmt: skip
    return {"cpu_s": time.process_time() - begin, "numbers": numbers}


def with_stribeck(logs: list[tuple[np.ndarray, np.ndarray, np.ndarray]], lugre: bool) -> dict[str, object]:
    """The same with ``fit_machine``, one start; with LuGre friction its other numbers are sought too."""
    law: dict[str, object] = {"name": "coulomb_viscous", "k_v": K_V, "parameters": {"F_c": 0.3, "sigma_2": 0.04}}
    paths = {"bodies.arm.inertia": INERTIA + TRUTH["armature"], "contacts.joint.law.parameters.F_c": TRUTH["coulomb"],
             "contacts.joint.law.parameters.sigma_2": TRUTH["viscous"]}  # fmt: skip
    if lugre:
        law = {"name": "lugre_majorant", "k_v": K_V, "parameters": {"F_c": 0.3, "sigma_2": 0.04, **LUGRE}}
        paths |= {f"contacts.joint.law.parameters.{n}": LUGRE[n] for n in LUGRE}
    machine = {
        "schema": 2, "name": "joint", "bodies": {"arm": {"inertia": 0.05, "initial": {"y": 0.0, "v": 0.0}}},
        "contacts": {"joint": {"from": "arm", "law": law}},
        "loads": {"gravity": {"on": "arm", "kind": "pendulum", "amplitude": PULL, "phase": 0.0},
                  "drive": {"on": "arm", "kind": "signal", "signal": {"kind": "step", "time": 0.0, "value": 0.0}}},
        "solve": {"t_end": T_END}, "output": {"step": STEP},
    }  # fmt: skip
    recordings = tuple(
        Recording(f"run{i}", t, {"arm.y": Channel("y", t, y)}, {"loads.drive.signal": Channel("u", t, u)})
        for i, (t, u, y) in enumerate(logs)
    )
    begin = time.process_time()
    sought = tuple(Sought(n, x / 5, 5 * x, FIRST * x) for n, x in paths.items())
    found = fit_machine(machine, Logs(recordings, sought), starts=1, baselines=False)
    numbers = {n: {**p.to_json(), "truth": paths[n]} for n, p in found.parameters.items()}
    return {"cpu_s": time.process_time() - begin, "left": found.error(False), "numbers": numbers, "notes": found.notes}


def main() -> None:
    """Record, fit with both, print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("build/actuator_sysid.json"))
    given = parser.parse_args()
    told = {}
    for lugre in (False, True):
        logs = [recorded(seed, lugre) for seed in range(3)]
        told["lugre" if lugre else "coulomb"] = {"mujoco": with_mujoco(logs), "stribeck": with_stribeck(logs, lugre)}
    given.out.parent.mkdir(parents=True, exist_ok=True)
    given.out.write_text(json.dumps(told, indent=1))
    for friction, both in told.items():
        for program, found in both.items():
            print(f"{friction}, {program}: {found['cpu_s']:.1f} s of processor")
            for n, p in found["numbers"].items():
                print(f"  {n:40} {p['truth']:.4g}: {p['value']:.5g} ({p['low']} ... {p['high']})")


if __name__ == "__main__":
    main()

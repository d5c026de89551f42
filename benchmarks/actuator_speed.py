"""What a fit of an actuator costs: 16 recordings of 6 s at 200 Hz, 8 unknown numbers, 20 starts.

Rotor and arm with play between them and a mesh whose friction grows with the gear's torque, as in ``actuator.py``; an
encoder only. Processor seconds are counted, over all threads, so that other work on the machine matters less.

Beside it, in the same run: SciPy's least_squares over solve_ivp, on the same equations written apart, from one start 5 %
off the truth (``--peer 0`` leaves it out; it takes that many of the recordings).

    python benchmarks/actuator_speed.py --out build/actuator_speed.json
"""

from __future__ import annotations

import argparse
import json
import math
import time
from pathlib import Path

import actuator
import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import least_squares

from stribeck import Scenario, simulate
from stribeck.identify.actuator import Logs, fit_machine
from stribeck.identify.actuator.recordings import Channel, Recording, Sought

RECORDINGS, T_END, STEP, STARTS = 16, 6.0, 0.005, 20
MORE = {
    "links.gear.damping": 0.1, "contacts.mesh.law.parameters.F_s": 1.0, "contacts.mesh.law.parameters.v_s": 0.3,
}  # fmt: skip
TRUTH = actuator.TRUTH | MORE


def machine(load: float, t: np.ndarray, push: np.ndarray) -> Scenario:
    """The drive with its true numbers."""
    made = actuator.machine(actuator.TRUTH, load, t, push)
    start = {f"bodies.{name}.initial": {"y": 0.0, "v": 0.0} for name in ("rotor", "arm")}
    return made.with_changes({"solve.t_end": float(t[-1]), **start})


def rates(
    t: float, x: np.ndarray, p: dict[str, float], load: float, times: np.ndarray, push: np.ndarray
) -> list[float]:
    """The drive's equations, written apart: docs/reference/machines.md in plain floats."""
    y, v, arm, speed, z = x
    span, half = y - arm, 1e-3
    elastic = p["links.gear.stiffness"] * (span - min(max(span, -half), half))
    damping = p["links.gear.damping"] * (v - speed)
    gear = elastic + min(max(damping, -abs(elastic)), abs(elastic))
    more, law = p["contacts.mesh.loads.0.F_c"] * abs(gear), "contacts.mesh.law.parameters."
    fall = math.exp(-min((v / p[f"{law}v_s"]) ** 2, 700.0))
    F_c = p[f"{law}F_c"] + more
    level = F_c + (p[f"{law}F_s"] - F_c) * fall
    k_v, sigma_0, sigma_1 = 1e3, 400.0, 1.0
    dz = v - (v * 2 / math.pi * math.atan(k_v * v) + 2 / (math.pi * k_v)) * sigma_0 / level * z
    friction = sigma_0 * z + sigma_1 * dz + p[f"{law}sigma_2"] * v
    drive = float(np.interp(t, times, push))
    inertia = 0.04 + 0.04 * load
    return [v, (drive - gear - friction) / p["bodies.rotor.inertia"], speed,
            (gear - 2.0 * load * math.sin(arm)) / inertia, dz]  # fmt: skip


def with_scipy(recordings: list[Recording]) -> dict[str, object]:
    """One start of SciPy's least_squares over solve_ivp."""
    names, runs = list(TRUTH), 0

    def left(u: np.ndarray) -> np.ndarray:
        nonlocal runs
        parts, p = [], dict(zip(names, np.exp(u), strict=True))
        for r in recordings:
            load, push = r.known["loads.gravity.amplitude"] / 2.0, r.inputs["loads.push.signal"].x
            runs += 1
            found = solve_ivp(
                rates, (0.0, r.t[-1]), np.zeros(5), "LSODA", r.t, rtol=1e-6, atol=1e-9, args=(p, load, r.t, push)
            )
            parts.append((found.y[0] - r.outputs["rotor.y"].x) / actuator.NOISE)
        return np.concatenate(parts)

    truth = np.log(list(TRUTH.values()))
    begin = time.process_time()
    at_truth = float(np.sqrt(np.mean(left(truth) ** 2)))
    one = (time.process_time() - begin) / runs
    first = truth + 0.05 * np.random.default_rng(1).choice([-1.0, 1.0], len(truth))
    found = least_squares(left, first, x_scale="jac", diff_step=1e-4, max_nfev=40)
    return {
        "recordings": len(recordings), "starts": 1, "cpu_s": time.process_time() - begin, "cpu_s_per_simulation": one,
        "simulations": runs, "left_of_noise": float(np.sqrt(2 * found.cost / len(found.fun))), "left_at_truth": at_truth,
        "farthest_from_truth": float(np.max(abs(np.exp(found.x - truth) - 1))), "message": found.message,
    }  # fmt: skip


def main() -> None:
    """Record, fit, print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("build/actuator_speed.json"))
    parser.add_argument("--recordings", type=int, default=RECORDINGS)
    parser.add_argument("--peer", type=int, default=1, help="recordings that SciPy fits")
    given = parser.parse_args()
    rng, t = np.random.default_rng(0), np.arange(round(T_END / STEP) + 1) * STEP
    recordings = []
    for i in range(given.recordings):
        load = 0.3 + 0.7 * (i % 2)
        rate = rng.uniform(0.1, 0.3)
        push = 3.0 * np.sin(2 * np.pi * (0.8 * t + 0.5 * t**2)) * np.cos(2 * np.pi * rate * t)
        y = simulate(machine(load, t, push))["rotor.y"] + actuator.NOISE * rng.standard_normal(len(t))
        known = {"bodies.arm.inertia": 0.04 + 0.04 * load, "loads.gravity.amplitude": 2.0 * load}
        channels = {"rotor.y": Channel("y", t, y)}, {"loads.push.signal": Channel("u", t, push)}
        recordings.append(Recording(f"run{i}", t, *channels, known))
    sought = tuple(Sought(n, 0.2 * x, 5 * x) for n, x in TRUTH.items())
    wall, cpu = time.perf_counter(), time.process_time()
    found = fit_machine(machine(0.5, t, 0 * t), Logs(tuple(recordings), sought), starts=STARTS, baselines=False)
    told = {
        "recordings": given.recordings, "seconds": T_END, "rate": 1 / STEP, "unknowns": len(TRUTH), "starts": STARTS,
        "cpu_s": time.process_time() - cpu, "wall_s": time.perf_counter() - wall, "status": found.status,
        "numbers": {n: {**found.parameters[n].to_json(), "truth": x} for n, x in TRUTH.items()}, "notes": found.notes,
    }  # fmt: skip
    if given.peer:
        told["scipy"] = with_scipy(recordings[: given.peer])
    given.out.parent.mkdir(parents=True, exist_ok=True)
    given.out.write_text(json.dumps(told, indent=1))
    print(f"{told['cpu_s']:.1f} s of processor, {told['wall_s']:.1f} s, {found.status}")
    if given.peer:
        print("SciPy:", json.dumps(told["scipy"]))
    for n, p in found.parameters.items():
        print(f"{n:40} {TRUTH[n]:.4g}: {p.value:.5g} ({p.low} ... {p.high}) {p.state}")


if __name__ == "__main__":
    main()

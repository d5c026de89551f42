"""What a fit of an actuator costs: 16 recordings of 6 s at 200 Hz, 8 unknown numbers, 20 starts.

Rotor and arm with play between them and a mesh whose friction grows with the gear's torque, as in ``actuator.py``; an
encoder only. Processor seconds are counted, over all threads, so that other work on the machine matters less.

    python benchmarks/actuator_speed.py --out build/actuator_speed.json
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path

import actuator
import numpy as np

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


def main() -> None:
    """Record, fit, print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("build/actuator_speed.json"))
    parser.add_argument("--recordings", type=int, default=RECORDINGS)
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
    given.out.parent.mkdir(parents=True, exist_ok=True)
    given.out.write_text(json.dumps(told, indent=1))
    print(f"{told['cpu_s']:.1f} s of processor, {told['wall_s']:.1f} s, {found.status}")
    for n, p in found.parameters.items():
        print(f"{n:40} {TRUTH[n]:.4g}: {p.value:.5g} ({p.low} ... {p.high}) {p.verdict}")


if __name__ == "__main__":
    main()

"""Do the intervals and ranges of a machine's numbers hold the truth? Synthetic actuators: two masses, play, a mesh whose friction
grows with its load, an encoder only.

Each experiment draws a truth, records two runs with noise, fits them with ``stribeck.identify.actuator`` and asks for each
number whether its interval and its range hold the truth, and how wide they are. Results are kept one by one: the same
command goes on where it was stopped.

    python benchmarks/actuator.py --experiments 12 --out build/actuator
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path

import numpy as np

from stribeck import Scenario, simulate
from stribeck.identify.actuator import Logs, fit_machine
from stribeck.identify.actuator.recordings import Channel, Recording, Sought
from stribeck.identify.core.states import Estimate

STEP, T_END, NOISE = 0.005, 2.0, 5e-4
TRUTH = {
    "contacts.mesh.law.parameters.F_c": 0.4, "contacts.mesh.law.parameters.sigma_2": 0.03,
    "contacts.mesh.loads.0.F_c": 0.06, "links.gear.stiffness": 60.0, "bodies.rotor.inertia": 0.02,
}  # fmt: skip


def machine(values: dict[str, float], load: float, t: np.ndarray, push: np.ndarray) -> Scenario:
    """Rotor and arm with play between them; the mesh's friction on the rotor grows with the gear's torque."""
    p = values
    law = {"sigma_0": 400.0, "sigma_1": 1.0, "sigma_2": p["contacts.mesh.law.parameters.sigma_2"],
           "F_c": p["contacts.mesh.law.parameters.F_c"], "F_s": 1.0, "v_s": 0.3}  # fmt: skip
    return Scenario({
        "schema": 2, "name": "joint",
        "bodies": {"rotor": {"inertia": p["bodies.rotor.inertia"]}, "arm": {"inertia": 0.04 + 0.04 * load}},
        "links": {"gear": {"from": "rotor", "to": "arm", "stiffness": p["links.gear.stiffness"], "damping": 0.1, "gap": 2e-3}},
        "contacts": {"mesh": {"from": "rotor", "law": {"name": "lugre_majorant", "k_v": 1e3, "parameters": law},
                              "loads": [{"force": "gear", "F_c": p["contacts.mesh.loads.0.F_c"]}]}},
        "loads": {"push": {"on": "rotor", "kind": "signal",
                           "signal": {"kind": "points", "t": t.tolist(), "value": push.tolist()}},
                  "gravity": {"on": "arm", "kind": "pendulum", "amplitude": 2.0 * load, "phase": 0.0}},
        "solve": {"t_end": T_END}, "output": {"step": STEP},
    })  # fmt: skip


def experiment(seed: int) -> dict[str, object]:
    """One truth, two recordings, one fit."""
    rng = np.random.default_rng(seed)
    truth = {n: float(x * np.exp(0.2 * rng.standard_normal())) for n, x in TRUTH.items()}
    t = np.arange(round(T_END / STEP) + 1) * STEP
    recordings = []
    for i, load in enumerate((0.3, 1.0)):
        push = 3.0 * np.sin(2 * np.pi * (0.8 * t + 1.5 * t**2)) * np.cos(2 * np.pi * rng.uniform(0.1, 0.3) * t)
        y = simulate(machine(truth, load, t, push))["rotor.y"] + NOISE * rng.standard_normal(len(t))
        known = {"bodies.arm.inertia": 0.04 + 0.04 * load, "loads.gravity.amplitude": 2.0 * load}
        channels = {"rotor.y": Channel("y", t, y)}, {"loads.push.signal": Channel("u", t, push)}
        recordings.append(Recording(f"run{i}", t, *channels, known))
    sought = tuple(Sought(n, 0.2 * x, 5 * x) for n, x in TRUTH.items())
    begin = time.process_time()
    model = machine(TRUTH, 0.5, t, 0 * t)
    model = model.with_changes(
        {"bodies.rotor.initial": {"y": 0.0, "v": 0.0}, "bodies.arm.initial": {"y": 0.0, "v": 0.0}}
    )
    found = fit_machine(model, Logs(tuple(recordings), sought), starts=6, seed=seed, baselines=False)
    rows = {n: row(e, truth[n]) for n, e in found.parameters.items()}
    return {"seed": seed, "status": found.status, "seconds": time.process_time() - begin, "numbers": rows}


def row(e: Estimate, truth: float) -> dict[str, object]:
    """An estimate beside its truth."""
    return {"truth": truth, "value": e.value, "interval": e.interval, "range": e.range or e.interval, "state": e.state}


def counted(rows: list[dict[str, object]]) -> str:
    """How many intervals and ranges hold the truth, how many numbers are identified, and how wide both are in the middle."""
    told = []
    for how in ("interval", "range"):
        held = [low <= x["truth"] <= high for x in rows for low, high in [x[how]]]
        half = np.median([(high - low) / 2 / x["value"] for x in rows for low, high in [x[how]]])
        told.append(f"{sum(held)} of {len(held)} {how}s hold (median half width {100 * half:.2g} %)")
    return f"{'; '.join(told)}; {sum(x['state'] == 'identified' for x in rows)} identified"


def main() -> None:
    """Run the experiments that are not there yet, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--experiments", type=int, default=12)
    parser.add_argument("--first", type=int, default=0, help="the seed of the first")
    parser.add_argument("--out", type=Path, default=Path("build/actuator"))
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    rows = []
    for seed in range(given.first, given.first + given.experiments):
        file = given.out / f"{seed}.json"
        if not file.exists():
            file.write_text(json.dumps(experiment(seed)))
        rows.append(json.loads(file.read_text()))
    done = [e for e in rows if e["status"] == "done"]
    seconds = np.median([e["seconds"] for e in rows])
    print(f"{len(rows)} experiments, {len(done)} done, {seconds:.1f} s of processor each (median)")
    print(f"all: {counted([x for e in done for x in e['numbers'].values()])}")
    for name in TRUTH:
        print(f"{name}: {counted([e['numbers'][name] for e in done])}")


if __name__ == "__main__":
    main()

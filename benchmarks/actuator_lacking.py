"""Do intervals and ranges of a machine's numbers hold the truth where its friction lacks a term, and where it lacks none?

Records made by SciPy, on equations written here, of an arm that hangs (torque and encoder) and of a motor with an elastic arm
(torque and the motor's encoder). The machine that is fitted has Coulomb and viscous friction; the truth has a further term of
0.3 to 10 % of the friction, or none.

    python benchmarks/actuator_lacking.py arm --experiments 20
    python benchmarks/actuator_lacking.py geared --lacks bump load --experiments 20 --first 100
"""

from __future__ import annotations

import argparse

import numpy as np
from actuator import counted, row
from scipy.integrate import odeint

from stribeck.identify.actuator import Logs, fit_machine
from stribeck.identify.actuator.recordings import Channel, Recording, Sought
from stribeck.identify.actuator.result import MachineFit

STEP, ROWS, NOISE, STEEP = 0.005, 401, 5e-4, 50.0
LAW = "contacts.joint.law.parameters."
USUAL = {
    "arm": {"bodies.arm.inertia": 0.17, "loads.gravity.amplitude": 3.3, f"{LAW}F_c": 0.1, f"{LAW}sigma_2": 0.05},
    "geared": {"bodies.rotor.inertia": 0.02, "links.gear.stiffness": 60.0, f"{LAW}F_c": 0.4, f"{LAW}sigma_2": 0.03},
}
LACKS = (
    "nothing", "bump", "drag", "position", "load", "direction", "spring", "time", "ripple", "offset", "root",
)  # fmt: skip
FAULTS = ("delay", "gain", "clock", "weight")  # of the sensor, and of what is known (geared only)
FAULTY = {"delay": (1e-4, 3e-3), "gain": (3e-4, 1e-2), "clock": (3e-5, 3e-3), "weight": (1e-3, 3e-2)}
GRAVITY, ARM, DAMPING = 1.0, 0.06, 0.1  # of the geared machine: known
SMALLEST = {"load": 0.0005}  # of the load; of all others 0.003 of the friction
LARGEST = {"load": 0.01}


def drawn(rng: np.random.Generator, what: str) -> dict[str, float]:
    """A term: its size by the friction, and where it is."""
    low, high = SMALLEST.get(what, 0.003), LARGEST.get(what, 0.1)
    low, high = FAULTY.get(what, (low, high))
    size = float(np.exp(rng.uniform(np.log(low), np.log(high)))) * rng.choice([-1.0, 1.0])
    size = abs(size) if what in ("bump", "load", "drag", "root") else size
    return {"size": size, "v_s": float(np.exp(rng.uniform(np.log(0.05), np.log(1.0)))), "phase": rng.uniform(0, 6),
            "waves": float(rng.integers(5, 30))}  # fmt: skip


def friction(
    what: str, p: dict[str, float], level: float, viscous: float, y: float, v: float, f: float, t: float
) -> float:
    """Friction with a further term; ``f``: the force that loads it."""
    s, sign = p["size"], 2 / np.pi * np.arctan(STEEP * v)
    more = {
        "nothing": 0.0, "bump": np.exp(-min((v / p["v_s"]) ** 2, 700.0)) * sign, "drag": v * abs(v) / 16,
        "position": np.cos(y + p["phase"]) * sign, "load": abs(f) / level * sign, "direction": abs(sign),
        "spring": y, "time": (t / 2 - 0.5) * sign, "ripple": np.sin(p["waves"] * y), "offset": 1.0,
        "root": sign * abs(v) ** 0.5,
    }.get(what, 0.0)  # fmt: skip
    return float(level * (sign + s * more) + viscous * v)


def record(case: str, rng: np.random.Generator, truth: dict[str, float], what: str, p: dict[str, float], size: float):
    """One recording: the times, the encoder and the torque."""
    t = STEP * np.arange(ROWS)
    f, phase = rng.uniform(0.3, 1.5, 3), rng.uniform(0, 2 * np.pi, 3)
    wave = sum(np.sin(2 * np.pi * a * t + b) - np.sin(b) for a, b in zip(f, phase, strict=True))
    u = (1.33 if case == "arm" else 0.9) * size * wave
    a, b, level, viscous = truth.values()
    s_w = p["size"]

    def hanging(x: np.ndarray, s: float) -> list[float]:
        y, v = x
        push = float(np.interp(s, t, u))
        return [v, (push - b * np.sin(y) - friction(what, p, level, viscous, y, v, push, s)) / a]

    def geared(x: np.ndarray, s: float) -> list[float]:
        y, v, q, w = x
        pull = b * (y - q) + DAMPING * (v - w)
        push = float(np.interp(s, t, u))
        rubs = friction(what, p, level, viscous, y, v, pull, s)
        weight = GRAVITY * (1 + (s_w if what == "weight" else 0.0))
        return [v, (push - pull - rubs) / a, w, (pull - weight * np.sin(q)) / ARM]

    rates, start = (hanging, [0.0, 0.0]) if case == "arm" else (geared, [0.0] * 4)
    y = odeint(rates, start, t, rtol=1e-9, atol=1e-10, hmax=STEP)[:, 0]
    if what == "gain":
        y = (1 + p["size"]) * y
    elif what in ("delay", "clock"):
        y = np.interp(t - (p["size"] if what == "delay" else p["size"] * t), t, y)
    return t, y + NOISE * rng.standard_normal(ROWS), u


def machine(case: str) -> dict[str, object]:
    """What is fitted."""
    usual, rest = USUAL[case], {"initial": {"y": 0.0, "v": 0.0}}
    law = {"name": "coulomb_viscous", "k_v": STEEP, "parameters": {"F_c": 1.2 * usual[f"{LAW}F_c"], "sigma_2": 0.06}}
    still = {"kind": "points", "t": [0.0, 1.0], "value": [0.0, 0.0]}
    on = "arm" if case == "arm" else "rotor"
    pendulum = {"on": "arm", "kind": "pendulum", "amplitude": 3.0 if case == "arm" else GRAVITY, "phase": 0.0}
    made = {
        "schema": 2, "name": case,
        "bodies": {"arm": {"inertia": 0.2, **rest}} if case == "arm" else
                  {"rotor": {"inertia": 0.025, **rest}, "arm": {"inertia": ARM, **rest}},
        "contacts": {"joint": {"from": on, "law": law}},
        "loads": {"push": {"on": on, "kind": "signal", "signal": still}, "gravity": pendulum},
        "solve": {"t_end": STEP * (ROWS - 1)}, "output": {"step": STEP},
    }  # fmt: skip
    if case == "geared":
        made["links"] = {"gear": {"from": "rotor", "to": "arm", "stiffness": 70.0, "damping": DAMPING}}
    return made


def experiment(case: str, what: str, seed: int) -> tuple[MachineFit, dict[str, float], dict[str, float]]:
    """One truth, two recordings, one fit; the truth and the term."""
    rng = np.random.default_rng([seed, (*LACKS, *FAULTS).index(what), len(case)])
    truth = {n: x * float(np.exp(0.15 * rng.standard_normal())) for n, x in USUAL[case].items()}
    p = drawn(rng, what)
    recordings = []
    for i in range(2):
        t, y, u = record(case, rng, truth, what, p, 0.7 + 0.6 * i)
        column = "arm.y" if case == "arm" else "rotor.y"
        channels = {column: Channel("y", t, y)}, {"loads.push.signal": Channel("u", t, u)}
        recordings.append(Recording(f"run{i}", t, *channels, {}))
    sought = tuple(Sought(n, x / 5, 5 * x) for n, x in USUAL[case].items())
    found = fit_machine(machine(case), Logs(tuple(recordings), sought), starts=2, seed=seed, baselines=False)
    return found, truth, p


def main() -> None:
    """Count."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("case", choices=USUAL)
    parser.add_argument("--lacks", nargs="+", choices=(*LACKS, *FAULTS), default=LACKS)
    parser.add_argument("--experiments", type=int, default=10, help="of each")
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--told", action="store_true", help="print the notes of each fit")
    given = parser.parse_args()
    every = list[dict[str, object]]()
    for what in given.lacks:
        rows, named = list[dict[str, object]](), 0
        for seed in range(given.first, given.first + given.experiments):
            found, truth, p = experiment(given.case, what, seed)
            named += any(n.startswith("What is left would fall") for n in found.notes)
            rows += [row(e, truth[n]) for n, e in found.parameters.items()]
            if given.told:
                print(seed, p, found.status, *found.notes, sep="\n    ", flush=True)
        print(f"{given.case} that lacks {what}: {counted(rows)}; a form is named in {named}", flush=True)
        every += rows
    print(f"all: {counted(every)}")


if __name__ == "__main__":
    main()

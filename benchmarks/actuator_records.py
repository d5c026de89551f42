"""Recordings of four machines with faults in all of them: do 95 % intervals hold the truth, and is the fault named?

Each record is made by SciPy, on equations written here: an arm that hangs (torque and encoder), a slide with LuGre friction
(force and position), an arm held upright by a motor with inductance (voltage and encoder, fitted in windows of 0.5 s), and a
slide that is fast wherever its Stribeck curve is not (force and position). Each experiment draws the numbers that are sought,
what drives the machine, and the noise.

    python benchmarks/actuator_records.py arm --fault gaps --experiments 30
    python benchmarks/actuator_records.py upright --experiments 50
    python benchmarks/actuator_records.py slide --fault clock --experiments 5 --told
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from actuator import counted, row
from scipy.integrate import solve_ivp

from stribeck.identify.actuator import Logs, fit_machine
from stribeck.identify.actuator.recordings import Channel, Recording, Sought
from stribeck.identify.actuator.result import MachineFit

LAW = "contacts.joint.law.parameters."
MOTOR = {"K": 0.5, "R": 1.0, "L": 0.3}
Sampled = tuple[np.ndarray, np.ndarray, np.ndarray]  # times, what was read, what drove


@dataclass(frozen=True)
class Case:
    """A machine: its file, what is sought with its usual value, what its records are, and how they are fitted."""

    machine: dict[str, object]
    usual: dict[str, float]
    record: Callable[[np.random.Generator, dict[str, float], float], Sampled]
    drive: str
    noise: float
    window: float | None = None
    recordings: int = 2


def waves(rng: np.random.Generator, t: np.ndarray, low: float, high: float) -> np.ndarray:
    """Three sines, 0 at first."""
    f, phase = rng.uniform(low, high, 3), rng.uniform(0, 2 * np.pi, 3)
    return np.asarray(sum(np.sin(2 * np.pi * a * t + b) - np.sin(b) for a, b in zip(f, phase, strict=True)))


def hanging(rng: np.random.Generator, truth: dict[str, float], size: float) -> Sampled:
    """The arm: Coulomb and viscous friction, gravity, a torque."""
    t = 0.005 * np.arange(401)
    inertia, gravity, level, viscous = truth.values()
    u = 1.33 * size * waves(rng, t, 0.3, 1.5)

    def rates(s: float, x: np.ndarray) -> list[float]:
        y, v = x
        friction = level * 2 / np.pi * np.arctan(50 * v) + viscous * v
        return [v, (np.interp(s, t, u) - gravity * np.sin(y) - friction) / inertia]

    return t, solve_ivp(rates, (0, t[-1]), [0, 0], "LSODA", t, rtol=1e-9, atol=1e-11, max_step=0.005).y[0], u


def sliding(rng: np.random.Generator, truth: dict[str, float], size: float) -> Sampled:
    """The slide: LuGre friction, a force."""
    t = 0.005 * np.arange(401)
    mass, F_c, sigma_2, F_s, v_s, sigma_0, sigma_1 = truth.values()
    u = 1.5 * size * waves(rng, t, 0.5, 2.5)

    def rates(s: float, x: np.ndarray) -> list[float]:
        _, v, z = x
        level = F_c + (F_s - F_c) * np.exp(-min((v / v_s) ** 2, 700.0))
        dz = v - (v * 2 / np.pi * np.arctan(1e4 * v) + 2 / (np.pi * 1e4)) * sigma_0 / level * z
        return [v, (np.interp(s, t, u) - sigma_0 * z - sigma_1 * dz - sigma_2 * v) / mass, dz]

    return t, solve_ivp(rates, (0, t[-1]), [0, 0, 0], "LSODA", t, rtol=1e-9, atol=1e-12, max_step=0.005).y[0], u


def fast(rng: np.random.Generator, truth: dict[str, float], size: float) -> Sampled:
    """A slide that passes through its Stribeck curve in some milliseconds."""
    t = 0.005 * np.arange(401)
    mass, F_c, sigma_2, F_s, v_s = truth.values()
    u = 3.0 * size * waves(rng, t, 0.5, 2.5)

    def rates(s: float, x: np.ndarray) -> list[float]:
        v = x[1]
        level = F_c + (F_s - F_c) * np.exp(-min((v / v_s) ** 2, 700.0))
        return [v, (np.interp(s, t, u) - level * 2 / np.pi * np.arctan(1e3 * v) - sigma_2 * v) / mass]

    return t, solve_ivp(rates, (0, t[-1]), [0, 0], "LSODA", t, rtol=1e-9, atol=1e-11, max_step=0.001).y[0], u


def upright(rng: np.random.Generator, truth: dict[str, float], size: float) -> Sampled:
    """The arm on its head: a controller sets the voltage, a sample late and straight from sample to sample."""
    step, rows = 0.004, [np.array([0.05, 0.0, 0.0])]
    t, u = step * np.arange(1001), [0.0]
    inertia, gravity, level, viscous = truth.values()

    def rates(s: float, x: np.ndarray, begin: float) -> list[float]:
        y, v, i = x
        volts = u[-2] + (u[-1] - u[-2]) * (s - begin) / step
        friction = level * 2 / np.pi * np.arctan(200 * v) + viscous * v
        pull = MOTOR["K"] * i + gravity * np.sin(y) - friction
        return [v, pull / inertia, (volts - MOTOR["R"] * i - MOTOR["K"] * v) / MOTOR["L"]]

    for now in t[:-1]:
        y, v, _ = rows[-1]
        wanted = 8.0 * (size * (0.25 * np.sin(2.1 * now) + 0.15 * np.sin(5.3 * now)) - y) - 2.0 * v
        u.append(wanted / MOTOR["K"] * MOTOR["R"] + MOTOR["K"] * v)
        end = solve_ivp(rates, (now, now + step), rows[-1], "DOP853", rtol=1e-10, atol=1e-13, args=(now,))
        rows.append(end.y[:, -1])
    return t, np.array(rows)[:, 0], np.array(u)


def machine(law: dict[str, object], body: dict[str, float], end: float, **more: object) -> dict[str, object]:
    """A body with a joint; ``more`` is what drives it."""
    made = {"schema": 2, "name": "case", "bodies": {"arm": body}, "contacts": {"joint": {"from": "arm", "law": law}}}
    return {**made, **more, "solve": {"t_end": end}, "output": {"step": 0.004}}


STILL = {"kind": "points", "t": [0.0, 1.0], "value": [0.0, 0.0]}
PUSH = {"on": "arm", "kind": "signal", "signal": STILL}
CURVE = {f"{LAW}F_s": 1.7, f"{LAW}v_s": 0.02, f"{LAW}sigma_0": 2e4, f"{LAW}sigma_1": 60.0}
CASES = {
    "arm": Case(
        machine({"name": "coulomb_viscous", "k_v": 50.0, "parameters": {"F_c": 0.12, "sigma_2": 0.06}}, {"inertia": 0.2}, 2.0,
                loads={"push": PUSH, "gravity": {"on": "arm", "kind": "pendulum", "amplitude": 3.0, "phase": 0.0}}),
        {"bodies.arm.inertia": 0.17, "loads.gravity.amplitude": 3.3, f"{LAW}F_c": 0.1, f"{LAW}sigma_2": 0.05},
        hanging, "loads.push.signal", 5e-4,
    ),
    "slide": Case(
        machine({"name": "lugre_majorant", "k_v": 1e4, "parameters": {
            "sigma_0": 2e4, "sigma_1": 60.0, "sigma_2": 3.5, "F_c": 0.9, "F_s": 1.7, "v_s": 0.02}}, {"mass": 1.2}, 2.0,
            loads={"push": PUSH}),
        {"bodies.arm.mass": 1.0, f"{LAW}F_c": 1.0, f"{LAW}sigma_2": 4.0, **CURVE},
        sliding, "loads.push.signal", 2e-5,
    ),
    "fast": Case(
        machine({"name": "stribeck", "k_v": 1e3, "parameters": {"sigma_2": 3.5, "F_c": 0.9, "F_s": 1.4, "v_s": 0.02}},
                {"mass": 1.2}, 2.0, loads={"push": PUSH}),
        {"bodies.arm.mass": 1.0, f"{LAW}F_c": 1.0, f"{LAW}sigma_2": 4.0, f"{LAW}F_s": 1.6, f"{LAW}v_s": 0.008},
        fast, "loads.push.signal", 3e-4,
    ),
    "upright": Case(
        machine({"name": "coulomb_viscous", "k_v": 200.0, "parameters": {"F_c": 0.3, "sigma_2": 0.1}}, {"inertia": 0.1}, 4.0,
                loads={"gravity": {"on": "arm", "kind": "pendulum", "amplitude": 1.0, "phase": np.pi}},
                motors={"drive": {"on": "arm", **MOTOR, "signal": STILL}}),
        {"bodies.arm.inertia": 0.05, "loads.gravity.amplitude": 2.0, f"{LAW}F_c": 0.15, f"{LAW}sigma_2": 0.03},
        upright, "motors.drive.signal", 5e-4, 0.5, 1,
    ),
}  # fmt: skip


def without(t: np.ndarray, y: np.ndarray, u: np.ndarray, rng: np.random.Generator) -> Sampled:
    """Six gaps of two to nine samples."""
    keep = np.ones(len(t), bool)
    for first in rng.integers(20, len(t) - 30, 6):
        keep[first : first + rng.integers(2, 10)] = False
    return t[keep], y[keep], u[keep]


FAULTS: dict[str, Callable[[np.ndarray, np.ndarray, np.ndarray, np.random.Generator], Sampled]] = {
    "none": lambda t, y, u, rng: (t, y, u),
    "degrees": lambda t, y, u, rng: (t, y * 180 / np.pi, u),
    "millimetres": lambda t, y, u, rng: (t, y * 1e3, u),
    "sign": lambda t, y, u, rng: (t, -y, u),
    "clock": lambda t, y, u, rng: (t, np.interp(t * (1 - 1e-3), t, y), u),
    "short": lambda t, y, u, rng: (t[: len(t) // 2], y[: len(t) // 2], u[: len(t) // 2]),
    "gaps": without,
    "coarse": lambda t, y, u, rng: (t, y, u),  # of what drives the machine every second sample only
}


def experiment(case: Case, fault: str, seed: int) -> tuple[MachineFit, dict[str, float]]:
    """One truth, its records, one fit; and the truth."""
    rng = np.random.default_rng([seed, 7])
    law_only = {n for n in CURVE if n in case.usual}  # these stay, so that F_s is above F_c
    truth = {
        n: x * (1.0 if n in law_only else float(np.exp(0.15 * rng.standard_normal()))) for n, x in case.usual.items()
    }
    recordings = []
    for i in range(case.recordings):
        t, y, u = FAULTS[fault](*case.record(rng, truth, 0.7 + 0.6 * i if case.recordings > 1 else 1.0), rng)
        size = case.noise * {"degrees": 180 / np.pi, "millimetres": 1e3}.get(fault, 1.0)
        y = y + size * rng.standard_normal(len(y))
        every = 2 if fault == "coarse" else 1
        channels = {"arm.y": Channel("y", t, y)}, {case.drive: Channel("u", t[::every], u[::every])}
        recordings.append(replace(Recording(f"run{i}", t, *channels, {}), window=case.window))
    sought = tuple(Sought(n, x / 8, 8 * x) for n, x in case.usual.items())
    found = fit_machine(case.machine, Logs(tuple(recordings), sought), starts=3, seed=seed, baselines=False)
    return found, truth


def main() -> None:
    """Count."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("case", choices=CASES)
    parser.add_argument("--fault", choices=FAULTS, default="none")
    parser.add_argument("--experiments", type=int, default=10)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--told", action="store_true", help="print the notes of each fit")
    given = parser.parse_args()
    rows: dict[str, list[dict[str, object]]] = {}
    for seed in range(given.first, given.first + given.experiments):
        found, truth = experiment(CASES[given.case], given.fault, seed)
        for n, e in found.parameters.items():
            rows.setdefault(n, []).append(row(e, truth[n]))
        if given.told:
            print(seed, found.status, *found.notes, sep="\n    ", flush=True)
    for n, own in rows.items():
        print(f"{n}: {counted(own)}")
    print(f"{given.case}, {given.fault}: {counted([e for own in rows.values() for e in own])}")


if __name__ == "__main__":
    main()

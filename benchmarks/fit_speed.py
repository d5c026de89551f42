"""How long do fits take? Seconds on the wall and of the processor, which say on a busy machine what free cores would do.

By simulation: LuGre's law from 25 s at 1 kHz with 20 starts, the same law by the positions of a body under a noisy force,
and a joint with play from recordings of 6 s at 200 Hz with 8 unknown numbers and 20 starts. Static fits, whole commands:
files of constant speed, and one record, short or very long, with a law and without; and the memory that they take.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import dynamic_records as records
import numpy as np
from measure import Given, environment, run, say

from stribeck import fit
from stribeck.identify.actuator import Logs, fit_machine
from stribeck.identify.actuator.recordings import Channel, Recording, Sought
from stribeck.identify.log import Log
from stribeck.identify.onebody import simulated
from stribeck.identify.options import FitOptions
from stribeck.identify.plan import motion
from stribeck.identify.synthetic import Sensors, experiment
from stribeck.laws import find
from tests.identify import rig

STEP = rig.STEP
# seconds of the LuGre record; recordings of the joint; constant-speed files and rows of each; rows of the one record
USUAL, QUICK = (25.0, 16, 54, 28_000, (50_000, 10_000_000)), (3.0, 2, 6, 2_800, (5_000, 1_100_000))
JOINT = {"links.gear.damping": 0.1, f"{records.LAW}F_s": 1.0, f"{records.LAW}v_s": 0.3}


def lugre_log(seconds: float) -> Log:
    """Reversals of several sizes, then strokes of several speeds, over and over."""
    tests = [*(rig.loop(size, rate) for size in (8e-6, 2e-5, 6e-5) for rate in (1.0, 4.0, 20.0)),
             *map(rig.stroke, np.geomspace(2e-4, 0.1, 15).tolist())]  # fmt: skip
    _, v = motion(tests, STEP / rig.FINER)
    count = round(seconds / STEP) * rig.FINER + 1
    moves = np.arange(count) * STEP / rig.FINER, np.resize(v, count)
    return experiment(find("lugre")(rig.TRUTH), moves, Sensors(force_noise=0.1), seed=1, every=rig.FINER).log


def lugre(seconds: float) -> Callable[[], object]:
    """A fit of LuGre's law."""
    log = lugre_log(seconds)
    return lambda: simulated(log, "lugre", FitOptions(mass=0.0)).judged()


def positions(seconds: float) -> Callable[[], object]:
    """A fit of LuGre's law by the positions of a body, whose force is as noisy as a motor's current."""
    columns, _ = records.body(records.Sensing(rate=1 / STEP, seconds=seconds, force_noise=0.03), 0)
    return lambda: fit(columns, "lugre", time="t", position="y", force="F", method="dynamic", output="position")


def joint(count: int) -> Callable[[], object]:
    """A fit of a rotor and an arm with play, whose friction grows with the gear's torque, by an encoder alone."""
    case, draw, recordings = records.CASES["joint"], np.random.default_rng(0), []
    truth = case.usual | JOINT
    for i in range(count):
        size = 0.3 + 0.7 * (i % 2)
        t, y, u = records.joint(draw, truth, size, records.Term(), 6.0)
        outputs = {"arm.y": Channel("y", t, y + case.noise * draw.standard_normal(len(t)))}
        recordings.append(Recording(f"run{i}", t, outputs, {case.drive: Channel("u", t, u)}, case.known(size)))
    logs = Logs(tuple(recordings), tuple(Sought(n, 0.2 * x, 5 * x) for n, x in truth.items()))
    built = {**case.machine, "solve": {"t_end": 6.0}}
    return lambda: fit_machine(built, logs, starts=20, baselines=False)


def saved(path: Path, v: np.ndarray, seed: int) -> str:
    """A file of a joint: a Stribeck curve, inertia 1.2, gravity of an unbalanced arm, an offset, noise, an encoder."""
    draw, x = np.random.default_rng(seed), np.cumsum(v) * STEP
    friction = np.tanh(v / 2e-3) * (11.0 + 3.0 * np.exp(-((v / 0.05) ** 2))) + 8.0 * v
    force = friction + 1.2 * np.gradient(v, STEP) + 0.8 * np.sin(x) + 0.4 + draw.normal(0, 0.3, len(v))
    columns = {"t": STEP * np.arange(len(v)), "q": np.round(x / 5e-6) * 5e-6, "F": force}
    if path.suffix == ".npz":
        np.savez(path, **columns)
    else:
        np.savetxt(path, np.column_stack([*columns.values()]), delimiter=",", fmt="%.7g", header="t,q,F", comments="")
    return str(path)


def static(folder: Path, files: list[str], law: str) -> Callable[[], float]:
    """A whole command: reading, fit, intervals, pictures and page. Gives the most memory that it took, GB."""
    names = ["--time", "t", "--position", "q", "--force", "F", "--out", str(folder / "out")]
    words = [sys.executable, "-m", "stribeck", "fit", *files, *names]
    words += ["--law", law] if law else []

    def command() -> float:
        peak = 0
        with subprocess.Popen(words, stdout=subprocess.DEVNULL, env=environment()) as child:
            # looked at while it runs: its usage at the end would count the memory of this process, too
            while child.poll() is None:
                high = re.search(r"VmHWM:\s+(\d+) kB", Path(f"/proc/{child.pid}/status").read_text())
                peak = int(high[1]) if high else peak
                time.sleep(0.05)
        assert child.returncode == 0, words
        return peak * 1024 / 1e9

    return command


def benchmark(given: Given) -> dict[str, Any]:
    """Every fit once."""
    seconds, recordings, files, each, counts = QUICK if given.quick else USUAL
    lugre(1.0)()  # compiles
    rows: list[dict[str, Any]] = []
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        t = STEP * np.arange(each)
        shape = np.clip(8 * np.sin(2 * np.pi * t / 7.0), -1, 1)
        many = [saved(folder / f"{i}.csv", v * shape, i) for i, v in enumerate(np.geomspace(5e-3, 1.5, files))]
        jobs = {
            f"lugre, {seconds:g} s at 1 kHz": lugre(seconds),
            f"lugre by position, {seconds:g} s at 1 kHz": positions(seconds),
            f"joint, {recordings} recordings": joint(recordings),
            f"stribeck, {files} files": static(folder, many, "stribeck"), f"any law, {files} files": static(folder, many, ""),
        }  # fmt: skip
        for rows_of_one, form in zip(counts, ("csv", "npz"), strict=True):
            t = STEP * np.arange(rows_of_one)
            v = sum(a * np.sin(2 * np.pi * f * t) for a, f in ((0.3, 0.31), (0.15, 0.83), (0.02, 2.9)))
            one = [saved(folder / f"one.{form}", np.asarray(v), 99)]
            jobs |= {f"{law or 'any law'}, {rows_of_one} rows": static(folder, one, law) for law in ("stribeck", "")}
        for name, job in jobs.items():
            wall, before = time.perf_counter(), os.times()
            memory = job()
            spent = sum(b - a for a, b in zip(before[:4], os.times()[:4], strict=True))
            rows.append({"fit": name, "processor_s": round(spent, 1), "wall_s": round(time.perf_counter() - wall, 1),
                         "memory_gb": round(memory, 2) if isinstance(memory, float) else ""})  # fmt: skip
            say(str(rows[-1]))
    return {"fits": rows}


if __name__ == "__main__":
    run(benchmark, __doc__, "fit_speed")

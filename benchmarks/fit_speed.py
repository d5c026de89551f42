"""How long does a LuGre fit by simulation take: 25 s at 1 kHz, 20 starts, with profile intervals?

Beside the wall clock stands the processor time: on a machine that others use too, it says what two free cores would do.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

import numpy as np
from interval_coverage import loop, stroke
from measure import RESULTS, machine, write

from stribeck.identify.log import Log
from stribeck.identify.onebody import fit_simulated
from stribeck.identify.options import FitOptions
from stribeck.identify.plan import motion
from stribeck.identify.synthetic import Sensors, experiment
from stribeck.laws import find

TRUTH = {"sigma_0": 1e6, "sigma_1": 1e3, "sigma_2": 30.0, "F_c": 10.0, "F_s": 14.0, "v_s": 5e-3}
SECONDS, STEP, FINER = 25.0, 1e-3, 4


def log() -> Log:
    """A synthetic record: reversals of several sizes, then strokes of several speeds, over and over."""
    tests = [*(loop(size, rate) for size in (8e-6, 2e-5, 6e-5) for rate in (1.0, 4.0, 20.0)),
             *map(stroke, np.geomspace(2e-4, 0.1, 15).tolist())]  # fmt: skip
    _, v = motion(tests, STEP / FINER)
    count = round(SECONDS / STEP) * FINER + 1
    velocity = np.resize(v, count)
    made = experiment(
        find("lugre")(TRUTH), (np.arange(count) * STEP / FINER, velocity), Sensors(force_noise=0.1), seed=1, every=FINER
    )
    return made.log


def main() -> None:
    """Measure and write."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--repetitions", type=int, default=3)
    parser.add_argument("--out", type=Path, default=RESULTS / "fit_speed.json")
    options = parser.parse_args()
    record, wall, processor = log(), [], []
    fit_simulated(record.rows(slice(0, 2000)), "lugre", FitOptions(mass=0.0, starts=1))  # compiles
    for _ in range(options.repetitions):
        started, used = time.perf_counter(), time.process_time()
        fit = fit_simulated(record, "lugre", FitOptions(mass=0.0))
        wall.append(time.perf_counter() - started)
        processor.append(time.process_time() - used)
    assert fit.unidentified == ()
    result = {
        "machine": machine(), "samples": len(record), "starts": 20,
        "wall_seconds": wall, "processor_seconds": processor,
    }  # fmt: skip
    write(options.out, result)
    print(
        f"{len(record)} samples, 20 starts: {np.median(wall):.1f} s wall, {np.median(processor):.1f} s processor time"
    )


if __name__ == "__main__":
    main()

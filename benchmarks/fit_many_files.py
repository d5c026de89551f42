"""Processor seconds of static fits of much data: 54 constant-speed files of 28 000 rows, and 50 000 rows with a choice of forms.

The data are synthetic: a joint with a Stribeck curve, viscous friction, an offset, white force noise and an encoder.
Whole commands are timed, reading, fit, intervals, pictures and page; user and system time of the process and its children.
"""

from __future__ import annotations

import argparse
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from measure import RESULTS, machine, write

FILES, ROWS, LONG = 54, 28_000, 50_000
STEP = 1e-3
JOBS = {
    "files, stribeck": ["--law", "stribeck"],
    "files, any law": [],
    "select, stribeck": ["--law", "stribeck"],
    "select, any law": [],
}


def friction(v: np.ndarray) -> np.ndarray:
    """N m, with v in rad/s."""
    return np.tanh(v / 2e-3) * (11.0 + 3.0 * np.exp(-((v / 0.05) ** 2))) + 8.0 * v


def record(v: np.ndarray, x: np.ndarray, seed: int) -> np.ndarray:
    """Columns time, position and force of a motion: inertia 1.2, gravity of an unbalanced arm, an offset, noise."""
    rng = np.random.default_rng(seed)
    force = friction(v) + 1.2 * np.gradient(v, STEP) + 0.8 * np.sin(x) + 0.4 + rng.normal(0, 0.3, len(v))
    return np.column_stack([STEP * np.arange(len(v)), np.round(x / 5e-6) * 5e-6, force])


def constant_speed(speed: float, rows: int, seed: int) -> np.ndarray:
    """To and fro at one speed, with ramps between."""
    t = STEP * np.arange(rows)
    v = speed * np.clip(8 * np.sin(2 * np.pi * t / 7.0), -1, 1)
    return record(v, np.cumsum(v) * STEP, seed)


def many_speeds(rows: int, seed: int) -> np.ndarray:
    """One record: three sines that sweep the curve."""
    t = STEP * np.arange(rows)
    v = 0.3 * np.sin(2 * np.pi * 0.31 * t) + 0.15 * np.sin(2 * np.pi * 0.83 * t) + 0.02 * np.sin(2 * np.pi * 2.9 * t)
    return record(v, np.cumsum(v) * STEP, seed)


def save(path: Path, columns: np.ndarray) -> Path:
    """A CSV file."""
    np.savetxt(path, columns, delimiter=",", fmt="%.7g", header="t,q,F", comments="")
    return path


def seconds(command: list[str]) -> float:
    """Processor time of a command."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def data(folder: Path, files: int, rows: int, long: int) -> dict[str, list[str]]:
    """The files of each kind of job; made where they are not there yet."""
    folder.mkdir(parents=True, exist_ok=True)
    speeds = np.geomspace(5e-3, 1.5, files)
    paths = [folder / f"speed_{i:02d}.csv" for i in range(files)]
    for i, path in enumerate(paths):
        if not path.exists():
            save(path, constant_speed(speeds[i], rows, i))
    one = folder / "long.csv"
    if not one.exists():
        save(one, many_speeds(long, 99))
    return {"files": [str(p) for p in paths], "select": [str(one)]}


def main() -> None:
    """Measure and write."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--quick", action="store_true", help="a tenth of the data")
    parser.add_argument("--data", type=Path, help="keep the data in this folder, and the fits beside them")
    parser.add_argument("--only", choices=list(JOBS), action="append")
    parser.add_argument("--out", type=Path, default=RESULTS / "fit_many_files.json")
    options = parser.parse_args()
    size = (6, 2800, 5000) if options.quick else (FILES, ROWS, LONG)
    found: dict[str, float] = {}
    with tempfile.TemporaryDirectory() as scratch:
        folder = options.data or Path(scratch)
        made = data(folder, *size)
        for name in options.only or JOBS:
            out = folder / f"fit {name}"
            columns = ["--time", "t", "--position", "q", "--force", "F", "--out", str(out)]
            command = [sys.executable, "-m", "stribeck", "fit", *made[name.split(",")[0]], *columns, *JOBS[name]]
            found[name] = seconds(command)
            print(f"{name}: {found[name]:.1f} s of processor time", flush=True)
    if not options.only:
        sizes = dict(zip(("files", "rows_of_each", "rows_of_one"), size, strict=True))
        write(options.out, {"machine": machine(), **sizes, "processor_seconds": found})


if __name__ == "__main__":
    main()

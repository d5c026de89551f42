"""A sweep on a Dask cluster of processes on this machine: nothing lost when workers are killed at random instants, and how
the time falls with workers.

    python benchmarks/cluster.py [--kills 20] [--seed 1] [--lanes 4000]

Workers are killed with SIGKILL and new ones started in their place; in the end every byte is compared with the same sweep by
this process alone. Then the time alone (one thread), and with 1, 2 and 4 workers of one thread each.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path
from typing import Any

import numpy as np

import stribeck
from stribeck.sweeps import job

WORKERS = (1, 2, 4)
RESULTS = Path(__file__).parent / "results" / "cluster.json"
SCENARIO = {
    "law": {"name": "lugre_majorant", "k_v": 1e6, "parameters": "canudas1995"}, "plant": {"mass": 1.0},
    "drive": {"kind": "spring", "stiffness": 2.0, "signal": {"kind": "ramp", "rate": 0.1}},
    "solve": {"t_end": 40.0}, "output": {"step": 0.05},
}  # fmt: skip


class Cluster:
    """A scheduler and workers, each a process."""

    def __init__(self, folder: Path, workers: int) -> None:
        self.folder = folder
        file = folder / "scheduler.json"
        self.scheduler = self._start("scheduler", "--port", "0", "--no-dashboard", "--scheduler-file", str(file))
        while not (file.exists() and file.read_text().endswith("}")):
            time.sleep(0.05)
        self.address = json.loads(file.read_text())["address"]
        self.workers = [self.worker() for _ in range(workers)]

    def _start(self, *words: str) -> subprocess.Popen[bytes]:
        command = [sys.executable, "-m", f"distributed.cli.dask_{words[0]}", *words[1:]]
        return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, cwd=self.folder)

    def worker(self) -> subprocess.Popen[bytes]:
        """One more worker of one thread."""
        return self._start("worker", self.address, "--nthreads", "1", "--no-nanny", "--no-dashboard")

    def close(self) -> None:
        """Kill all."""
        for process in (*self.workers, self.scheduler):
            process.send_signal(signal.SIGKILL)
            process.wait()


def bytes_of(folder: Path) -> dict[str, bytes]:
    """The files of a folder."""
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


def sweep(values: dict[str, Any], out: Path, on: str | None = None) -> float:
    """Make it; how long it took, s."""
    started = time.perf_counter()
    stribeck.sweep(SCENARIO, values, out, summary=True, threads=None if on else 1, on=on)
    return time.perf_counter() - started


def attack(values: dict[str, Any], folder: Path, kills: int, random_: random.Random) -> dict[str, Any]:
    """Kill workers at random instants until the sweep is done; begin it anew while kills are left."""
    sweep(values, folder / "alone")
    done = rounds = 0
    same = True
    while done < kills:
        (place := folder / f"round{rounds}").mkdir()
        cluster, stop = Cluster(place, 2), threading.Event()
        count = [0]

        def kill(cluster: Cluster = cluster, stop: threading.Event = stop, count: list[int] = count) -> None:
            while not stop.wait(random_.uniform(0.2, 3.0)):
                i = random_.randrange(len(cluster.workers))
                os.kill(cluster.workers[i].pid, signal.SIGKILL)
                cluster.workers[i].wait()
                cluster.workers[i] = cluster.worker()
                count[0] += 1

        thread = threading.Thread(target=kill)
        thread.start()
        try:
            sweep(values, place / "out", cluster.address.replace("tcp", "dask"))
        finally:
            stop.set()
            thread.join()
            cluster.close()
        same &= bytes_of(place / "out") == bytes_of(folder / "alone")
        done, rounds = done + count[0], rounds + 1
        print(f"round {rounds}: {count[0]} kills, every byte the same: {same}", flush=True)
    return {"kills": done, "sweeps": rounds, "same_bytes": same}


def figures(seconds: dict[str, float], lanes: int, parts: int) -> dict[str, Any]:
    """What the times say: the efficiency of w workers, time alone/(w time), where there are as many cores; what a part costs
    beside its lanes; and what a million lanes would take on 100 cores if each went on like the one worker did here."""
    cores = os.cpu_count() or 1
    efficiency = {w: seconds["alone"] / (w * seconds[f"{w} workers"]) for w in WORKERS if w <= cores}
    return {
        "efficiency": efficiency,
        "parts": parts,
        "seconds_a_part_beside_its_lanes": (seconds["1 workers"] - seconds["alone"]) / parts,
        "a_million_lanes_on_100_cores_in_seconds": 1e6 / lanes * seconds["1 workers"] / 100,
    }


def main() -> None:
    """Attack, then measure."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--lanes", type=int, default=4000)
    given = parser.parse_args()
    values = {"law.k_v": np.geomspace(1e6, 1e8, given.lanes), "plant.mass": np.linspace(1.0, 2.0, given.lanes)}
    job._PART_BYTES = 64e6 / 16  # some parts a worker
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        result = attack(values, folder, given.kills, random.Random(given.seed))
        seconds = {"alone": sweep(values, folder / "timed")}
        parts = len(list((folder / "timed").glob("part-*")))
        for workers in WORKERS:
            (place := folder / f"workers{workers}").mkdir()
            cluster = Cluster(place, workers)
            try:
                sweep(
                    {path: x[:400] for path, x in values.items()},
                    place / "warm",
                    cluster.address.replace("tcp", "dask"),
                )
                seconds[f"{workers} workers"] = sweep(values, place / "out", cluster.address.replace("tcp", "dask"))
            finally:
                cluster.close()
    result |= {"lanes": given.lanes, "cores": os.cpu_count(), "seconds": seconds}
    result |= figures(seconds, given.lanes, parts)
    RESULTS.write_text(json.dumps(result, indent=2) + "\n", encoding="utf-8")
    print(json.dumps(result, indent=2))


if __name__ == "__main__":
    main()

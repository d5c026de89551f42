"""Commands killed at random instants over an older result: what is there afterwards is whole, and the next one works."""

from __future__ import annotations

import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

from stribeck import examples

_LAST = 4.0  # s; kills come until then, some after the end


def campaign(seed: int, count: int) -> tuple[Counter[str], list[str]]:
    """How the processes ended, and what is wrong."""
    ended: Counter[str] = Counter()
    faults = []
    for i in range(count):
        rng = random.Random(f"{seed}/{i}")
        with tempfile.TemporaryDirectory() as folder:
            fault = _one(Path(folder), rng, ended)
            if fault:
                faults.append(f"kill {seed}/{i}: {fault}")
    return ended, faults


def _one(place: Path, rng: random.Random, ended: Counter[str]) -> str | None:
    scenario, out = place / "rig.toml", place / "out"
    scenario.write_bytes(examples.path("stick_slip").read_bytes())
    environment = os.environ | {"STRIBECK_CACHE": str(place / "cache")}
    base = [sys.executable, "-m", "stribeck"]
    what, old, new = rng.choice([
        ("run", ["--set", "solve.t_end=5.0"], ["--set", "solve.t_end=40.0"]),
        ("sweep", ["--vary", "law.k_v=1e6:1e8:40:log"], ["--vary", "law.k_v=1e6:1e8:40:log"]),
    ])  # fmt: skip
    command = [*base, what, str(scenario), "--out", str(out)]
    if what == "run":
        subprocess.run([*command, *old], env=environment, check=True, capture_output=True)
    process = subprocess.Popen(
        [*command, *new], env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # a shell's background job ignores it
    )  # fmt: skip
    time.sleep(rng.uniform(0.05, _LAST))
    number = rng.choice((signal.SIGKILL, signal.SIGTERM, signal.SIGINT))
    process.send_signal(number)
    try:
        _, error = process.communicate(timeout=60)
    except subprocess.TimeoutExpired:
        process.kill()
        return f"{what} does not end on {number.name}"
    ended[f"{what} {number.name} exit {process.returncode}"] += 1
    if b"Traceback" in error:
        return f"{what} {number.name}: a traceback"
    if number != signal.SIGKILL and (left := [p.name for p in out.glob(".*")]):
        return f"{what} {number.name} left {left}"
    if what == "run" and (out / "summary.json").exists():
        end = json.loads((out / "summary.json").read_text())["final"]["t"]
        rows = len((out / "trajectory.csv").read_text().splitlines())
        if rows != round(end / 0.01) + 2:
            return f"a summary to t = {end} beside {rows} rows"
    again = subprocess.run([*command, *new], env=environment, check=False, capture_output=True)
    return None if again.returncode == 0 else f"{what} after {number.name}: {again.stderr.decode()[:200]}"

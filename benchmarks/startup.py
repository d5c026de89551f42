"""Start-up: the time and the memory of whole processes, from the call of the command to its end.

Each command runs in an environment of its own: its cache folder is a fresh one, filled beforehand for the cached cases
and empty for the new ones. The commands take turns. Memory is the peak of the process and its children (the compiler).
"""

from __future__ import annotations

import shutil
import sys
import tempfile
from pathlib import Path
from typing import Any

from measure import Given, Process, process, run, say, spread

from stribeck import examples


def stribeck() -> list[str]:
    """The command of the environment that runs this file, else the one on the path."""
    beside = Path(sys.executable).parent / "stribeck"
    result = str(beside) if beside.is_file() else shutil.which("stribeck")
    if result is None:
        raise SystemExit("there is no command stribeck: install the project first")
    return [result]


def cases() -> dict[str, tuple[list[str], bool, bool]]:
    """Commands, whether their cache is filled, and whether they write a folder."""
    simulate = [*stribeck(), "run", str(examples.path("limit_cycle")), "--json"]
    return {
        "python -c pass": ([sys.executable, "-c", "pass"], True, False),
        "python -c 'import numpy'": ([sys.executable, "-c", "import numpy"], True, False),
        "stribeck --help": ([*stribeck(), "--help"], True, False),
        "run --json, cached": (simulate, True, False),
        "run --json, new": (simulate, False, False),
        "run --json --out, cached": (simulate, True, True),
        "run --json --out, new": (simulate, False, True),
    }


def benchmark(given: Given) -> dict[str, Any]:
    """Run every command once unmeasured, then all in turn."""
    done: dict[str, list[Process]] = {name: [] for name in cases()}
    with tempfile.TemporaryDirectory() as folder:
        for repetition in range(given.repetitions + 1):
            for name, (command, cached, writes) in cases().items():
                cache = Path(folder) / "filled" if cached else tempfile.mkdtemp(dir=folder)
                more = ["--out", tempfile.mkdtemp(dir=folder)] if writes else []
                done[name].append(process([*command, *more], STRIBECK_CACHE=str(cache)))
            say(f"repetition {repetition} of {given.repetitions}")
    lines = []
    for name, processes in done.items():
        cpu, wall, megabytes = zip(*processes[1:], strict=True)
        lines.append(
            {"case": name, "seconds": spread(wall), "cpu_seconds": spread(cpu), "peak_megabytes": max(megabytes)}
        )
    return {"benchmark": "start-up, whole processes", "cases": lines}


if __name__ == "__main__":
    run(benchmark, __doc__, "startup", repetitions=(11, 1))

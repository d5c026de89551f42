"""Start-up: the time and the memory of whole processes, from the call of the command to its end.

Each command runs in an environment of its own: its cache folder is a fresh one, filled beforehand for the cached cases
and empty for the new ones. The commands take turns. Memory is the peak of the process and its children (the compiler).
"""

from __future__ import annotations

import shutil
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

from measure import Given, Process, process, run, say, spread

from stribeck import examples

Prepared = Callable[[], tuple[Path, list[str]]]  # the cache folder, and further arguments
Case = tuple[list[str], Prepared]


def stribeck() -> list[str]:
    """The command of the environment that runs this file, else the one on the path."""
    beside = Path(sys.executable).parent / "stribeck"
    result = str(beside) if beside.is_file() else shutil.which("stribeck")
    if result is None:
        raise SystemExit("there is no command stribeck: install the project first")
    return [result]


def cases(folder: Path) -> dict[str, Case]:
    """The commands."""
    scenario, filled = examples.path("limit_cycle"), folder / "filled"

    def fresh() -> Path:
        return Path(tempfile.mkdtemp(prefix="fresh-", dir=folder))

    def with_out(cache: Path) -> tuple[Path, list[str]]:
        return cache, ["--out", str(fresh())]

    simulate = [*stribeck(), "run", str(scenario), "--json"]
    return {
        "python -c pass": ([sys.executable, "-c", "pass"], lambda: (filled, [])),
        "python -c 'import numpy'": ([sys.executable, "-c", "import numpy"], lambda: (filled, [])),
        "stribeck --help": ([*stribeck(), "--help"], lambda: (filled, [])),
        "run --json, cached": (simulate, lambda: (filled, [])),
        "run --json, new": (simulate, lambda: (fresh(), [])),
        "run --json --out, cached": (simulate, lambda: with_out(filled)),
        "run --json --out, new": (simulate, lambda: with_out(fresh())),
    }


def figures(name: str, processes: list[Process]) -> dict[str, Any]:
    """A case's line of the results."""
    cpu, wall, megabytes = (list(x) for x in zip(*processes, strict=True))
    return {"case": name, "seconds": spread(wall), "cpu_seconds": spread(cpu), "peak_megabytes": max(megabytes)}


def benchmark(given: Given) -> dict[str, Any]:
    """Run every command once unmeasured, then all in turn."""
    with tempfile.TemporaryDirectory() as folder:
        measured = cases(Path(folder))
        done: dict[str, list[Process]] = {name: [] for name in measured}
        for repetition in range(given.repetitions + 1):
            for name, (command, prepare) in measured.items():
                cache, arguments = prepare()
                done[name].append(process([*command, *arguments], STRIBECK_CACHE=str(cache)))
            say(f"repetition {repetition} of {given.repetitions}")
    lines = [figures(name, processes[1:]) for name, processes in done.items()]
    return {"benchmark": "start-up, whole processes", "cases": lines}


if __name__ == "__main__":
    run(benchmark, __doc__, "startup", repetitions=(11, 1))

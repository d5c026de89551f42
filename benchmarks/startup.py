"""Start-up: the time and the memory of whole processes, from the call of the command to its end.

Each command runs in an environment of its own: its cache folder is a fresh one, filled beforehand for the cached cases
and empty for the new ones. The commands take turns. Memory is the peak of the process and its children (the compiler).
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from time import perf_counter
from typing import Any, NamedTuple

from measure import environment, finish, options, say, spread

from stribeck import examples

KILO = 1 if sys.platform == "darwin" else 1024  # ru_maxrss is in bytes there


Prepared = Callable[[], tuple[Path, list[str]]]  # the cache folder, and further arguments
Case = tuple[list[str], Prepared]


class Process(NamedTuple):
    """What a process took: time on the wall, processor time, and its peak of memory, MB."""

    wall: float
    cpu: float
    megabytes: float


def run(name: str, command: list[str], prepare: Prepared) -> Process:
    """Run a command once."""
    cache, arguments = prepare()
    started = perf_counter()
    process = subprocess.Popen(
        [*command, *arguments], env=environment(STRIBECK_CACHE=str(cache)), stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
    )  # fmt: skip
    assert process.stderr is not None
    with process.stderr:
        complaint = process.stderr.read()
    _, status, usage = os.wait4(process.pid, 0)
    wall, process.returncode = perf_counter() - started, os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        raise SystemExit(f"{name}: exit status {process.returncode}: {complaint.decode(errors='replace')}")
    return Process(wall, usage.ru_utime + usage.ru_stime, usage.ru_maxrss * KILO / 1e6)


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
    wall, cpu, megabytes = (list(x) for x in zip(*processes, strict=True))
    return {"case": name, "seconds": spread(wall), "cpu_seconds": spread(cpu), "peak_megabytes": max(megabytes)}


def benchmark(repetitions: int) -> dict[str, Any]:
    """Run every command once unmeasured, then all in turn."""
    with tempfile.TemporaryDirectory() as folder:
        measured = cases(Path(folder))
        done: dict[str, list[Process]] = {name: [] for name in measured}
        for repetition in range(repetitions + 1):
            for name, case in measured.items():
                done[name].append(run(name, *case))
            say(f"repetition {repetition} of {repetitions}")
    lines = [figures(name, processes[1:]) for name, processes in done.items()]
    return {"benchmark": "start-up, whole processes", "cases": lines}


def main() -> None:
    """Run the benchmark, print the table, write the results."""
    given = options(__doc__, "startup", repetitions=(11, 1))
    finish(given, benchmark(given.repetitions))


if __name__ == "__main__":
    main()

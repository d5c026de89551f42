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
from dataclasses import dataclass, field
from pathlib import Path
from time import perf_counter
from typing import Any

from measure import environment, finish, options, say, spread
from problems import LIMIT_CYCLE

KILO = 1 if sys.platform == "darwin" else 1024  # ru_maxrss is in bytes there


@dataclass
class Case:
    """A command to time; ``prepare`` makes what it needs and returns the cache folder and further arguments."""

    name: str
    command: list[str]
    prepare: Callable[[], tuple[Path, list[str]]]
    times: list[float] = field(default_factory=list)
    cpu: list[float] = field(default_factory=list)
    megabytes: list[float] = field(default_factory=list)

    def run(self) -> None:
        """Run once, keeping time and memory."""
        cache, arguments = self.prepare()
        started = perf_counter()
        process = subprocess.Popen(
            [*self.command, *arguments], env=environment(STRIBECK_CACHE=str(cache)), stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
        )  # fmt: skip
        assert process.stderr is not None
        complaint = process.stderr.read()
        _, status, usage = os.wait4(process.pid, 0)
        self.times.append(perf_counter() - started)
        self.cpu.append(usage.ru_utime + usage.ru_stime)
        process.stderr.close()
        process.returncode = os.waitstatus_to_exitcode(status)
        self.megabytes.append(usage.ru_maxrss * KILO / 1e6)
        if process.returncode != 0:
            raise SystemExit(f"{self.name}: exit status {process.returncode}: {complaint.decode(errors='replace')}")


def stribeck() -> list[str]:
    """The command of the environment that runs this file, else the one on the path."""
    beside = Path(sys.executable).parent / "stribeck"
    found = str(beside) if beside.is_file() else shutil.which("stribeck")
    if found is None:
        raise SystemExit("there is no command stribeck: install the project first")
    return [found]


def cases(folder: Path) -> list[Case]:
    """The commands."""
    scenario, filled = folder / "limit_cycle.toml", folder / "filled"
    scenario.write_text(LIMIT_CYCLE.toml)

    def fresh() -> Path:
        return Path(tempfile.mkdtemp(prefix="fresh-", dir=folder))

    def with_out(cache: Path) -> tuple[Path, list[str]]:
        return cache, ["--out", str(fresh())]

    run = [*stribeck(), "run", str(scenario), "--json"]
    return [
        Case("python -c pass", [sys.executable, "-c", "pass"], lambda: (filled, [])),
        Case("python -c 'import numpy'", [sys.executable, "-c", "import numpy"], lambda: (filled, [])),
        Case("stribeck --help", [*stribeck(), "--help"], lambda: (filled, [])),
        Case("run --json, cached", run, lambda: (filled, [])),
        Case("run --json, new", run, lambda: (fresh(), [])),
        Case("run --json --out, cached", run, lambda: with_out(filled)),
        Case("run --json --out, new", run, lambda: with_out(fresh())),
    ]


def figures(case: Case) -> dict[str, Any]:
    """A case's line of the results."""
    peak = max(case.megabytes)
    return {"case": case.name, "seconds": spread(case.times), "cpu_seconds": spread(case.cpu), "peak_megabytes": peak}


def benchmark(repetitions: int) -> dict[str, Any]:
    """Run every command once unmeasured, then all in turn."""
    with tempfile.TemporaryDirectory() as folder:
        measured = cases(Path(folder))
        for case in measured:
            case.run()
        for case in measured:
            for kept in (case.times, case.cpu, case.megabytes):
                kept.clear()
        for repetition in range(repetitions):
            for case in measured:
                case.run()
            say(f"repetition {repetition + 1} of {repetitions}")
    return {
        "benchmark": "start-up, whole processes",
        "cases": [figures(case) for case in measured],
    }


def main() -> None:
    """Run the benchmark, print the table, write the results."""
    given = options(__doc__, "startup", repetitions=(11, 1))
    finish(given, benchmark(given.repetitions))


if __name__ == "__main__":
    main()

"""What the benchmarks share: clocks, medians and quartiles, the machine, options, and files of results with their tables."""

from __future__ import annotations

import argparse
import ctypes
import json
import os
import platform
import random
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path
from time import perf_counter, process_time
from typing import Any, NamedTuple

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))  # some simulate what tests and tools do
RESULTS = ROOT / "benchmarks" / "results"
KILO = 1 if sys.platform == "darwin" else 1024  # ru_maxrss is in bytes there
KEPT = ROOT / "benchmarks" / "tolerances.json"  # tolerances whose search takes long
PACKAGES = (
    "stribeck", "numpy", "scipy", "numba", "numbalsoda", "scikit-sundae", "casadi", "diffrax", "jax", "mujoco",
)  # fmt: skip


Given = argparse.Namespace


class Seconds(NamedTuple):
    """What a call took: processor time of all threads, and time on the wall."""

    cpu: float
    wall: float


def timed(call: Callable[[], object]) -> Seconds:
    """Call once. Ratios are taken of processor time: another process at work then matters little."""
    wall, cpu = perf_counter(), process_time()
    call()
    return Seconds(process_time() - cpu, perf_counter() - wall)


class Process(NamedTuple):
    """What a process and its children took: processor time and time on the wall, s, and their peak of memory, MB."""

    cpu: float
    wall: float
    megabytes: float


def environment(**more: str) -> dict[str, str]:
    """The environment of a command that is timed: bytecode is kept, as an installed package has it."""
    return {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"} | more


def process(command: list[str], **more: str) -> Process:
    """Run a command; ``more``: of its environment."""
    quiet: dict[str, Any] = {"stdin": subprocess.DEVNULL, "stdout": subprocess.DEVNULL, "stderr": subprocess.PIPE}
    started = perf_counter()
    with subprocess.Popen(command, env=environment(**more), **quiet) as child:
        assert child.stderr is not None
        complaint = child.stderr.read()
        _, status, usage = os.wait4(child.pid, 0)
        wall, child.returncode = perf_counter() - started, os.waitstatus_to_exitcode(status)
    if child.returncode:
        raise SystemExit(f"{' '.join(command)}: status {child.returncode}: {complaint.decode(errors='replace')}")
    return Process(usage.ru_utime + usage.ru_stime, wall, usage.ru_maxrss * KILO / 1e6)


def compiled(source: Path, *more: str) -> ctypes.CDLL:
    """A file of C as a library; ``more``: options of the compiler and further files, beside the first."""
    library = Path(tempfile.mkdtemp()) / f"{source.stem}.so"
    command = ["cc", "-O2", "-shared", "-fPIC", "-o", str(library), source.name, *more, "-lm"]
    subprocess.run(command, cwd=source.parent, check=True)
    return ctypes.CDLL(str(library))


def say(text: str) -> None:
    """Progress, on standard error."""
    print(text, file=sys.stderr, flush=True)


def options(about: str | None, name: str, **defaults: Any) -> Given:
    """The options of a benchmark: --out, --quick, and one for each default; of a pair, --quick takes the second."""
    parser = argparse.ArgumentParser(description=about, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=RESULTS / f"{name}.json", help="file of the results")
    parser.add_argument("--quick", action="store_true", help="only see whether it works; the figures mean little")
    for key, value in defaults.items():
        word, usual = f"--{key.replace('_', '-')}", value[0] if isinstance(value, tuple) else value
        if isinstance(usual, bool):
            parser.add_argument(word, action="store_true")
        elif isinstance(usual, list):
            parser.add_argument(word, nargs="+", choices=usual, metavar="NAME", help=f"of {', '.join(usual)}")
        else:
            parser.add_argument(word, type=type(usual), help=f"{usual} unless given")
    given = parser.parse_args()
    for key, value in defaults.items():
        if getattr(given, key) is None:
            usual, quick = value if isinstance(value, tuple) else (value, value)
            setattr(given, key, quick if given.quick else usual)
    given.name, given.machine = name, machine()  # its load is that before anything is measured
    return given


def spread(values: Sequence[float]) -> dict[str, float]:
    """Median and quartiles of the repetitions, and how many there were."""
    low, middle, high = statistics.quantiles(values, n=4) if len(values) > 1 else [values[0]] * 3
    return {"median": middle, "q1": low, "q3": high, "repetitions": len(values)}


def machine() -> dict[str, Any]:
    """Date, processor, load (of the last 1, 5 and 15 minutes), compiler and versions: what the figures depend on."""
    return {
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
        "processor": processor(),
        "cores": os.cpu_count(),
        "load": [round(x, 2) for x in os.getloadavg()] if hasattr(os, "getloadavg") else None,
        "system": f"{platform.system()} {platform.release()} {platform.machine()}",
        "compiler": first_line([os.environ.get("STRIBECK_CC") or os.environ.get("CC") or "cc", "--version"]),
        "python": platform.python_version(),
        "versions": {name: version(name) for name in PACKAGES},
    }


def processor() -> str:
    """The processor's model."""
    try:
        lines = Path("/proc/cpuinfo").read_text(errors="replace").splitlines()
    except OSError:
        lines = []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()


def version(package: str) -> str | None:
    """The installed version of a package, None where there is none."""
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return None


def first_line(command: list[str]) -> str | None:
    """The first line that a command prints, None where it cannot be run."""
    try:
        result = subprocess.run(command, capture_output=True, text=True, timeout=30, check=True)
    except (OSError, subprocess.SubprocessError):
        return None
    return result.stdout.partition("\n")[0] or None


def kept() -> dict[str, dict[str, float]]:
    """The tolerances, by solver, that an earlier search found."""
    return json.loads(KEPT.read_text()) if KEPT.is_file() else {}


def keep(name: str, rtol: float, atol: float) -> None:
    """Keep what a search found."""
    write(KEPT, {**kept(), name: {"rtol": rtol, "atol": atol}})


def in_turn(ways: Mapping[str, Callable[[], object]], repetitions: int) -> dict[str, list[Seconds]]:
    """What each call takes: in every repetition each has its turn, in random order."""
    taken: dict[str, list[Seconds]] = {name: [] for name in ways}
    for _ in range(repetitions):
        for name in random.sample(list(ways), len(ways)):
            taken[name].append(timed(ways[name]))
    return taken


def run(
    measured: Callable[[Given], dict[str, Any]], about: str | None, name: str, *tables: str, **defaults: Any
) -> dict[str, Any]:
    """Measure by the options of the command, write the results and print their tables; the results."""
    given = options(about, name, **defaults)
    results = measured(given)
    finish(given, results, *tables)
    return results


def finish(given: Given, results: dict[str, Any], *tables: str, stem: str = "") -> None:
    """Write the results, and print their tables as the pages of docs/evidence show them; ``stem``: of another file."""
    results = {"machine": given.machine, **results}
    write(given.out.with_stem(stem) if stem else given.out, results)
    sys.path.insert(0, str(ROOT / "docs" / "_ext"))
    from evidence import table

    print(*(f"{table(name, results)}\n" for name in tables or (stem or given.name,)), sep="\n")


def write(path: Path, results: dict[str, Any]) -> None:
    """Write a file of results."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(results, indent=2) + "\n", encoding="utf-8")

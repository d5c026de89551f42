"""All benchmarks: prints plain tables and writes results/*.json and *.svg. Each runs in a process of its own."""

from __future__ import annotations

import argparse
import subprocess
import sys
from pathlib import Path
from time import perf_counter

from measure import RESULTS, machine

BENCHMARKS = {  # and their files
    "single": "single.py",
    "ensemble": "ensemble.py",
    "precision": "precision.py",
    "scaling": "scaling.py",
    "mujoco": "mujoco_lugre.py",
    "in_mujoco": "in_mujoco.py",
    "discretisation": "discretisation.py",
    "instructions": "instructions.py",
    "arm_instructions": "arm_instructions.py",
    "fit_speed": "fit_speed.py",
    "coverage": "interval_coverage.py",
    "majorants": "majorants.py",
    "startup": "startup.py",
    "explorer": "explorer.py",
    "machines": "machines.py",
}


def main() -> None:
    """Run the benchmarks that are asked for, all unless told; the exit status is 1 where one failed to run."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(BENCHMARKS)}; all unless given")
    parser.add_argument("--repetitions", type=int, help="repetitions of each")
    parser.add_argument("--quick", action="store_true", help="only see whether they work; the figures mean little")
    parser.add_argument("--out", type=Path, default=RESULTS, help="folder of the results")
    options = parser.parse_args()
    for name in options.names:
        if name not in BENCHMARKS:
            parser.error(f"{name}: must be one of {', '.join(BENCHMARKS)}")
    about = machine()
    print(f"{about['date']}: {about['processor']}, {about['cores']} cores, {about['system']}, Python {about['python']}")
    print(f"compiler: {about['compiler'] or 'none'}; load: {about['load']}")
    print("Another process at work makes slow solvers look slower: a load near 0 is wanted.\n", flush=True)
    failed, begun = [], perf_counter()
    for name in options.names or BENCHMARKS:
        started = perf_counter()
        command = [sys.executable, str(Path(__file__).with_name(BENCHMARKS[name]))]
        command += ["--out", str(options.out / f"{name}.json"), *(["--quick"] if options.quick else [])]
        if options.repetitions:
            command += ["--repetitions", str(options.repetitions)]
        if subprocess.run(command, check=False).returncode != 0:
            failed.append(name)
        print(f"({name}: {perf_counter() - started:.0f} s)\n", flush=True)
    print(f"all: {perf_counter() - begun:.0f} s")
    if failed:
        sys.exit(f"did not run: {', '.join(failed)}")


if __name__ == "__main__":
    main()

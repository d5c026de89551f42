"""Run a family of benchmarks: each script answers one question, in a process of its own, and writes results/NAME.json.

python benchmarks/run.py                    # the family "speed"
python benchmarks/run.py export ensemble    # families and single scripts
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from pathlib import Path
from time import perf_counter

from measure import RESULTS, machine

FAMILIES = {
    "speed": ("single", "ensemble", "machines", "sampled", "majorants", "startup", "backends", "explorer", "fit_speed"),
    "accuracy": ("promise",),
    "export": ("instructions", "discretization", "learning"),
    "verdicts": ("verdicts", "design_attack"),
    "fits": ("estimates", "intervals"),
}
NAMED = {"instructions": "arm_instructions", "intervals": "coverage"}  # results of another name than the script's


def main() -> None:
    """Run the benchmarks that are asked for; the exit status is 1 where one failed to run."""
    known = (*FAMILIES, *(name for names in FAMILIES.values() for name in names))
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(known)}")
    parser.add_argument("--quick", action="store_true", help="only see whether they work")
    parser.add_argument("--out", type=Path, default=RESULTS, help="folder of the results")
    given = parser.parse_args()
    if unknown := [name for name in given.names if name not in known]:
        parser.error(f"{', '.join(unknown)}: must be of {', '.join(known)}")
    chosen = [script for name in given.names or ["speed"] for script in FAMILIES.get(name, (name,))]
    about = machine()
    print(f"{about['date']}: {about['processor']}, {about['cores']} cores, {about['system']}, Python {about['python']}")
    print(f"compiler: {about['compiler'] or 'none'}; load: {about['load']}")
    print("Another process at work makes slow solvers look slower: a load near 0 is wanted.\n", flush=True)
    failed, begun = [], perf_counter()
    for name in chosen:
        started = perf_counter()
        command = [sys.executable, str(Path(__file__).with_name(f"{name}.py"))]
        command += ["--out", str(given.out / f"{NAMED.get(name, name)}.json"), *(["--quick"] if given.quick else [])]
        if subprocess.run(command, check=False).returncode != 0:
            failed.append(name)
        print(f"({name}: {perf_counter() - started:.0f} s)\n", flush=True)
    print(f"all: {perf_counter() - begun:.0f} s")
    if failed:
        sys.exit(f"did not run: {', '.join(failed)}")


if __name__ == "__main__":
    main()

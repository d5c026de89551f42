"""Machine files that combine every feature, through the command line, against equations written apart from the project's:
columns, events, energy, and how long SciPy needs for the same.

    python benchmarks/machine_attack.py [NAME ...]

The files are tests/reference/unseen/*.toml (and, if it is there, ../shared/scenarios/machines), the equations
tests/reference/apart.py. Takes a few minutes.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import time
import tomllib
from pathlib import Path

import numpy as np

ROOT = Path(__file__).parent.parent
sys.path.insert(0, str(ROOT))

from tests.reference import apart  # noqa: E402
from tests.shared import SHARED  # noqa: E402

FILES = [
    *sorted((ROOT / "tests/reference/unseen").glob("*.toml")),
    *sorted((SHARED / "scenarios/machines").glob("*.toml")),
]
FINE = 100  # points in a row's step, for the events
MOTION = (".y", ".v", ".w", ".r")


def run(file: Path, out: str) -> tuple[dict[str, np.ndarray], dict[str, dict[str, list[float]]]]:
    """The columns and the events of `stribeck run`."""
    words = [sys.executable, "-m", "stribeck", "run", str(file), "--out", out, "--json"]
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    head, *rows = (Path(out) / "trajectory.csv").read_text().splitlines()
    table = np.loadtxt(rows, delimiter=",").T
    return dict(zip(head.split(","), table, strict=True)), json.loads(done.stdout)["events"]


def compare(file: Path) -> str:
    """A line on how far both are apart."""
    begun = time.process_time()
    expected, events = apart.solve(tomllib.loads(file.read_text()), FINE)
    seconds = time.process_time() - begun
    with tempfile.TemporaryDirectory() as out:
        found, happened = run(file, out)
    if list(found) != list(expected):
        return f"{file.stem:22} columns {list(found)}, not {list(expected)}"
    error = {n: np.max(np.abs(found[n] - x)) / max(np.max(np.abs(x)), 1e-12) for n, x in expected.items()}
    motion = max(x for n, x in error.items() if n.endswith(MOTION))
    force = max(x for n, x in error.items() if not n.endswith(MOTION))
    rest = found["E_in"] + found["E_stored"][0] - found["E_stored"] - found["E_dissipated"]
    energy = np.max(np.abs(rest)) / max(np.max(np.abs(found["E_in"])), np.max(found["E_stored"]))
    count, late, other = 0, 0.0, []
    for element, kinds in events.items():
        for kind, times in kinds.items():
            there = happened[element][kind]
            if len(there) != len(times):
                other.append(f"{element}.{kind}: {len(there)}, not {len(times)}")
            elif times:
                count, late = count + len(times), max(late, float(np.max(np.abs(np.subtract(there, times)))))
    verdict = "agrees" if motion <= 1e-5 and force <= 2e-4 and energy <= 1e-6 and not other else "DIFFERS"
    return (
        f"{file.stem:22} {verdict:8} {motion:8.1e} {force:8.1e} {energy:8.1e} {count:5} {late:8.1e} {seconds:7.1f}"
        f" {'; '.join(other)}"
    )


if __name__ == "__main__":
    print(f"{'machine':22} {'':8} {'motion':>8} {'force':>8} {'energy':>8} {'events':>5} {'s off':>8} {'SciPy s':>7}")
    for path in FILES:
        if len(sys.argv) < 2 or path.stem in sys.argv[1:]:
            print(compare(path), flush=True)

"""Machine files that combine every feature, through the command line, against equations written apart from the project's:
columns, events, energy, and how long SciPy needs for the same.

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
from typing import Any

import numpy as np
from measure import machine, options, write

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


def compare(file: Path) -> dict[str, Any]:
    """How far both are apart."""
    begun = time.process_time()
    expected, events = apart.solve_with_events(tomllib.loads(file.read_text()), FINE)
    seconds = time.process_time() - begun
    with tempfile.TemporaryDirectory() as out:
        found, happened = run(file, out)
    if list(found) != list(expected):
        return {"machine": file.stem, "agrees": False, "columns": list(found), "expected": list(expected)}
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
    return {
        "machine": file.stem, "agrees": motion <= 1e-5 and force <= 2e-4 and energy <= 1e-6 and not other,
        "motion": motion, "force": force, "energy": float(energy), "events": count, "seconds_off": late, "other": other,
        "scipy_seconds": seconds,
    }  # fmt: skip


def main() -> None:
    """Compare each file, print a line of it, and write all."""
    given, rows = options(__doc__, "machine_attack"), []
    for file in FILES[:2] if given.quick else FILES:
        rows.append(compare(file))
        print(*(f"{x:.3g}" if isinstance(x, float) else x for x in rows[-1].values()), flush=True)
    write(given.out, {"machine": machine(), "rows": rows})


if __name__ == "__main__":
    main()

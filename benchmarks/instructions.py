"""Instructions of one step of the exported C, counted by callgrind: the same on every machine of this kind."""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import tempfile
from pathlib import Path
from typing import Any

from measure import RESULTS, first_line, machine, table

import stribeck
from stribeck import laws

_COUNTS = (2000, 6000)
_MAIN = """
#include <stdlib.h>
#include "@.h"
int main(int argc, char **argv)
{
    @_parameters p;
    @_state s;
    @_body b = {0, 0, 0};
    @_real F = 0;
    const int n = atoi(argv[1]), way = atoi(argv[2]);
    (void)argc;
    @_defaults(&p);
    @_reset(&s);
    for (int i = 0; i < n; ++i) {
        /* a velocity that stays around v_s, and a force that makes the body slip and stick */
        const @_real x = (@_real)((i * 37) % 1000 - 500) / 500;
        if (way == 0) @_step(&p, &s, x * (@_real)2e-3, (@_real)1e-3, &F);
        else if (way == 1) @_body_step(&p, &b, 1, x * 3, (@_real)1e-3, &F);
        else @_force(&p, x * (@_real)2e-3, (@_real)1e-6, &F);
    }
    return F > 1e9;
}
"""


def counted(program: Path, way: int) -> float:
    """Instructions a call: the difference of two runs, so that the start does not count."""
    totals = []
    for count in _COUNTS:
        command = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", str(program), str(count), str(way)]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        found = re.search(r"Collected : (\d+)", done.stderr)
        assert found is not None
        totals.append(int(found[1]))
    return (totals[1] - totals[0]) / (_COUNTS[1] - _COUNTS[0])


def measure() -> list[dict[str, Any]]:
    """One row for each law and precision."""
    machine_set = dict(stribeck.library().sets["canudas1995"].values)
    own = {"k_v": 1e7, "z_ba": 7e-6, "g1": 0.25, "g2": 100.0, "g3": 10.0, "g4": 0.1, "g5": 100.0, "g6": 0.01}
    rows = []
    for name, law in laws.builtin().items():
        values = {n: x for n, x in {**machine_set, **own}.items() if n in law.constants()}
        folder = Path(tempfile.mkdtemp())
        stribeck.export(law(values), "c", folder)
        (folder / "main.c").write_text(_MAIN.replace("@", name))
        for precision, defines in (("double", []), ("float", [f"-D{name.upper()}_FLOAT"])):
            command = ["gcc", "-std=c99", "-O2", *defines, f"{name}.c", "main.c", "-o", "main", "-lm"]
            subprocess.run(command, cwd=folder, check=True)
            ways = {key: round(counted(folder / "main", i), 1) for i, key in enumerate(("step", "body_step", "force"))}
            rows.append({"law": name, "precision": precision, **ways})
    return rows


def main() -> None:
    """Print a table, and write the results."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=RESULTS / "instructions.json")
    parser.add_argument("--repetitions", type=int, help="of no use here: the counts do not vary")
    options = parser.parse_args()
    rows = measure()
    keys = ("force", "step", "body_step")
    print(
        table(("law", "precision", *keys), [[r["law"], r["precision"], *(f"{r[k]:.0f}" for k in keys)] for r in rows])
    )
    about = {"machine": machine(), "gcc": first_line(["gcc", "--version"]), "flags": "-std=c99 -O2"}
    options.out.parent.mkdir(parents=True, exist_ok=True)
    options.out.write_text(json.dumps({**about, "rows": rows}, indent=2) + "\n")


if __name__ == "__main__":
    main()

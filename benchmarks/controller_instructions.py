"""Instructions of one sample of exported controllers on Cortex-M4 and M7: compiled for them, and every instruction that qemu
executes of it counted, as benchmarks/arm_instructions.py counts the laws.

    python benchmarks/controller_instructions.py [--out FILE]
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

from arm_instructions import FLAGS, TARGETS, traced
from measure import RESULTS, first_line, machine, table

ROOT = Path(__file__).parent.parent
sys.path.insert(0, str(ROOT))

import stribeck  # noqa: E402
from tests.exports.controller.stages import CASES, stage  # noqa: E402

CALLS = 100
_MAIN = """
#include "@.h"
static @_parameters p;
static @_state s;
static @_input in[CALLS];
static @_output out;
__attribute__((noinline)) void counted(const @_input *now) { @_step(&p, &s, now, &out); }
void _start(void)
{
    @_defaults(&p);
    @_reset(&s);
    for (int i = 0; i < CALLS; ++i) { /* to and fro around v_s, the reference with it */
        @_path_at(&p, (@_real)(i * 1e-3), &in[i]);
        in[i].y = (@_real)(((i * 37) % 100 - 50) * 1e-7);
    }
    for (int i = 0; i < CALLS; ++i) counted(&in[i]);
    register int r7 __asm__("r7") = 1, r0 __asm__("r0") = 0;
    __asm__ volatile("svc 0" : : "r"(r7), "r"(r0));
}
"""


def counts(case: str, flags: str, single: bool) -> list[int]:
    """Instructions of each sample."""
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        files = stribeck.export(None, "c", folder, part="controller", scenario=stage(case))
        name = files[0].stem
        (folder / "main.c").write_text(_MAIN.replace("@", name).replace("CALLS", str(CALLS)))
        command = ["arm-none-eabi-gcc", *FLAGS, *flags.split(), *([f"-D{name.upper()}_FLOAT"] if single else [])]
        command += ["-nostartfiles", "--specs=nosys.specs", f"{name}.c", "main.c", "-o", "main", "-lm"]
        subprocess.run(command, cwd=folder, check=True, capture_output=True)
        found = traced(folder)
    assert len(found) == CALLS, (case, len(found))
    return found


def main() -> None:
    """Print a table, and write the results."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=RESULTS / "controller_instructions.json")
    options = parser.parse_args()
    rows = []
    for case in CASES:
        for target, (flags, single) in TARGETS.items():
            found = counts(case, flags, single)
            rows.append(
                {"controller": case, "target": target, "mean": round(sum(found) / len(found)), "most": max(found)}
            )
    print(table(("controller", "target", "mean", "most"), [[str(x) for x in row.values()] for row in rows]))
    compiler = first_line(["arm-none-eabi-gcc", "--version"])
    options.out.write_text(json.dumps({"machine": machine(), "gcc": compiler, "rows": rows}, indent=2) + "\n")


if __name__ == "__main__":
    main()

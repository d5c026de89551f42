"""Instructions of one step of exported laws, and of one sample of exported controllers, on Cortex-M4 and M7: the C is compiled
for them, and every instruction that qemu executes of it is counted. The headers of exports state the numbers of laws.

The results are arm_instructions.json and controller_instructions.json, beside ``--out``.
"""

from __future__ import annotations

import json
import re
import subprocess
import tempfile
from pathlib import Path
from typing import Any

from measure import RESULTS, Given, finish, first_line, run

import stribeck
from stribeck import laws
from tests.exports.controller.stages import CASES, stage
from tests.exports.harness import law

# name in the results, in the headers; flags; precision
TARGETS = {
    "Cortex-M4, float": ("-mcpu=cortex-m4 -mfpu=fpv4-sp-d16", True),
    "Cortex-M7, float": ("-mcpu=cortex-m7 -mfpu=fpv5-d16", True),
    "Cortex-M7, double": ("-mcpu=cortex-m7 -mfpu=fpv5-d16", False),
}
FLAGS = ("-mthumb", "-mfloat-abi=hard", "-std=gnu99", "-O2")
CALLS = 200
PACKAGED = Path(stribeck.__file__).parent / "exports" / "templates" / "costs.json"

# The start of a program without a C library's own: the counted function is called, then Linux is asked to end it.
_END = """    register int r7 __asm__("r7") = 1, r0 __asm__("r0") = 0;
    __asm__ volatile("svc 0" : : "r"(r7), "r"(r0));
}
"""
_LAW = """
#include "@.h"
static @_parameters p;
static @_state s;
static @_real F;
__attribute__((noinline)) void counted(@_real v) { @_step(&p, &s, v, (@_real)1e-3, &F); }
void _start(void)
{
    @_defaults(&p);
    @_reset(&s);
    for (int i = 0; i < CALLS; ++i) /* speeds around v_s, reversals among them */
        counted((@_real)((i * 37) % 1000 - 500) / 500 * (@_real)2e-3);
"""
_CONTROLLER = """
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
"""
_LINE = re.compile(r"Trace 0: \S+ \[[0-9a-f]+/([0-9a-f]+)/\S+ (\w+)")


def counts(made: Any, flags: str, single: bool) -> list[int]:
    """Instructions of each call, of a law with its constants."""
    with tempfile.TemporaryDirectory() as folder:
        stribeck.export(made, "c", folder)
        return counted(Path(folder), re.sub(r"\W", "_", made.name), _LAW, flags, single)


def controller_counts(case: str, flags: str, single: bool) -> list[int]:
    """Instructions of each sample of a controller."""
    with tempfile.TemporaryDirectory() as folder:
        files = stribeck.export(None, "c", folder, part="controller", scenario=stage(case))
        return counted(Path(folder), files[0].stem, _CONTROLLER, flags, single)


def counted(folder: Path, name: str, text: str, flags: str, single: bool) -> list[int]:
    """Instructions of each call of the exported file in a folder."""
    (folder / "main.c").write_text((text + _END).replace("@", name).replace("CALLS", str(CALLS)))
    command = ["arm-none-eabi-gcc", *FLAGS, *flags.split(), *([f"-D{name.upper()}_FLOAT"] if single else [])]
    command += ["-nostartfiles", "--specs=nosys.specs", f"{name}.c", "main.c", "-o", "main", "-lm"]
    subprocess.run(command, cwd=folder, check=True, capture_output=True)
    result = traced(folder)
    assert len(result) == CALLS, (name, len(result))
    return result


def traced(folder: Path) -> list[int]:
    """Instructions of each call of ``counted`` in the folder's program ``main``."""
    # the code is that of the Cortex; the processor that runs it only has to know all of its instructions
    words = ["qemu-arm", "-cpu", "max", "-singlestep", "-d", "nochain,exec", "-D", "/dev/stderr", "./main"]
    trace = subprocess.run(words, cwd=folder, check=True, capture_output=True, text=True).stderr
    results: list[int] = []
    first = None
    for line in trace.splitlines():
        match = _LINE.match(line)
        if match is None:
            continue
        if match[2] == "counted":
            first = first or match[1]
            if match[1] == first:
                results.append(0)
        if match[2] == "_start":
            if results:
                results.append(-1)  # between two calls
        elif results:
            results[-1] += 1
    return [count for count in results if count > 0]


def forms() -> list[Any]:
    """Every law of the package, in every form of its smooth |v|, with the constants of canudas1995."""
    results = []
    for name, made in laws.builtin().items():
        words = ("atan", "sqrt", "compact") if "smooth_abs" in made.constants() else ("",)
        more = {} if made.has_z else {"delta": 2.0}  # off: the usual curve
        results += [law(name, **more, **({"smooth_abs": word} if word else {})) for word in words]
    return results


def rows_of(name: str, cases: dict[str, Any], count: Any) -> list[dict[str, Any]]:
    """A row for each case and target: mean and most of one call."""
    rows = []
    for case, what in cases.items():
        for target, (flags, single) in TARGETS.items():
            result = count(what, flags, single)
            rows.append({name: case, "target": target, "mean": round(sum(result) / len(result)), "most": max(result)})
    return rows


def benchmark(given: Given) -> dict[str, Any]:
    """Count both; those of laws also are written where the exporter reads them."""
    compiler, qemu = first_line(["arm-none-eabi-gcc", "--version"]), first_line(["qemu-arm", "--version"])
    about = {"gcc": compiler, "qemu": qemu, "flags": " ".join(FLAGS)}
    rows = rows_of("law", {" ".join((each.name, *each.form.words)): each for each in forms()}, counts)
    controllers = rows_of("controller", {case: case for case in CASES}, controller_counts)
    finish(given, {**about, "rows": controllers}, stem="controller_instructions")
    if given.out == RESULTS / "arm_instructions.json":
        by_law: dict[str, dict[str, list[int]]] = {}
        for r in rows:
            by_law.setdefault(r["law"], {})[r["target"]] = [r["mean"], r["most"]]
        version = re.search(r"\d+\.\d+(\.\d+)?", (compiler or "").rpartition(")")[2])
        PACKAGED.write_text(json.dumps({"gcc": version[0] if version else "", "laws": by_law}, indent=1) + "\n")
    return {**about, "rows": rows}


if __name__ == "__main__":
    run(benchmark, __doc__, "arm_instructions")

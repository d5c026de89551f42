"""C and WebAssembly: what each costs for the examples, first and afterwards, and whether the numbers agree.

Both solve in turn, in one run. "First" is a whole process with an empty cache, less the same process once more.
"""

from __future__ import annotations

import math
import statistics
import sys
import tempfile
from functools import partial
from typing import Any

import numpy as np
from measure import Given, in_turn, process, run, say, spread

from stribeck import Scenario, examples
from stribeck.codegen import source
from stribeck.simulation import cache, compiler, native, wasm

PROCESS = "import sys; from stribeck import simulate; assert simulate(sys.argv[1]).success"


def benchmark(given: Given) -> dict[str, Any]:
    """Every example by both."""
    result = compiler.find()
    if result is None:
        sys.exit("there is no C compiler to compare with")
    lines = []
    for name in examples.names():
        say(name)
        scenario = Scenario.load(examples.path(name))
        system = wasm.system_module(scenario.system)
        by = {
            "c": partial(native.solve, cache.library(source(scenario.system), result, native.check)[0], scenario),
            "wasm": partial(wasm.solve, wasm.compiled(system.module)[0], system, scenario),
        }
        results = {backend: solve() for backend, solve in by.items()}
        peak = np.maximum(np.abs(results["c"].states).max(0), 1e-300)
        off = float((np.abs(results["wasm"].states - results["c"].states).max(0) / peak).max())
        taken = in_turn(by, given.repetitions)
        ratios = [wasm.cpu / c.cpu for wasm, c in zip(taken["wasm"], taken["c"], strict=True)]
        first = {}
        for backend in by:
            command = [sys.executable, "-c", PROCESS, str(examples.path(name))]
            with tempfile.TemporaryDirectory() as folder:
                how = {"STRIBECK_BACKEND": backend, "STRIBECK_CACHE": folder}
                cold, warm = (process(command, **how).cpu for _ in range(2))
            first[backend] = {"first": cold, "again": warm}
        lines.append({"example": name, "ratio": spread(ratios), "off": off, "process": first})
    mean = math.exp(statistics.fmean(math.log(line["ratio"]["median"]) for line in lines))
    return {"geometric_mean": mean, "examples": lines}


if __name__ == "__main__":
    run(benchmark, __doc__, "backends", repetitions=(15, 3))

"""The cost that a header states is what the benchmark counted, and counting again gives the same."""

import importlib.util
import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import stribeck
from stribeck.exports.c.c99 import costs
from tests.exports.harness import law

BENCHMARKS = Path(__file__).parent.parent.parent / "benchmarks"
PACKAGED = json.loads((Path(stribeck.__file__).parent / "exports" / "templates" / "costs.json").read_text())


def test_what_is_packaged_is_what_was_counted():
    results = json.loads((BENCHMARKS / "results" / "arm_instructions.json").read_text())
    counted = {(r["law"], r["target"]): [r["mean"], r["most"]] for r in results["rows"]}
    assert {(n, t): x for n, row in PACKAGED["laws"].items() for t, x in row.items()} == counted
    assert PACKAGED["gcc"] in results["gcc"]


def test_what_was_not_counted_is_not_stated():
    assert costs(law("lugre", v_d=1e-3)) == []
    assert costs(type("lugre", (type(law("lugre")),), {"__doc__": "Another."})(law("lugre").values)) == []
    mean = PACKAGED["laws"]["lugre_majorant smooth_abs=sqrt"]["Cortex-M4, float"][0]
    assert f" {mean} " in costs(law("lugre_majorant", smooth_abs="sqrt"))[1]


def test_counting_again_gives_the_same():
    for tool in ("arm-none-eabi-gcc", "qemu-arm"):
        if shutil.which(tool) is None:
            pytest.skip(f"{tool} is not installed")
    version = subprocess.run(
        ["arm-none-eabi-gcc", "-dumpfullversion"], capture_output=True, text=True, check=True
    ).stdout
    if version.strip() != PACKAGED["gcc"]:
        pytest.skip(f"another compiler than gcc {PACKAGED['gcc']}")
    sys.path.insert(0, str(BENCHMARKS))
    try:
        spec = importlib.util.spec_from_file_location("instructions", BENCHMARKS / "instructions.py")
        counting = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(counting)
    finally:
        sys.path.remove(str(BENCHMARKS))
    for name, target in (("lugre_majorant", "Cortex-M4, float"), ("dahl", "Cortex-M7, double")):
        flags, single = counting.TARGETS[target]
        result = counting.counts(law(name), flags, single)
        assert [round(sum(result) / len(result)), max(result)] == PACKAGED["laws"][name][target]

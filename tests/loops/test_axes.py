"""The three axes of docs run: a log, a fit, a controller in C, and a loop whose error is smaller."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from stribeck.loops.loop import rests_at
from stribeck.machine.signal import Sine, Staircase, Step, Sum
from tests.exports.harness import need

FOLDER = Path(__file__).parent.parent.parent / "docs" / "axes"


@pytest.mark.thorough
def test_from_the_log_of_a_stage_to_its_controller(tmp_path, monkeypatch):
    need("gcc")
    monkeypatch.syspath_prepend(str(FOLDER))
    for name in ("axes", "machines"):  # other folders have modules of these names
        monkeypatch.delitem(sys.modules, name, raising=False)
    import axes

    result = axes.show("stage", tmp_path, quick=True)
    for name in ("axes", "machines"):
        monkeypatch.delitem(sys.modules, name)
    assert result["rms_after"] < 0.5 * result["rms_before"]
    assert (tmp_path / "stage.svg").stat().st_size > 5000
    sources = [str(tmp_path / "c" / name) for name in ("stage_axis.c", "stage_axis_test.c")]
    subprocess.run(["gcc", "-std=c99", *sources, "-o", str(tmp_path / "check"), "-lm"], check=True)
    subprocess.run([tmp_path / "check"], check=True, capture_output=True)
    assert np.isfinite(list(result.values())).all()


def test_a_sum_of_signals_is_held_and_comes_to_rest():
    """Its sines are held at the end of the run as a sine is; a sum of what rests does so when the last part does."""
    assert rests_at(Sum((Step(1.0, 0.5), Staircase((0.0, 1.0, 2.0), 0.5))).built) == 1.0
    assert rests_at(Sum((Step(1.0, 0.5), Sine(1.0, 1.0))).built) == float("inf")

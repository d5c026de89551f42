"""The counts in a sweep's manifest."""

import json

import numpy as np
import pytest

import stribeck
from stribeck.errors import InputError

LANES = {"law.k_v": np.geomspace(1e6, 1e8, 12)}
SCENARIO = {
    "law": {"name": "lugre_majorant", "k_v": 1e6, "parameters": "canudas1995"}, "plant": {"mass": 1.0},
    "drive": {"kind": "spring", "stiffness": 2.0, "signal": {"kind": "ramp", "rate": 0.1}},
    "solve": {"t_end": 2.0}, "output": {"step": 0.01},
}  # fmt: skip


def test_the_manifest_counts_the_lanes_beyond_the_promised_accuracy(tmp_path):
    """Also of parts from an earlier run."""
    speed = 2 / np.sqrt(1 - 1e-13)  # over the top of the pendulum by so little that rounding decides when it falls
    data = {
        "schema": 2, "bodies": {"arm": {"inertia": 1.0}},
        "loads": {"gravity": {"on": "arm", "kind": "pendulum", "amplitude": 1.0}},
        "solve": {"t_end": 20.0}, "output": {"step": 0.1},
    }  # fmt: skip
    for _ in range(2):
        result = stribeck.sweep(data, {"bodies.arm.initial.v": [1.0, speed]}, tmp_path, summary=True)
        manifest = json.loads((tmp_path / "_manifest.json").read_text())
        assert result.inaccurate == sum(manifest["inaccurate"].values()) == 1


def test_the_manifest_counts_the_lanes_that_failed(tmp_path):
    masses, told = {"plant.mass": [1.0, -1.0, 2.0]}, []
    result = stribeck.sweep(SCENARIO, masses, tmp_path, summary=True, progress=lambda *done: told.append(done))
    assert told[-1] == (1.0, 3)
    manifest = json.loads((tmp_path / "_manifest.json").read_text())
    assert result.failed == sum(manifest["failed"].values()) == 1
    assert stribeck.sweep(SCENARIO, masses, tmp_path, summary=True).failed == 1


@pytest.mark.parametrize("count", [None, "x", -1, True, 1.5])
def test_a_manifest_whose_counts_are_no_counts_is_damaged(count, tmp_path):
    stribeck.sweep(SCENARIO, LANES, tmp_path, summary=True)
    path = tmp_path / "_manifest.json"
    manifest = json.loads(path.read_text())
    manifest["failed"][min(manifest["failed"])] = count
    path.write_text(json.dumps(manifest))
    with pytest.raises(InputError, match=r"_manifest\.json in it is damaged"):
        stribeck.sweep(SCENARIO, LANES, tmp_path, summary=True)

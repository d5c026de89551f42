"""The reference trajectories of machines (SciPy's LSODA by others), through the command line."""

import json

import numpy as np
import pytest

from stribeck import Scenario
from stribeck.cli import _status
from tests.machine.machines import assert_balanced
from tests.shared import SHARED

FILES = sorted((SHARED / "reference" / "machines").glob("*.csv"))


@pytest.mark.skipif(not FILES, reason="needs shared/reference, which is not part of the project")
def test_every_reference_is_there():
    assert len(FILES) == 8


@pytest.mark.share(2)
@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_trajectory(file, tmp_path, capsys):
    path = SHARED / "scenarios" / "machines" / f"{file.stem}.toml"
    assert _status(["run", str(path), "--out", str(tmp_path), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["status"] == "done"
    names = file.read_text().partition("\n")[0].split(",")
    assert (tmp_path / "trajectory.csv").read_text().partition("\n")[0].split(",") == names
    expected, result = (np.loadtxt(f, delimiter=",", skiprows=1) for f in (file, tmp_path / "trajectory.csv"))
    assert_balanced(dict(zip(names, result.T, strict=True)))
    rows = np.rint(expected[:, 0] / Scenario.load(path).output.step).astype(int)
    for i, name in enumerate(names[1:], start=1):
        tolerance = 1e-5 if name.endswith((".y", ".v", ".w", ".r")) else 2e-4
        peak = np.max(np.abs(expected[:, i]))
        assert np.max(np.abs(result[rows, i] - expected[:, i])) <= tolerance * peak, name

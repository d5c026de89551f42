"""The reference trajectories of the project (SUNDIALS CVODE by others), at default settings."""

import numpy as np
import pytest

from stribeck import Scenario
from tests.shared import SHARED
from tests.simulation.rig import solved

FILES = sorted(f for f in (SHARED / "reference").glob("*.csv") if not f.name.startswith("pneumatic_servo"))


@pytest.mark.skipif(not FILES, reason="needs shared/reference, which is not part of the project")
def test_every_reference_is_there():
    assert len(FILES) == 36


@pytest.mark.share(3)
@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_trajectory(file):
    name, law, *k_v = file.stem.split("__")
    path = SHARED / "scenarios" / f"{name}.toml"
    data = Scenario.load(path).data
    constants = {"k_v": float(k_v[0])} if k_v else {}
    data["law"] = {"name": law, "parameters": data["law"]["parameters"], **constants}
    solution = solved(data)
    expected = np.genfromtxt(file, delimiter=",", names=True)
    rows = np.rint(expected["t"] / data["output"]["step"]).astype(int)
    assert rows[-1] < len(solution.t)
    for column, tolerance in (("y", 1e-6), ("v", 1e-6), ("F", 1e-4)):
        peak = np.max(np.abs(expected[column]))
        assert np.max(np.abs(solution[column][rows] - expected[column])) <= tolerance * peak, column

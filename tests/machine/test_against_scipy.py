"""Dithers of controllers against SciPy on equations written apart (tests/reference/apart.py).

Every other element is in the machines of tests/reference.
"""

import numpy as np
import pytest

from tests.machine.machines import law, machine, solved
from tests.reference import apart

pytestmark = [pytest.mark.usefixtures("each_system_is_run_once")]

MOVE = {"kind": "point_to_point", "t": [0.1, 0.5, 0.8], "value": [0.0, 0.3, 0.1]}
CONTROLLERS = {
    "continuous": {
        "kind": "pid", "on": "a", "K_p": 80.0, "K_i": 60.0, "K_d": 9.0, "signal": MOVE, "limit": 9.0,
        "dither": {"amplitude": 3.0, "frequency": 9.0},
    },
    "sampled": {
        "kind": "cascade", "on": "a", "K_p": 20.0, "K_v": 8.0, "T_i": 0.1, "signal": MOVE,
        "sampling": {"period": 0.01, "delay": 4e-3, "resolution": 1.7e-4},
        "dither": {"kind": "square", "amplitude": 3.0, "frequency": 10.0},  # its edges are at samples
    },
}  # fmt: skip


@pytest.mark.parametrize("name", CONTROLLERS)
def test_columns(name):
    contact, controllers = {"from": "a", "law": law()}, {"u": CONTROLLERS[name]}
    data = machine({"a": {"mass": 0.5}}, contacts={"c": contact}, controllers=controllers)
    expected = apart.solve(data)
    solution = solved(data)
    assert len(solution.t) == len(expected["t"])
    for column in solution.columns:
        x = expected[column.name]
        error = np.max(np.abs(solution[column.name] - x)) / max(np.max(np.abs(x)), 1e-12)
        assert error <= (1e-6 if column.name.endswith((".y", ".v")) else 2e-5), column.name
    assert solution.peaks["E_in"] > 0

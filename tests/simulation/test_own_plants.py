"""A body of the user's own: one class in one file, and everything that a single body has."""

import numpy as np
import pytest

import stribeck
from stribeck import Scenario, simulate

FILE = '''
from stribeck.machine.element import State
from stribeck.machine.elements.bodies import Body
from stribeck.machine.table import quantity


class Flexible(Body):
    """A carriage on a rail with a load on a spring and damper."""

    states = (State("d", "m", "how far the load is ahead"), State("w", "m/s", "how fast it gets ahead"))
    load: float = quantity("kg", "mass of the load", above=0)
    stiffness: float = quantity("N/m", "stiffness between them", above=0)
    damping: float = quantity("N s/m", "damping between them", at_least=0, default=0.0)

    def pull(self, x):
        return self.stiffness * x["d"] + self.damping * x["w"]

    def acceleration(self, force, inertia, x):
        return (force + self.pull(x)) / inertia

    def rates(self, y, v, acceleration, x):
        return {"d": x["w"], "w": -self.pull(x) / self.load - acceleration}

    def stored_energy(self, y, v, inertia, x):
        return inertia * v**2 / 2 + self.load * (v + x["w"]) ** 2 / 2 + self.stiffness * x["d"] ** 2 / 2

    def lost_power(self, y, v, x):
        return self.damping * x["w"] ** 2
'''
M, L, C, D, PULL = 0.7, 0.4, 30.0, 0.3, 20.0


def data(**plant):
    return {
        "schema": 1,
        "law": {"name": "lugre_majorant", "k_v": 1e4, "parameters": "canudas1995"},
        "plant": {"kind": "own.py:Flexible", "mass": M, "load": L, "stiffness": C, "damping": D, **plant},
        "drive": {"kind": "spring", "stiffness": PULL, "signal": {"kind": "ramp", "rate": 0.1}},
        "solve": {"t_end": 1.5},
        "output": {"step": 0.01, "energy": True},
    }


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "own.py").write_text(FILE, encoding="utf-8")
    return tmp_path


def test_it_moves_as_scipy_says_and_keeps_the_balance_of_energy(folder):
    from scipy.integrate import solve_ivp

    solution = simulate(Scenario(data(initial={"d": 0.05}), folder=folder))
    assert solution.status == "done"
    law = stribeck.law("lugre_majorant", parameters="canudas1995", k_v=1e4)

    def rates(t, x):  # the load's own position and speed, where the plant has its distance
        y, v, z, at, speed = x
        F, between = law.force(v, z), C * (at - y) + D * (speed - v)
        return v, (PULL * (0.1 * t - y) - F + between) / M, law.rate(v, z), speed, -between / L

    result = solve_ivp(rates, (0, 1.5), [0, 0, 0, 0.05, 0], "Radau", solution.t, rtol=1e-9, atol=1e-12).y
    for name, expected in (("y", result[0]), ("v", result[1]), ("z", result[2]), ("d", result[3] - result[0])):
        assert abs(solution[name] - expected).max() < 1e-5 * abs(expected).max(), name
    stored = solution["E_stored"]
    off = solution["E_in"] + stored[0] - stored - solution["E_dissipated"]
    assert abs(off).max() < 1e-9 * stored.max()
    assert [c.name for c in solution.columns][:4] == ["y", "v", "z", "F"]


def test_its_numbers_vary_in_lanes(folder):
    scenario = Scenario(data(), folder=folder)
    lanes = simulate(scenario, {"plant.load": [0.2, 0.8], "plant.initial.d": [0.0, 0.05]})
    for i, changes in enumerate(({"plant.load": 0.2}, {"plant.load": 0.8, "plant.initial.d": 0.05})):
        alone = simulate(scenario.with_changes(changes))
        np.testing.assert_allclose(lanes["y"][i], alone["y"], rtol=1e-6, atol=1e-9)

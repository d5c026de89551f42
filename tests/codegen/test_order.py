"""Convergence order of the compiled Rodas5P, and its damping of stiff parts.

The step is fixed by the harness (tests/codegen/harness.py): it calls ``attempt`` of the generated source n times with
h = T/n and takes every step, so that no step control interferes.
"""

import ctypes

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from stribeck import Scenario
from stribeck.simulation.native import Run
from tests.codegen.harness import compiled
from tests.simulation import independent
from tests.simulation.rig import needs_compiler, rig

pytestmark = needs_compiler

SOFT = {"sigma_0": 8.0, "sigma_1": 1.0, "sigma_2": 0.4, "F_c": 1.0, "F_s": 1.5, "v_s": 1.0}
END = 2.0


def data(law, drive, initial):
    sine = {"kind": "sine", "amplitude": 1.3, "frequency": 0.35, "offset": 0.4, "phase": 0.3}
    return rig(law, drive, sine, END, initial=initial)


PROBLEMS = {
    "force": data({"name": "lugre_majorant", "k_v": 1.5, "parameters": SOFT}, "force", {"v": 0.8, "z": 0.05}),
    "spring": data(
        {"name": "lugre_sobczyk", "k_v": 1.5, "parameters": SOFT}, {"kind": "spring", "stiffness": 2.0}, {"v": 0.8}
    ),
    "pid": data(
        {"name": "makkar", "g1": 0.25, "g2": 2.0, "g3": 0.5, "g4": 0.1, "g5": 2.0, "g6": 0.01},
        {"kind": "pid", "K_p": 2.0, "K_i": 0.7, "K_d": 0.5}, {"v": -0.5},
    ),
    "velocity": data({"name": "lugre_arctan", "k_v": 1.5, "parameters": SOFT}, "velocity", {"z": 0.05}),
}  # fmt: skip


def pointer(array):
    return array.ctypes.data_as(ctypes.POINTER(ctypes.c_double))


def steps(library, scenario, h, n, inside=0.5):
    """The states at a share of each of n steps of length h."""
    system, values = scenario.system, scenario.elements.values
    parameters = np.array([values[key] for key in system.parameters])
    x = np.array([scenario.initial.get(state.name, 0.0) for state in system.states])
    ones, zero, dense = np.ones(len(x)), np.zeros(3), np.empty((n, len(x)))
    run = Run(rtol=1.0)
    for name, array in {"parameters": parameters, "atol": ones, "x": x, "piece_rows": zero}.items():
        setattr(run, name, array.ctypes.data)
    d = ctypes.c_double
    library.test_steps(ctypes.byref(run), d(h), ctypes.c_int(n), d(inside), pointer(dense))
    return dense


def exact(scenario, times):
    """The states at some times, from SciPy's DOP853 on the independent equations."""
    table = scenario.data
    force_of = independent.friction(table["law"]["name"], independent.constants(table))
    body, line = independent._body(table, force_of), independent.signal(table["drive"]["signal"], END)[1](0)
    start = np.array(independent._start(table), float)
    solution = solve_ivp(lambda t, x: body(line(t), x), (0, END), start, "DOP853", times, rtol=3e-14, atol=1e-15)
    x = solution.y.T
    return x if scenario.law.has_z else np.delete(x, 2, axis=1)


def slope(h, errors):
    return np.polyfit(np.log(h), np.log(errors), 1)[0]


@pytest.mark.parametrize("drive", PROBLEMS)
def test_order_of_the_method(drive, tmp_path):
    """The largest error over all steps falls like h^5."""
    scenario = Scenario(PROBLEMS[drive])
    library, counts, errors = compiled(scenario.system, tmp_path), np.array([64, 90, 128, 180, 256]), []
    for n in counts:
        times = (np.arange(n) + 1) * END / n
        result = steps(library, scenario, END / n, int(n), inside=1.0)
        errors.append(np.max(np.abs(result - exact(scenario, times))))
    assert slope(1 / counts, errors) == pytest.approx(5, abs=0.2)


@pytest.mark.parametrize("drive", PROBLEMS)
def test_order_of_the_dense_output(drive, tmp_path):
    """Of order 4: within one step from exact values the largest error falls like h^5."""
    scenario = Scenario(PROBLEMS[drive])
    library, lengths, errors = compiled(scenario.system, tmp_path), 0.05 / 2.0 ** np.arange(4), []
    shares = np.array([0.2, 0.4, 0.6, 0.8])
    for h in lengths:
        results = [steps(library, scenario, h, 1, inside=s)[0] for s in shares]
        errors.append(np.max(np.abs(results - exact(scenario, shares * h))))
    assert slope(lengths, errors) - 1 == pytest.approx(4, abs=0.2)


RELAXING = """
from stribeck.laws import BristleLaw

class Relaxing(BristleLaw):
    @staticmethod
    def dz_dt(p, v, z):
        return -1e9 * z + 0.0 * v
"""


def test_stiff_parts_are_damped_at_once(tmp_path):
    """L-stability: what decays within 1e-9 s is gone after one step of 1 s."""
    (tmp_path / "law.py").write_text(RELAXING)
    table = data({"name": "law.py:Relaxing", "parameters": SOFT}, "velocity", {"z": 1.0})
    scenario = Scenario(table, folder=tmp_path)
    y, z = steps(compiled(scenario.system, tmp_path), scenario, 1.0, 1, inside=1.0)[0]
    assert abs(z) < 1e-6
    assert np.isfinite(y)

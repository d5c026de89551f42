"""Whole simulations against an independent solver on independently written equations (independent.py)."""

import numpy as np
import pytest

from tests.simulation import independent
from tests.simulation.independent import machine
from tests.simulation.random_rigs import random_rig
from tests.simulation.rig import BRISTLES, LAWS, pid, rig, solved, spring

TOLERANCES = {"y": 1e-6, "v": 1e-6, "z": 1e-6, "F": 1e-4}  # of the column's peak


def assert_agrees(data):
    result, expected = solved(data), independent.solve(data)
    np.testing.assert_array_equal(result.t, expected["t"])
    for name, tolerance in TOLERANCES.items():
        peak = np.max(np.abs(expected[name]))
        error = np.max(np.abs(result[name] - expected[name]))
        assert error <= tolerance * peak, f"{name}: {error / peak:.2g} of the peak"


def presliding(on):
    F_s = machine(on)["F_s"]
    signal = {"kind": "points", "t": [0, 1, 1.5, 3.5, 4, 5], "value": [0, 0.95 * F_s, 0.95 * F_s, -0.95 * F_s, 0, 0]}
    return "force", signal, 5.0


def pulled(on):
    return spring(on), {"kind": "ramp", "rate": 0.3}, 6.0


def positioned(on):
    return pid(on), {"kind": "step", "value": 1.0, "time": 0.25}, 8.0


def rubbed(on):
    p = machine(on)
    period = 60 * p["F_s"] / p["sigma_0"] / p["v_s"]
    signal = {"kind": "sine", "amplitude": 2 * p["v_s"], "frequency": 1 / period, "offset": 0.5 * p["v_s"], "phase": 1}
    return "velocity", signal, 2.0 * period


@pytest.mark.share(7)
@pytest.mark.parametrize("task", [presliding, pulled, positioned, rubbed])
@pytest.mark.parametrize("law", LAWS)
def test_every_law_under_every_drive(law, task):
    drive, signal, t_end = task("canudas1995")
    assert_agrees(rig(law, drive, signal, t_end))


@pytest.mark.share(6)
@pytest.mark.parametrize("on", ["olsson1998", "direct_drive2016", "liu2015", "valve_graphite", "valve_teflon"])
@pytest.mark.parametrize("task", [presliding, pulled, positioned, rubbed])
@pytest.mark.parametrize("law", ["lugre", "lugre_sobczyk", "elastoplastic_majorant"])
def test_other_machines(law, task, on):
    drive, signal, t_end = task(on)
    assert_agrees(rig(law, drive, signal, t_end, on=on))


@pytest.mark.parametrize("law", ["elastoplastic", "elastoplastic_majorant", "lugre_majorant"])
def test_corners_between_long_rests(law):
    """A load that changes over hours: the body follows each corner within milliseconds, amid steps of an hour."""
    t, value = [0.0, 1e4, 1.5e4, 3.5e4, 4e4, 5e4], [0.0, 0.9, 0.9, -0.9, -0.9, 0.0]
    assert_agrees(rig(law, "force", {"kind": "points", "t": t, "value": value}, 5e4, rows=1000))


@pytest.mark.share(3)
@pytest.mark.parametrize("law", ["lugre", "lugre_sobczyk", "elastoplastic_majorant"])
def test_slips_that_errors_put_off(law):
    """A slow creep to each break-away, which makes small errors of force large errors of time."""
    drive = {"kind": "spring", "stiffness": 11.41}
    assert_agrees(rig(law, drive, {"kind": "ramp", "rate": 0.1}, 40.0, on="direct_drive2016", rows=4000))


@pytest.mark.share(4)
@pytest.mark.parametrize("law", [*BRISTLES, "makkar"])
def test_starts_in_motion_with_bent_bristles(law):
    initial = {"y": 0.2, "v": -0.03, "z": 8e-6} if law != "makkar" else {"y": 0.2, "v": -0.03}
    assert_agrees(rig(law, "force", {"kind": "sine", "amplitude": 1.8, "frequency": 2.0}, 2.0, initial=initial))


JUMPS = {"kind": "points", "t": [0.1, 0.4, 0.4, 0.9, 0.9, 1.3], "value": [0.0, 1.0, -0.8, 0.7, 1.4, -1.2]}


@pytest.mark.share(3)
@pytest.mark.parametrize(
    ("drive", "size"), [("force", 2.0), ("velocity", 5e-3), (spring("canudas1995", 0.1), 0.3), (pid("canudas1995"), 2.0)]
)  # fmt: skip
@pytest.mark.parametrize("law", ["lugre", "lugre_majorant", "elastoplastic", "stribeck"])
def test_signals_that_jump(law, drive, size):
    signal = {**JUMPS, "value": [size * value for value in JUMPS["value"]]}
    assert_agrees(rig(law, drive, signal, 1.7, rows=170, initial={"y": 0.01}))


def test_a_step_at_once_and_rows_that_miss_the_end():
    data = rig("lugre", "force", {"kind": "step", "value": 1.7, "time": 0.0}, 1.0)
    data["output"]["step"] = 0.03
    assert_agrees(data)
    assert solved(data).t[-1] == 33 * 0.03


@pytest.mark.share(7)
@pytest.mark.parametrize("seed", range(40))
def test_random_rigs(seed):
    assert_agrees(random_rig(seed))

"""Fits of the motion for a measured force, and within a closed loop."""

from pathlib import Path

import numpy as np
import pytest

import stribeck
from stribeck.errors import InputError
from stribeck.identify.api import read_log
from stribeck.identify.log import Log
from stribeck.identify.methods.motion import fit_motion

PARAMETERS = {"sigma_0": 1e5, "sigma_1": 3e2, "sigma_2": 30.0, "F_c": 10.0, "F_s": 14.0, "v_s": 5e-3}
STEP = 2e-3
T = np.arange(0, 2.4, STEP)
LOOP = {"kind": "pid", "K_p": 3000.0, "K_i": 2000.0, "K_d": 100.0}


def rig(drive, signal):
    scenario = stribeck.Scenario(
        law={"name": "lugre", "parameters": PARAMETERS},
        plant={"mass": 2.0},
        drive={**drive, "signal": {"kind": "points", "t": T.tolist(), "value": signal.tolist()}},
        solve={"t_end": float(T[-1])},
        output={"step": STEP},
    )
    return stribeck.simulate(scenario)


def log_of(solution, force, command=None):
    noise = np.random.default_rng(0).standard_normal((2, len(T)))
    return Log(
        time=T, position=solution["y"] + 1e-7 * noise[0], velocity=solution["v"] + 1e-4 * noise[1],
        acceleration=np.gradient(solution["v"], STEP), force=force, run=np.zeros(len(T), np.int32), step=STEP,
        command=command,
    )  # fmt: skip


def check(fit, names, tolerance):
    for name in names:
        truth = {**PARAMETERS, "mass": 2.0, "offset": 1.0}[name]
        estimate = {**fit.estimates, **fit.body}[name]
        assert estimate.identifiable, name
        assert estimate.value == pytest.approx(truth, rel=tolerance), name


@pytest.mark.thorough
def test_the_velocity_for_a_measured_force():
    force = (16 + 6 * np.sin(2 * np.pi * 1.3 * T)) * np.sin(2 * np.pi * 0.8 * T)
    log = log_of(rig({"kind": "force"}, force - 1.0), force)  # 1 N holds back all the time
    fit = fit_motion(log, "lugre", body=("offset",), starts=3, profiles=False)
    check(fit, ("sigma_2", "F_c", "mass", "offset", "F_s"), 0.01)
    assert fit.details["output_error"] < 3e-3


def test_the_position_in_a_closed_loop():
    command = 0.02 * np.sin(2 * np.pi * 0.8 * T)
    solution = rig(LOOP, command)
    fit = fit_motion(
        log_of(solution, solution["u"], command), "lugre", LOOP, output="position", starts=3, profiles=False
    )
    check(fit, ("sigma_0", "sigma_2", "F_c", "F_s", "v_s", "mass"), 0.02)


@pytest.mark.parametrize(
    ("drive", "options", "message"),
    [
        ({"kind": "velocity"}, {}, "drive.kind: 'velocity': must be"),
        (LOOP, {}, "no column 'command'"),
        ({"kind": "force"}, {"output": "force"}, "output: 'force': must be"),
        ({"kind": "force"}, {"body": ("F_c_by_position",)}, "F_c_by_position.*has no place"),
    ],
)
def test_what_makes_no_sense_is_refused(drive, options, message):
    force = 20 * np.sin(2 * np.pi * T)
    log = log_of(rig({"kind": "force"}, force), force)
    with pytest.raises(InputError, match=message):
        fit_motion(log, "lugre", drive, **options)


def test_an_arm_s_weight_does_not_hide_its_friction(monkeypatch):
    """Whole runs were simulated from values that took the weight for friction: the fit missed, and nothing was known."""
    monkeypatch.syspath_prepend(Path(__file__).parent.parent.parent.parent / "benchmarks")
    import arm_coverage

    monkeypatch.setattr(arm_coverage, "SECONDS", 3.0)
    columns, truth = arm_coverage.record("sin", 1, 0.0)
    log = read_log(columns, {"time": "t", "position": "y", "force": "F"}, simulated=True)
    fit = fit_motion(log, "lugre", output="position", body=("offset", "gravity_sin"), starts=2, profiles=False)
    told = {**fit.estimates, **fit.body}
    assert all(e.identifiable for e in told.values())
    for name, tolerance in {"sigma_0": 0.01, "F_c": 1e-3, "F_s": 0.02, "mass": 1e-3, "gravity_sin": 1e-3}.items():
        assert told[name].value == pytest.approx(truth[name], rel=tolerance), name

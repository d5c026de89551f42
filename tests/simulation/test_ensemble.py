"""Ensembles: each lane is what a single run is, whatever runs beside it."""

import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

from stribeck import InputError, Scenario, examples, simulate
from stribeck.simulation import ensemble as module
from stribeck.simulation.lanes import one_by_one
from stribeck.simulation.variations import Variations
from tests.simulation.rig import LAWS, pid, rig, spring

PULLED = rig("lugre_majorant", spring("canudas1995"), {"kind": "ramp", "rate": 0.3}, 6.0)
STEPPED = rig("lugre", pid("canudas1995"), {"kind": "step", "value": 1.0, "time": 0.25}, 4.0)
SHAKEN = rig("lugre_sobczyk", "force", {"kind": "sine", "amplitude": 2.0, "frequency": 1.0}, 2.0)
RUBBED = rig("lugre", "velocity", {"kind": "sine", "amplitude": 2e-3, "frequency": 0.5}, 4.0)


def assert_as_alone(data, values, folder=None, share=1e-6):
    """Every lane of the ensemble against the run of its own scenario."""
    scenario = Scenario(data, folder=folder)
    solution = simulate(scenario, values)
    for lane in range(len(solution)):
        alone = simulate(scenario.with_changes({path: float(x[lane]) for path, x in values.items()}))
        assert solution.status[lane] == alone.status
        for name in (c.name for c in scenario.system.columns):
            off = np.abs(solution[name][lane] - alone[name]).max()
            assert off <= (100 * share if name == "F" else share) * alone.peaks[name], (lane, name)
        assert (solution.slips[lane], solution.sticks[lane]) == tuple(
            len(alone.events[kind]) for kind in ("slip", "stick")
        )
    return solution


@pytest.mark.share(7)
@pytest.mark.parametrize("law", LAWS)
def test_every_law(law):
    data = rig(law, spring("canudas1995"), {"kind": "ramp", "rate": 0.3}, 6.0)
    names = Scenario(data).law.uses
    values = {"plant.mass": np.linspace(0.5, 2.0, 5), "drive.stiffness": np.geomspace(2, 5, 5)}
    values |= {f"law.parameters.{n}": np.linspace(1.0, 1.2, 5) * Scenario(data).law.values[n] for n in names[:1]}
    assert_as_alone(data, values)


@pytest.mark.share(5)
@pytest.mark.parametrize(
    ("data", "values"),
    [
        (PULLED, {"drive.signal.rate": [0.1, 0.2, -0.3], "plant.initial.y": [0.0, -0.1, 0.2]}),
        (PULLED, {"law.k_v": [1e5, 1e6, 1e7], "plant.initial.z": [0.0, 1e-6, -1e-6]}),
        (STEPPED, {"drive.signal.time": [0.0, 0.5, 5.0], "drive.signal.value": [1.0, -2.0, 0.5]}),
        (STEPPED, {"drive.K_i": [0.0, 0.5, 1.0], "law.parameters.v_s": [1e-3, 2e-3, 3e-3]}),
        (SHAKEN, {"drive.signal.frequency": [0.7, 1.3, 3.0], "drive.signal.offset": [0.0, 0.2, -0.1]}),
        (RUBBED, {"drive.signal.amplitude": [2e-3, 0.5e-3, 5e-3], "law.parameters.v_s": [1e-3, 1e-3, 2e-3]}),
    ],
    ids=["ramp", "law", "step", "pid", "sine", "velocity"],
)
def test_everything_that_can_vary(data, values):
    result = assert_as_alone(data, {path: np.array(x) for path, x in values.items()})
    assert result["y"].shape == (3, Scenario(data).rows)
    assert result.t[-1] == pytest.approx(Scenario(data).solve.t_end)


def test_lanes_that_fail_leave_the_others_alone(tmp_path):
    values = {"drive.K_d": np.array([6.0, -1e4, 6.0, 5.0]), "law.parameters.F_c": np.array([1.0, 1.0, 3.0, 1.0])}
    solution = simulate(Scenario(STEPPED), values)
    assert solution.status == ["done", "failed", "failed", "done"]
    assert "no longer finite" in solution.reason[1]
    assert solution.reason[2] == "law.parameters.F_s: 1.5: must be at least F_c (F_c = 3.0)"
    reached = np.isfinite(solution["y"])
    assert 0 < reached[1].sum() < solution["y"].shape[1]
    assert not reached[2].any()
    for name in ("y", "v", "z", "F"):
        assert np.array_equal(np.isfinite(solution[name]), reached)
    good = simulate(Scenario(STEPPED), {path: x[[0, 3]] for path, x in values.items()})
    assert np.array_equal(solution["y"][[0, 3]], good["y"])


def test_lanes_that_end_early_count_the_events_up_to_there():
    few = Scenario({**RUBBED, "solve": {**RUBBED["solve"], "max_steps": 150}})
    amplitudes = [2e-3, 3e-3]
    solution = simulate(few, {"drive.signal.amplitude": amplitudes})
    alone = [simulate(few.with_changes({"drive.signal.amplitude": x})).events for x in amplitudes]
    assert list(solution.status) == ["failed", "failed"]
    assert solution.slips.tolist() == [len(events["slip"]) for events in alone] == [1, 1]


def test_optional_constants_are_switched_on():
    data = rig("stribeck", "velocity", {"kind": "ramp", "rate": 1e-3}, 1.0)
    del data["law"]["k_v"]
    solution = simulate(Scenario(data), {"law.k_v": [1e3, 1e4]})
    alone = simulate(Scenario(data).with_changes({"law.k_v": 1e4}))
    np.testing.assert_allclose(solution["F"][1], alone["F"], rtol=1e-12)


def test_more_than_memory_holds(monkeypatch):
    monkeypatch.setattr(module.platforms, "free_memory", lambda: 1e6)
    with pytest.raises(InputError, match=r"1000 lanes of 201 rows would take .* 'stribeck sweep'"):
        simulate(Scenario(PULLED), {"plant.mass": np.ones(1000)})


MANY = """
import sys, numpy as np, stribeck
data = eval(sys.argv[1])
print("ready", flush=True)
stribeck.simulate(data, {"plant.mass": np.linspace(1, 2, 5000)})
"""


@pytest.mark.skipif(os.name != "posix", reason="needs signals")
@pytest.mark.parametrize("later", [0.05, 0.5, 1.0])
def test_ctrl_c_ends_lanes_at_once_and_in_one_piece(later):
    """Python's Thread.join returned early: arrays were freed while C wrote into them. Full rows were waited for."""
    data = {**PULLED, "solve": {"t_end": 6.0, "rtol": 1e-11}, "output": {"step": 6.0 / 2000}}
    words = [sys.executable, "-c", MANY, repr(data)]
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline() == "ready\n"
        time.sleep(later)
        started = time.monotonic()
        process.send_signal(signal.SIGINT)
        complaint = process.communicate(timeout=60)[1]
    assert process.returncode in (1, 130, -signal.SIGINT), complaint
    assert "KeyboardInterrupt" in complaint
    assert time.monotonic() - started < 10  # 5000 lanes take minutes


def test_a_lane_that_ends_in_an_error_stops_the_others():
    started, both = time.monotonic(), threading.Barrier(2)

    def run(lane, check_stopped):
        both.wait(10)
        while lane and time.monotonic() < started + 30:
            check_stopped(0.5)
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        one_by_one(run, [0, 1], 2, None)
    assert time.monotonic() < started + 20


def test_scales_written_for_numbers_serve_lanes(tmp_path):
    for law in ("dahl", "stribeck", "makkar"):
        data = rig(law, "force", {"kind": "ramp", "rate": 3.0}, 0.5)
        lanes = Variations(Scenario(data), {"plant.mass": [1.0, 2.0]})
        assert lanes.atol().shape == (2, len(Scenario(data).system.states))
        assert lanes.atol()[1].tolist() == list(Scenario(data).atol().values())


def test_servos_and_moves_along_paths_are_lanes_too():
    """Each lane is then a scenario of its own: whatever is a number in it can vary."""
    servo = Scenario.load(examples.path("servo")).with_changes({"solve.t_end": 2.0})
    solution = simulate(servo, {"drive.K_D": [40.0, 60.0, -1.0], "drive.observer.k_v": [1e6, 1e5, 1e6]})
    assert solution.status == ["done", "done", "failed"]
    assert "drive.K_D" in solution.reason[2]
    alone = simulate(servo.with_changes({"drive.K_D": 60.0, "drive.observer.k_v": 1e5}))
    assert solution.slips[1] == len(alone.events["slip"])
    for name in ("y", "u", "F_hat", "V"):
        assert np.array_equal(solution[name][1], alone[name])
    assert np.isnan(solution["V"][2]).all()
    with pytest.raises(InputError, match="unknown key"):
        simulate(servo, {"drive.K_Q": [1.0]})
    moved = rig("lugre", spring("canudas1995"), {"kind": "point_to_point", "t": [0, 2, 4], "value": [0, 1, 0]}, 4.0)
    lanes = simulate(Scenario(moved), {"plant.mass": [1.0, 2.0]})
    assert lanes.status == ["done", "done"]
    assert lanes["y"].shape == (2, 201)


def test_whole_numbers_of_the_solver_and_masked_values_are_lanes():
    arm = Scenario.load(examples.path("arm"), {"solve.t_end": 0.02})
    solution, alone = simulate(arm, {"solve.max_steps": [20, 100_000]}), simulate(arm, max_steps=20)
    assert solution.reason == [alone.reason, None]
    for name in ("arm.y", "seal.F"):
        np.testing.assert_array_equal(solution[name][0], [*alone[name], *[np.nan] * (arm.rows - len(alone.t))])
    assert (solution.accepted[0], solution.rejected[0]) == (alone.stats["accepted"], alone.stats["rejected"])
    solution = simulate(Scenario(PULLED), {"plant.mass": np.ma.array([1.0, 2.0], mask=[False, True])})
    assert solution.reason[0] is None
    assert solution.reason[1].startswith("plant.mass: nan: ")

"""Machines in lanes agree with single runs."""

import numpy as np
import pytest

from stribeck import InputError, Scenario, simulate
from stribeck.simulation.variations import LaneByLane, Variations
from tests.machine.machines import assert_balanced, law, machine, push

PID = {"kind": "pid", "on": "a", "K_p": 80.0, "K_i": 60.0, "K_d": 9.0, "limit": 3.0,
       "signal": {"kind": "step", "time": 0.1, "value": 0.05}}  # fmt: skip
SAMPLING = {"period": 0.01, "delay": 4e-3, "resolution": 1.7e-4, "noise": 1e-4}
JOINT = {"from": "a", "to": "b", "ratio": 3.0, "stiffness": 40.0, "damping": 0.1, "gap": 0.02}
RIG = machine(
    {"a": {"mass": 0.5}, "b": {"inertia": 0.02}}, links={"k": JOINT}, loads={"p": push()}, controllers={"u": PID},
    contacts={"c": {"from": "a", "law": law(), "loads": [{"force": "k", "F_c": 0.1, "F_s": 0.1}]}}, t_end=0.5,
)  # fmt: skip
SAMPLED = {**RIG, "controllers": {"u": {**PID, "sampling": SAMPLING}}}
VALUES = {
    "contacts.c.law.parameters.F_c": [0.8, 1.0, 1.2, 0.9, 1.1],
    "links.k.gap": [0.01, 0.02, 0.03, 0.02, 0.01],
    "loads.p.signal.frequency": [2.0, 3.0, 2.5, 1.0, 2.0],
    "controllers.u.signal.value": [0.05, 0.02, 0.04, 0.05, 0.01],
    "bodies.b.initial.y": [0.0, 0.01, 0.0, 0.02, 0.0],
}
SETS = {
    "continuous": (RIG, VALUES),
    "sampled": (SAMPLED, {**VALUES, "controllers.u.sampling.period": [0.01, 0.007, 0.01, 0.004, 0.02]}),
}


@pytest.mark.parametrize("name", SETS)
def test_lanes_agree_with_single_runs(name):
    data, values = SETS[name]
    scenario = Scenario(data)
    ensemble = simulate(scenario, values)
    assert isinstance(ensemble._variations, Variations)
    assert ensemble.status == ["done"] * 5
    for lane in range(5):
        single = simulate(scenario.replace({path: x[lane] for path, x in values.items()}))
        assert_balanced({c.name: ensemble[c.name][lane] for c in single.columns})
        assert_balanced(single)
        for column in single.columns:
            error = np.max(np.abs(ensemble[column.name][lane] - single[column.name]))
            assert error <= 1e-6 * max(single.peaks[column.name], 1e-9), (lane, column.name)
        for element, events in single.events.items():
            assert {k: len(x) for k, x in events.items()} == {k: x[lane] for k, x in ensemble.happened[element].items()}
        assert ensemble.slips[lane] == len(single.events["c"]["slip"])


def test_no_lane_steps_over_more_than_an_eighth_of_a_wave():
    """Of the load's sine, or of a dither that is faster."""
    dithered = {**RIG, "controllers": {"u": {**PID, "dither": {"amplitude": 0.1, "frequency": 50.0}}}}
    ensemble = simulate(dithered, {"loads.p.signal.frequency": [2.0, 80.0]})
    np.testing.assert_allclose(ensemble._variations.longest_step(), [1 / 400, 1 / 640])


def test_a_constant_that_is_off_is_turned_on():
    plain = machine(
        {"a": {"mass": 0.5}}, links={"k": {"from": "a", "to": "ground", "stiffness": 9.0}}, loads={"p": push()}
    )
    ensemble = simulate(plain, {"links.k.damping": [0.5, 1.0]})
    one = simulate(Scenario(plain).replace({"links.k.damping": 1.0}))
    assert_balanced(one)
    np.testing.assert_allclose(ensemble["a.y"][1], one["a.y"], rtol=0, atol=1e-8 * one.peaks["a.y"])


def test_what_is_no_number_of_the_structure_runs_one_by_one():
    ensemble = simulate(SAMPLED, {"controllers.u.sampling.seed": [1, 2]})
    assert isinstance(ensemble._variations, LaneByLane)
    assert ensemble.status == ["done", "done"]
    assert np.any(ensemble["u.u"][0] != ensemble["u.u"][1])


def test_values_that_no_machine_may_have():
    ensemble = simulate(RIG, {"links.k.ratio": [3.0, 0.0, 3.0], "contacts.c.law.parameters.F_s": [1.4, 1.4, 0.5]})
    assert ensemble.reason == [
        None, "links.k.ratio: 0.0: must be a finite number from 1e-30 to 1e+30, or the negative of one",
        "contacts.c.law.parameters.F_s: 0.5: must be at least F_c (F_c = 1.0)",
    ]  # fmt: skip
    with pytest.raises(InputError, match=r"links\.k\.gapp"):
        simulate(RIG, {"links.k.gapp": [1.0]})

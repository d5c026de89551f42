"""Each element of a machine against SciPy on equations written apart (tests/reference/apart.py)."""

import numpy as np
import pytest

from tests.machine.machines import law, machine, push, solved
from tests.reference import apart

pytestmark = [pytest.mark.usefixtures("each_system_is_run_once")]


SINE = {"kind": "sine", "amplitude": 2.5, "frequency": 2.0, "phase": 0.4}
MOVE = {"kind": "point_to_point", "t": [0.1, 0.5, 0.8], "value": [0.0, 0.3, 0.1]}
MOTOR = {"on": "a", "K": 0.5, "R": 1.0}
CASCADE = {"kind": "cascade", "on": "a", "K_p": 20.0, "K_v": 8.0, "T_i": 0.1, "signal": MOVE}
PID = {"kind": "pid", "on": "a", "K_p": 80.0, "K_i": 60.0, "K_d": 9.0, "signal": MOVE}
A = {"a": {"mass": 0.5}}
AB = {"a": {"mass": 0.5}, "b": {"inertia": 0.02, "initial": {"y": 0.01, "v": -0.1}}}
JOINT = {"from": "a", "to": "b", "ratio": 3.0, "stiffness": 40.0, "damping": 0.1}
COMPENSATION = {"contact": "c", "speed": "reference"}
OBSERVER = {"speed": "measured", "law": law("lugre", F_c=0.7, F_s=0.9)}
SAMPLING = {"period": 0.01, "delay": 4e-3, "resolution": 1.7e-4}


def with_contact(bodies=A, contact=None, **sections):
    """A machine whose body a slides on the ground."""
    return machine(bodies, contacts={"c": {"from": "a", "law": law(), **(contact or {})}}, **sections)


MACHINES = {
    "link": with_contact(AB, links={"k": JOINT}, loads={"p": push()}),
    "play": with_contact(AB, links={"k": {**JOINT, "gap": 0.02}}, loads={"p": push()}),
    "far_end": with_contact(
        links={"k": {
            "from": {"signal": {"kind": "points", "t": [0, 0.3, 0.3, 1], "value": [0, 0.1, 0.2, -0.2]}},
            "to": "a", "ratio": 2.0, "stiffness": 50.0, "damping": 1.0,
        }},
    ),
    "tied": with_contact(
        {**A, "b": {"inertia": 0.01, "tied_to": "a", "ratio": -4.0}, "c1": {"mass": 0.2, "tied_to": "b", "ratio": 0.3}},
        contact={"from": "c1"},
        loads={"p": push(2.0, on="b"), "q": {"on": "c1", "kind": "pendulum", "amplitude": 1.0, "phase": 0.3}},
    ),
    "driven": machine(
        {"belt": {"velocity": {"signal": SINE}, "initial": {"y": 0.2}}, **A},
        links={"k": {"from": "a", "to": "ground", "stiffness": 60.0}},
        contacts={"c": {"from": "a", "to": "belt", "ratio": 1.5, "law": law("lugre")}},
    ),
    "parallel": machine(
        A, loads={"p": push()},
        contacts={"c": {"from": "a", "law": law()}, "d": {"from": "a", "law": law("lugre", sigma_0=5e3, sigma_1=20.0)}},
    ),
    "load": with_contact(
        AB, {"loads": [{"force": "k", "F_c": 0.3, "F_s": 0.4}, {"force": {"p": 0.5, "k": -0.2}, "F_s": 0.1}]},
        links={"k": JOINT}, loads={"p": push()},
    ),
    "factors": with_contact(
        contact={"factors": {
            "sigma_2": {"signal": {"kind": "points", "t": [0.0, 0.6], "value": [1.0, 3.0]}},
            "F_s": {"signal": {"kind": "sine", "amplitude": 0.2, "frequency": 3.0, "offset": 1.5}},
            "level": {"amplitude": [0.2, 0.1], "waves": [50.0, 90.0], "phase": [0.3, 0.0]},
        }, "loads": [{"force": "p", "F_c": 0.1, "F_s": 0.1}]},
        loads={"p": push(4.0)},
    ),
    "ripple": with_contact(
        loads={"r": {"on": "a", "kind": "ripple", "amplitude": [1.0, 0.3], "waves": [20.0, 45.0], "phase": [0.0, 1.0]},
               "p": push()},
    ),
    "motor": with_contact(motors={"m": {**MOTOR, "signal": {**SINE, "amplitude": 9.0}, "voltage": 7.0}}),
    "inductance": with_contact(motors={"m": {**MOTOR, "L": 0.03, "signal": SINE}},
                               contact={"loads": [{"force": "m", "F_c": 0.2, "F_s": 0.2}]}),
    "pid": with_contact(controllers={"u": PID}),
    "pid_at_its_limit": with_contact(controllers={"u": {**PID, "limit": 2.0}}),
    "cascade": with_contact(
        controllers={"u": {**CASCADE, "limit": 6.0, "feedforward": {"inertia": 0.5}, "compensation": COMPENSATION}}
    ),
    "cascade_on_a_sine": with_contact(
        controllers={"u": {**CASCADE, "compensation": COMPENSATION, "signal": {**SINE, "amplitude": 0.1}}}
    ),
    "observer": with_contact(
        AB, links={"k": JOINT}, controllers={"u": {**CASCADE, "measures": "b", "K_v": 0.5, "compensation": OBSERVER}},
        motors={"m": {**MOTOR, "L": 0.02}},
    ) | {"controllers": {"u": {**CASCADE, "on": "m", "compensation": OBSERVER}}},
    "motor_at_its_limit": with_contact(
        motors={"m": {**MOTOR, "voltage": 3.0}}, controllers={"u": {**CASCADE, "on": "m"}}
    ),
    "sampled_pid": with_contact(controllers={"u": {**PID, "limit": 2.0, "sampling": SAMPLING}}),
    "sampled_cascade": with_contact(
        motors={"m": {**MOTOR, "L": 0.01, "voltage": 9.0}},
        controllers={"u": {**CASCADE, "on": "m", "compensation": COMPENSATION, "sampling": {"period": 0.005}}},
    ),
    "sampled_observer": with_contact(
        controllers={"u": {
            **CASCADE, "compensation": OBSERVER, "limit": 3.0,
            "sampling": {**SAMPLING, "delay": 0.013, "bandwidth": 150.0},
        }},
    ),
    "dither": with_contact(controllers={"u": {**PID, "limit": 9.0, "dither": {"amplitude": 3.0, "frequency": 9.0}}}),
    "sampled_dither": with_contact(
        controllers={"u": {
            **CASCADE, "sampling": SAMPLING,
            "dither": {"kind": "square", "amplitude": 3.0, "frequency": 10.0},  # its edges are at samples
        }},
    ),
    "sampled_noise": with_contact(
        controllers={"u": {**PID, "sampling": {"period": 0.01, "noise": 1e-4, "seed": 3}}},
    ),
    "two_rates": with_contact(
        AB, links={"k": JOINT},
        controllers={
            "u": {**PID, "sampling": {"period": 0.01, "delay": 0.01}},
            "w": {**CASCADE, "on": "b", "K_v": 0.1, "sampling": {"period": 0.007, "delay": 0.002}},
        },
    ),
}  # fmt: skip


@pytest.mark.share(14)
@pytest.mark.parametrize("name", MACHINES)
def test_columns(name):
    expected = apart.solve(MACHINES[name])
    solution = solved(MACHINES[name])
    assert len(solution.t) == len(expected["t"])
    for column in solution.columns:
        x = expected[column.name]
        error = np.max(np.abs(solution[column.name] - x)) / max(np.max(np.abs(x)), 1e-12)
        assert error <= (1e-6 if column.name.endswith((".y", ".v")) else 2e-5), column.name
    assert solution.peaks["E_in"] > 0

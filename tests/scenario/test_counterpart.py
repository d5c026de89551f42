"""A law on a single body with the names of a machine: drawn, judged, and the same motion."""

import tomllib

import numpy as np
import pytest

from stribeck import InputError, Scenario, examples, simulate
from stribeck.loops import design
from stribeck.loops.loop import loop_of

ENDS = {"limit_cycle": 4.0, "servo": 0.5, "break_away": 2.0, "hysteresis": 2.0, "stick_slip": 4.0}
OTHERS = {"y": "body.y", "v": "body.v", "z": "contact.z", "F": "contact.F"}
DRIVEN = {
    "limit_cycle": {"u": "controller.u", "r": "controller.r"}, "break_away": {"u": "force.f"}, "stick_slip": {"u": "spring.f"},
}  # fmt: skip


def short(name):
    data = tomllib.loads(examples.path(name).read_text())
    data["solve"]["t_end"], data["output"] = ENDS[name], {"step": ENDS[name] / 50, "energy": name != "servo"}
    return Scenario(data)


@pytest.mark.share(2)
@pytest.mark.parametrize("name", ENDS)
def test_the_motion_is_the_same(name, each_system_is_run_once):
    one = simulate(short(name))
    many = simulate(short(name).as_machine().with_changes({"output.energy": name != "servo"}))
    assert (one.reason, many.reason) == (None, None)
    energy = {} if name == "servo" else {"E_dissipated": "E_dissipated"}
    for old, new in (OTHERS | DRIVEN.get(name, {}) | energy).items():
        np.testing.assert_allclose(many[new], one[old], rtol=0, atol=1e-6 * np.max(np.abs(one[old])), err_msg=new)
    for event, times in one.events.items():
        np.testing.assert_allclose(many.events["contact"][event], times, atol=1e-6)


def test_a_machine_stays_as_it_is():
    machine = Scenario.load(examples.path("belt"))
    assert machine.as_machine() is machine


def test_paths():
    pid = Scenario(PID)
    assert pid.path_in_machine("law.parameters.F_c=1:2") == "contacts.contact.law.parameters.F_c=1:2"
    assert pid.path_in_machine("drive.K_p") == "controllers.controller.K_p"
    assert pid.path_in_machine("plant.mass") == "bodies.body.mass"
    assert pid.path_in_machine("plant.initial.z") == "contacts.contact.initial.z"
    assert pid.path_in_machine("K_p") == "K_p"


PID = {
    "schema": 1, "name": "axis", "plant": {"mass": 1.0}, "solve": {"t_end": 5.0}, "output": {"step": 0.01},
    "law": {"name": "lugre_majorant", "k_v": 1e5, "parameters": {
        "sigma_0": 1e4, "sigma_1": 60.0, "sigma_2": 1.0, "F_c": 1.0, "F_s": 1.5, "v_s": 0.01}},
    "drive": {"kind": "pid", "K_p": 50.0, "K_i": 80.0, "K_d": 8.0, "signal": {"kind": "step", "time": 0.1, "value": 0.05}},
}  # fmt: skip


def test_the_loop_of_a_pid_controller_is_judged():
    loop = loop_of(Scenario(PID))
    assert [each.name for each in loop.scenario.system.controllers] == ["controller"]
    poles = np.roots([1.0, 8.0 + 1.0, 50.0, 80.0])  # mass, K_d + sigma_2, K_p, K_i
    assert loop.slowest == pytest.approx(1 / min(-poles.real), rel=1e-6)
    with pytest.raises(InputError, match="'spring': must be 'pid'"):
        loop_of(Scenario.load(examples.path("stick_slip")))


def test_design_knows_the_paths_of_the_file():
    with pytest.raises(InputError, match=r"^vary: drive\.K_q: .*'drive\.K_"):
        design(PID, vary=["drive.K_q=1:2"])

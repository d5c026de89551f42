"""A law on a body under a drive is the smallest machine: the same motion as the machine that is written out."""

import numpy as np
import pytest

from stribeck import Scenario, simulate
from tests.machine.machines import law, machine

SINE = {"kind": "sine", "amplitude": 3.0, "frequency": 2.0}
STEP = {"kind": "step", "time": 0.1, "value": 0.02}
RAMP = {"kind": "ramp", "rate": 0.05}
GUIDE = {"guide": {"from": "a", "law": law()}}
CASES = {
    "force": ({"kind": "force", "signal": SINE}, {"loads": {"push": {"on": "a", "kind": "signal", "signal": SINE}}},
              {"u": "push.f"}),
    "spring": ({"kind": "spring", "stiffness": 900.0, "signal": RAMP},
               {"links": {"k": {"from": {"signal": RAMP}, "to": "a", "stiffness": 900.0}}}, {"u": "k.f"}),
    "pid": ({"kind": "pid", "K_p": 80.0, "K_i": 60.0, "K_d": 9.0, "signal": STEP},
            {"controllers": {"c": {"kind": "pid", "on": "a", "K_p": 80.0, "K_i": 60.0, "K_d": 9.0, "signal": STEP}}},
            {"u": "c.u", "r": "c.r"}),
    "velocity": ({"kind": "velocity", "signal": SINE}, {}, {}),
}  # fmt: skip


@pytest.mark.share(2)
@pytest.mark.parametrize("kind", CASES)
def test_the_smallest_machine(kind):
    drive, sections, more = CASES[kind]
    moved = kind == "velocity"
    single = {
        "schema": 1, "law": law(), "plant": {} if moved else {"mass": 0.5}, "drive": drive,
        "solve": {"t_end": 0.7}, "output": {"step": 0.025, "energy": True},
    }  # fmt: skip
    body = {"velocity": {"signal": SINE}} if moved else {"mass": 0.5}
    one = simulate(Scenario(single))
    many = simulate(Scenario(machine({"a": body}, contacts=GUIDE, **sections)))
    assert one.scenario.elements.unnamed
    assert not many.scenario.elements.unnamed
    names = {"y": "a.y", "v": "a.v", "z": "guide.z", "F": "guide.F", "E_dissipated": "E_dissipated", **more}
    for old, new in names.items():
        np.testing.assert_allclose(many[new], one[old], rtol=0, atol=2e-7 * one.peaks[old], err_msg=new)
    for event, times in one.events.items():
        np.testing.assert_allclose(many.events["guide"][event], times, atol=1e-7)

"""A cylinder and its cascade among the parts of a machine, against the same servo as a file of schema 1."""

import copy
import tomllib

import numpy as np
import pytest

from stribeck import Scenario, examples, simulate

SERVO = tomllib.loads(examples.path("servo").read_text())
SERVO["solve"]["t_end"], SERVO["output"] = 1.0, {"step": 0.02}
NAMES = {"y": "piston.y", "v": "piston.v", "p_1": "piston.p_1", "p_2": "piston.p_2", "z": "seal.z", "F": "seal.F",
         **{n: f"axis.{n}" for n in ("u", "e", "s", "p_err", "F_hat", "z_hat", "V")}}  # fmt: skip
SAMPLED = {"drive.sample_time": 1e-3, "drive.delay": 5e-4, "drive.noise": 1e-6, "drive.quantization": 1e-6,
           "drive.bandwidth": 500.0, "drive.seed": 3}  # fmt: skip


def as_machine(servo):
    """The servo with names: its piston a body, its law a contact, its drive a controller."""
    servo = copy.deepcopy(servo)
    drive = {**servo["drive"], "kind": "pressure_cascade", "on": "piston"}
    return {
        "schema": 2, "name": "servo", "bodies": {"piston": servo["plant"]}, "solve": servo["solve"],
        "contacts": {"seal": {"from": "piston", "law": servo["law"]}}, "controllers": {"axis": drive},
        "output": servo["output"],
    }  # fmt: skip


MACHINE = as_machine(SERVO)


@pytest.mark.share(2)
@pytest.mark.parametrize("changes", [{}, SAMPLED, {"drive.adaptive": True, "drive.supply_droop": 1e7}])
def test_a_machine_is_the_servo(changes):
    servo = Scenario(SERVO).with_changes(changes)
    one, many = simulate(servo), simulate(Scenario(as_machine(servo.data)))
    assert (one.reason, many.reason) == (None, None)
    more = {f"sigma_{i}_hat": f"axis.sigma_{i}_hat" for i in range(3)} if "drive.adaptive" in changes else {}
    for old, new in (NAMES | more).items():
        np.testing.assert_allclose(many[new], one[old], rtol=0, atol=1e-7 * one.peaks[old], err_msg=new)
    for kind, times in one.events.items():
        np.testing.assert_allclose(many.events["seal"][kind], times, atol=1e-7)


def test_a_mass_tied_to_the_piston_counts_as_its_own():
    split = Scenario(MACHINE).with_changes({
        "bodies.piston.mass": 2.4, "bodies.load": {"mass": 0.125, "tied_to": "piston", "ratio": 2.0},
        "controllers.axis.model": {"mass": 2.9},
    })  # fmt: skip
    one, many = simulate(Scenario(SERVO)), simulate(split)
    np.testing.assert_allclose(many["piston.y"], one["y"], rtol=0, atol=1e-7 * one.peaks["y"])
    np.testing.assert_allclose(many["load.v"], 2 * many["piston.v"], rtol=1e-12)

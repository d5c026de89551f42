"""An encoder in a closed loop: its steps are coarse, the controller answers them, and the current is noisy."""

import numpy as np
import pytest

from stribeck import Scenario
from stribeck.identify.actuator import fit_machine
from stribeck.identify.actuator.guides import CARRIED, Guides
from stribeck.identify.actuator.recordings import Channel, Recording
from tests.identify.actuator.recorded import body, logs, record
from tests.shared import SHARED

SERVO = SHARED / "data" / "servo-motor"
LAW = "contacts.bearing.law.parameters."
# of closed.csv, and first values that are wrong by a half
TRUTH = {"bodies.rotor.inertia": 5e-5, f"{LAW}F_c": 0.02, f"{LAW}F_s": 0.03, f"{LAW}v_s": 1.0, f"{LAW}sigma_0": 20.0}
FIRST = {"F_c": 0.01, "F_s": 0.015, "v_s": 0.5, "sigma_0": 10.0, "sigma_1": 0.02, "sigma_2": 1e-4}


@pytest.mark.parametrize("step", [0.0, 1e-3])
def test_other_noise_of_an_encoder_is_none_at_rest(step):
    """Half of the record stands still. Rounding repeats its value there; a sensor without steps is noisy there too."""
    t = 1e-3 * np.arange(4001)
    y = 0.1 * np.clip(np.sin(2 * np.pi * t), 0.0, None)
    noise = np.random.default_rng(1).standard_normal(len(t))
    measured = step * np.round(y / step) if step else y + 3e-4 * noise
    recording = Recording("run", t, {"a.y": Channel("y", t, measured)})
    guides = Guides(Scenario(body()), [(0, recording)])
    guided = guides.at(guides.bandwidths[3], noisy=True).recordings[0][1]
    rest, motion = (t > 0.6) & (t < 0.9), (t > 0.1) & (t < 0.4)
    for other in guided.as_well[CARRIED]:
        added = other.outputs["a.y"].x - measured
        assert np.std(added[motion]) == pytest.approx(step / np.sqrt(12) if step else 3e-4, rel=0.5)
        assert (np.std(added[rest]) < 0.1 * np.std(added[motion])) == bool(step)


@pytest.mark.thorough
@pytest.mark.skipif(not SERVO.is_dir(), reason="needs shared/data/servo-motor, which is not part of the project")
def test_a_closed_loop_identifies_its_friction_by_position(tmp_path):
    """Its free simulation drifts by revolutions, and a loose guide leaves it a hundred encoder steps off."""
    law = {"name": "lugre", "parameters": FIRST}
    still = {"kind": "points", "t": [0.0, 20.0], "value": [0.0, 0.0]}
    machine = {
        "schema": 2, "name": "servo", "bodies": {"rotor": {"inertia": 3e-5}},
        "contacts": {"bearing": {"from": "rotor", "law": law}},
        "loads": {"motor": {"on": "rotor", "kind": "signal", "signal": still}},
        "solve": {"t_end": 20.0}, "output": {"step": 1e-3},
    }  # fmt: skip
    log = {
        "file": str(SERVO / "closed.csv"), "time": "t", "outputs": {"rotor.y": "theta"},
        "inputs": {"loads.motor.signal": {"column": "i", "gain": 0.05, "held": True}},
    }  # fmt: skip
    wanted = {n: {"low": x / 10, "high": 10 * x} for n, x in TRUTH.items()} | {
        f"{LAW}sigma_2": {"low": 1e-6, "high": 1e-2}
    }
    result = fit_machine(machine, logs(tmp_path, [log], wanted), baselines=False)
    for name, truth in TRUTH.items():
        low, high = result.estimates[name].range
        assert low < truth < high
    for name in list(TRUTH)[:3]:  # the inertia and both levels
        low, high = result.estimates[name].interval
        assert high < 1.2 * low


def test_a_rough_command_is_no_noise(tmp_path):
    """It is recorded as it was. As noise it would leave a far larger residual than it does."""
    machine = body(amplitude=5.0, step=0.0025)
    push = machine["loads"]["push"]["signal"]
    push["value"] = (np.array(push["value"]) + 0.5 * np.random.default_rng(5).standard_normal(len(push["t"]))).tolist()
    record(tmp_path / "a.csv", machine)
    wanted = {
        "contacts.guide.law.parameters.F_c": {"low": 0.1, "high": 10.0},
        "bodies.a.mass": {"low": 0.2, "high": 5.0},
    }
    result = fit_machine(body(), logs(tmp_path, ["a.csv"], wanted), starts=1, baselines=False)
    for name in wanted:
        low, high = result.estimates[name].interval
        assert low < 1.0 < high < 1.01 * low

"""An encoder in a closed loop: its steps are coarse, the controller answers them, and the current is noisy."""

import numpy as np
import pytest

from stribeck import Scenario
from stribeck.identify.actuator import fit_machine
from stribeck.identify.actuator.coordinates import MachineCoordinate
from stribeck.identify.actuator.drawn import input_errors
from stribeck.identify.actuator.guides import CARRIED, Guides
from stribeck.identify.actuator.recordings import Channel, Logs, Recording, Sought
from stribeck.identify.actuator.starts import problem_of
from tests.identify.actuator.recorded import body, logs, record
from tests.reference.apart import solve
from tests.shared import SHARED

SERVO = SHARED / "data" / "servo-motor"
LAW = "contacts.bearing.law.parameters."
# of closed.csv, and first values that are wrong by a half
TRUTH = {"bodies.rotor.inertia": 5e-5, f"{LAW}F_c": 0.02, f"{LAW}F_s": 0.03, f"{LAW}v_s": 1.0, f"{LAW}sigma_0": 20.0}
FIRST = {"F_c": 0.01, "F_s": 0.015, "v_s": 0.5, "sigma_0": 10.0, "sigma_1": 0.02, "sigma_2": 1e-4}


@pytest.mark.parametrize("step", [0.0, 1e-3])
def test_other_noise_of_an_encoder_is_none_at_rest(step):
    """Half of the record stands still. Rounding repeats its value there; a sensor without steps is noisy there too."""
    t = 1e-3 * np.arange(2501)
    y = 0.1 * np.clip(np.sin(2 * np.pi * t), 0.0, None)
    noise = np.random.default_rng(1).standard_normal(len(t))
    measured = step * np.round(y / step) if step else y + 3e-4 * noise
    recording = Recording("run", t, {"a.y": Channel("y", t, measured)})
    guides = Guides(Scenario(body()), [(0, recording)])
    guided = guides.at(guides.bandwidths[3], noisy=True).recordings[0][1]
    rest, motion = (t > 0.6) & (t < 0.9), (t > 0.1) & (t < 0.4)
    for other in guided.as_well[CARRIED]:
        assert other.inputs.keys() == guided.inputs.keys()
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
        assert result.estimates[name].state == "identified"
    for name in list(TRUTH)[:3]:  # the inertia and both levels
        low, high = result.estimates[name].interval
        assert high < 1.2 * low


def turned_in_a_loop(seed):
    """Times, what an encoder of 4000 steps read, and the torque of a sampled loop on LuGre's friction, in steps of 40 us."""
    draw, fine, encoder = np.random.default_rng(seed), 25, 2 * np.pi / 4000
    t, h = 1e-3 * np.arange(2501), 1e-3 / 25
    waves = 2.0 * np.sin(2 * np.pi * (0.25 * t + draw.random())) + 0.5 * np.sin(2 * np.pi * (0.8 * t + draw.random()))
    y, u, speed, state = np.zeros(len(t)), np.zeros(len(t)), 0.0, np.zeros(3)

    def rates(x, push):
        bends = x[1] - 20.0 * abs(x[1]) * x[2] / (0.02 + 0.01 * np.exp(-(x[1] ** 2)))
        return np.array([x[1], (push - 20.0 * x[2] - 0.03 * bends - 1e-4 * x[1]) / 5e-5, bends])

    for i, wanted in enumerate(waves - waves[0]):
        y[i] = encoder * round(state[0] / encoder)
        speed = 0.8 * speed + 0.2 * (y[i] - y[i - 1]) / 1e-3 if i else 0.0
        u[i] = np.clip(0.24 * (wanted - y[i]) - 4e-3 * speed, -0.18, 0.18)
        for _ in range(fine):
            state = state + h * rates(state + h / 2 * rates(state, u[i]), u[i])
    return t, y, u + 1.5e-4 * draw.standard_normal(len(t))


@pytest.mark.share(2)
@pytest.mark.parametrize("seed", [1, 3])
def test_a_loop_whose_free_motion_strays_is_fitted_along_the_measured_one(seed):
    """The free simulation ended dozens of encoder steps beside it. F_c and sigma_2 were then out of their ranges."""
    t, y, u = turned_in_a_loop(seed)
    machine = {
        "schema": 2, "bodies": {"rotor": {"inertia": 3e-5}},
        "contacts": {"bearing": {"from": "rotor", "law": {"name": "lugre", "parameters": FIRST | {"sigma_1": 0.03}}}},
        "loads": {"motor": {"on": "rotor", "kind": "signal", "signal": {"kind": "points", "t": [0.0, 1.0], "value": [0.0, 0.0]}}},
        "solve": {"t_end": 2.5}, "output": {"step": 1e-3},
    }  # fmt: skip
    inputs = {"loads.motor.signal": Channel("u", t, u, held=True)}
    recording = Recording("loop", t, {"rotor.y": Channel("y", t, y)}, inputs)
    truth = TRUTH | {f"{LAW}sigma_2": 1e-4}
    sought = tuple(Sought(name, x / 11, 9 * x) for name, x in truth.items())
    result = fit_machine(machine, Logs((recording,), sought), starts=1, baselines=False)
    outside = {n: (e.value, e.range) for n, e in result.estimates.items() if not e.range[0] <= truth[n] <= e.range[1]}
    assert not outside
    assert any("errors are those under this guide" in note for note in result.notes)


def test_noise_of_an_input_is_drawn_at_its_size():
    """What the record's own noise does is as large as what drawn noise does, although the output's noise hides it."""
    machine = body(amplitude=5.0, step=0.0025)
    push = np.array(machine["loads"]["push"]["signal"]["value"])
    t = 0.0025 * np.arange(len(push))
    read = Channel("u", t, push + 0.1 * np.random.default_rng(6).standard_normal(len(t)), noise=0.1)
    y = solve(machine, rtol=1e-9)["a.y"]
    level = MachineCoordinate("level", 0.5, 2.0, targets={"contacts.guide.law.parameters.F_c": 1.0})

    def problem(y):
        recording = Recording("run", t, {"a.y": Channel("y", t, y)}, {"loads.push.signal": read})
        return problem_of(Scenario(machine), [(0, recording)], [level], {"a.y": 1e-6})

    exact, noisy = problem(y), problem(y + 0.01 * np.random.default_rng(7).standard_normal(len(y)))
    effect = np.mean(exact.residuals(exact.point({"level": 1.0})[None]) ** 2)
    u = noisy.point({"level": 1.0})
    r, J = noisy.slopes(u[None], np.full(len(u), noisy.step))
    (errors,) = input_errors(noisy, u, J[0])
    size = np.mean(errors**2, axis=1)
    assert size.min() < effect < size.max()
    assert effect < 1e-3 * np.mean(r**2)


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

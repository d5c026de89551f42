"""Stretches of a recording: what drives the machine in them, and how they meet."""

import numpy as np
import pytest
from scipy.integrate import odeint
from scipy.linalg import expm

from stribeck import Scenario
from stribeck.identify.actuator import Logs, fit_machine
from stribeck.identify.actuator.coordinates import coordinates
from stribeck.identify.actuator.inputs import later
from stribeck.identify.actuator.recordings import Channel, Recording, Sought
from stribeck.identify.actuator.starts import problem_of


@pytest.mark.parametrize(
    ("signal", "value"),
    [
        ({"kind": "sine", "amplitude": 2.0, "frequency": 0.7, "phase": 0.3, "offset": 0.1},
         lambda t: 0.1 + 2.0 * np.sin(2 * np.pi * 0.7 * t + 0.3)),
        ({"kind": "step", "time": 2.0, "value": 3.0}, lambda t: 3.0 * (t >= 2.0)),
        ({"kind": "points", "t": [0.0, 1.0, 4.0], "value": [0.0, 2.0, -1.0]},
         lambda t: np.interp(t, [0.0, 1.0, 4.0], [0.0, 2.0, -1.0])),
    ],
)  # fmt: skip
@pytest.mark.parametrize("by", [0.6, 1.7, 3.9, 5.5])
def test_a_signal_goes_on_where_a_stretch_begins(signal, value, by):
    s = later(signal, by)
    t = np.linspace(0.0, 1.0, 50)
    if s["kind"] == "sine":
        now = s["offset"] + s["amplitude"] * np.sin(2 * np.pi * s["frequency"] * t + s["phase"])
    elif s["kind"] == "step":
        now = s["value"] * (t >= s["time"])
    else:
        now = np.interp(t, s["t"], s["value"])
    np.testing.assert_allclose(now, value(t + by), atol=1e-12)


def test_a_signal_that_cannot_be_cut_is_none():
    assert later({"kind": "point_to_point", "t": [0.0, 1.0], "value": [0.0, 1.0]}, 0.5) is None


@pytest.mark.thorough
def test_an_unstable_machine_is_fitted_in_windows():
    """An arm held upright: whole, its simulation falls over; a SciPy program records the torque and the angle."""
    J, A, level, viscous, step = 0.05, 2.0, 0.15, 0.03, 0.004
    t = np.arange(1001) * step

    def torque(t, y, v):
        return 12.0 * (0.25 * np.sin(2.1 * t) + 0.15 * np.sin(5.3 * t) - y) - 0.8 * v

    def rates(x, t):
        y, v = x
        friction = level * 2 / np.pi * np.arctan(200.0 * v) + viscous * v
        return [v, (torque(t, y, v) + A * np.sin(y) - friction) / J]

    y, v = odeint(rates, [0.05, 0.0], t, rtol=1e-10, atol=1e-12).T
    law = {"name": "coulomb_viscous", "k_v": 200.0, "parameters": {"F_c": 0.3, "sigma_2": 0.1}}
    still = {"kind": "points", "t": [0.0, 1.0], "value": [0.0, 0.0]}
    machine = {
        "schema": 2, "name": "upright", "bodies": {"arm": {"inertia": 0.1}}, "contacts": {"joint": {"from": "arm", "law": law}},
        "loads": {"gravity": {"on": "arm", "kind": "pendulum", "amplitude": 1.0, "phase": np.pi},
                  "push": {"on": "arm", "kind": "signal", "signal": still}},
        "solve": {"t_end": 4.0}, "output": {"step": step},
    }  # fmt: skip
    truth = {
        "bodies.arm.inertia": J, "loads.gravity.amplitude": A, "contacts.joint.law.parameters.F_c": level,
        "contacts.joint.law.parameters.sigma_2": viscous,
    }  # fmt: skip
    measured = Channel("y", t, y + 5e-4 * np.random.default_rng(0).standard_normal(len(t)))
    drive = Channel("u", t, torque(t, y, v))
    recording = Recording("upright.csv", t, {"arm.y": measured}, {"loads.push.signal": drive}, {}, window=0.5)
    sought = tuple(Sought(name, x / 8, 8 * x) for name, x in truth.items())
    found = fit_machine(machine, Logs((recording,), sought), starts=2, baselines=False)
    for name, x in truth.items():
        p = found.estimates[name]
        assert p.state == "identified"
        assert p.low < x < p.high
        assert p.high - p.low < 0.1 * x


def test_what_nobody_measures_begins_a_stretch_as_the_one_before_ends_at_the_same_numbers():
    """A motor with inductance, its encoder alone: each stretch by the exponential of a matrix, its current handed on."""
    K, R, L, volts, step = 0.5, 1.0, 0.3, 2.0, 0.01
    law = {"name": "coulomb_viscous", "k_v": 1.0, "parameters": {"F_c": 1e-9, "sigma_2": 0.02}}
    machine = {
        "schema": 2, "name": "drive", "bodies": {"arm": {"inertia": 0.05}},
        "contacts": {"joint": {"from": "arm", "law": law}},
        "motors": {"drive": {"on": "arm", "K": K, "R": R, "L": L, "signal": {"kind": "step", "time": 0.0, "value": volts}}},
        "solve": {"t_end": 0.6}, "output": {"step": step},
    }  # fmt: skip
    t = step * np.arange(61)
    measured = 0.3 * t**2 * (3 - 2 * t) + 1e-3 * np.random.default_rng(0).standard_normal(len(t))
    recording = Recording("drive", t, {"arm.y": Channel("y", t, measured)}, {}, {}, window=0.2)
    sought = coordinates(Scenario.of(machine), Logs((recording,), (Sought("bodies.arm.inertia", 0.01, 0.2),)))
    problem = problem_of(Scenario.of(machine), [(0, recording)], sought, {"arm.y": 1e-3}, tied=True)
    for inertia in (0.03, 0.08):
        values = {**problem.values(problem.start()), "bodies.arm.inertia": inertia}
        r, x, at = problem.residuals(problem.point(values)[None])[0], np.zeros(4), 0
        A = np.array([[0, 1, 0, 0], [0, -0.02 / inertia, K / inertia, 0], [0, -K / L, -R / L, volts / L], [0, 0, 0, 0]])
        for run in problem.runs:
            begin = "" if run.piece == "0" else f"{float(run.piece):g}s."
            own = [values.get(f"log.0.{begin or '0s.'}initial.arm.{what}", 0.0) for what in "yv"]
            x = np.array([*own, x[2], 1.0])
            (target,) = run.targets
            y = np.array([(expm(A * s) @ x)[0] for s in target.t])
            np.testing.assert_allclose(r[at : at + len(y)], (y - target.x) / 1e-3, atol=1e-4)
            x, at = expm(A * run.scenario.end) @ x, at + len(y)

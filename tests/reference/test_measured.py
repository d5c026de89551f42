"""Friction predicted from a measured velocity: the EMPS record with its published model, and a record made here."""

import numpy as np
import pytest
from scipy import signal
from scipy.io import loadmat

from stribeck import Scenario, simulate
from tests.shared import SHARED

EMPS = SHARED / "data" / "emps" / "DATA_EMPS.mat"

# Janot, Gautier, Brunot 2019: inverse dynamic model, least squares
MASS, F_V, F_C, OFFSET, PUBLISHED_ERROR = 95.109, 203.50, 20.394, -3.165, 0.04083


def decimated(x):
    """The published procedure in MATLAB's conventions, samples 1, 11, 21 ... counted from 0 (see the README beside the data)."""
    b, a = signal.cheby1(8, 0.05, 0.08)
    return signal.filtfilt(b, a, x, padlen=24)[1::10]


def friction(folder, t, velocity):
    """The friction of the published model at a velocity that was measured, from a file."""
    rows = "".join(f"{x!r},{y!r}\n" for x, y in zip(t.tolist(), velocity.tolist(), strict=True))
    (folder / "log.csv").write_text("t,v\n" + rows)
    scenario = Scenario(
        law={"name": "coulomb_viscous", "parameters": {"F_c": F_C, "sigma_2": F_V}},
        drive={"kind": "velocity", "signal": {"kind": "file", "path": "log.csv", "time": "t", "value": "v"}},
        solve={"t_end": 1e-3 * (len(t) - 1)},
        output={"step": 1e-3},
        folder=folder,
    )
    solution = simulate(scenario)
    assert solution.status == "done"
    np.testing.assert_allclose(solution["v"], velocity, atol=1e-6)
    return solution["F"]


def test_the_force_of_a_record_made_here_is_predicted(tmp_path):
    """The same way from a position with the counts of an encoder, where EMPS is not at hand: what is left is the noise."""
    t = 1e-3 * np.arange(4000)
    w = 2 * np.pi * np.array([[0.5], [1.25]])
    y, v, a = (np.array([0.1, 0.02]) @ x for x in (np.sin(w * t), w * np.cos(w * t), -(w**2) * np.sin(w * t)))
    noise = 2.0 * np.random.default_rng(0).standard_normal(len(t))
    force = MASS * a + F_C * np.sign(v) + F_V * v + OFFSET + noise
    b, lower = signal.butter(4, 30 / 500)
    position = signal.filtfilt(b, lower, 1e-6 * np.round(y / 1e-6))
    velocity = np.gradient(position, 1e-3)
    predicted = MASS * np.gradient(velocity, 1e-3) + friction(tmp_path, t, velocity) + OFFSET
    rows = slice(200, -200)
    left = np.linalg.norm((force - predicted)[rows]) / np.linalg.norm(noise[rows])
    assert 0.98 < left < 1.02


@pytest.mark.skipif(not EMPS.is_file(), reason="needs shared/data/emps, which is not part of the project")
def test_emps_force_is_predicted_with_the_published_error(tmp_path):
    data = {key: np.ravel(value).astype(float) for key, value in loadmat(EMPS).items() if not key.startswith("__")}
    t, force = data["t"] - data["t"][0], data["gtau"] * data["vir"]
    b, a = signal.butter(4, 100 / 500)
    position = signal.filtfilt(b, a, data["qm"], padlen=12)
    velocity = np.gradient(position, 1e-3)
    acceleration = np.gradient(velocity, 1e-3)
    predicted = MASS * acceleration + friction(tmp_path, t, velocity) + OFFSET
    measured, predicted = decimated(force[49:]), decimated(predicted[49:])
    error = np.linalg.norm(measured - predicted) / np.linalg.norm(measured)
    assert error == pytest.approx(PUBLISHED_ERROR, abs=1e-5)

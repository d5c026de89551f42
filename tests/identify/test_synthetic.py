"""The synthetic rig: what it measures is the law and the sensors that it was given."""

import numpy as np
import pytest

import stribeck
from stribeck.identify.synthetic import Sensors, experiment

T = np.arange(0, 2, 1e-3)
V = 0.01 * np.sin(2 * np.pi * T)
LAW = stribeck.law("stribeck", parameters="canudas1995")


def test_the_force_is_the_friction_of_the_law():
    result = experiment(LAW, (T, V), Sensors(position_resolution=0.0))
    assert result.log.force == pytest.approx(LAW.steady_force(V), abs=1e-9)
    assert all("SYNTHETIC" in word for word in result.log.sources.values())


def test_sensors_add_the_noise_and_the_steps_that_they_have():
    sensors = Sensors(position_resolution=1e-6, force_noise=0.2)
    clean, noisy = (experiment(LAW, (T, V), s, seed=3).log for s in (Sensors(), sensors))
    assert noisy.position * 1e6 == pytest.approx(np.round(noisy.position * 1e6), abs=1e-6)
    noise = noisy.force - clean.force
    assert np.std(noise) == pytest.approx(0.2, rel=0.05)
    assert experiment(LAW, (T, V), sensors, seed=3).log.force == pytest.approx(noisy.force)

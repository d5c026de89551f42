"""Presliding fits against known truth."""

import numpy as np
import pytest

import stribeck
from stribeck.identify.features.guess import sizes_of
from stribeck.identify.methods.presliding import fit_presliding, loops, turning_points
from stribeck.rig.synthetic import Sensors, experiment


def test_turning_points_ignore_noise():
    t = np.arange(2000) * 1e-3
    y = np.sin(2 * np.pi * t) + 1e-3 * np.random.default_rng(0).standard_normal(len(t))
    turns = turning_points(y, 0.01)
    np.testing.assert_allclose(t[turns][1:-1], [0.25, 0.75, 1.25, 1.75], atol=0.03)


@pytest.fixture(scope="module")
def small_reversals():
    t = np.arange(0, 8, 1e-3)
    y = 5e-6 * (1 + np.floor(t)) * np.sin(2 * np.pi * t)
    law = stribeck.law("lugre", parameters="canudas1995")
    return experiment(law, (t, np.gradient(y, t)), Sensors(force_noise=0.015), seed=1).log  # 1 % of F_s


def test_presliding_gives_the_stiffness_within_five_per_cent(small_reversals):
    fit = fit_presliding(small_reversals, "lugre", starts=2, profiles=False)
    assert fit.estimates["sigma_0"].value == pytest.approx(1e5, rel=0.05)
    assert fit.estimates["sigma_1"].value == pytest.approx(316.2, rel=0.2)
    assert fit.estimates["F_s"].value == pytest.approx(1.5, rel=0.05)
    assert set(fit.unidentified) == {"F_c", "v_s", "sigma_2"}
    assert len(fit.details["loops"]) == len(loops(small_reversals, sizes_of(small_reversals)))


def test_without_presliding_the_stiffness_is_declared_unknown():
    law = stribeck.law("lugre", parameters="canudas1995")
    t = np.arange(0, 8, 1e-3)
    v = np.interp(t, [0, 2, 2.2, 4, 4.2, 6, 6.2, 8], [0.01, 0.01, -0.01, -0.01, 0.03, 0.03, -0.03, -0.03])
    log = experiment(law, (t, v), Sensors(force_noise=0.015), seed=1).log
    fit = stribeck.fit(log, "lugre", method="presliding")
    assert not fit.estimates["sigma_0"].identifiable
    assert fit.to_json()["parameters"]["sigma_0"]["state"] == "not identifiable"

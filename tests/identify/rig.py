"""Synthetic experiments for the tests of fits by simulation."""

import math

import numpy as np

from stribeck.identify.plan import Test, motion
from stribeck.identify.synthetic import Sensors, experiment
from stribeck.laws import find

TRUTH = {"sigma_0": 1e6, "sigma_1": 1e3, "sigma_2": 30.0, "F_c": 10.0, "F_s": 14.0, "v_s": 5e-3}
STEP, FINER = 1e-3, 4


def loop(size, rate, cycles=2):
    return Test("presliding loop", "", "motion", size, math.pi * rate * size, None, 1 / rate, cycles)


def stroke(speed):
    return Test("constant speed", "", "motion", 0.14 * speed, speed, None, 0.4, 1)


LOOPS = [loop(size, rate) for size in (8e-6, 2e-5) for rate in (4.0, 20.0)]
STROKES = [stroke(speed) for speed in (5e-4, 2e-3, 5e-3, 1e-2, 3e-2, 0.1)]


def measured(tests, law="lugre", noise=0.1, mass=0.0, stiffness=0.0, offset=0.0, **own):
    """The log of a rig that plays the tests, with a mass (kg), a spring (N/m) and a constant force (N)."""
    built, moves = find(law)({**TRUTH, **own}), motion(tests, STEP / FINER)
    log = experiment(built, moves, Sensors(force_noise=noise), 1, FINER).log
    more = mass * np.gradient(moves[1][::FINER], STEP) + stiffness * log.position + offset
    return log.with_columns(force=log.force + more)


def held_at(speed, seconds=2.0, noise=0.1):
    """A log of one direction and speeds around one, always sliding."""
    t = np.arange(0, seconds, STEP / FINER)
    v = speed * (1 + 0.9 * np.sin(2 * np.pi * 0.5 * t))
    return experiment(find("lugre")(TRUTH), (t, v), Sensors(force_noise=noise), seed=1, every=FINER).log

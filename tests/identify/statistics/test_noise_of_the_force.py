"""A fit of the motion under a force that was measured with noise."""

import numpy as np
import pytest

from stribeck.identify.models.dynamic_problem import velocity_problem
from stribeck.identify.models.motion_problem import ROUGH, MotionProblem
from stribeck.identify.statistics.sensor_noise import again_with_force_noise
from tests.identify import rig


@pytest.fixture(scope="module")
def problem():
    log = rig.measured(rig.STROKES[:2])
    inverse, *_ = velocity_problem(log, "lugre", mass=1.0)
    rows = [slice(a, a + 200) for a in range(0, len(log) - 200, 200)][:12]
    return MotionProblem(inverse, "velocity", rows, 1e-5, ROUGH)


def test_a_force_without_noise_moves_nothing(problem):
    quiet = problem.driven(problem.force)
    quiet.log = problem.log.with_columns(force=np.zeros(len(problem.log)))
    assert not again_with_force_noise(quiet, problem.home).any()


def test_the_other_force_leaves_the_problem_as_it_is(problem):
    before = problem.residual(problem.home)
    other = problem.driven(problem.force + 1.0)
    assert not np.allclose(other.residual(problem.home), before)
    assert np.array_equal(problem.residual(problem.home), before)

"""Bristles beside numbers that the motion's filter moves far: one step does not tell how far it moves them."""

import numpy as np
import pytest

from stribeck.identify.models.problem import Coordinate
from stribeck.identify.statistics.verdicts import farther, misled


class Numbers:
    """What :func:`misled` looks at."""

    coordinates = (
        Coordinate("sigma_0", "N/m", -5, 5, True),
        Coordinate("v_s", "m/s", -5, 5, True),
        Coordinate("offset", "N", -5, 5, False),
    )


@pytest.mark.parametrize(("bias", "far"), [((0.1, 0.5, 0), True), ((0.1, 0.3, 0), False), ((0.1, 0.1, 9), False)])
def test_bristles_reach_twice_as_far_beside_a_bend_that_the_filter_moves(bias, far):
    assert misled(Numbers(), np.array(bias)) is far
    sigma_0 = Numbers.coordinates[0]
    assert farther(sigma_0, 0.1, misled(Numbers(), np.array(bias))) == pytest.approx(0.2 if far else 0.1)

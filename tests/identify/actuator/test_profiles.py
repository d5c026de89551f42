"""Profiles in valleys that bend: their ends are those of the cost, or stay open."""

import numpy as np
import pytest

from stribeck.identify.actuator.intervals import THRESHOLD, Spread, profiles

LEVEL = 1.4


class Valley:
    """Residuals of exp(x) + 2 y, which is told to 1e-4 of its size however far it bends, and of a rule for y as wide as
    ``wide``."""

    low, high = np.array([np.log(0.01), 0.0]), np.array([np.log(10.0), 0.6])
    step = 1e-4

    def __init__(self, wide):
        self.wide = wide

    def residuals(self, U):
        U = np.atleast_2d(U)
        level = np.exp(U[:, 0]) + 2 * U[:, 1]
        bent = np.sin(9 * (level - LEVEL)) / 9 + 0.5 * (level - LEVEL) ** 2
        return np.stack([bent / 1e-4, (U[:, 1] - 0.2) / self.wide], axis=1)

    def slopes(self, U, step):
        r = self.residuals(U)
        J = [(self.residuals(U + step[i] * np.eye(2)[i]) - r) / step[i] for i in range(2)]
        return r, np.stack(J, axis=-1)


@pytest.mark.parametrize("wide", [0.02, 0.05, 1e3])
def test_ends_are_those_of_the_least_cost(wide):
    problem = Valley(wide)
    u = np.array([np.log(LEVEL - 0.4), 0.2])
    J = problem.slopes(u[None], np.full(2, 1e-6))[1][0]
    s = Spread(J, np.linalg.inv(J.T @ J), np.ones(2), {}, 1e9)
    found = profiles(problem, u, s, [0, 1])
    if wide > 1:  # any y does
        assert found[1].low is None
        assert found[1].high is None
        assert found[0].low is None or found[0].low < np.log(LEVEL - 1.2) + 1e-3
        assert found[0].high is None or found[0].high > np.log(LEVEL) - 1e-3
        return
    reach = wide * np.sqrt(THRESHOLD)
    np.testing.assert_allclose([found[1].low, found[1].high], [0.2 - reach, 0.2 + reach], rtol=5e-3)
    ends = [np.log(LEVEL - 2 * (0.2 + share * reach)) for share in (1, -1)]
    np.testing.assert_allclose([found[0].low, found[0].high], ends, rtol=2e-2, atol=2e-2)

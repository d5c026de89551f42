"""Why a number of a simulated fit is not told."""

import warnings
from types import SimpleNamespace

import numpy as np

from stribeck.identify.models.problem import Coordinate
from stribeck.identify.statistics.verdicts import why_not


def test_a_variance_that_rounding_made_negative_tells_nothing() -> None:
    """It was a warning on the screen, and no reason."""
    coordinates = [Coordinate(n, "N", -10.0, 10.0, log=False) for n in ("a", "b")]
    problem = SimpleNamespace(coordinates=coordinates, bounds=(np.full(2, -10.0), np.full(2, 10.0)))
    inner = np.array([[-1e-12, 1e-7], [1e-7, 1.0]])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        why = why_not(problem, 0, np.zeros(2), inner, 1000.0, False)
    assert "rounding" in why

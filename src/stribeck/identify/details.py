"""What a fit tells beside its numbers (:attr:`stribeck.identify.result.Fit.details`), each part with its keys."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypedDict

from stribeck.arrays import Array


class Candidate(TypedDict):
    """A model of the record: its law and forms, how many numbers it has, and its error; ``chosen``: it is the fit."""

    name: str
    law: str
    forms: list[str]
    numbers: int
    relative_force_error: float
    cross_validated_error: float | None
    chosen: bool


class FitDetails(TypedDict, total=False):
    """All that a fit may tell; which parts there are depends on the method."""

    forms: dict[str, float]
    speeds: dict[str, float]
    missed: float
    nearest_stribeck: dict[str, float]
    friction_error: float
    rest: float
    seen: dict[str, tuple[float, float]]
    decimation: int
    output: str
    output_error: float
    output_trace: Mapping[str, Array]

"""What a fit tells beside its numbers (:attr:`stribeck.identify.result.Fit.details`), each part with its keys."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, TypedDict

from stribeck.arrays import Array

if TYPE_CHECKING:
    from stribeck.identify.statistics.crossvalidate import LeftOut


class FileLevel(TypedDict, total=False):
    """The friction level of a file, N: its own with an interval, and what the fit without that file predicts."""

    file: str
    at: dict[str, float]
    rows: int
    level: float
    low: float
    high: float
    predicted: float
    predicted_low: float
    predicted_high: float
    spread: float


class MeasuredLoop(TypedDict):
    """A small reversal, row by row: s, m, N."""

    time: Array
    position: Array
    measured: Array
    fitted: Array


class AddedTerm(TypedDict):
    """A term that was added, and the errors with it."""

    added: str
    cross_validated_error: float
    relative_force_error: float


class Candidate(TypedDict):
    """A plainer model of the same record, or the fit itself: its errors, and how many numbers it has."""

    name: str
    law: str
    numbers: int
    values: dict[str, float]
    cross_validated_error: float
    relative_force_error: float


class SeenNoise(TypedDict):
    """Of the residual: its standard deviation, and the order of the model of its correlation."""

    standard_deviation: float
    memory: int


class FitDetails(TypedDict, total=False):
    """All that a fit may tell; which parts there are depends on the method."""

    levels: Sequence[FileLevel]
    loops: Sequence[MeasuredLoop]
    selection: Sequence[AddedTerm]
    candidates: Sequence[Candidate]
    segments: Sequence[dict[str, float]]
    left_out: LeftOut
    friction_error: float
    rest: float
    seen: dict[str, tuple[float, float]]
    decimation: int
    intervals_over: str
    misfit_share: float
    filter_bias: dict[str, float]
    noise: SeenNoise
    search: str
    output: str
    output_error: float
    output_trace: Mapping[str, Array]

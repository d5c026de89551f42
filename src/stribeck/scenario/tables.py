"""The tables of a scenario file that are no elements."""

from __future__ import annotations

import math
from typing import Annotated

from pydantic import Field

from stribeck.constants import POSITIVE, Constant
from stribeck.machine.table import ConstantField, FileTable, given_as

ROWS_LARGEST = 10**15  # more than any machine holds, and still exact in a float
# Beyond, rtol is a mistake: rounding decides below 5e-12, and at 0.01 the promised error of y is the peak itself.
RTOL_SMALLEST, RTOL_LARGEST = 1e-13, 0.1


class Solve(FileTable):
    """Settings of the solver."""

    t_end: float = given_as(Constant("s", "end of the simulation", above=0))
    rtol: float = Field(1e-8, ge=RTOL_SMALLEST, le=RTOL_LARGEST, description="relative tolerance")
    atol: dict[str, Annotated[float, ConstantField(POSITIVE)]] = Field(
        default_factory=dict, description="absolute tolerance by state; the default scales with F_s/sigma_0 and v_s"
    )
    max_steps: int = Field(1_000_000_000, gt=0, le=10**18, description="largest number of attempted steps")


class Output(FileTable):
    """Settings of the output."""

    step: float = given_as(Constant("", "time between rows, s: row i is at i * step", above=0))
    energy: bool = Field(False, description="add the columns E_in, E_stored and E_dissipated, J")


def rows(t_end: float, step: float) -> int:
    """The number of rows of an output: i * step for i = 0 ... floor(t_end/step + 1e-9)."""
    ratio = t_end / step + 1e-9
    return math.floor(ratio) + 1 if ratio < ROWS_LARGEST else ROWS_LARGEST

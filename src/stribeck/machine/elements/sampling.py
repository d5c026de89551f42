"""When a controller computes, what it reads of the motion, and what it remembers from sample to sample."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from stribeck.expressions.graph import Expr, symbol, wrap
from stribeck.expressions.ops import Value, exp, floor, where
from stribeck.machine.sampled import PERIOD
from stribeck.machine.table import Aside, FileTable, given_as, quantity


class Sampling(FileTable):
    """When a controller computes, and what it reads of the motion."""

    period: float = given_as(PERIOD)
    delay: float = quantity("s", "time from a sample to its output", at_least=0, default=0.0)
    resolution: float | None = quantity(
        "m", "step of the encoder; 0: none", at_least=0, off_at_zero=True, rotary_unit="rad"
    )
    noise: float | None = quantity(
        "m", "standard deviation of the reading", at_least=0, off_at_zero=True, rotary_unit="rad"
    )
    bandwidth: float | None = quantity("rad/s", "of the filter that estimates the speed", above=0, optional=True)
    seed: Annotated[int, Aside(0)] = Field(
        0, ge=0, le=2**32 - 1, description="seed of the noise; the same seed gives the same noise"
    )

    def reading(self, y: Value) -> Value:
        """The encoder's reading of the position y: with noise, rounded to the nearest count."""
        if self.noise is not None:
            y = y + self.noise * symbol("noise")
        if self.resolution is not None:
            y = floor(y / self.resolution + 0.5) * self.resolution
        return y

    @property
    def memory(self) -> tuple[str, ...]:
        """The memory of the speed estimator."""
        return ("filter_y", "filter_v") if self.bandwidth is not None else ("last",)

    def speed(self, first: Value, y: Expr, m: dict[str, Expr]) -> tuple[Expr, dict[str, Expr]]:
        """The controller's speed, and the estimator's states after this sample.

        The speed is a difference, or the output of a critically damped filter after one period of constant reading.
        """
        if self.bandwidth is None:
            return wrap(where(first, 0.0, (y - m["last"]) / self.period)), {"last": y}
        was, v = where(first, y, m["filter_y"]), m["filter_v"]
        decay, off = exp(-self.bandwidth * self.period), was - y
        pull = v + self.bandwidth * off
        filter_y = y + (off + pull * self.period) * decay
        filter_v = (v - self.bandwidth * pull * self.period) * decay
        return wrap(v + 0.0), {"filter_y": filter_y, "filter_v": filter_v}

"""Numbers as the cells of tables show them, on pages and in the terminal."""

from __future__ import annotations

import math


def digits(x: float | None, unknown: str = "-", count: int = 6) -> str:
    """A number with so many digits; ``unknown`` where there is none."""
    return unknown if x is None or math.isnan(x) else f"{x:.{count}g}"


def percent(share: float | None, places: int | None = None) -> str:
    """A share as a percentage with three digits, or with so many places."""
    if share is None or not math.isfinite(share):
        return "-"
    return f"{100 * share:.3g} %" if places is None else f"{100 * share:.{places}f} %"

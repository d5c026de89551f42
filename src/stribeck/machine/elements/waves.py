"""Sums of waves, given as lists of one length."""

from __future__ import annotations

from stribeck.expressions.ops import Value, sin
from stribeck.machine.table import Problem


def same_length(table: object, *names: str) -> list[Problem]:
    """Lists that must be as long as the first of them."""
    count = len(getattr(table, names[0]))
    lists = [(n, getattr(table, n)) for n in names[1:]]
    return [
        (n, f"a list of {len(x)}: must be as long as {names[0]} ({count})")
        for n, x in lists if x is not None and len(x) != count
    ]  # fmt: skip


def sum_of_waves(p: object, position: Value) -> Value:
    """Sum of amplitude_k sin(waves_k at + phase_k)."""
    total = 0.0
    for amplitude, waves, phase in zip(*(getattr(p, n) for n in ("amplitude", "waves", "phase")), strict=True):
        total = total + amplitude * sin(waves * position + phase)
    return total

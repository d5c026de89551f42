"""The signal of a validated table [drive.signal]."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from stribeck import signals
from stribeck.errors import InputError
from stribeck.scenario.tables import SIGNALS, Problem


def read_signal(kind: str, values: Any, folder: Path) -> tuple[signals.Signal | None, list[Problem]]:
    """The signal, or None and what is wrong with its points or its file: (key, message)."""
    cls = SIGNALS[kind]
    if cls is signals.FileSignal:
        try:
            path, columns = folder / values.path, (values.time, values.value)
            return signals.FileSignal.read(path, *columns, values.unit, values.time_unit, values.scale), []
        except InputError as error:
            keyed = (text.partition(": ") for text in error.problems)
            return None, [("path" if key == "data" else key, text) for key, _, text in keyed]
    if issubclass(cls, signals.PointsSignal | signals.Curve):
        t, value = np.array(values.t, float), np.array(values.value, float)
        wrong = cls.problems(t, value)
        return (None, wrong) if wrong else (cls(t, value), [])
    return cls({name: getattr(values, name) for name in cls.constants}), []

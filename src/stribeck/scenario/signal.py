"""The signal of a validated table [drive.signal]."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from stribeck import signals
from stribeck.errors import InputError
from stribeck.scenario.tables import SIGNALS, Problem, StrictTable


def read_signal(kind: str, values: StrictTable, folder: Path) -> tuple[signals.Signal | None, list[Problem]]:
    """The signal, or None and what is wrong with its points or its file: (key, message)."""
    cls, given = SIGNALS[kind], dict(values)
    if cls is signals.FileSignal:
        try:
            path, columns = folder / given["path"], (given["time"], given["value"])
            return signals.FileSignal.read(path, *columns, given["unit"], given["time_unit"], given["scale"]), []
        except InputError as error:
            keyed = (text.partition(": ") for text in error.problems)
            return None, [("path" if key == "data" else key, text) for key, _, text in keyed]
    if issubclass(cls, signals.PointsSignal | signals.Curve):
        t, value = np.array(given["t"], float), np.array(given["value"], float)
        wrong = cls.problems(t, value)
        return (None, wrong) if wrong else (cls(t, value), [])
    return cls({name: given[name] for name in cls.constants}), []

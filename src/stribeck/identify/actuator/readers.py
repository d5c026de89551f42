"""Files of recordings: those of :mod:`stribeck.recorded`, and the JSON logs of BAM."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from stribeck.errors import InputError
from stribeck.files import read_file
from stribeck.recorded import Source, opened


def opened_log(path: Path) -> Source:
    """A recording, its columns not read yet.

    Raises:
        InputError: there is no such file, or it cannot be read.
    """
    return _bam(path) if path.suffix.lower() == ".json" else opened(path)


def _bam(path: Path) -> Source:
    """A processed log of BAM: ``dt`` and ``entries``, each with position, speed, goal_position, load, input_volts, ...

    The columns are those of the entries, and ``t``; whole numbers beside them (mass, length, kp, vin) are constants.
    """
    try:
        data = json.loads(read_file(path))
    except OSError as error:
        raise InputError(f"'{path}': cannot be read: {error.strerror or error}") from None
    except (ValueError, RecursionError) as error:
        raise InputError(f"'{path}': is not JSON: {error}") from None
    entries = data.get("entries") if isinstance(data, dict) else None
    if not isinstance(entries, list) or not entries or not all(isinstance(e, dict) for e in entries):
        raise InputError(f"'{path}': must be a log of BAM: a list 'entries' of tables")
    names = [n for n, x in entries[0].items() if isinstance(x, int | float | bool)]
    found: dict[str, Any] = {
        n: np.array([float(x) if isinstance(x := e.get(n), int | float | bool) else np.nan for e in entries])
        for n in names
    }
    found |= {n: np.asarray(x) for n, x in data.items() if isinstance(x, int | float) and n not in found}
    if "t" not in found and isinstance(data.get("dt"), int | float):
        found["t"] = float(data["dt"]) * np.arange(len(entries))
    elif "t" not in found and "timestamp" in found:
        found["t"] = found["timestamp"]
    return Source(path, found)

"""Opens recordings: files of :mod:`stribeck.recorded`, BAM's JSON logs, MCAP and rosbags."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from stribeck.errors import InputError, arg
from stribeck.files import json_of
from stribeck.recorded import Source, bags, opened


def opened_log(path: Path) -> Source:
    """Open a recording without reading its columns.

    Raises:
        InputError: there is no such file, or it cannot be read.
        MissingExtra: the reader of such files is not installed.
    """
    kind = path.suffix.lower()
    if kind == ".json":
        return _bam(path)
    if kind == ".db3":
        raise InputError(
            f"{arg('data')}: '{path}': is a part of a rosbag: give the folder that holds its metadata.yaml"
        )
    if kind == ".mcap" and path.is_file():
        return bags.opened_mcap(path)
    if (kind == ".bag" and path.is_file()) or (path / "metadata.yaml").is_file():
        return bags.opened_rosbag(path)
    return opened(path)


def time_of(source: Source, column: str) -> str | None:
    """The column with the times of another column, if the file declares it."""
    return source.times.get(column) if isinstance(source, bags.BagSource) else None


def _bam(path: Path) -> Source:
    """A processed log of BAM: ``dt`` and ``entries``, each with position, speed, goal_position, load, input_volts, ...

    The columns are those of the entries, and ``t``; whole numbers beside them (mass, length, kp, vin) are constants.
    """
    try:
        data = json_of(path)
    except OSError as error:
        raise InputError(f"{arg('data')}: '{path}': cannot be read: {error.strerror or error}") from None
    except ValueError as error:
        raise InputError(f"{arg('data')}: '{path}': is not JSON: {error}") from None
    entries = data.get("entries") if isinstance(data, dict) else None
    if not isinstance(entries, list) or not entries or not all(isinstance(e, dict) for e in entries):
        raise InputError(f"{arg('data')}: '{path}': must be a log of BAM: a list 'entries' of tables")
    names = [n for n, x in entries[0].items() if isinstance(x, int | float | bool)]
    columns: dict[str, object] = {
        n: np.array([float(x) if isinstance(x := e.get(n), int | float | bool) else np.nan for e in entries])
        for n in names
    }
    columns |= {n: np.asarray(x) for n, x in data.items() if isinstance(x, int | float) and n not in columns}
    if "t" not in columns and isinstance(data.get("dt"), int | float):
        columns["t"] = float(data["dt"]) * np.arange(len(entries))
    elif "t" not in columns and "timestamp" in columns:
        columns["t"] = columns["timestamp"]
    return Source(path, columns)

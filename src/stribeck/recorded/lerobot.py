"""Reads episodes of LeRobot datasets (versions 2 and 3): Parquet files beside ``meta/info.json``."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from stribeck.arrays import Array
from stribeck.errors import InputError, needed
from stribeck.files import json_of
from stribeck.recorded import Source


def is_dataset(path: Path) -> bool:
    """Whether a folder is a dataset."""
    return (path / "meta" / "info.json").is_file()


def opened_episode(path: Path, episode: int) -> Source:
    """One episode: ``timestamp``, ``observation.state.elbow.pos``, ``action.elbow.pos``, ...

    Names come from info.json, otherwise from the index. Values are not converted: many datasets hold degrees, or shares
    of a joint's range.

    Raises:
        MissingExtra: pyarrow is not installed.
        InputError: the folder is no dataset, or has no such episode.
    """
    with needed("reading LeRobot datasets"):
        from pyarrow import ArrowException, parquet
    try:
        info = json_of(path / "meta" / "info.json")
        features = {n: dict(f) for n, f in info["features"].items()}
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise InputError(f"'{path}': meta/info.json: cannot be read: {error}") from None
    numbered = sorted((path / "data").rglob(f"episode_{episode:06d}.parquet"))  # version 2: a file for each episode
    files = numbered or sorted((path / "data").rglob("file-*.parquet"))
    numeric = [n for n, f in features.items() if str(f.get("dtype", "")).startswith(("float", "int", "bool"))]
    parts: dict[str, list[Array]] = {}
    try:
        for file in files:
            there = parquet.read_schema(file).names
            only = None if numbered or "episode_index" not in there else [("episode_index", "=", episode)]
            table = parquet.read_table(file, columns=[n for n in numeric if n in there], filters=only)
            for name in table.column_names:
                column = table.column(name)
                rows = column.to_pylist() if "list" in str(column.type) else column.to_numpy()
                if len(rows):
                    parts.setdefault(name, []).append(np.asarray(rows, float))
    except (OSError, ArrowException, ValueError) as error:
        raise InputError(f"'{path}': cannot be read: {str(error).splitlines()[0]}") from None
    if not parts:
        last = info.get("total_episodes")
        raise InputError(f"'{path}': episode: {episode}: there is none" + (f" (it has {last}, from 0)" if last else ""))
    columns: dict[str, Array] = {}
    for name, pieces in parts.items():
        x = np.concatenate(pieces)
        if x.ndim == 1 or x.size == len(x):
            columns[name] = x.ravel()
        else:
            x = x.reshape(len(x), -1)
            columns |= {f"{name}{end}": x[:, i] for i, end in enumerate(_ends(features[name], x.shape[1]))}
    return Source(path, columns)


def _ends(feature: Mapping[str, object], count: int) -> list[str]:
    """The suffixes of a feature's column names."""
    names = feature.get("names")
    if isinstance(names, Mapping):  # { motors = [...] }, or a name for each number
        lists = [x for x in names.values() if isinstance(x, list)]
        names = lists[0] if len(lists) == 1 else list(names)
    if isinstance(names, list) and len(names) == count and len(set(map(str, names))) == count:
        return [f".{name}" for name in names]
    return [f"[{i}]" for i in range(count)]

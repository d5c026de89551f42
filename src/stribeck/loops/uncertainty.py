"""What the friction may be instead: samples of a machine's friction parameters within their intervals."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from stribeck.arrays import Array
from stribeck.constants import show
from stribeck.errors import InputError, arg, nearest
from stribeck.parameter_sets import read_toml
from stribeck.scenario import Scenario

SHARE = 0.1  # of each parameter, both ways, where no intervals are given
VARIED = ("F_c", "F_s", "v_s", "sigma_0", "sigma_1", "sigma_2")
_RANDOM = 8


def friction_intervals(scenario: Scenario, file: Path | None) -> dict[str, tuple[float, float]]:
    """The interval of each friction parameter by its path: of the file, else a tenth both ways.

    The file is a parameters.toml as ``stribeck fit`` writes it: ``[parameters]`` with tables of value, low and high, by
    the names of a law's constants (of every contact that has them) or by paths of the machine.

    Raises:
        InputError: the file cannot be read, or names what the machine does not have.
    """
    from stribeck.simulation.variations import machine_places

    places = machine_places(scenario)
    rig = scenario.rig
    laws = {c.law_path for c in rig.machine.contacts}
    own = {path: rig.values[at] for path, at in places.items() if at[0] in laws and at in rig.values}
    if file is None:
        return {
            path: (min(x * (1 - SHARE), x), max(x * (1 + SHARE), x))
            for path, x in own.items() if path.rpartition(".")[2] in VARIED and x
        }  # fmt: skip
    table = read_toml(file).get("parameters")
    if not isinstance(table, dict) or not table:
        raise InputError(f"{arg('uncertainty')}: {show(str(file))}: has no table [parameters] with intervals")
    found: dict[str, tuple[float, float]] = {}
    problems = []
    for name, entry in table.items():
        low, high = _ends(entry)
        if low is None or high is None:
            continue
        paths = [name] if name in places else [path for path in own if path.rpartition(".")[2] == name]
        if not paths:
            problems.append(f"{arg('uncertainty')}: {name}: no contact of the machine has it{nearest(name, list(own))}")
        elif not low <= high:
            problems.append(f"{arg('uncertainty')}: {name}: low = {low:g} must not be above high = {high:g}")
        found |= dict.fromkeys(paths, (low, high))
    if problems or not found:
        raise InputError(problems or f"{arg('uncertainty')}: {show(str(file))}: no parameter has both low and high")
    return found


def _ends(entry: object) -> tuple[float | None, float | None]:
    if isinstance(entry, dict):
        ends = (entry.get("low"), entry.get("high"))
        return tuple(float(x) if isinstance(x, int | float) else None for x in ends)  # type: ignore[return-value]
    return None, None


def friction_samples(given: dict[str, tuple[float, float]], seed: int = 0) -> dict[str, Array]:
    """Values of each path, sample by sample: all low, all high, each alone at both ends, and some at random; the first
    sample is the middle."""
    names = list(given)
    low, high = (np.array([given[n][i] for n in names]) for i in (0, 1))
    middle = (low + high) / 2
    rows = [middle, low, high]
    for i in range(len(names)):
        for end in (low, high):
            row = middle.copy()
            row[i] = end[i]
            rows.append(row)
    rows += list(low + (high - low) * np.random.default_rng(seed).random((_RANDOM, len(names))))
    found = {n: np.array([row[i] for row in rows]) for i, n in enumerate(names)}
    for path in [n for n in names if n.endswith(".F_s")]:  # at least F_c, as every law asks
        if (other := path[:-3] + "F_c") in found:
            found[path] = np.maximum(found[path], found[other])
    return found

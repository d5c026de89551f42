"""Samples of a machine's friction parameters within their intervals."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from stribeck.arrays import Array
from stribeck.constants import Constant, show
from stribeck.errors import InputError, arg, nearest
from stribeck.parameter_sets import read_toml
from stribeck.scenario import Scenario

SHARE = 0.1  # of each parameter, both ways, if no intervals are given: a round assumption
VARIED = ("F_c", "F_s", "v_s", "sigma_0", "sigma_1", "sigma_2")
_RANDOM = 8  # samples at random: as many again as four parameters have ends


def friction_intervals(scenario: Scenario, file: str | Path | None) -> dict[str, tuple[float, float]]:
    """The interval of each friction parameter by its path: from the file; without a file, 10 % both ways.

    The file is a parameters.toml as ``stribeck fit`` writes it: ``[parameters]`` with tables of value, low and high. Its
    keys are constants of a law, then valid for every contact that has them, or paths of the machine.

    Raises:
        InputError: if the file cannot be read, or contains a parameter that the machine does not have or that the data of
            the fit do not determine.
    """
    places = scenario.places
    machine = scenario.elements
    laws = {c.law_path for c in machine.system.contacts}
    nominal = {path: machine.values[key] for path, key in places.items() if key[0] in laws and key in machine.values}
    if file is None:
        return {
            path: (min(x * (1 - SHARE), x), max(x * (1 + SHARE), x))
            for path, x in nominal.items() if path.rpartition(".")[2] in VARIED and x
        }  # fmt: skip
    table = read_toml(Path(file)).get("parameters")
    if not isinstance(table, dict) or not table:
        raise InputError(f"{arg('uncertainty')}: {show(str(file))}: has no table [parameters] with intervals")
    intervals: dict[str, tuple[float, float]] = {}
    problems = []
    for name, entry in table.items():
        ends = [entry[end] for end in ("low", "high") if end in entry] if isinstance(entry, dict) else []
        if len(ends) < 2:
            continue
        paths = [name] if name in places else [path for path in nominal if path.rpartition(".")[2] == name]
        wrong = [f"{name}: {show(x)}: {text}" for x in ends if (text := _problem(scenario, paths, x))]
        if not paths:
            wrong = [f"{name}: no contact of the machine has it{nearest(name, list(nominal))}"]
        elif entry.get("determined") is False:
            text = "measure the experiment that the file names, or write an interval of your own in its place"
            wrong = [f"{name}: the data of this fit do not determine it: {text}"]
        elif not wrong and ends[0] > ends[1]:
            wrong = [f"{name}: low = {ends[0]:g} must not be above high = {ends[1]:g}"]
        if wrong:
            problems += [f"{arg('uncertainty')}: {text}" for text in wrong]
            continue
        low, high = map(float, ends)
        intervals |= dict.fromkeys(paths, (low, high))
    if problems or not intervals:
        raise InputError(problems or f"{arg('uncertainty')}: {show(str(file))}: no parameter has both low and high")
    return intervals


def _problem(scenario: Scenario, paths: Sequence[str], value: object) -> str | None:
    """The mistake in an end of the interval of a number at these paths, in words."""
    for path in paths:
        owner, name = scenario.places[path]
        law = scenario.elements.laws.get(owner)
        constants = law.constants() if law is not None else {}
        if text := constants.get(name, Constant("", "")).problem(value):
            return text
    return None


def friction_samples(intervals: dict[str, tuple[float, float]]) -> dict[str, Array]:
    """The samples as one array for each path: the middle, all low, all high, each alone at both ends, and 8 at random."""
    names = list(intervals)
    low, high = (np.array([intervals[n][i] for n in names]) for i in (0, 1))
    middle = (low + high) / 2
    rows = [middle, low, high]
    for i in range(len(names)):
        for end in (low, high):
            row = middle.copy()
            row[i] = end[i]
            rows.append(row)
    rows += list(low + (high - low) * np.random.default_rng(0).random((_RANDOM, len(names))))
    samples = {n: np.array([row[i] for row in rows]) for i, n in enumerate(names)}
    for path in [n for n in names if n.endswith(".F_s")]:  # at least F_c, as every law requires
        if (other := path[:-3] + "F_c") in samples:
            samples[path] = np.maximum(samples[path], samples[other])
    return samples

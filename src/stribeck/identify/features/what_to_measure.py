"""Estimates with their units, and the experiments that would identify open ones."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace

import numpy as np

from stribeck import laws
from stribeck.constants import rotary_unit
from stribeck.identify.core.states import Estimate, EstimateState
from stribeck.identify.features.guess import Sizes, sizes_of
from stribeck.identify.log import Log, thinned
from stribeck.identify.models.curves import REACHED
from stribeck.identify.models.terms import TERMS

_WORDS = {
    "sigma_0": "small reversals of {small} to {large} (peak to peak), at least 20 samples each, the largest at {loop} or "
    "slower; the position resolution must be {fine} or better",
    "sigma_1": "small and fast reversals of {small} to {large} (peak to peak) at several frequencies, with top speeds of "
    "{loop} to {loop_fast} and a position resolution of {fine} or better; or steps of force from rest, at {rate} or faster",
    "sigma_2": "constant speeds in both directions up to {fast} or more, at least three of them above a third of this speed",
    "F_c": "constant speeds in both directions from {middle} up, long enough for the force to settle",
    "F_s": "constant speeds in both directions from {slowest} to {middle}, evenly spaced in the logarithm; or force "
    "ramps from rest at {gentle} or slower",
    "v_s": "constant speeds in both directions from {slowest} to {fast}, at least ten, evenly spaced in the logarithm",
    "k_v": "",  # of a model, not of the machine
    "mass": "accelerations at which mass * acceleration exceeds half the friction level ({half}), in both directions",
    "stiffness": "slow strokes over the whole travel, in both directions",
    "sigma_2_by_direction": "at least three constant speeds up to {fast}, the same in both directions",
    "F_c_by_direction": "constant speeds in both directions from {slowest} to {middle}, the same in both",
    "gravity_sin": "slow strokes over as large a part of a turn as possible, in both directions",
    "gravity_cos": "slow strokes over as large a part of a turn as possible, in both directions",
    "offset": "the same constant speeds in both directions",
}
_UNITS = {**dict.fromkeys(("small", "large", "fine"), "m"), **dict.fromkeys(("rate", "gentle"), "N/s"), "half": "N"}
_BOTH = 10.0  # ratio of the lengths by fit and by log: beyond it one of them is of loops that slide
_OF_TRAVEL = 0.1  # of the travel: largest presliding length, as a stroke of several times this length must slide
_GUESSED = 1e-4  # of the largest speed: a smaller v_s that is not identifiable is no scale
_IN_A_LOOP = 20  # samples of a loop at the log's rate: five for each of its four branches


def presliding_length(values: Mapping[str, float], sizes: Sizes, open_: Collection[str] = ()) -> float:
    """The displacement to break-away, m, at most a tenth of the travel.

    It is the fit's F_s/sigma_0 if the stiffness of the log agrees, or else the smaller of both. If F_s is not identifiable
    (in ``open_``), the force of the log replaces it, as F_s may then be many times too high.
    """
    seen = sizes.force / sizes.stiffness
    level = next((values[n] for n in ("F_s", "F_c") if n in values and n not in open_), sizes.force)
    fitted = level / values["sigma_0"] if values.get("sigma_0", 0.0) > 0 else seen
    length = fitted if seen / _BOTH < fitted < seen * _BOTH else min(seen, fitted)  # the larger is of sliding
    return min(length, _OF_TRAVEL * sizes.travel) if sizes.travel > 0 else length


def reachable(values: Mapping[str, float], sizes: Sizes, open_: Collection[str] = ()) -> dict[str, float]:
    """The values of the advice, SI units, within the speeds, the travel and the sampling rate of the log.

    They come from fitted constants if these are identifiable and agree with the log.

    Returns:
        By name: ``small``, ``large``: peak-to-peak sizes of reversals; ``fine``: the position resolution that these need.
        ``loop``, ``loop_fast``: top speeds in slow and in fast reversals.
        ``slowest``, ``middle``, ``fast``: speeds of strokes.
        ``rate``, ``gentle``: rates of the force; ``half``: half the friction level.
    """
    length = presliding_length(values, sizes, open_)
    speed, fast = values.get("v_s", 0.0), sizes.fast
    bent = (_GUESSED * fast if "v_s" in open_ else 0) < speed < 0.3 * fast
    slowest = min(0.1 * speed, 1e-2 * fast) if bent else 1e-3 * fast
    middle = min(max(10 * speed, 0.03 * fast), 0.3 * fast) if bent else 0.1 * fast
    sampled = np.pi * 5 * length / (_IN_A_LOOP * sizes.step) if sizes.step > 0 else np.inf
    loop_fast = min(middle, sampled)
    return {
        "small": 0.5 * length, "large": 5 * length, "fine": 0.01 * length, "slowest": slowest, "middle": middle, "fast": fast,
        "loop": min(0.01 * fast, 0.1 * loop_fast), "loop_fast": loop_fast, "rate": 100 * sizes.force,
        "gentle": 0.1 * sizes.force, "half": 0.5 * sizes.force,
    }  # fmt: skip


def experiment_for(
    name: str, values: Mapping[str, float], sizes: Sizes, open_: Collection[str] = (), rotary: bool = False
) -> str:
    """The advised experiment in words, with the values of :func:`reachable`; empty for the friction level at a speed."""
    if name.startswith("level"):
        return ""
    if "_by_" in name and name not in _WORDS:
        return f"the same motions at three or more values of {name.partition('_by_')[2]}, evenly over its range"
    words = _WORDS.get(name, "motions in which the force depends on it: reversals of several sizes and speeds")
    numbers = reachable(values, sizes, open_)
    units = {n: rotary_unit(_UNITS.get(n, "m/s")) if rotary else _UNITS.get(n, "m/s") for n in numbers}
    return words.format(**{n: f"{float(f'{x:.2g}'):g} {units[n]}" for n, x in numbers.items()})


def with_units(
    estimates: Mapping[str, Estimate], law: str, given: Mapping[str, float], log: Log
) -> dict[str, Estimate]:
    """The estimates of a log's fit, the law's first, with units, and with the experiment that would determine open ones.

    Args:
        given: constants of the law.
    """
    constants, sizes, out = laws.find(law).constants(), sizes_of(thinned(log)), dict[str, Estimate]()
    values = {**given, **{n: e.value for n, e in estimates.items()}}
    open_ = [n for n, e in estimates.items() if not e.usable]
    for name in [*(n for n in constants if n in estimates), *(n for n in estimates if n not in constants)]:
        e, of = estimates[name], constants if name in constants else TERMS
        unit = of[name].unit if name in of else "N"
        e = replace(e, unit=log.unit(unit))
        if not e.usable or e.state is EstimateState.AT_LEAST:
            experiment = "" if e.files_differ else experiment_for(name, values, sizes, open_, rotary=log.rotary)
            e = replace(e, why=e.why or _why(e), experiment=experiment)
        out[name] = e
    return out


def _why(e: Estimate) -> str:
    if e.files_differ:
        return "the files differ"
    if e.state is EstimateState.NOT_IDENTIFIABLE:
        return "its interval is not narrow"
    return f"no sliding below {REACHED:g} v_s was recorded"

"""Which experiment would determine a parameter that the data leave open."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np

from stribeck.constants import rotary_unit
from stribeck.identify.features.guess import Sizes

_WORDS = {
    "sigma_0": "small reversals: move to and fro by {small} to {large} (total way), the largest at {loop} or slower, at least 20 "
    "samples in each, with a position resolution of {fine} or better",
    "sigma_1": "small and fast reversals: {small} to {large} (total way) at several frequencies, so that the speed in "
    "the largest reaches {loop} to {loop_fast}, with a position resolution of {fine} or better; "
    "or steps of force from rest, rising at {rate} or faster",
    "sigma_2": "constant speeds in both directions up to {fast} or more, at least three of them above a third of that",
    "F_c": "constant speeds in both directions from {middle} up, long enough for the force to settle",
    "F_s": "constant speeds in both directions from {slowest} to {middle}, evenly spaced in the logarithm; or force "
    "ramps from rest at {gentle} or slower",
    "v_s": "constant speeds in both directions from {slowest} to {fast}, at least ten, evenly spaced in the logarithm",
    "k_v": "constant speeds in both directions from {slowest} to {middle}, evenly spaced in the logarithm",
    "mass": "accelerations at which mass * acceleration exceeds half the friction level ({half}), in both directions",
    "stiffness": "slow strokes over the whole travel, in both directions",
    "sigma_2_by_direction": "at least three constant speeds up to {fast}, the same in both directions",
    "F_c_by_direction": "constant speeds in both directions from {slowest} to {middle}, the same in both",
    "gravity_sin": "slow strokes over as much of a turn as there is room for, in both directions",
    "gravity_cos": "slow strokes over as much of a turn as there is room for, in both directions",
    "offset": "the same constant speeds in both directions",
}
_UNITS = {**dict.fromkeys(("small", "large", "fine"), "m"), **dict.fromkeys(("rate", "gentle"), "N/s"), "half": "N"}
_BOTH = 10.0  # factor between the fit's length and the record's, beyond which one of them is of loops that slide
_OF_TRAVEL = 0.1  # of the travel: what presliding can be at most, as a stroke of some times its length must slide
_GUESSED = 1e-4  # of the largest speed: a v_s below it that the data leave open is no scale
_IN_A_LOOP = 20  # samples of a loop at the record's rate: five for each of its four branches


def presliding_length(values: Mapping[str, float], sizes: Sizes, open_: Collection[str] = ()) -> float:
    """The way to break-away, m: the fit's F_s/sigma_0 where the record's own stiffness agrees with it, else the smaller;
    never more than a tenth of the travel. Of a level that the data leave open (``open_``) the record's force is taken: F_s
    may come out many times too high."""
    seen = sizes.force / sizes.stiffness
    level = next((values[n] for n in ("F_s", "F_c") if n in values and n not in open_), sizes.force)
    fitted = level / values["sigma_0"] if values.get("sigma_0", 0.0) > 0 else seen
    length = fitted if seen / _BOTH < fitted < seen * _BOTH else min(seen, fitted)  # loops that slide tell nothing
    return min(length, _OF_TRAVEL * sizes.travel) if sizes.travel > 0 else length


def reachable(values: Mapping[str, float], sizes: Sizes, open_: Collection[str] = ()) -> dict[str, float]:
    """The numbers of what is advised, SI units: from the fitted constants where the data tell them and the record bears them
    out, within the speeds, the way and the sampling of the record.

    ``small``, ``large`` and ``fine``: total ways of reversals, and the resolution that these need; ``loop``, ``loop_fast``:
    largest speeds in slow and in fast reversals; ``slowest``, ``middle``, ``fast``: speeds of strokes; ``rate``, ``gentle``,
    ``half``: rates and size of the force.
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
    """What to measure, in words and numbers (:func:`reachable`); nothing for a level, whose speed was seen."""
    if name.startswith("level"):
        return ""
    if "_by_" in name and name not in _WORDS:
        return f"the same motions at three levels of {name.partition('_by_')[2]} or more, evenly over its range"
    words = _WORDS.get(name, "motions in which the force depends on it: reversals of several sizes and speeds")
    numbers = reachable(values, sizes, open_)
    units = {n: rotary_unit(_UNITS.get(n, "m/s")) if rotary else _UNITS.get(n, "m/s") for n in numbers}
    return words.format(**{n: f"{float(f'{x:.2g}'):g} {units[n]}" for n, x in numbers.items()})

"""Which experiment would determine a parameter that the data leave open."""

from __future__ import annotations

from collections.abc import Mapping

from stribeck.identify.features.guess import Sizes

_WORDS = {
    "sigma_0": "small reversals: move to and fro by {small} to {large} (total way), slower than {slow}, at least 20 "
    "samples in each, with a position resolution of {fine} or better",
    "sigma_1": "small and fast reversals: {small} to {large} (total way) at several frequencies, so that the speed in "
    "them reaches {slow} to {middle}; or steps of force from rest, rising at {rate} or faster",
    "sigma_2": "constant speeds in both directions up to {fast} or more, at least three of them above a third of that",
    "F_c": "constant speeds in both directions from {middle} up, long enough for the force to settle",
    "F_s": "constant speeds in both directions from {slowest} to {middle}, evenly spaced in the logarithm; or force "
    "ramps from rest at {gentle} or slower",
    "v_s": "constant speeds in both directions from {slowest} to {fast}, at least ten, evenly spaced in the logarithm",
    "mass": "accelerations at which mass * acceleration exceeds half the friction level ({half}), in both directions",
    "stiffness": "slow strokes over the whole travel, in both directions",
    "sigma_2_by_direction": "at least three constant speeds up to {fast}, the same in both directions",
    "drag": "constant speeds in both directions, at least five, evenly up to {fast} or more",
    "thinning": "constant speeds in both directions, at least five, evenly in the logarithm up to {fast} or more",
    "ripple_waves": "slow strokes over the whole travel, in both directions",
    "play": "slow reversals (below {slow}), each followed by a way of many times that over which friction turns round",
    "offset": "the same constant speeds in both directions",
}
_BOTH = 10.0  # factor between the fit's length and the record's, up to which the fit's is taken
_OF_TRAVEL = 0.1  # what presliding can be at most


def presliding_length(values: Mapping[str, float], sizes: Sizes) -> float:
    """The way to break-away, m: the fit's F_s/sigma_0 where the record's own stiffness agrees with it, else the
    smaller; never more than a tenth of the travel."""
    seen = sizes.force / sizes.stiffness
    level = values.get("F_s", values.get("F_c", sizes.force))
    fitted = level / values["sigma_0"] if values.get("sigma_0", 0.0) > 0 else seen
    length = fitted if seen / _BOTH < fitted < seen * _BOTH else min(seen, fitted)  # loops that slide tell nothing
    return min(length, _OF_TRAVEL * sizes.travel) if sizes.travel > 0 else length


def experiment_for(name: str, values: Mapping[str, float], sizes: Sizes) -> str:
    """What to measure, in words and numbers: from the fitted constants where the record bears them out, within what the
    rig reached in the record."""
    length = presliding_length(values, sizes)
    speed = values.get("v_s", 0.0)
    slowest = min(0.1 * speed, 1e-2 * sizes.fast) if 0 < speed < 0.3 * sizes.fast else 1e-3 * sizes.fast
    middle = (
        min(max(10 * speed, 0.03 * sizes.fast), 0.3 * sizes.fast) if slowest != 1e-3 * sizes.fast else 0.1 * sizes.fast
    )
    numbers = {
        "small": _show(0.5 * length, "m"), "large": _show(5 * length, "m"), "fine": _show(0.01 * length, "m"),
        "slowest": _show(slowest, "m/s"), "slow": _show(0.01 * sizes.fast, "m/s"),
        "middle": _show(middle, "m/s"), "fast": _show(sizes.fast, "m/s"),
        "rate": _show(100 * sizes.force, "N/s"), "gentle": _show(0.1 * sizes.force, "N/s"),
        "half": _show(0.5 * sizes.force, "N"),
    }  # fmt: skip
    if "_by_" in name and name not in _WORDS:
        return f"the same motions at three levels of {name.partition('_by_')[2]} or more, evenly over its range"
    words = _WORDS.get(name, "motions in which the force depends on it: reversals of several sizes and speeds")
    return words.format(**numbers)


def _show(value: float, unit: str) -> str:
    return f"{value:.2g} {unit}"

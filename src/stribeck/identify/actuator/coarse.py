"""Recordings with fewer samples, for a search that is far from the optimum.

The solver takes steps at every sample of a noisy input, and most of this noise moves no output by as much as the output's own
noise. A coarser input is the spline through fewer samples that is nearest to the input.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.interpolate import LSQUnivariateSpline

from stribeck.arrays import Array
from stribeck.identify.actuator.recordings import Channel, Recording

_FEWEST = 500  # samples of a coarse recording
_EVEN = 1e-3  # of a step


def coarser(recording: Recording, factor: int) -> Recording | None:
    """A recording with one of ``factor`` samples; None if its samples are uneven, too few would be left, or it is cut."""
    t, gaps = recording.t, np.diff(recording.t)
    if recording.window or len(t) < _FEWEST * factor or np.ptp(gaps) > _EVEN * gaps[0]:
        return None
    every = t[::factor]
    outputs = {name: _fewer(c, every) for name, c in recording.outputs.items()}
    inputs = {path: _smoother(c, every) for path, c in recording.inputs.items()}
    return replace(recording, t=every, outputs=outputs, inputs=inputs, as_well={})


def _fewer(channel: Channel, t: Array) -> Channel:
    """An output at the samples nearest to these times."""
    if len(channel.t) <= len(t):
        return channel
    rows = np.unique(np.clip(np.searchsorted(channel.t, t - 0.5 * np.diff(channel.t).min()), 0, len(channel.t) - 1))
    beside = {name: x[rows] for name, x in channel.beside.items()}
    return replace(channel, t=channel.t[rows], x=channel.x[rows], beside=beside)


def _smoother(channel: Channel, t: Array) -> Channel:
    """An input as the nearest signal of its kind with these samples: cubic, straight or held in between."""
    own, x = channel.bridged.t, channel.bridged.x
    if len(own) <= 2 * len(t):
        return channel
    inside = own <= t[-1]
    own, x = own[inside], x[inside]
    if channel.held:
        first = np.searchsorted(own, t - 0.5 * (own[1] - own[0]))
        return replace(channel, t=t, x=np.add.reduceat(x, first) / np.diff([*first, len(own)]))
    return replace(channel, t=t, x=LSQUnivariateSpline(own, x, t[1:-1], k=3 if channel.smooth else 1)(t))

"""Ranges of numbers in a sweep, and the values of every lane."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stribeck.arrays import Array
from stribeck.errors import InputError, arg, read_pairs

_MOST_LANES = 10**8  # a typing error in COUNT is reported before memory runs out


@dataclass(frozen=True)
class Range:
    """A range of one number: ``count`` values from first to last, evenly or logarithmically spaced."""

    path: str
    first: float
    last: float
    count: int
    log: bool = False

    @classmethod
    def parse(cls, text: str, drawn: bool = False) -> Range:
        """Read ``PATH=FIRST:LAST:COUNT[:log]``; for a random sample ``COUNT`` may be left out.

        Raises:
            InputError: if the text is not of this form.
        """
        form = "PATH=FIRST:LAST[:log]" if drawn else "PATH=FIRST:LAST:COUNT[:log]"
        path, sign, rest = text.partition("=")
        words = rest.split(":")
        log = words[-1] == "log"
        words = words[:-1] if log else words
        try:
            first, last = float(words[0]), float(words[1])
            count = int(words[2]) if len(words) > 2 or not drawn else 1
            is_range = sign and path.strip() and len(words) <= 3
        except (ValueError, IndexError):
            is_range = False
        if not is_range:
            raise InputError(f"{arg('vary')} {text!r}: must be {form}, such as law.k_v=1e6:1e8:5:log")
        if not (math.isfinite(first) and math.isfinite(last)):
            raise InputError(f"{arg('vary')} {text!r}: FIRST and LAST must be finite numbers")
        if not 1 <= count <= _MOST_LANES:
            raise InputError(f"{arg('vary')} {text!r}: COUNT must be a whole number from 1 to {_MOST_LANES}")
        if log and not (first > 0 and last > 0):
            raise InputError(f"{arg('vary')} {text!r}: FIRST and LAST must be > 0 for log")
        return cls(path.strip(), first, last, count, log)

    @property
    def values(self) -> Array:
        """The values, both ends included."""
        return self._scaled(np.linspace(0.0, 1.0, self.count) if self.count > 1 else np.zeros(1))

    def drawn(self, random: np.random.Generator, count: int) -> Array:
        """Random values between the ends, uniform (in the logarithm for ``log``)."""
        return self._scaled(random.random(count))

    def _scaled(self, share: Array) -> Array:
        if self.log:
            decades = math.log10(self.last) - math.log10(self.first)
            values = 10 ** (math.log10(self.first) + decades * share)
        elif math.isinf(self.last - self.first):
            values = self.first * (1 - share) + self.last * share
        else:
            values = self.first + (self.last - self.first) * share
        return np.where(share == 0, self.first, np.where(share == 1, self.last, values))


def lanes_of(ranges: Sequence[Range], samples: int | None = None, seed: int = 0) -> dict[str, Array]:
    """The values of every lane by path: the grid of the ranges, the last one fastest, or ``samples`` random points.

    Raises:
        InputError: if there is no range, if two have the same path, or if there are too many lanes.
    """
    if not ranges:
        raise InputError(f"{arg('vary')}: missing: must be given at least once, such as law.k_v=1e6:1e8:5:log")
    by_path = read_pairs(lambda r: (r.path, r), ranges, arg("vary"))
    count = math.prod(r.count for r in ranges) if samples is None else samples
    if not 1 <= count <= _MOST_LANES:
        what = "the grid has" if samples is None else arg("samples")
        raise InputError(f"{what} {count} lanes: must be from 1 to {_MOST_LANES}")
    if samples is not None:
        random = np.random.default_rng(seed)
        return {path: r.drawn(random, samples) for path, r in by_path.items()}
    grid = np.meshgrid(*(r.values for r in ranges), indexing="ij")
    return {path: values.reshape(-1) for path, values in zip(by_path, grid, strict=True)}

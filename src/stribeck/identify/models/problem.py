"""A fit as an optimiser sees it: coordinates, residuals, their derivatives."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from types import SimpleNamespace
from typing import ClassVar

import numpy as np

from stribeck.arrays import Array
from stribeck.errors import InputError
from stribeck.laws.base import Law

_FAILED = 1e3  # residual, in units of the data, where a simulation fails
_WALL = 1e3  # residual for a distance of one beyond what the law allows
_NOTHING = 1e-100  # of the largest derivative: none


@dataclass(frozen=True)
class Coordinate:
    """A number that is fitted.

    Inside, the optimiser sees its logarithm, or the number divided by ``scale``.

    Attributes:
        name: of the constant.
        unit: SI.
        low: smallest value that is tried; ``high``: the largest.
        log: fitted on a logarithmic scale.
        scale: natural size of one that is not.
        nuisance: belongs to the record, not to the machine, such as the deflection at its first sample.
        rows: the rows of the output that it can change; all where None.
    """

    name: str
    unit: str
    low: float
    high: float
    log: bool = True
    scale: float = 1.0
    nuisance: bool = False
    rows: slice | None = None

    def inner(self, value: float) -> float:
        """The number inside for a value."""
        return float(np.log(value)) if self.log else value / self.scale

    def outer(self, inner: float) -> float:
        """The value for a number inside."""
        return float(np.exp(inner)) if self.log else inner * self.scale


@dataclass(frozen=True)
class Tie:
    """A constant that is another one times a factor."""

    to: str
    factor: float = 1.0


class Problem(ABC):
    """Residuals of a model against a log as functions of the free coordinates.

    Args:
        law: the law that is fitted.
        coordinates: what is free.
        fixed: constants that are given.
        tied: constants that follow another one.
        measured: the output that the model is to meet, at the rows that count.
        scale: natural size of the output: residuals are divided by it.
    """

    step: ClassVar[float] = 1e-6  # of finite differences, in inner coordinates

    def __init__(
        self,
        law: type[Law],
        coordinates: Sequence[Coordinate],
        fixed: Mapping[str, float],
        tied: Mapping[str, Tie],
        measured: Array,
        scale: float,
    ) -> None:
        self.law, self.coordinates = law, tuple(coordinates)
        self.fixed, self.tied = dict(fixed), dict(tied)
        self.measured, self.scale = measured, scale
        self.home: Array | None = None  # a point that the law allows
        names = [c.name for c in self.coordinates]
        unknown = [
            f"tied.{n}: {t.to!r}: must be free or fixed" for n, t in tied.items() if t.to not in (*names, *fixed)
        ]
        if unknown:
            raise InputError(unknown)

    @abstractmethod
    def outputs(self, points: Array) -> Array | None:
        """The model's output at the rows that count for each point (lanes, coordinates); None where it fails.

        All lanes are computed as the first one needs, so that their differences are smooth.
        """

    # -- values ------------------------------------------------------------------------------------------------------

    def values(self, u: Array) -> dict[str, float]:
        """Every constant by name at a point."""
        found = {**self.fixed, **{c.name: c.outer(x) for c, x in zip(self.coordinates, u.tolist(), strict=True)}}
        return found | {name: tie.factor * found[tie.to] for name, tie in self.tied.items()}

    def point(self, values: Mapping[str, float]) -> Array:
        """The point of given values, within the bounds."""
        u = np.array([c.inner(values[c.name]) for c in self.coordinates])
        return np.asarray(np.clip(u, *self.bounds))

    @property
    def bounds(self) -> tuple[Array, Array]:
        """Lowest and highest point."""
        return (
            np.array([c.inner(c.low) for c in self.coordinates]),
            np.array([c.inner(c.high) for c in self.coordinates]),
        )

    def allowed(self, u: Array) -> bool:
        """Whether the law's relations between constants hold at a point."""
        values = SimpleNamespace(**self.values(u))
        return all(relation.holds(values) for relation in self.law.relations)

    def nearest(self, u: Array) -> Array:
        """The point, or the last allowed one on the way to it from :attr:`home`."""
        if self.home is None or self.allowed(u):
            return u
        good, bad = 0.0, 1.0
        for _ in range(50):
            middle = (good + bad) / 2
            good, bad = (middle, bad) if self.allowed(self.home + middle * (u - self.home)) else (good, middle)
        return np.asarray(self.home + good * (u - self.home))

    def length(self, values: Mapping[str, float]) -> float:
        """The law's natural length for given constants, m."""
        off = {
            n: c.choices[0] if c.choices else None for n, c in self.law.constants().items() if c.optional or c.choices
        }
        return self.law.scales(SimpleNamespace(**{**off, **values})).length

    # -- residuals ---------------------------------------------------------------------------------------------------

    def misfit(self, u: Array) -> Array | None:
        """Model minus measurement in units of the data."""
        out = self.outputs(self.nearest(u)[None, :])
        return None if out is None else out[0] - self.measured

    def residual(self, u: Array) -> Array:
        """What an optimiser makes small: scaled misfits, then the distances beyond what the law allows."""
        inside = self.nearest(u)
        out = self.outputs(inside[None, :])
        misfit = np.full(len(self.measured), _FAILED) if out is None else (out[0] - self.measured) / self.scale
        return np.concatenate([misfit, _WALL * (u - inside)])

    def jacobian(self, u: Array) -> Array:
        """The derivatives of :meth:`residual`, by differences between lanes of one simulation."""
        slopes, outward = self.slopes(u), u - self.nearest(u)
        whole = np.zeros((len(self.measured), len(u))) if slopes is None else self._spread(slopes)
        return np.vstack([whole, np.outer(outward / max(float(np.linalg.norm(outward)), 1e-300), self.wall(u))])

    def slopes(self, u: Array) -> Array | None:
        """The derivatives of the scaled misfits by what each lane moves, (rows, lanes); None where the simulation fails.

        Beyond what the law allows, the misfits are those of the allowed point, which moves along the wall.
        """
        inside = self.nearest(u)
        beyond = None if inside is u else [self.nearest(self._moved(u, lane)) for lane in self.lanes]
        found = self._slopes(inside, beyond)
        return None if found is None else found / self.scale

    def wall(self, u: Array) -> Array:
        """The derivatives of the length of the walls' residuals, with which :meth:`residual` ends, by each coordinate."""
        found, inside = np.zeros(len(u)), self.nearest(u)
        if inside is u:
            return found
        here = float(np.linalg.norm(u - inside))
        for i, c in enumerate(self.coordinates):
            if c.rows is None:  # no relation is about a record's own numbers
                moved = self._moved(u, [i])
                found[i] = _WALL * (float(np.linalg.norm(moved - self.nearest(moved))) - here) / self.step
        return found

    def _moved(self, u: Array, lane: Sequence[int]) -> Array:
        moved = u.copy()
        moved[lane] += self.step
        return moved

    def sensitivities(self, u: Array) -> Array | None:
        """The derivatives of the output by the inner coordinates, (rows, coordinates)."""
        found = self._slopes(u)
        return None if found is None else self._spread(found)

    def _slopes(self, u: Array, moved: Sequence[Array] | None = None) -> Array | None:
        out = self.outputs(np.array([u, *(moved or [self._moved(u, lane) for lane in self.lanes])]))
        return None if out is None else np.ascontiguousarray((out[1:] - out[0]).T / self.step)

    def _spread(self, slopes: Array) -> Array:
        result = np.zeros((len(slopes), len(self.coordinates)))
        for lane, moved in enumerate(self.lanes):
            for i in moved:
                where = self.coordinates[i].rows or slice(None)
                result[where, i] = slopes[where, lane]
        return result

    @cached_property
    def lanes(self) -> list[list[int]]:
        """The coordinates that are moved together: those that change different rows share a lane."""
        lanes = [[i] for i, c in enumerate(self.coordinates) if c.rows is None]
        shared: list[list[int]] = []
        ends: list[int] = []
        for i, c in enumerate(self.coordinates):
            if c.rows is None:
                continue
            free = next((k for k, end in enumerate(ends) if end <= c.rows.start), None)
            if free is None:
                shared.append([i])
                ends.append(c.rows.stop)
            else:
                shared[free].append(i)
                ends[free] = c.rows.stop
        return lanes + shared

    def describe(self, u: Array) -> dict[str, float]:
        """Values that belong to the machine, by name."""
        names = {c.name for c in self.coordinates if c.nuisance}
        return {name: value for name, value in self.values(u).items() if name not in names}


def linear_step(slopes: Array, change: Array) -> Array:
    """The least squares solution x of slopes x = change: how far a change of the output moves the coordinates. It is 0 for
    those that the output does not hang on."""
    size = np.sqrt(np.mean(slopes**2, axis=0))
    size = np.where(size > _NOTHING * max(float(np.max(size)), 1e-300), size, np.inf)
    return np.asarray(np.linalg.lstsq(slopes / size, change, rcond=1e-9)[0] / size)

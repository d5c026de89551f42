"""Numbers that are not sought and that the residuals show to be wrong: of a sensor, of the machine, or how inputs run between
their samples."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.actuator import fixed, sensors
from stribeck.identify.actuator.coordinates import MachineCoordinate
from stribeck.identify.actuator.driven import bent, otherwise_held
from stribeck.identify.actuator.estimate import POOR, BestPoint, leftovers, noise_of
from stribeck.identify.actuator.intervals import Spread, inverse, remembered, scores
from stribeck.identify.actuator.problem import MachineProblem
from stribeck.identify.actuator.solve import search

_SURE = 4.5  # deviations
_MATTERS = 0.02  # of what is left of the recordings that it concerns
_MOVES = 1.0  # deviations of a number: one that would move by more has no interval
_AS_WELL = 0.9  # of what the first explains: others that explain as much are named with it
_SHADOW = 0.8  # of what a term of friction explains: numbers that explain less are its shadows
_TWO_SIDED = 1.96  # deviations in half of an interval
_UNSURE = 0.2  # of a fixed number: one that must be off by more to matter is not named
_PLAUSIBLE = 2.5  # deviations: a way between samples that is not farther off is followed as well
_WHOLE = 0.5  # how far from 1 the share of the way to inputs held otherwise may be
_NAMED = 3
_BENT = "smooth between their samples, which are too far apart for straight lines (record them faster)"
_INPUTS = "inputs"  # a coordinate that cannot be sought
_TRIED, _STEPS, _ROUGHLY = 3, 12, 1e-3
_TOGETHER = 8  # fixed numbers that are sought together
_FEWER = 0.9  # of what one number more leaves: several must leave less
_LIKE = 1.3  # times the least that is left: reasons that explain as much (docs/reference/fit-files.md counts both)
_FAR_LESS = 0.6  # of what is left now
_STILL = 1.5  # times the noise: a reason that leaves more does not explain all


@dataclass(frozen=True)
class Suspect:
    """A number that may be wrong: the coordinate that it would be, what it is now, how far it would be off and its deviation;
    by how much the sum of squares would fall, and by what share of that of the recordings that it concerns; how far each
    coordinate would move; and what it is, in words."""

    coordinate: MachineCoordinate
    now: float
    off: float
    wide: float
    fall: float
    share: float
    moves: Array
    words: str = ""

    @property
    def sure(self) -> bool:
        """Whether the residuals show it."""
        return abs(self.off) > _SURE * self.wide and self.share > _MATTERS


@dataclass(frozen=True)
class Between:
    """Another way in which inputs may run between their samples: by what share of it residuals would be followed better, how
    far each coordinate would move with it, and what it is, in words."""

    share: Suspect
    reach: Array
    words: str

    @property
    def as_well(self) -> bool:
        """Whether the recordings are followed as well in that way."""
        return not self.share.sure and abs(self.share.off - 1) < _PLAUSIBLE * self.share.wide


def between(best: BestPoint, s: Spread) -> list[Between]:
    """The other ways in which inputs may run between their samples: first held (or straight, where they are held), then
    smooth."""
    smooth = bent(best.problem)
    ways = [otherwise_held(best.problem), None if smooth is None else (smooth, _BENT)]
    return [x for other, words in filter(None, ways) if (x := _instead(best, s, other, words)) is not None]


def unresolved(ways: Sequence[Between]) -> list[tuple[str, Array]]:
    """The ways that the recordings cannot tell from the one that was taken, in words, with how far they move numbers."""
    return [(f"inputs may as well be {x.words}", x.reach) for x in ways if x.as_well]


def numbers(best: BestPoint, s: Spread, ways: Sequence[Between]) -> list[Suspect]:
    """What each number that is not sought would be, and by what share inputs would bend between their samples."""
    problem = best.problem
    own = [replace(x, words=_words(problem, x)) for x in _suspects(problem, best.u, s.J, s.moved)]
    bends = [x.share for x in ways if x.words == _BENT and x.share.off > 0]
    return [*own, *(replace(x, words=f"inputs seem to be {_BENT}") for x in bends)]


def seen(
    best: BestPoint, s: Spread, suspected: Sequence[Suspect], terms: Sequence[Suspect], ways: Sequence[Between]
) -> tuple[list[str], bool]:
    """What is not sought but the residuals show, in words, with ``terms`` of friction that they show; and whether a number of
    it would move what is sought, so that no interval can be given without it."""
    found = sorted((x for x in suspected if x.sure), key=lambda x: -x.fall)
    terms = sorted(terms, key=lambda x: -x.fall)
    if terms and found and found[0].fall < _SHADOW * terms[0].fall:
        found = []
    found = [x for x in found if x.fall > _AS_WELL * found[0].fall][:_NAMED]  # the rest may be their shadows
    terms = [x for x in terms if not found or x.fall > _AS_WELL * found[0].fall][:1]
    for way in (x for x in ways if x.words != _BENT and x.share.sure and abs(x.share.off - 1) < _WHOLE):
        if all(way.share.fall > _AS_WELL * x.fall for x in [*found[:1], *terms]):
            text = (
                f"inputs {way.words} would be followed better: what is left would fall by {100 * way.share.share:.2g} %"
            )
            return [text], _moves(best, s, way.share)
    if not (found or terms):
        return [], False
    words = "; or ".join(x.words for x in [*found, *terms])
    names = " or ".join(x.coordinate.name for x in found if x.coordinate.name != _INPUTS)
    seek = f"; seek {names} if that can be" if names else ""
    return [f"{words}{seek}"], any(_moves(best, s, x) for x in found)


def taken_as_exact(best: BestPoint, s: Spread, farther: Array) -> list[str]:
    """The fixed numbers of the machine by which the intervals stand or fall, in words: no residual shows what the numbers
    sought can make up for. ``farther``: how far the interval of each coordinate reaches beyond its deviations."""
    problem, found = best.problem, list[tuple[float, str]]()
    asked = [i for i, c in enumerate(problem.sought) if not c.nuisance]
    for c, now, slopes in fixed.candidates(problem, best.u):
        moves = abs(s.covariance @ (s.J.T @ slopes))[asked] * abs(now)
        with np.errstate(all="ignore"):
            off = (_TWO_SIDED * s.deviations + farther)[asked] / moves
        moved = [problem.sought[asked[i]].name for i in np.argsort(off) if off[i] < _UNSURE]
        if moved:
            found.append(
                (float(off.min()), f"{c.name} is off by {100 * off.min():.2g} % ({', '.join(moved[:_NAMED])})")
            )
    told = [words for _, words in sorted(found)[:_NAMED]]
    if not told:
        return []
    return [
        f"what is fixed counts as exact; intervals miss where {'; or '.join(told)}: seek what is not sure, with a prior"
    ]


def tried(best: BestPoint) -> list[str]:
    """The number with which a machine that errs would follow its recordings far better, or the fixed numbers of the machine
    that are wrong together; those that do as well are named with it."""
    problem, u = best.problem, best.u
    r, J = (x[0] for x in problem.slopes(u[None], np.full(len(u), problem.step)))
    if not (np.isfinite(r).all() and np.isfinite(J).all()):
        return []
    before, told = leftovers(problem, u), _held_tried(problem, u)
    suspects = sorted(_suspects(problem, u, J, None), key=lambda x: -x.fall)
    of_machine = [x for x in suspects if x.coordinate.output is None]
    of_sensors = [x for x in suspects if x.coordinate.output is not None]
    for x in [*of_sensors[:_TRIED], *of_machine[:_TRIED]]:
        if (better := _with(problem, u, [x])) is not None:
            words = _words(problem, replace(x, off=better.values[0] - x.now, wide=0.0))
            told.append((better.share, f"{words}: with {x.coordinate.name} sought, {better.words(before)}"))
    together = of_machine[:_TOGETHER]
    told.sort()
    better = _with(problem, u, together) if len(together) > 1 else None
    if better is not None and (not told or better.share < _LIKE * min(told)[0]):
        order = sorted(zip(together, better.values, strict=True), key=lambda x: -abs(np.log(x[1] / x[0].now)))
        names = ", ".join(f"{x.coordinate.name} ({x.now:.3g}, then {value:.3g})" for x, value in order[:_NAMED])
        words = f"with {len(together)} fixed numbers sought too, {better.words(before)}; most move {names}"
        as_well = told and better.share > _FEWER * min(told)[0]
        told = [*told[: _NAMED - 1], (better.share, words)] if as_well else [(better.share, words)]
    told = [x for x in told if x[0] <= _LIKE * min(told)[0]][:_NAMED]
    return ["; or ".join(words for _, words in told)] if told else []


def _held_tried(problem: MachineProblem, u: Array) -> list[tuple[float, str]]:
    """Inputs that run otherwise between their samples, where that leaves far less: the share of it, and in words."""
    before, told, smooth = leftovers(problem, u), list[tuple[float, str]](), bent(problem)
    others = [otherwise_held(problem), None if smooth is None else (smooth, _BENT)]
    for other, words in filter(None, others):
        found = search(other, 1, 0, u, steps=_STEPS, small=_ROUGHLY)
        better = None if found.stopped else _better(before, other, found.u, [])
        if better is not None:
            told.append((_AS_WELL * better.share, f"with inputs {words}, {better.words(before)}"))
    return told


@dataclass(frozen=True)
class Better:
    """What is left with numbers sought that were not: the column that has most of what it had, by its noise too, and the
    numbers."""

    share: float
    column: str
    left: float
    by_noise: float
    values: list[float]

    def words(self, before: dict[str, tuple[float, float]]) -> str:
        """What is left, and was."""
        found = f"{self.left:.2g} of {self.column} is left, not {before[self.column][0]:.2g}"
        if not self.by_noise > _STILL:
            return found
        return f"{found} (still {self.by_noise:.2g} times its noise: more is wrong, or it is the law that errs)"


def _better(
    before: dict[str, tuple[float, float]], problem: MachineProblem, u: Array, values: list[float]
) -> Better | None:
    """What is left at a point, where that is far less than before."""
    after = leftovers(problem, u)
    shares = {c: after[c][0] / before[c][0] for c in after if before[c][0] > 0}
    if not shares:
        return None
    column = max(shares, key=lambda c: shares[c])
    left, size = after[column]
    if not left < min(_FAR_LESS * before[column][0], POOR * size):
        return None
    noise = noise_of(problem, column)
    return Better(shares[column], column, left, left / noise if noise > 0 else np.inf, values)


def _with(problem: MachineProblem, u: Array, suspects: Sequence[Suspect]) -> Better | None:
    """What is left where these numbers are sought too, if that is far less."""
    added = [x.coordinate for x in suspects]
    own = replace(problem, sought=[*problem.sought, *added], noise=dict(problem.noise))
    first = suspects[0].now + suspects[0].off if len(suspects) == 1 else None
    there = [c.inner(x.now if first is None else first) for c, x in zip(added, suspects, strict=True)]
    found = search(own, 1, 0, own.repaired(np.append(u, there)[None])[0], steps=_STEPS, small=_ROUGHLY)
    if found.stopped:
        return None
    values = [c.outer(x) for c, x in zip(added, found.u[len(u) :], strict=True)]
    return _better(leftovers(problem, u), own, found.u, values)


def _moves(best: BestPoint, s: Spread, x: Suspect) -> bool:
    """Whether what is asked for would move."""
    asked = [i for i, c in enumerate(best.problem.sought) if not c.nuisance]
    return bool((abs(x.moves[asked]) > _MOVES * s.deviations[asked]).any())


def _instead(best: BestPoint, s: Spread, other: MachineProblem, words: str) -> Between | None:
    """By what share of the way to other inputs the residuals would be followed better."""
    r = best.problem.residuals(best.u[None])[0]
    off, there = np.zeros(len(r)), other.residuals(best.u[None])[0]
    compared = int(best.problem.first[-1])  # priors and ties stay
    off[:compared] = there[:compared] - r[:compared]
    if not (np.isfinite(off).all() and off @ off > 0):
        return None
    share = suspect(best.problem, r, s.J, off, MachineCoordinate(_INPUTS, 0.0, 1.0), 0.0, s.moved)
    return Between(share, -s.covariance @ (s.J.T @ off), words)


def _suspects(problem: MachineProblem, u: Array, J: Array, moved: Array | None) -> list[Suspect]:
    """What each number that is not sought would be, from the slopes."""
    r = problem.residuals(u[None])[0]
    return [
        suspect(problem, r, J, slopes, c, now, moved)
        for candidates in (sensors.candidates, fixed.candidates)
        for c, now, slopes in candidates(problem, u)
    ]


def suspect(
    problem: MachineProblem, r: Array, J: Array, slopes: Array, c: MachineCoordinate, now: float, moved: Array | None
) -> Suspect:
    """A number from its slopes; ``moved``: residuals as noise of the inputs moves them, a row for each draw."""
    J = np.column_stack([J, slopes])
    covariance = inverse(J)
    move = -(covariance @ (J.T @ r))
    left = r + J @ move  # what is left with it
    lags, _, _ = remembered(problem, left)
    variance = max((covariance @ scores(problem, left, J, lags) @ covariance)[-1, -1], covariance[-1, -1])
    if moved is not None:
        variance = max(variance, covariance[-1, -1] + np.mean((moved @ (J @ covariance[-1])) ** 2))
    wide = np.sqrt(variance)
    own = r[sensors.rows(problem, c.log)]
    fall = float(r @ r) - float(left @ left)
    return Suspect(c, now, float(move[-1]), float(wide), fall, fall / max(float(own @ own), 1e-300), move[:-1])


def _words(problem: MachineProblem, x: Suspect) -> str:
    within = f" ± {2 * x.wide:.2g}" if x.wide else ""
    if x.coordinate.output is not None:
        return sensors.words(problem, x.coordinate, x.off, within)
    return f"{x.coordinate.name} is fixed at {x.now:.4g} and seems to be {x.now + x.off:.4g}{within}"

"""What the residuals ask for that a machine has not: terms of friction, and how far they would move what is sought."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.actuator.coordinates import MachineCoordinate
from stribeck.identify.actuator.estimate import BestPoint
from stribeck.identify.actuator.intervals import Ends, Spread
from stribeck.identify.actuator.probes import Probe, probes
from stribeck.identify.actuator.suspects import Suspect, suspect

_SURE = 4.0  # deviations: beyond chance, of some thirty terms that are tried
_PERHAPS = 2.5  # deviations: not beyond chance, but intervals reach as far as such a term would move them
_AS_WELL = 0.5  # of what the best explains
_EQUAL = 0.9  # of it: a term that explains so much is named with it
_OWN = 0.01  # of a term's slopes that what is sought cannot make up for: less, and residuals cannot show it
_ALIKE = 0.03  # of them: less, and it hangs on the record whether they do
_SAME = 2e-3  # of them: less, and it is no other term
_HALF = 1.96  # deviations in half of an interval
_SMALL = 0.05  # of the friction: a term that must be larger to matter is not named
_NAMED = 3
_LITTLE = 0.1  # deviations: not worth a line


@dataclass(frozen=True)
class Unsaid:
    """What the residuals ask for that is not in the machine, and how far that moves each coordinate down and up.

    Attributes:
        perhaps: terms of friction, and numbers that are not sought, that may be chance.
        terms: of friction, beyond chance.
        reach: how far from its interval each of ``perhaps`` moves each coordinate, a row for each.
        alike: what the numbers sought make up for (friction that grows with a force, inputs that run otherwise between their
            samples), in words, with how far it reaches.
        exact: how small a term may be that is not seen and matters, in words.
    """

    perhaps: list[Suspect]
    terms: list[Suspect]
    reach: Array
    alike: list[tuple[str, Array]] = field(default_factory=list)
    exact: list[str] = field(default_factory=list)

    @property
    def farther(self) -> Array:
        """How far intervals reach beyond what they are, at most, by coordinate."""
        every = np.vstack([self.reach, *(x for _, x in self.alike)])
        return np.asarray(abs(every).max(axis=0, initial=0.0))

    def wider(self, k: int, ends: Ends, low: float, high: float) -> Ends:
        """The ends of an interval as far out as that would move the number; open where it is beyond its bounds."""
        reach = np.array([*self.reach[:, k], *(x[k] for _, x in self.alike)])
        down = None if ends.low is None else ends.low + float(reach.min(initial=0.0))
        up = None if ends.high is None else ends.high + float(reach.max(initial=0.0))
        return replace(
            ends,
            low=down if down is not None and down > low else None,
            high=up if up is not None and up < high else None,
        )

    def notes(self, s: Spread, asked: list[int]) -> list[str]:
        """By how much intervals reach farther, in words."""
        told = []
        if (farther := _farthest(self.reach, s, asked)) > _LITTLE:
            what = "" if self.terms else f"{max(self.perhaps, key=lambda x: x.fall).words}, which may be chance; "
            told.append(
                f"{what}intervals reach up to {farther:.2g} deviations farther, to the side to which that would move them"
            )
        for words, reach in self.alike:
            if (farther := _farthest(reach[None], s, asked)) > _LITTLE:
                told.append(f"{words}: intervals reach up to {farther:.2g} deviations farther for it")
        return told


def _farthest(reach: Array, s: Spread, asked: list[int]) -> float:
    """How far that reaches at most, in deviations of a number."""
    return float((abs(reach)[:, asked] / s.deviations[asked]).max(initial=0.0))


def unsaid(best: BestPoint, s: Spread, numbers: Sequence[Suspect]) -> Unsaid:
    """The terms that the friction of a machine may lack, each by one step of Gauss and Newton from what was found, and those
    of the ``numbers`` not sought that residuals may ask for."""
    problem, every = best.problem, probes(best.problem, best.u)
    r, found, alike = problem.residuals(best.u[None])[0], list[Suspect](), list[tuple[str, Array]]()
    contacts = problem.runs[0].scenario.data["contacts"]
    for x in every:
        own = float(np.linalg.norm(rest := _rest(s, x)))
        hidden, seen = own < _ALIKE * np.linalg.norm(x.slopes), abs(rest @ r) >= _PERHAPS * own
        shown = seen and own > _OWN * np.linalg.norm(x.slopes)
        if not (shown or (hidden and x.force)):
            continue
        c = MachineCoordinate(f"{x.contact}.{x.term}", -1.0, 1.0)
        told = suspect(problem, r, s.J, x.slopes, c, 0.0, s.moved)
        if shown:
            found.append(replace(told, words=_words([told])))
        elif not contacts[x.contact].get("loads"):  # else the machine says how its friction grows
            alike.append(_grown(s, x, told))
    perhaps = [x for x in [*found, *(x for x in numbers if not x.sure)] if abs(x.off) > _PERHAPS * x.wide]
    terms = _named_together([x for x in found if abs(x.off) > _SURE * x.wide])
    most = max((x.fall for x in perhaps), default=0.0)
    perhaps = [x for x in perhaps if x.fall > _AS_WELL * most]
    moves = np.array([_reach(s, x) for x in perhaps]).reshape(-1, len(best.u))
    return Unsaid(perhaps, terms, moves, alike, _exact(best, s, every))


def _named_together(terms: list[Suspect]) -> list[Suspect]:
    """The terms, the first of which names those of its contact that explain as much: a size is that of its own term."""
    order = sorted(terms, key=lambda x: -x.fall)
    contact = order[0].coordinate.name.partition(".")[0] if order else ""
    as_much = [x for x in order if x.fall > _EQUAL * order[0].fall and x.coordinate.name.startswith(f"{contact}.")]
    return [replace(x, words=_words(as_much[:_NAMED])) if x is order[0] else x for x in order]


def _grown(s: Spread, x: Probe, told: Suspect) -> tuple[str, Array]:
    """Friction that grows with a force, which only adds to it, in words, and how far from the interval as it is that with it
    ends: what is sought makes up for it, so the size that residuals allow moves numbers far."""
    per = -(s.covariance @ (s.J.T @ x.slopes))
    wider = np.hypot(s.deviations, per * told.wide) - s.deviations
    reach = per * told.off + np.sign(per) * _HALF * wider
    most = max(told.off, 0.0) + _HALF * told.wide
    words = (
        f"friction of {x.contact} that grows with the force of {x.force} (a gear's; up to {100 * most:.2g} % of the friction) "
        f'would look alike; if there is none, contacts.{x.contact}.loads = [{{ force = "{x.force}", F_c = 0 }}] says so'
    )
    return words, np.where(reach * per > 0, reach, 0.0)


def _reach(s: Spread, x: Suspect) -> Array:
    """How far from the interval as it is that with the term ends, on the side to which the term moves each coordinate."""
    wider = np.hypot(s.deviations, x.moves * x.wide / x.off) - s.deviations
    return np.asarray(x.moves + np.sign(x.moves) * _HALF * wider)


def _words(terms: Sequence[Suspect]) -> str:
    """What a contact seems to lack: one of these terms."""
    contact = terms[0].coordinate.name.partition(".")[0]
    sizes = [
        f"{x.coordinate.name.partition('.')[2]}, {100 * abs(x.off):.2g} ± {200 * x.wide:.2g} % of its friction"
        for x in terms
    ]
    return f"the friction of {contact} seems to lack a term ({'; or as well '.join(sizes)})"


def _exact(best: BestPoint, s: Spread, every: list[Probe]) -> list[str]:
    """The terms that no residual would show and that make an interval miss all the same, in words, with their sizes."""
    asked = [i for i, c in enumerate(best.problem.sought) if not c.nuisance]
    least: dict[str, tuple[float, str]] = {}
    for x in every:
        own = float(np.linalg.norm(_rest(s, x)))
        with np.errstate(all="ignore"):
            sizes = _HALF * s.deviations[asked] / abs(s.covariance @ (s.J.T @ x.slopes))[asked]
        size = float(sizes.min(initial=np.inf))
        if own > _SAME * np.linalg.norm(x.slopes) and size < _SMALL and size * own < _SURE:
            name = best.problem.sought[asked[int(np.argmin(sizes))]].name
            words = f"{x.term} of {100 * size:.2g} % of the friction of {x.contact} ({name})"
            kind = f"{x.contact}.{x.term.partition(' below ')[0]}"
            least[kind] = min(least.get(kind, (np.inf, "")), (size, words))
    told = [words for _, words in sorted(least.values())[:_NAMED]]
    if not told:
        return []
    return [
        f"the form of the friction counts as exact; intervals miss where it has another term unseen: {'; or '.join(told)}"
    ]


def _rest(s: Spread, x: Probe) -> Array:
    """What of a term's slopes the numbers sought cannot make up for."""
    return np.asarray(x.slopes - s.J @ (s.covariance @ (s.J.T @ x.slopes)))

"""Decisions about the five properties of a law, with fixed constants or for every history within ranges.

If constants vary, above all the level (F_c and F_s), the worst of all laws in the range decides (theory, "A level that
varies").
"""

from __future__ import annotations

import importlib
import logging
from collections.abc import Callable, Iterator
from fractions import Fraction
from functools import cached_property, partial
from itertools import islice
from math import e

import numpy as np

from stribeck import laws
from stribeck.constants import POSITIVE, show
from stribeck.errors import InputError, arg, needed
from stribeck.laws.base import Law
from stribeck.laws.terms import m_0
from stribeck.properties import bounded, cycles, damped, drift, endless, passive, smooth, stateless, unique
from stribeck.properties.certificate import Certificate
from stribeck.properties.claims import NULL, ClaimProver
from stribeck.properties.model import Model, Unreadable
from stribeck.properties.plain import Json
from stribeck.properties.prover.search import Budget
from stribeck.properties.storage import own_speeds
from stribeck.properties.verdicts import NAMES, Verdict, Verdicts, accepted, proved, undecided
from stribeck.properties.worst import BRISTLES, MAJORANT, Varied

_log = logging.getLogger(__name__)

# Shares of the work: passivity and uniqueness divide the plane of v and z into many regions, the others into few. The sum
# is above 1, because few laws use all of a share.
SHARES = {"bounded": 0.2, "unique": 0.5, "smooth": 0.1, "passive": 0.65, "drift_free": 0.1}
_PROVED = (
    "the dissipated power, F v - S' dz/dt, is never negative at the worst level (signs of polynomials), with the elastic energy "
    "as storage S; at other levels it is larger (theory.md)"
)
_BOUNDED = "for |z| >= Z = (highest level)/sigma_0, dz/dt points inward or is 0, for every v and every level"
_SWING = "a cycle of constant speeds and levels returns z to its start and draws energy (bounds by interval arithmetic)"
_DROPPED = (
    "wound up at the highest level and unwound at the lowest: F v <= -c v^2 and |dz/dt| <= C |v| for z from z_start to z_end "
    "and |v| >= u (signs over the whole range): the energy drawn grows with |v| without limit"
)
_HELD = "at a constant level: "
_SAME = "at every level, as proved at the lowest one (theory.md): "
_UNKNOWN = "the worst level is known only for the laws of this package; no run that draws energy was found"
_ENDLESS = Fraction(3)  # of the threshold: swing of a level without an upper end
_HIGH = Fraction(1000)  # the same with v_d, for which all losses during winding up count
_TRIED = 4  # largest number of cycles to simulate
_DROPS = (
    1e-2,
    1e-4,
    1e-6,
    1e-9,
    1e-12,
)  # of the bound: start of unwinding below it; near the threshold only small values draw energy


def check_law(law: Law, v_max: float | None, work: float) -> Verdicts:
    """The verdicts on a law whose constants do not vary."""
    checked = Checked(law, v_max, work)
    return _verdicts(Verdicts(law, {}, v_max), lambda name: accepted(checked.decided(name), law, name, v_max))


def check_varied(varied: Varied, v_max: float | None, work: float) -> Verdicts:
    """The verdicts that hold for every history within the ranges."""
    verdicts = Verdicts(varied.law, {}, v_max, varied=varied)
    return _verdicts(verdicts, CheckedAlways(varied, v_max, work).decided)


def _verdicts(verdicts: Verdicts, decided: Callable[[str], Verdict]) -> Verdicts:
    """Each property; undecided if the equations make the check fail, and all but passivity if a law has no z."""
    with needed("a proof"):
        importlib.import_module("flint")
    if not verdicts.law.has_z:
        decided = partial(stateless.decide, verdicts.varied or Varied(verdicts.law, {}), verdicts.v_max)
    with np.errstate(all="ignore"):  # samples may overflow; they prove nothing
        verdicts.properties = {name: _safely(decided, name) for name in NAMES}
    return verdicts


def _safely(decided: Callable[[str], Verdict], name: str) -> Verdict:
    try:
        return decided(name)
    except (OverflowError, ZeroDivisionError) as error:
        _log.debug("the values of '%s' exceed the floating-point range", name, exc_info=True)
        return undecided(f"an intermediate result exceeds the floating-point range ({error})")
    except Exception as error:
        _log.debug("the check of '%s' failed", name, exc_info=True)
        return undecided(f"the equations cannot be treated: {type(error).__name__}: {error}")


class Checked:
    """Decides the properties, each with a fixed share of ``work``, so that none depends on the others."""

    def __init__(self, law: Law, v_max: float | None, work: float) -> None:
        self.law, self.v_max, self.work = law, v_max, work

    def decided(self, name: str) -> Verdict:
        """The verdict on one property."""
        try:
            verdict: Verdict = getattr(self, name)()
        except Unreadable as error:
            verdict = undecided(str(error))
        return verdict

    @cached_property
    def model(self) -> Model:
        """The law's equations."""
        return Model(self.law, self.v_max)

    def claims(self, name: str) -> ClaimProver:
        """A prover with its share of the work."""
        return ClaimProver(self.model, Budget(SHARES[name] * self.work))

    @cached_property
    def _bounded(self) -> tuple[Verdict, Certificate | None]:
        return bounded.decide(self.model, self.claims("bounded"))

    def bounded(self) -> Verdict:
        """|z| <= Z at all times."""
        return self._bounded[0]

    def unique(self) -> Verdict:
        """One solution."""
        return unique.decide(self.model, self.claims("unique"), self._bounded[1])

    def smooth(self) -> Verdict:
        """Continuously differentiable."""
        return smooth.decide(self.model, self.claims("smooth"))

    def passive(self) -> Verdict:
        """The contact returns no more energy than it received."""
        verdict, certificate = self._bounded
        return passive.decide(self.model, self.claims("passive"), certificate, verdict.holds is False)

    def drift_free(self) -> Verdict:
        """Elastic below some deflection."""
        return drift.decide(self.model, self.claims("drift_free"))


# -- constants that vary ------------------------------------------------------------------------------------------------


def at_level(law: Law, level: tuple[float, float]) -> Varied:
    """The law with the ranges of a level.

    Raises:
        InputError: ``level`` is not a range, the law has no level, or an end is not allowed.
    """
    low, high = level if isinstance(level, tuple | list) and len(level) == 2 else (0, 0)
    if POSITIVE.problem(low) or POSITIVE.problem(high) or low > high:
        raise InputError(f"{arg('level')}: {show(level)}: must be two finite numbers, 0 < LOW <= HIGH")
    this = f"{arg('level')}: {show([low, high])}: law '{law.name}'"
    if "F_c" not in law.values:
        raise InputError(f"{this} has no F_c, and so no level that could vary")
    varied = Varied.by_level(law, low, high)
    try:
        varied.extreme(-1), varied.extreme(1)
    except InputError as error:
        raise InputError([f"{this}: {text}" for text in error.problems]) from None
    return varied


class CheckedAlways:
    """Decides the properties of a law whose constants vary, each for every history within their ranges."""

    def __init__(self, varied: Varied, v_max: float | None, work: float) -> None:
        self.varied, self.v_max, self.work = varied, v_max, work
        kind = type(varied.law)
        self.known = kind.name in BRISTLES and laws.builtin().get(kind.name) is kind
        self._held: dict[tuple[int, str], Verdict] = {}

    def decided(self, name: str) -> Verdict:
        """The verdict on one property."""
        by_property = {"bounded": self.bounded, "passive": self.passive}
        try:
            return by_property[name]() if name in by_property else self.at_lowest_level(name)
        except (InputError, Unreadable, ArithmeticError) as error:
            return undecided(f"the law cannot be treated at every level: {error}")

    def held(self, side: int, name: str) -> Verdict:
        """The verdict at a constant level, one end of the range."""
        if (side, name) not in self._held:
            self._held[side, name] = Checked(self._end(side, name), self.v_max, self.work).decided(name)
        return self._held[side, name]

    def _end(self, side: int, name: str) -> Law:
        """The law at one end of the level; for freedom from drift, the one with the smallest elastic range."""
        return self.varied.extreme(side, _ENDLESS, least=("z_ba",) if name == "drift_free" else ())

    def _with_level(self, name: str, verdict: Verdict, law: Law) -> Verdict:
        assert verdict.certificate is not None
        verdict.certificate = {**verdict.certificate, "level": self.varied.exactly()}
        verdict.law = law
        return accepted(verdict, law, name, self.v_max)

    def at_lowest_level(self, name: str) -> Verdict:
        """Unique, smooth or drift_free: for this package's laws, the lowest level decides for all levels."""
        verdict = self.held(-1, name)
        if verdict.holds:
            if not self.known and self.varied.varies:
                return undecided(f"it holds at the lowest level; {_UNKNOWN.partition(';')[0]}")
            verdict.method = _SAME + verdict.method
            return self._with_level(name, verdict, self._end(-1, name))
        return self._at_end(-1, name, verdict)

    def _at_end(self, side: int, name: str, verdict: Verdict) -> Verdict:
        """A counterexample at one end of the level, marked as such."""
        if verdict.holds is False:
            verdict.method = _HELD + verdict.method
            verdict.law = self._end(side, name)
        return verdict

    def bounded(self) -> Verdict:
        """|z| <= highest level/sigma_0."""
        law = self.varied.highest() if self.known else None
        if law is None:
            held = self.held(-1, "bounded")
            if held.holds is False:
                return self._at_end(-1, "bounded", held)
            return undecided(
                "the level has no upper end, and z no bound that holds at all of them" if self.known else _UNKNOWN
            )
        model = Model(law)
        certificate = bounded.prove(model, ClaimProver(model, Budget(SHARES["bounded"] * self.work)))
        if certificate is None:
            return undecided("no proof was found at the highest level")
        return self._with_level("bounded", proved(model, certificate, _BOUNDED, {"Z": float(model.bound[1])}), law)

    # -- passive -----------------------------------------------------------------------------------------------------

    def passive(self) -> Verdict:
        """No history of speed and level draws energy."""
        verdict = self._passive()
        if self.known and "sigma_1" in self.varied.law.values:
            verdict.evidence |= thresholds(self.varied)
        verdict.evidence["v_max"] = self.v_max
        return verdict

    def _passive(self) -> Verdict:
        refused: Verdict | None = None
        for law, proof in self._shown():
            verdict = self._with_level("passive", proof, law)
            if verdict.holds:
                return verdict
            refused = refused or verdict
        unknown = _UNKNOWN if not self.known else "neither a proof nor a run that draws energy was found"
        return self._refuted() or refused or undecided(unknown)

    def _shown(self) -> Iterator[tuple[Law, Verdict]]:
        """Candidate proofs and their laws, the simplest first."""
        within, anywhere = self.varied.worst(), self.varied.worst(any_z=True)
        if within is not None and (proof := self._proved(within, False)) is not None:
            yield within, proof
        if anywhere is not None:
            if self.known and (proof := self._damped(anywhere)) is not None:
                yield anywhere, proof
            # otherwise D < 0 for large z and v
            falls = not anywhere.values.get("sigma_1") or anywhere.values.get("v_d") is not None
            if falls and (proof := self._proved(anywhere, True)) is not None:
                yield anywhere, proof
        if not self.varied.varies and (held := self.held(-1, "passive")).holds:
            yield self._end(-1, "passive"), held

    def _proved(self, law: Law, any_z: bool) -> Verdict | None:
        model = Model(law, self.v_max)
        claims = ClaimProver(model, Budget(0.5 * SHARES["passive"] * self.work))
        within = None if any_z else bounded.prove(model, claims)
        if within is None and not any_z:
            return None
        reach = model.bound[1] if within is not None else None
        slope = next(passive.elastic_forces(model))
        rising = claims.rising(slope, (NULL, reach))
        certificate = None if rising is None else passive.by_storage(model, claims, slope, rising, within)
        if certificate is None:
            return None
        evidence = {"z_within": None if reach is None else float(reach), **self._theorem(law, any_z)}
        return proved(model, certificate, _PROVED, evidence)

    def _damped(self, law: Law) -> Verdict | None:
        model = Model(law)
        certificate = damped.prove(model, ClaimProver(model, Budget(0.5 * SHARES["passive"] * self.work)))
        if certificate is None:
            return None
        words = f"at the lowest level: {damped.method(certificate)}"
        return proved(model, certificate, words, {"z_within": None, **self._theorem(law, True)})

    def _theorem(self, law: Law, any_z: bool) -> dict[str, Json]:
        """The theorem of proofs/Level.v for every set of constants, if its condition holds; ``law`` is the worst."""
        nominal, varying = self.varied.law, {n for n, (a, b) in self.varied.ranges.items() if a != b}
        proved_there = ("lugre", "elastoplastic", *MAJORANT)
        if nominal.name not in proved_there or nominal.values.get("delta") is not None or varying - {"F_c", "F_s"}:
            return {}
        if self.v_max is not None or any_z != (nominal.values.get("v_d") is not None):
            return {}
        low, high = self.varied.newtons
        if any_z:
            met = damped.suffices(law)
        else:
            sigma_1, sigma_2 = (self.varied.range(n)[0] for n in ("sigma_1", "sigma_2"))
            met = high is not None and sigma_1 * (high - low) <= sigma_2 * low and sigma_1 * damped.excess(law) <= high
        form = nominal.choices.get("smooth_abs", "atan")
        word = "" if form == "atan" else f"_{form}"
        return {"coq": f"{nominal.name}{word}_level_passive{'_damped' if any_z else ''}"} if met else {}

    def _refuted(self) -> Verdict | None:
        low, high = self.varied.extreme(-1), self.varied.extreme(1, self._most())
        if self.varied.varies and (refutation := self._by_swing(low, high)) is not None:
            return refutation
        for side in (-1, 1):
            held = self.held(side, "passive")
            if held.holds is False:
                return self._at_end(side, "passive", held)
        return self._dropped(low, high) if self.known and self.v_max is None else None

    def _by_swing(self, low: Law, high: Law) -> Verdict | None:
        """A cycle that certainly draws energy; one that a simulation confirms is preferred."""
        refutations: list[Verdict] = []
        for swing in islice(cycles.find_swings(low, high, self.v_max), _TRIED):
            if (drawn := swing.drawn()) is not None:
                evidence = {**swing.evidence(), "enclosed": {"energy_drawn_per_cycle": list(drawn)}}
                refutations.append(Verdict(False, _SWING, evidence))
                cycles.add_run(refutations[-1], swing.machine(self.varied.law), "contact.z")
                if refutations[-1].scenario is not None:
                    return refutations[-1]
        return refutations[0] if refutations else None

    def _most(self) -> Fraction:
        """The swing of a level without an upper end: beyond the threshold of the constants."""
        p = {n: self.varied.range(n) for n in ("sigma_1", "sigma_2") if n in self.varied.law.values}
        if not p or not p["sigma_1"][1]:
            return _ENDLESS
        if self.varied.law.values.get("v_d") is not None:
            return _HIGH
        return _ENDLESS * (1 + p["sigma_2"][0] / p["sigma_1"][1])

    def _dropped(self, low: Law, high: Law) -> Verdict | None:
        """A counterexample at the lowest level: unwinding from the highest deflection returns more energy at higher speed."""
        model, top = Model(low), float(high.z_bound(high.p)) * (1 - 2**-52)
        for share in _DROPS:
            refutation = endless.unwinding(model, (1, 1), own_speeds(low)[-1] * 100 / share, top, share)
            if refutation is not None:
                refutation.method = _DROPPED
                refutation.evidence["levels"] = [
                    {n: x.p.numbers[n] for n in ("F_c", "F_s") if n in x.values} for x in (high, low)
                ]
                return refutation
        return None


def thresholds(varied: Varied) -> dict[str, float | None]:
    """The limits within which the contact is passive at every level.

    They are the least sigma_2, the largest v_d, and the largest F_s with the other constants fixed. The last is None if F_c
    alone is too large.
    """
    low, high = varied.newtons
    sigma_1, sigma_2 = varied.range("sigma_1")[1], varied.range("sigma_2")[0]
    limits: dict[str, float | None] = {"largest_v_d": largest_v_d(varied)}
    if sigma_1 is None or not sigma_1:
        return {**limits, "sigma_2_needed": 0.0 if sigma_1 == 0 else None}
    limits["sigma_2_needed"] = None if high is None else float(sigma_1 * (high - low) / low)
    most = low * (1 + sigma_2 / sigma_1)
    F_c = varied.range("F_c")[1] if varied.law.values.get("F_c") is not None else low
    limits["largest_F_s"] = None if F_c is None or F_c > most else float(most)
    return limits


def largest_v_d(varied: Varied) -> float | None:
    """The largest v_d with which the contact is passive for every history of its level, m/s; formula of theory.md.

    None if there is none: sigma_1 m(0) is too large (a larger k_v helps), or sigma_1 is 0.
    """
    law, (low, _), sigma_1 = varied.law, varied.newtons, varied.range("sigma_1")[1]
    if not sigma_1 or law.name not in BRISTLES or law.name.endswith("sobczyk"):
        return None
    excess = float(m_0(law.p)) if law.name in MAJORANT else 0.0
    v_d = (2 * e) ** 0.5 * (4 * float(low) / float(sigma_1) - excess)
    return v_d * (1 - 1e-15) if v_d > 0 else None

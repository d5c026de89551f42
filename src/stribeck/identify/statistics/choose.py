"""Which model: terms of the body, and laws, by the error over data that were left out."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import islice
from typing import TypedDict

import numpy as np

from stribeck import laws
from stribeck.errors import InputError, StribeckError, arg, first_line, with_marks
from stribeck.identify.details import AddedTerm, Candidate, FitDetails
from stribeck.identify.log import INTEGRAL, Log
from stribeck.identify.methods.optimise import STOPPED
from stribeck.identify.methods.static import (
    Setting,
    Settled,
    check_motion,
    finished,
    missed_beyond,
    settle,
)
from stribeck.identify.models import play, terms
from stribeck.identify.models.ripple import range_of, share
from stribeck.identify.models.static_problem import Rows, rows_of
from stribeck.identify.models.terms import OF_POSITION, RIPPLE, TERMS
from stribeck.identify.result import Fit
from stribeck.identify.statistics import crossvalidate, reversals
from stribeck.identify.statistics.alike import bounded, told_apart, too_heavy
from stribeck.identify.statistics.crossvalidate import beyond_chance
from stribeck.identify.statistics.lacking import beside, open_terms
from stribeck.identify.statistics.static_intervals import untold
from stribeck.identify.statistics.suspects import turns

_TRIED = 3  # terms that lower the residual most, whose error on data left out is computed
_WORTH = 0.01  # of the error: less gain does not pay for another number
_HALF = 0.5  # of the error on data left out: so much is no chance, however few moments it comes from
_UNBOUNDED = ("stiffness", "F_c_by_position")  # grow on along a longer way
_EXPLAINS = 0.82  # of the error: they must leave no more, as hysteresis and backlash look a little like them
_AS_FAST = 0.7  # of the faster direction's speeds: what the slower one must reach for a slope of its own
_AT_END = 0.99  # of the longest delay that is tried
_PAIRED = {"gravity_sin": "gravity_cos", "gravity_cos": "gravity_sin"}  # an angle of unknown zero needs both
BASELINES = {"least squares": "coulomb_viscous", "tanh-Stribeck": "stribeck_tanh"}
_RIPPLE = " and ".join(RIPPLE)  # it takes the place of no weight or spring that is as good: these have fewer numbers
_BEFORE_ITS_END = "the fit was stopped before its end"
_CANDIDATES = ("coulomb_viscous", "stribeck", "stribeck_tanh")


class LawRow(TypedDict):
    """One law of several, in a table: its errors over data left out and over all, how many numbers it has, and which of
    these the data do not tell."""

    law: str
    cross_validated_error: float | None
    numbers: int
    relative_force_error: float
    unidentified: list[str]
    picked: bool


@dataclass(frozen=True)
class Choice:
    """Several laws fitted to one log.

    Attributes:
        fits: by what was asked for, in order.
        picked: the one to use; ``reason`` says why.
        failed: laws that could not be fitted, and why.
    """

    fits: dict[str, Fit]
    picked: str
    reason: str
    failed: dict[str, str]

    @property
    def best(self) -> Fit:
        """The fit to use."""
        return self.fits[self.picked]

    def table(self) -> list[LawRow]:
        """A row for each law."""
        return [
            {
                "law": name, "cross_validated_error": fit.cross_validated_error, "numbers": len(fit.names),
                "relative_force_error": fit.relative_force_error, "unidentified": list(fit.unidentified),
                "picked": name == self.picked,
            }
            for name, fit in self.fits.items()
        ]  # fmt: skip

    def to_json(self) -> dict[str, object]:
        """The picked law's fit, with the table."""
        return {**self.best.to_json(), "laws": self.table(), "reason": self.reason, "failed": self.failed}


def choose(fits: dict[str, Fit], failed: dict[str, str]) -> Choice:
    """The law to take: the simplest of those that predict data left out as well as the best does.

    Raises:
        InputError: none could be fitted.
    """
    candidates = {n: f.details["left_out"] for n, f in fits.items() if "left_out" in f.details}
    if not candidates:
        raise InputError(
            [f"{arg('law')}: {name!r}: {with_marks(why)}" for name, why in failed.items()]
            or f"{arg('law')}: no law could be compared"
        )
    picked, reason = crossvalidate.choose(candidates)
    return Choice(fits, picked, reason, failed)


# -- terms -----------------------------------------------------------------------------------------------------------


def select_terms(log: Log, law: str, setting: Setting, tell: Callable[[float], None] | None = None) -> Fit:
    """Add terms to a static fit one by one, each time the one that lowers the error over left-out blocks most.

    It stops where the best of the rest lowers it by less than a hundredth, or by less than chance would. The steps stand in
    ``details["selection"]``; ``details["candidates"]`` has what least squares and a tanh-Stribeck curve come to.
    """
    check_motion(log)
    terms.check(tuple(setting.body), log)
    rows, reached = rows_of(log, setting.decimate), _Reached()
    try:
        found, steps = _forward(rows, law, reached.keep(settle(rows, law, setting)), tell, reached)
        found, instead = bounded(found, setting.body)
        fit = told_apart(reversals.named(finished(rows, found)), found, setting.body, instead)
        compared = _compared(fit, rows, setting, found)
    except KeyboardInterrupt:
        return reached.stopped()
    return replace(compared, details={**compared.details, "selection": steps})


def fit_with_baselines(log: Log, law: str, setting: Setting) -> Fit:
    """The fit that is asked for, and in ``details["candidates"]`` what plainer models come to on data left out."""
    check_motion(log)
    terms.check(tuple(setting.body), log)
    rows, reached = rows_of(log, setting.decimate), _Reached()
    try:
        settled = reached.keep(settle(rows, law, setting))
        fit = reversals.looked_for(reversals.named(finished(rows, settled)), settled)
        return _compared(fit, rows, setting, settled)
    except KeyboardInterrupt:
        return reached.stopped()


class _Reached:
    """The best model so far, for when Ctrl-C comes."""

    def __init__(self) -> None:
        self.best: Settled | None = None

    def keep(self, settled: Settled) -> Settled:
        """The same, which is kept where it foretells data left out better than the one before."""
        if self.best is None or settled.left_out.error < self.best.left_out.error:
            self.best = settled
        return settled

    def stopped(self) -> Fit:
        """The fit so far: its values, none of which is called known, as what was not looked at would widen intervals.

        Raises:
            KeyboardInterrupt: nothing was found yet.
        """
        if self.best is None:
            raise KeyboardInterrupt
        judged = untold(self.best.model, self.best.solution, _BEFORE_ITS_END)
        fit = finished(self.best.rows, self.best, judged=judged)
        return replace(fit, status="stopped", notes=(STOPPED, *fit.notes))


def _compared(fit: Fit, rows: Rows, setting: Setting, settled: Settled) -> Fit:
    """The fit with what plainer models come to on data left out, and a note where one of them is better."""
    plainer = _plainer(rows, setting)
    found = [*(_row(name, each) for name, each in plainer.items()), _row("this fit", settled)]
    better = min(plainer, key=lambda n: plainer[n].left_out.error, default="")
    if better and plainer[better].left_out.error < (1 - _WORTH) * settled.left_out.error:
        least = plainer[better]
        told = f"{better} ({least.model.law.name}) predicts data left out better: {least.left_out.error:.3%}"
        if beyond_chance(least.left_out, settled.left_out) or least.left_out.error < _HALF * settled.left_out.error:
            fit = beside(fit, least.solution.values)
            told += ", beyond chance, so that intervals are wider by what it differs by"
        fit = replace(fit, notes=(f"{told}; where no law is named, the best law and terms are looked for", *fit.notes))
    return replace(fit, details={**fit.details, "candidates": found})


def select_law(log: Log, setting: Setting, tell: Callable[[float], None] | None = None) -> Fit | Choice:
    """The static law and the terms that predict data left out best, with the plainer ones beside it.

    Least squares (Coulomb, viscous and an offset) and the tanh-Stribeck curve that a few lines of SciPy would fit are among
    the candidates, so that nothing worse than they are is picked. Ctrl-C ends it with the best so far.
    """
    check_motion(log)
    rows, reached = rows_of(log, setting.decimate, to_choose=True), _Reached()
    try:
        return _law_of(rows, setting, tell, reached)
    except KeyboardInterrupt:
        return reached.stopped()


def _law_of(rows: Rows, setting: Setting, tell: Callable[[float], None] | None, reached: _Reached) -> Choice:
    plain: dict[str, Settled] = {}
    failed: dict[str, str] = {}
    for law in _CANDIDATES:
        try:
            plain[law] = reached.keep(settle(rows, law, _for_law(setting, law)))
        except StribeckError as error:
            failed[law] = first_line(error)
    if not plain:
        raise InputError([f"{arg('law')}: {name!r}: {with_marks(why)}" for name, why in failed.items()])
    start = min(plain, key=lambda n: plain[n].left_out.error)
    best, steps = _forward(rows, start, plain[start], tell, reached, steepness=False)
    best, instead = bounded(best, setting.body)
    wider: dict[str, tuple[Settled, list[AddedTerm]]] = {start: (best, steps)}
    for law, narrow in plain.items():
        if law != start and narrow.setting.body != best.setting.body:
            try:
                with_terms = replace(narrow.setting, body=best.setting.body)
                at = settle(rows, law, with_terms, [best.shapes, narrow.shapes])
                wider[law] = at, [_step("(as asked)", narrow), _step(", ".join(best.setting.body), at)]
            except StribeckError as error:
                failed.setdefault(law, first_line(error))
    settled = {**plain, **{f"{law}, selected": s for law, (s, _) in wider.items() if _differs(s, plain[law])}}
    picked, reason = crossvalidate.choose({n: s.left_out for n, s in settled.items()})
    fits, plainer = {}, [_row(name, each) for name, each in _plainer(rows, setting).items()]
    for name, each in settled.items():
        law = name.removesuffix(", selected")
        fit = finished(rows, each, profiles=name == picked)
        if name == picked:
            fit = told_apart(reversals.named(fit), each, setting.body, instead if each is best else None)
        details: FitDetails = {**fit.details, "candidates": [*plainer, _row("this fit", each)]}
        if name != law:
            details["selection"] = wider[law][1]
        fits[name] = replace(fit, details=details)
    return Choice(fits, picked, reason, failed)


def _differs(one: Settled, other: Settled) -> bool:
    return (tuple(one.setting.body), one.setting.free) != (tuple(other.setting.body), other.setting.free)


def _plainer(rows: Rows, setting: Setting) -> dict[str, Settled]:
    """Least squares and a tanh-Stribeck curve of the same rows, with the asked-for terms only."""
    found = {}
    for name, law in BASELINES.items():
        plain = Setting(
            {n: v for n, v in setting.fixed.items() if n in TERMS},
            None,
            setting.mass,
            setting.body,
            folds=setting.folds,
        )
        try:
            found[name] = settle(rows, law, plain)
        except StribeckError:
            continue
    return found


def _row(name: str, at: Settled) -> Candidate:
    errors = _step("", at)
    return {
        "name": name, "law": at.model.law.name, "numbers": at.left_out.parameters, "values": _numbers(at),
        "cross_validated_error": errors["cross_validated_error"], "relative_force_error": errors["relative_force_error"],
    }  # fmt: skip


def _numbers(at: Settled) -> dict[str, float]:
    return {n: v for n, v in at.solution.values.items() if not (n == "delay" and v == 0)}


def _forward(
    rows: Rows, law: str, best: Settled, tell: Callable[[float], None] | None, reached: _Reached, steepness: bool = True
) -> tuple[Settled, list[AddedTerm]]:
    steps = [_step("(as asked)", best)]
    while True:
        trials: dict[str, Settled] = {}
        names = [n for n in _open(rows, law, best.setting) if steepness or n != "k_v"]
        names = [n for n in names if n != _RIPPLE or _ripples(best)]
        for k, name in enumerate(names):
            try:
                trials[name] = settle(
                    rows,
                    law,
                    _wider(best.setting, law, name),
                    [reversals.start(best) if name == "play" else best.shapes],
                    everywhere=False,
                )
            except StribeckError:
                continue
            if tell is not None:
                tell(min(0.1 + 0.15 * (len(steps) - 1 + k / len(names)), 0.9))
        if not trials:
            return best, steps
        by_cost = sorted(trials, key=lambda n: trials[n].solution.cost)
        likely = list(islice((n for n in by_cost if _credible(n, trials[n], best)), _TRIED))
        if not likely:
            return best, steps
        name = min(likely, key=lambda n: trials[n].left_out.error * (1.0 if n != _RIPPLE else 1 / (1 - _WORTH)))
        found = trials[name]
        if found.left_out.error > (1 - _WORTH) * best.left_out.error or not beyond_chance(
            found.left_out, best.left_out
        ):
            return best, steps
        best = reached.keep(found)
        steps.append(_step(name, found))


def _ripples(at: Settled) -> bool:
    """Whether the residual ripples over the position by as much as a term must be worth: to fit it takes time."""
    whole = at.model.whole
    counted, found = whole.weight > 0, range_of(at.rows.log, at.rows.q)
    left = (whole.force - whole.force_at(at.solution.values))[counted]
    return found is not None and share(whole.columns.position[counted], left, *found) > _WORTH


def _credible(added: str, wide: Settled, narrow: Settled) -> bool:
    """Whether a term may be taken to another motion.

    A delay at the end of what is tried is none. A term of the position, told by a part of the way, must help on the rest of it:
    what imitates cogging over half a tooth, or backlash, grows without bound on a longer way.
    """
    values, names = wide.solution.values, set(added.split(" and "))
    for shape in wide.model.whole.shapes:
        if shape.name == "delay" and abs(values["delay"]) > _AT_END * shape.high:
            return False
    if not reversals.credible(wide):
        return False
    if not names & set(OF_POSITION):
        return True
    if names & set(_UNBOUNDED) and wide.left_out.error > _EXPLAINS * narrow.left_out.error:
        return False
    if names & set(_PAIRED) and too_heavy(wide):
        return False
    return bool(np.all(missed_beyond(wide) <= missed_beyond(narrow)))


def _open(rows: Rows, law: str, setting: Setting) -> list[str]:
    """The terms that may be added, and k_v where the law has one.

    Beside a weight the level is not let grow with the position: it imitates friction that grows with what the arm carries, which
    comes to an end on the turn where a straight line grows on. A direction that is slower by far has no slope of its own, which
    would go on beyond its speeds; with a smooth sign levels by direction are no offset.
    """
    log, own = rows.log, laws.find(law).constants()
    there = (*setting.body, *setting.fixed)
    names = open_terms(log, there, "F_c" in own)
    if set(_PAIRED) & set(there):
        names = [n for n in names if n != "F_c_by_position"]
    names += [f"{n} and {_PAIRED[n]}" for n in names if n == "gravity_sin" and _PAIRED[n] in names]
    if not set(RIPPLE) & set(there) and log.sources.get("position") != INTEGRAL and range_of(log, rows.q):
        names.append(_RIPPLE)
    if "play" not in there and play.range_of(log):
        names.append("play")
    free = setting.free or ()
    slower, faster = sorted((-float(log.velocity.min()), float(log.velocity.max())))
    if slower < _AS_FAST * faster:
        names = [n for n in names if n != "sigma_2_by_direction"]
    if "k_v" not in own or "k_v" in setting.fixed:
        return names
    if not own["k_v"].required and "k_v" not in free:
        return ["k_v", *names]
    if "F_c" in own and "offset" in there and "F_c_by_direction" not in there and turns(log.velocity):
        names.append("F_c_by_direction")
    return names


def _wider(setting: Setting, law: str, name: str) -> Setting:
    if name == "k_v":
        return _free_steepness(setting, law)
    return replace(setting, body=(*setting.body, *name.split(" and ")))


def _free_steepness(setting: Setting, law: str) -> Setting:
    """The setting with k_v to be fitted, where the law has one that is not given."""
    found = laws.find(law)
    if "k_v" not in found.constants() or "k_v" in setting.fixed or found.has_z:
        return setting
    free = setting.free if setting.free is not None else [n for n in found.uses if n not in setting.fixed]
    return setting if "k_v" in free else replace(setting, free=(*free, "k_v"))


def _for_law(setting: Setting, law: str) -> Setting:
    own = laws.find(law).constants()
    return replace(setting, fixed={n: v for n, v in setting.fixed.items() if n in own or n in TERMS}, free=None)


def _step(name: str, at: Settled) -> AddedTerm:
    whole, w = at.model.whole, at.model.whole.weight > 0
    missed = (whole.force - whole.force_at(at.solution.values))[w]
    return {
        "added": name, "cross_validated_error": at.left_out.error,
        "relative_force_error": float(np.linalg.norm(missed) / np.linalg.norm(whole.force[w])),
    }  # fmt: skip

"""Which model: terms of the body, and laws, by the error over data that were left out."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from stribeck import laws
from stribeck.errors import InputError, StribeckError, arg
from stribeck.identify.log import Log
from stribeck.identify.methods.static import Setting, fit_static
from stribeck.identify.models.terms import TERMS
from stribeck.identify.result import Fit
from stribeck.identify.statistics import crossvalidate

_WORTH = 0.01  # of the error: less gain does not pay for another number


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

    def table(self) -> list[dict[str, Any]]:
        """A row for each law."""
        return [
            {
                "law": name, "cross_validated_error": fit.cross_validated_error, "numbers": len(fit.names),
                "relative_force_error": fit.relative_force_error, "unidentified": list(fit.unidentified),
                "picked": name == self.picked,
            }
            for name, fit in self.fits.items()
        ]  # fmt: skip

    def to_json(self) -> dict[str, Any]:
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
            [f"{arg('law')}: {name!r}: {why}" for name, why in failed.items()]
            or f"{arg('law')}: no law could be compared"
        )
    picked, reason = crossvalidate.choose(candidates)
    return Choice(fits, picked, reason, failed)


def select_terms(log: Log, law: str, setting: Setting, tell: Any = None) -> Fit:
    """Add terms to a static fit one by one, each time the one that lowers the error over left-out blocks most.

    It stops where the best of the rest lowers it by less than a hundredth. The steps stand in ``details["selection"]``.
    """
    open_terms = [
        n for n, t in TERMS.items()
        if n not in ("mass", *setting.body)
        and (not t.needs or getattr(log, t.needs) is not None)
        and (not t.level or "F_c" in laws.find(law).constants())
    ]  # fmt: skip
    own = laws.find(law).constants()
    extra = ["k_v"] if "k_v" in own and "k_v" not in setting.fixed else []
    best = fit_static(log, law, setting, profiles=False)
    steps: list[dict[str, Any]] = [_step("(as asked)", best)]
    while open_terms or extra:
        trials: dict[str, tuple[Setting, Fit]] = {}
        for name in [*open_terms, *extra]:
            wider = _wider(setting, law, name)
            try:
                trials[name] = wider, fit_static(log, law, wider, profiles=False)
            except StribeckError:
                continue
        if not trials:
            break
        name = min(trials, key=lambda n: trials[n][1].cross_validated_error or 0.0)
        wider, found = trials[name]
        if (found.cross_validated_error or 0.0) > (1 - _WORTH) * (best.cross_validated_error or 0.0):
            break
        setting, best = wider, found
        steps.append(_step(name, found))
        open_terms, extra = [n for n in open_terms if n != name], [n for n in extra if n != name]
    final = fit_static(log, law, setting)
    return replace(final, details={**final.details, "selection": steps})


def _wider(setting: Setting, law: str, name: str) -> Setting:
    if name in TERMS:
        return replace(setting, body=(*setting.body, name))
    found = laws.find(law)
    free = list(setting.free) if setting.free is not None else [n for n in found.uses if n not in setting.fixed]
    return replace(setting, free=(*free, name))


def _step(name: str, fit: Fit) -> dict[str, Any]:
    return {
        "added": name, "cross_validated_error": fit.cross_validated_error,
        "relative_force_error": fit.relative_force_error,
    }  # fmt: skip

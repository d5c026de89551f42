"""What a fit says of friction that turns round over a way behind a reversal."""

from __future__ import annotations

from dataclasses import replace

from stribeck.errors import StribeckError
from stribeck.identify.methods.static import Settled, settle
from stribeck.identify.models import play
from stribeck.identify.result import Fit
from stribeck.identify.statistics.crossvalidate import beyond_chance

_MISSED = 0.05  # of the force: a fit that misses less is not searched again
_WORTH = 0.9  # of the error on data left out, which play leaves at most where it is spoken of
_CAUSES = (
    "backlash between what is measured and what rubs, or a contact that yields (a law with bristles, fitted by simulation, "
    "tells its stiffness)"
)


def start(narrow: Settled) -> dict[str, float]:
    """Where a fit with play begins: a smooth sign of the narrower one may have stood in for it."""
    sharp = {s.name: s.high for s in narrow.model.whole.shapes if s.name == "k_v"}
    return {**narrow.shapes, **sharp}


def credible(at: Settled) -> bool:
    """Whether a way was found, and not an end of the search."""
    shapes = (s for s in at.model.whole.shapes if s.name == "play")
    return not any(play.at_an_end(at.solution.values["play"], s.low, s.high) for s in shapes)


def named(fit: Fit) -> Fit:
    """The fit, which says what its play is."""
    if "play" not in fit.body:
        return fit
    told = f"play: behind a reversal friction turns round over {fit.used['play']:.3g} m (or rad): {_CAUSES}"
    return replace(fit, notes=(told, *fit.notes))


def looked_for(fit: Fit, at: Settled) -> Fit:
    """A fit of named terms that misses much, with a note where play would explain that."""
    setting, log = at.setting, at.rows.log
    if fit.relative_force_error < _MISSED or "play" in (*setting.body, *setting.fixed) or not play.range_of(log):
        return fit
    try:
        wide = settle(
            at.rows, at.model.law.name, replace(setting, body=(*setting.body, "play")), [start(at)], everywhere=False
        )
    except StribeckError:
        return fit
    less = wide.left_out.error < _WORTH * at.left_out.error and beyond_chance(wide.left_out, at.left_out)
    if not (less and credible(wide)):
        return fit
    told = (
        f"behind each reversal the force turns round over some {wide.solution.values['play']:.2g} m (or rad), and not at once: "
        f"{_CAUSES}; the term play would lower the error on data left out from {at.left_out.error:.2%} to "
        f"{wide.left_out.error:.2%}"
    )
    return replace(fit, notes=(told, *fit.notes))

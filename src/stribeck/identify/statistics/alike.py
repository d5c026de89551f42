"""A weight and a spring, which a part of a turn may not tell apart: on a longer way they part."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from stribeck.errors import StribeckError
from stribeck.identify.methods.static import Settled, missed_beyond, settle
from stribeck.identify.result import Fit
from stribeck.identify.statistics.crossvalidate import beyond_chance
from stribeck.identify.statistics.lacking import open_terms

_SPRING, _WEIGHT = "stiffness", ("gravity_sin", "gravity_cos")
_HEAVIEST = 2.0  # of the largest force: no heavier weight, with the offset, is taken from a part of a turn
_AS_GOOD = 1.05  # of the squared error at both ends of the way


def too_heavy(at: Settled) -> bool:
    """Whether the weight that was found would exceed, somewhere on a turn, by far what was measured."""
    values, turn = at.solution.values, np.linspace(0, 2 * np.pi, 100)
    weight = values.get("gravity_sin", 0.0) * np.sin(turn) + values.get("gravity_cos", 0.0) * np.cos(turn)
    largest = float(np.max(abs(weight + values.get("offset", 0.0))))
    return largest > _HEAVIEST * float(np.max(abs(at.rows.log.force)))


def bounded(at: Settled, asked: Sequence[str]) -> tuple[Settled, Settled | None]:
    """What was found, with a weight in place of a spring that was not asked for, where that predicts data left out, and the ends
    of the way, as well: on a longer way a spring grows without bound, and a weight does not. And the other of the two, where
    there are two."""
    own = [n for n in (_SPRING, *_WEIGHT) if n in (*at.setting.body, *asked, *at.setting.fixed)]
    if _SPRING not in at.setting.body or set(own) & {*asked, *at.setting.fixed} or len(own) > 1:
        return at, None
    instead = _instead(at)
    if instead is None or beyond_chance(at.left_out, instead.left_out):
        return at, instead
    spring, weight = abs(at.solution.values[_SPRING]), abs(instead.solution.values[_WEIGHT[0]])
    if weight > np.pi * spring:  # more than the spring on half a turn: the way lies where a sine is flat
        return at, instead
    ends = [float(np.sum(missed_beyond(each))) for each in (instead, at)]
    return (instead, at) if ends[0] <= _AS_GOOD * ends[1] else (at, instead)


def _instead(at: Settled) -> Settled | None:
    """The same with a weight in place of the spring, or the other way round."""
    body = at.setting.body
    own = [n for n in (_SPRING, *_WEIGHT) if n in body]
    rest = tuple(n for n in body if n not in own)
    other = [n for n in ((_WEIGHT[0],) if own == [_SPRING] else (_SPRING,)) if n in open_terms(at.rows.log, rest, True)]
    if not other:
        return None
    try:
        return settle(at.rows, at.model.law.name, replace(at.setting, body=(*rest, *other)), [at.shapes])
    except StribeckError:
        return None


def told_apart(fit: Fit, at: Settled, asked: Sequence[str], instead: Settled | None = None) -> Fit:
    """The fit; its spring or weight, unless asked for, is not told where the other predicts data left out as well.

    Args:
        fit, at: what was found.
        asked: the terms that the user named.
        instead: the same with a weight in place of the spring, or the other way round, where that was settled.
    """
    body = at.setting.body
    own = [n for n in (_SPRING, *_WEIGHT) if n in body]
    if not own or set(own) & set(asked) or (_SPRING in own and len(own) > 1):
        return fit
    instead = instead or _instead(at)
    if instead is None:
        return fit
    log, other = at.rows.log, [n for n in (_SPRING, *_WEIGHT) if n in instead.setting.body]
    if beyond_chance(at.left_out, instead.left_out):
        return fit
    why = f"{other[0]} in its place predicts data left out as well: on this way a spring and a weight are alike"
    body_now = {
        n: replace(e, value=None, identifiable=False, why=why, best=e.value) if n in own and e.identifiable else e
        for n, e in fit.body.items()
    }
    told = (
        f"{' and '.join(own)} or {other[0]}: on a way of {float(np.ptp(log.position)):.2g} they predict data left out alike "
        f"({at.left_out.error:.2%} and {instead.left_out.error:.2%}), and part on a longer one: name the one that it is as a term"
    )
    return replace(fit, body=body_now, notes=(told, *fit.notes))

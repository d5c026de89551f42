"""A weight and a spring, which a part of a turn may not tell apart: on a longer way they part."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from stribeck.errors import StribeckError
from stribeck.identify.methods.static import Settled, settle
from stribeck.identify.result import Fit
from stribeck.identify.statistics.crossvalidate import beyond_chance
from stribeck.identify.statistics.lacking import open_terms

_SPRING, _WEIGHT = "stiffness", ("gravity_sin", "gravity_cos")


def told_apart(fit: Fit, at: Settled, asked: Sequence[str]) -> Fit:
    """The fit; its spring or weight, unless asked for, is not told where the other predicts data left out as well.

    Args:
        fit, at: what was found.
        asked: the terms that the user named.
    """
    body = at.setting.body
    own = [n for n in (_SPRING, *_WEIGHT) if n in body]
    if not own or set(own) & set(asked) or (_SPRING in own and len(own) > 1):
        return fit
    rest = tuple(n for n in body if n not in own)
    log = at.rows.log
    other = [n for n in ((_WEIGHT[0],) if own == [_SPRING] else (_SPRING,)) if n in open_terms(log, rest, True)]
    if not other:
        return fit
    try:
        instead = settle(at.rows, at.model.law.name, replace(at.setting, body=(*rest, *other)), [at.shapes])
    except StribeckError:
        return fit
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

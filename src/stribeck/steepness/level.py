"""What keeps a contact passive while its level varies: the largest v_d, and what it costs (docs/theory.md)."""

from __future__ import annotations

from dataclasses import dataclass
from math import exp

import numpy as np

from stribeck.arrays import Array
from stribeck.errors import InputError, arg
from stribeck.laws.base import Law
from stribeck.laws.terms import m_0
from stribeck.properties.damped import largest, suffices
from stribeck.properties.level import at_level, largest_v_d, thresholds
from stribeck.properties.worst import MAJORANT

LEVELLED = ("lugre", "lugre_arctan", "elastoplastic", *MAJORANT)
_POINTS = 400


@dataclass(frozen=True)
class LevelAdvice:
    """Two ways to a contact that is passive whatever its level does.

    Attributes:
        low, high: the level, as factors of F_c and F_s.
        v_d: the largest speed constant of the damping with which it is passive, m/s, however high the level rises; None
            where none will do: then k_v must be larger than ``k_v_above``, s/m.
        v_d_limit: the largest v_d that there is, m/s: with a larger one a level that rises high enough and falls draws
            energy, by a load of some kind (theory.md); ``v_d`` is the part of it that one line of arithmetic shows. None
            where there is none, or for an elasto-plastic law with so small a k_v that it is not known.
        k_v_above: see ``v_d``; 0 for a law without k_v.
        steady_change: by how much v_d changes the steady friction at most, as a share of it, up to ``v_max``: computed.
        damping_at_v_s: the share of sigma_1 that is left at v_s.
        sigma_2: without v_d, the sigma_2 that would be needed, N s/m; None where no sigma_1 is in the way.
        steady_change_by_sigma_2: by how much that would change the steady friction at most, as a share.
        passive_now: whether the constants given are passive at this level, by the conditions of theory.md.
    """

    low: float
    high: float
    v_d: float | None
    v_d_limit: float | None
    k_v_above: float
    steady_change: float
    damping_at_v_s: float | None
    sigma_2: float | None
    steady_change_by_sigma_2: float | None
    v_max: float
    passive_now: bool


def level_advice(law: Law, low: float, high: float, v_max: float) -> LevelAdvice:
    """The answer for a law with its constants; v_d, if it has one, is left out of account but for ``passive_now``.

    Raises:
        InputError: a law of another form.
    """
    if law.name not in LEVELLED:
        raise InputError(
            f"{arg('level')}: law '{law.name}': must be one with bristles that v_d can make passive: {', '.join(LEVELLED)}"
        )
    varied = at_level(law, (low, high))
    v_d, bounds = largest_v_d(varied), thresholds(varied)
    sigma_2, p = bounds["sigma_2_needed"], law.p
    bounded = law.name != "lugre_arctan"
    excess = float(m_0(p)) if law.name in MAJORANT else 0.0
    above = 0.0
    if law.name in MAJORANT:
        above = float(m_0(p)) * p.k_v * p.sigma_1 / (4 * low * p.F_c)
    speeds = np.geomspace(1e-4 * law.scales(p).speed, v_max, _POINTS)
    now = np.asarray(law.steady_force(speeds))
    changed = 0.0
    if v_d is not None:
        changed = _largest_change(_with(law, v_d=v_d), speeds, now)
    by_sigma_2 = None
    if sigma_2 is not None and sigma_2 > p.sigma_2 and bounded:
        by_sigma_2 = _largest_change(_with(law, sigma_2=sigma_2), speeds, now)
    small = p.sigma_1 * excess <= high * p.F_s
    constant = bounded and small and sigma_2 is not None and p.sigma_2 >= sigma_2
    known = not law.name.startswith("elastoplastic") or p.sigma_1 * excess <= 2 * low * p.F_c
    left = exp(-((p.v_s / v_d) ** 2)) if v_d else None
    return LevelAdvice(
        low, high, v_d, largest(varied.extreme(-1)) if known else None, above, changed, left, sigma_2 if bounded else None,
        by_sigma_2, v_max, bool(constant or suffices(varied.worst(any_z=True))),
    )  # fmt: skip


def _with(law: Law, **changes: float) -> Law:
    return type(law)({**law.machine, **law.values, **law.choices, **changes}, law.rotary)


def _largest_change(other: Law, speeds: Array, now: Array) -> float:
    return float(np.max(abs(np.asarray(other.steady_force(speeds)) / now - 1)))

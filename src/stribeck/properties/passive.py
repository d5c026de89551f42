"""Passivity from v to F."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction

import numpy as np

from stribeck.expressions.graph import ZERO, Expr, derivative, is_zero, substitute, wrap
from stribeck.expressions.ops import where
from stribeck.properties import cycles, damped, enclosed, fitted
from stribeck.properties.certificate import Certificate, Claim
from stribeck.properties.claims import NULL, ClaimProver
from stribeck.properties.endless import steady_gain, without_limit
from stribeck.properties.model import RATE, SIGNS, Model, U, V, W, Z, depends, divided
from stribeck.properties.storage import Storage, largest_speed
from stribeck.properties.verdicts import Verdict, proved, undecided

_PATIENCE = 3  # times its share of the work: a cell that needs more ends the fit
_OWN = "the dissipated power, F v - S' dz/dt, is never negative (signs of polynomials), with the elastic energy as storage S"
_FITTED = (
    "the dissipated power, F v - S' dz/dt, is never negative (signs of polynomials), with S' the elastic force near z = 0 and "
    "fitted to [L, U] beyond"
)
_STORED = "the elastic energy, sigma_0 z^2/2 for a linear spring"
_GIVEN_BACK = "the energy that the bristles return when unwound slowly: S' = F v/(dz/dt) as v -> 0"
_CYCLE = "a cycle of constant speeds returns z to its start and draws energy (bounds by interval arithmetic)"


def decide(model: Model, claims: ClaimProver, bounded: Certificate | None, refuted: bool) -> Verdict:
    """Passive with a proved storage function, or not passive with unlimited energy that can be drawn.

    Args:
        model: the law.
        claims: the prover.
        bounded: proof that z keeps its bound; without it, proofs do not restrict z.
        refuted: whether z can pass its bound; if not, a counterexample keeps z within it.
    """
    v_max = float(model.v_max) if model.v_max is not None else None
    reach = float(model.bound[1]) if bounded is not None else None
    storage = Storage(model.law, v_max, reach)
    small = damped.prove(model, claims)
    if small is not None:
        verdict: Verdict | None = proved(model, small, damped.method(small), {"storage": _STORED, "z_within": None})
    else:
        verdict = _proved(model, claims, storage, bounded) if storage.exists else None
    if verdict is None or verdict.holds is None:
        within = Storage(model.law, v_max, None if refuted else float(model.bound[0]))
        no = _refuted(model, within, refuted) if verdict is None or not within.exists or refuted else None
        verdict = (
            no
            or verdict
            or undecided("by sampling, no storage function exists, but no run that draws energy was confirmed")
        )
    verdict.evidence["v_max"] = v_max
    if v_max is None and verdict.holds is not True:
        verdict.evidence["sampled_v_max"] = largest_speed(model.law, reach)
    return verdict


def elastic_forces(model: Model) -> Iterator[Expr]:
    """Candidates for S': the slope of the law's stored energy, F at rest, and the energy returned by slow unwinding."""
    slope = derivative(model.stored, Z)
    if not is_zero(slope):
        yield slope
    try:
        at_rest = substitute([model.force], {V: wrap(0.0), RATE: wrap(0.0)})[0]
    except (ZeroDivisionError, TypeError):
        return
    if not is_zero(at_rest) and at_rest is not slope and depends(at_rest, Z):
        yield at_rest
    if is_zero(at_rest):
        yield ZERO
    elif (slow := _slowly_unwound(model, at_rest)) is not None:
        yield slow


def _slowly_unwound(model: Model, at_rest: Expr) -> Expr | None:
    """F v/f for small v that unwinds z, a lower bound of S'."""
    sides = []
    for t in SIGNS:  # f/|v| at v -> 0, from the side that unwinds
        ratio = divided(model.form(-t, t), U)
        if ratio is None:
            return None
        sign = -t
        while ratio.op == "neg":
            ratio, sign = ratio.args[0], -sign
        top, bottom = ratio.args if ratio.op == "div" else (ratio, wrap(1.0))
        sides.append(substitute([at_rest * bottom / (top * sign)], {U: wrap(0.0), W: Z * t})[0])
    return wrap(where(Z >= 0.0, *sides))


def _numeric(model: Model, slope: Expr) -> fitted.Slope:
    return lambda z: np.asarray(model.numeric([slope], z=z)[0]) + 0 * z


def _proved(model: Model, claims: ClaimProver, storage: Storage, bounded: Certificate | None) -> Verdict:
    reach = model.bound[1] if bounded is not None else None
    top = float(model.bound[1]) if reach is not None else storage.largest
    bounds = {
        "z_within": None if reach is None else float(reach),
        "speeds": "all" if model.v_max is None else f"|v| <= {float(model.v_max):g}",
    }
    reasons = []
    for slope in elastic_forces(model):
        rising = claims.rising(slope, (NULL, reach))
        if rising is None:
            reasons.append("the elastic energy has no least value")
            continue
        served = fitted.serves(storage, _numeric(model, slope), top)
        if served.all():
            certificate = by_storage(model, claims, slope, rising, bounded)
            if certificate is not None:
                evidence = {"storage": _STORED if slope.op != "where" else _GIVEN_BACK, **bounds}
                return proved(model, certificate, _OWN, evidence)
            reasons.append("no proof was found with the elastic energy as storage")
        elif bounded is not None and served[0]:
            cells = fitted.fit(storage, _numeric(model, slope), top, served)
            verdict = None if cells is None else _with_cells(model, claims, cells, slope, rising, bounded)
            if verdict is not None:
                verdict.evidence.update(bounds)
                return verdict
            reasons.append("no proof was found with a fitted storage function")
        else:
            reasons.append("the elastic energy is no storage function near z = 0")
    reason = "no proof: " + ("; ".join(dict.fromkeys(reasons)) or "the stored energy of the law is unknown")
    return undecided(reason, sampled="samples allow a storage function", **bounds)


def by_storage(
    model: Model, claims: ClaimProver, slope: Expr, rising: list[Claim], bounded: Certificate | None
) -> Certificate | None:
    """The proof with a storage function of this slope, for all z or, with the proof of its bound, for z within it."""
    reach = model.bound[1] if bounded is not None else None
    shown = claims.power(slope, (NULL, model.v_max), (NULL, reach), (*SIGNS, 0))
    hypotheses = {"bounded": bounded} if bounded is not None else {}
    return Certificate("passive", "storage", [*shown, *rising], {"slope": slope}, hypotheses) if shown else None


def _with_cells(
    model: Model, claims: ClaimProver, cells: fitted.Fitted, slope: Expr, rising: list[Claim], bounded: Certificate
) -> Verdict | None:
    """The proof with slopes fitted on cells of z."""
    reach = model.bound[1]
    u, elastic_reach = (NULL, model.v_max), Fraction(cells.elastic_up_to)
    shown = claims.power(slope, u, (NULL, elastic_reach), (*SIGNS, 0))
    if shown is None:
        return None
    table = []
    most = _PATIENCE * claims.work.left / len(cells.slope)
    for low, high, value in zip(cells.low, cells.high, cells.slope, strict=True):
        side = 1 if high > 0 else -1
        ends = sorted(abs(Fraction(float(x))) for x in (low, high))
        if abs(float(ends[1]) - float(reach)) <= 1e-12 * float(reach):
            ends[1] = reach
        number = model.number(Fraction(float(value)))
        with claims.at_most(most):
            part = claims.power(number, u, (ends[0], ends[1]), (side,))
        if part is None:
            return None
        shown += part
        table.append([side, ends[0], ends[1], Fraction(float(value))])
    data = {"slope": slope, "own_up_to": elastic_reach, "cells": table}
    certificate = Certificate("passive", "storage", [*shown, *rising], data, {"bounded": bounded})
    evidence = {
        "storage": "the elastic energy near z = 0, and beyond it a fit between L and U",
        "own_up_to": cells.elastic_up_to,
        "slopes": [[float(x) for x in row] for row in zip(cells.low, cells.high, cells.slope, strict=True)],
    }
    return proved(model, certificate, _FITTED, evidence)


def _refuted(model: Model, storage: Storage, unrestricted: bool) -> Verdict | None:
    law = model.law
    cycle = cycles.find(law, storage)
    if cycle is not None and (verdict := _by_cycle(model, storage, cycle)) is not None:
        return verdict
    if (verdict := steady_gain(model, storage)) is not None:
        return verdict
    if model.v_max is None:
        return without_limit(model, storage, unrestricted)
    return None


def _by_cycle(model: Model, storage: Storage, cycle: Sequence[cycles.Piece]) -> Verdict | None:
    turns = [cycle[0][2], *(end for *_, end in cycle)]
    if storage.reach is not None and max(abs(x) for x in turns) > storage.reach:
        return None
    bounds = enclosed.program([(model, v, a, b) for _, v, a, b in cycle])
    if bounds is None or not bounds[1] < 0:
        return None
    found = cycles.evidence(cycle)
    verdict = Verdict(False, _CYCLE, {**found, "enclosed": {"energy_drawn": [-bounds[1], -bounds[0]]}})
    near = turns[-1], 1e-4 * (max(turns) - min(turns))
    cycles.add_run(verdict, cycles.scenario(storage.law, found), near=near)
    return verdict

"""A bound Z on |z| for every v(t)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stribeck.expressions.boxes import grid, not_negative
from stribeck.expressions.graph import Expr, substitute, symbol, wrap
from stribeck.expressions.intervals import Evaluator, Interval, point
from stribeck.properties import replay
from stribeck.properties.algebra import sign_over_all
from stribeck.properties.cycles import integrate
from stribeck.properties.elastic import speed_edges
from stribeck.properties.model import Model, Z, over_u, reciprocal
from stribeck.properties.storage import Storage
from stribeck.properties.verdicts import Verdict, later, undecided

_ALGEBRA = "exact algebra: on |z| = Z, dz/dt points inward for every v (signs of polynomials by Bernstein coefficients)"
_BOXES = "interval arithmetic over all v: on |z| = Z, dz/dt points inward"
_PASSED = "held speeds that take z past the bound, replayed by simulation"
_LEVELS = (2.0, 10.0, 100.0, 1e4, 1e6)
_REPLAYED = 10.0


def decide(model: Model, deadline: float) -> Verdict:
    """Whether |z| = Z is never passed outward."""
    law = model.law
    z_bound = float(law.z_bound(law.p))
    for method in (_ALGEBRA, _BOXES):
        if _inward(model, method, deadline):
            return Verdict(True, method, {"Z": z_bound}, again=lambda m=method: _inward(model, m, later()))  # type: ignore[misc]
    return _passed(model, z_bound)


def _inward(model: Model, method: str, deadline: float) -> bool:
    values = {n: x for n, x in model.law.values.items() if x is not None}
    bound = wrap(model.law.z_bound(model.law.symbolic(symbol, model.law.structure)))
    for z_side in (1, -1):
        edge = bound if z_side > 0 else -bound
        rest = Evaluator([substitute([model.rate], {Z: edge})[0] * z_side])({**model.constants, "v": point(0.0)})[0]
        if not rest.high <= 0:
            return False
        for v_side in (1, -1):
            outward = substitute([model.sided(model.rate, v_side)], {Z: edge})[0] * z_side
            algebra = method is _ALGEBRA
            if algebra and not sign_over_all(outward, values).not_positive:
                return False
            if not algebra and not _by_boxes(model, outward, deadline):
                return False
    return True


def _by_boxes(model: Model, outward: Expr, deadline: float) -> bool:
    evaluate = Evaluator([outward, over_u(outward)])

    def bound(box: Sequence[Interval]) -> Interval:
        plain, slope = evaluate({**model.constants, "u": box[0], "t": reciprocal(box[0])})
        return Interval(-np.fmin(plain.high, slope.high), -np.fmax(plain.low, slope.low))

    return not_negative(bound, *grid([speed_edges(model, None)]), deadline).holds


def _passed(model: Model, z_bound: float) -> Verdict:
    """Speeds that take z past the bound from z = 0, and how far."""
    law = model.law
    levels: list[dict[str, float]] = []
    for level in (1 + 1e-6, *_LEVELS):
        found = _fastest(model, level * z_bound)
        if found is None:
            break
        levels.append({"z": level * z_bound, "z_over_Z": level, "v": found[0], "time": found[1]})
    if not levels:
        return undecided("no proof, and no held speed was found that takes z past the bound", Z=z_bound)
    farthest = levels[-1]["z_over_Z"]
    shown = max((x for x in levels if x["z_over_Z"] <= _REPLAYED), key=lambda x: x["z"])
    if farthest < _LEVELS[-1]:
        shown = _to_the_end(model, shown, farthest)
    drive, end = replay.velocity_drive([shown["v"]], [shown["time"]])
    tables = replay.scenario_of(law, "bounded", drive, end, {}, energy=True)  # compiled for passive, too
    evidence: dict[str, Any] = {
        "Z": z_bound, "levels": levels if farthest >= _LEVELS[-1] else [shown],
        "passes_any_level": farthest >= _LEVELS[-1],
    }  # fmt: skip
    solution = replay.run(tables)
    if tables is None or solution is None or not abs(solution.final["z"]) > z_bound:
        return undecided("held speeds take z past the bound by quadrature; it could not be replayed", **evidence)
    stated = {"z": solution.final["z"]}
    evidence["replay"] = {"v": shown["v"], "time": shown["time"], **stated}
    return Verdict(False, _PASSED, evidence, tables, again=lambda: replay.repeats(tables, stated))


def _to_the_end(model: Model, shown: dict[str, float], level: float) -> dict[str, float]:
    """The farthest that held speeds get, within a thousandth: z may have a larger bound."""
    z_bound = shown["z"] / shown["z_over_Z"]
    low, high = level, max(2 * level, 2.0)
    for _ in range(12):
        middle = 0.5 * (low + high)
        found = _fastest(model, middle * z_bound)
        if found is None:
            high = middle
        else:
            low, shown = middle, {"z": middle * z_bound, "z_over_Z": middle, "v": found[0], "time": found[1]}
    return shown


def _fastest(model: Model, level: float) -> tuple[float, float] | None:
    """The held speed that takes z from 0 to a level soonest, and the time; None where none does."""
    law = model.law
    v = Storage(law, per_decade=12).v
    v = v[v > 0]
    z = level * np.linspace(0, 1, 41)
    with np.errstate(all="ignore"):
        rate = law.rate(v[:, None], z)
        slowest = rate.min(axis=1)
        size = np.maximum(abs(law.rate(v, -level)), abs(law.rate(v, 0.0)))
        time: NDArray[np.float64] = np.where(slowest > 1e-9 * size, (1 / rate).mean(axis=1) * level, np.inf)
    if not np.isfinite(time).any():
        return None
    # not faster than need be: among speeds that take at most ten times as long as ... a second, the slowest
    enough = np.flatnonzero(time <= max(1.0, 2 * float(time.min())))
    chosen = float(v[enough[0]])
    return chosen, integrate(law, chosen, 0.0, level)[0]

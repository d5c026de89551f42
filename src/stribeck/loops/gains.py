"""The gains of a servo: conditions for a decreasing Lyapunov function V, the speeds for which they hold, better gains."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from stribeck.arrays import Array
from stribeck.errors import needed
from stribeck.expressions.emit import python_function
from stribeck.expressions.graph import Expr, derivative, symbol, wrap
from stribeck.expressions.intervals import Box, Range, add, neg, not_negative
from stribeck.expressions.ops import Value
from stribeck.laws.base import Law
from stribeck.loops.proof import derive

if TYPE_CHECKING:
    import sympy

FASTEST = 1e6  # m/s: the largest speed tried; "any speed" needs a proof for all of them
_SPEEDS = 4000  # of each of two grids; the logarithmic one has 220 points a decade


@dataclass(frozen=True)
class Condition:
    """A condition on the gains up to a speed.

    Attributes:
        holds: whether it holds.
        least_K_D: the smallest K_D that satisfies it, N s/m.
        margin: K_D less that, N s/m.
        largest_speed: the largest speed up to which it holds, m/s; None: at any speed.
    """

    holds: bool
    least_K_D: float
    margin: float
    largest_speed: float | None


@dataclass(frozen=True)
class GainVerdict:
    """Whether V decreases for all errors up to the speed ``v_max``, as long as the valve does not saturate.

    Attributes:
        v_max: the speed, m/s.
        w_max: the largest decay rate w of the bristles up to it, 1/s.
        exact: the exact condition on the gains.
        sufficient: the corrected eq. 21, which is sufficient.
        largest_K_sufficient: the largest K that eq. 21 allows, m/N.
        proposed: gains K_D and K that satisfy the exact condition with a factor of two to spare.
    """

    v_max: float
    w_max: float
    exact: Condition
    sufficient: Condition
    largest_K_sufficient: float
    proposed: dict[str, float]


def decay(law: Law) -> Expr:
    """w(v) of a law dz/dt = S_1 v - w z, 1/s, with symbols for its constants."""
    p, v, z = law.symbolic(symbol, law.form), symbol("v"), symbol("z")
    return -derivative(wrap(law.dz_dt(p, v, z)), z)


def damping(law: Law) -> Expr:
    """sigma_1 of a law F = sigma_0 z + sigma_1 dz/dt + sigma_2 v, N s/m; with v_d a function of v, largest at rest."""
    p, rate = law.symbolic(symbol, law.form), symbol("dz_dt")
    return derivative(wrap(law.friction(p, symbol("v"), symbol("z"), rate)), rate)


def at_speed(law: Law, expr: Expr) -> Callable[[Value], Value]:
    """An expression of the law's constants and v as a function of the speed."""
    numbers = law.p.numbers
    function = python_function([*numbers, "v"], [expr])
    return lambda v: function(*numbers.values(), v)[0]


def gain_verdict(law: Law, gains: Mapping[str, float], v_max: float) -> GainVerdict:
    """The conditions on the gains K_D and K for a law linear in z, the same in plant and observer.

    If the law has v_d, sigma_1 at rest is used, its largest value: the conditions are then sufficient, since a smaller
    sigma_1 needs less.

    Raises:
        StribeckError: if SymPy is not installed.
    """
    with needed("the proof of a servo's gains"):
        import sympy

    form, w = derive(), sympy.Symbol("w", real=True)
    K_D, K = (sympy.Symbol(n, positive=True) for n in ("K_D", "K"))
    p = {sympy.Symbol(n, positive=True): law.values[n] for n in ("sigma_0", "sigma_1")}
    decay_rate = at_speed(law, decay(law))
    u = _speed_grid(v_max)
    w_max = float(np.max([decay_rate(u), decay_rate(-u)]))  # w need not rise with |v|
    exact = form.exact.subs(p)
    error, deflection = (each.subs(p) for each in form.sufficient)

    def condition(expr: sympy.Expr, also: bool) -> Condition:
        # without bristle damping any K_D > 0 is enough, and there is no root
        solutions = sympy.solve(expr, K_D)
        least = float(solutions[0].subs({K: gains["K"], w: w_max})) if solutions else 0.0
        roots = sympy.solve(expr.subs({K: gains["K"], K_D: gains["K_D"]}), w)
        speed = _largest_speed(law, decay_rate, float(roots[0])) if roots else None
        margin = gains["K_D"] - least
        return Condition(also and margin >= 0, least, margin, speed if also else 0.0)

    largest_K = float(sympy.solve(deflection, K)[0]) if law.values["sigma_1"] else math.inf
    twice = 2.0 * condition(exact, True).least_K_D
    roots = sympy.solve(exact.subs({K_D: gains["K_D"], w: w_max}), K)
    limit = float(roots[0]) if roots else math.inf
    # half of the allowed K; if any K is allowed, the given one
    proposed = {"K_D": max(gains["K_D"], twice), "K": gains["K"] if limit <= 0 else min(gains["K"], limit / 2)}
    return GainVerdict(
        v_max, w_max, condition(exact, True), condition(error, gains["K"] < largest_K), largest_K, proposed
    )


def _speed_grid(v_max: float) -> Array:
    """Speeds from 0 to v_max, on a linear and a logarithmic grid."""
    return np.unique([0.0, *np.geomspace(v_max * 1e-12, v_max, _SPEEDS), *np.linspace(0, v_max, _SPEEDS)])


def _largest_speed(law: Law, decay_rate: Callable[[Value], Value], w: float) -> float | None:
    """The speed up to which the decay rate does not exceed w; None if intervals prove that it never does."""
    u = _speed_grid(FASTEST)
    passed = np.flatnonzero(np.maximum(decay_rate(u), decay_rate(-u)) > w)
    if not len(passed):
        return None if _never_above(law, w) else FASTEST
    if passed[0] == 0:
        return 0.0
    low, high = float(u[passed[0] - 1]), float(u[passed[0]])
    for _ in range(200):
        middle = 0.5 * (low + high)
        below = max(float(decay_rate(middle)), float(decay_rate(-middle))) <= w
        low, high = (middle, high) if below else (low, middle)
    return low


def _never_above(law: Law, w: float) -> bool:
    """Whether w(v) stays at or below a value at every speed, by interval arithmetic."""
    rate, constants = decay(law), {name: (float(x), float(x)) for name, x in law.p.numbers.items()}

    def margin(v: Range) -> Range:
        return add((w, w), neg(Box({**constants, "v": v})(rate)))

    return not_negative(margin, [(0.0, math.inf), (-math.inf, 0.0)]).holds


@dataclass(frozen=True)
class Staying:
    """The starts from which the speed stays below ``v_max``, the speed up to which the gains are valid; V then always falls.

    As long as the speed is below v_max, V falls, so that |s| <= s_max = sqrt(2 V(0)/M). As de/dt = s - lambda e, lambda |e|
    stays below the larger of lambda |e(0)| and s_max. And |v| <= |dy_d/dt| + |s| + lambda |e|.

    Attributes:
        path_speed: the largest speed of the path, m/s.
        largest_V: V(0) below which this holds for every start with lambda |e(0)| <= sqrt(2 V(0)/M), J.
        bound: the bound on the speed from the start of this run, m/s.
        holds: whether ``bound`` is below v_max.
    """

    path_speed: float
    largest_V: float
    bound: float
    holds: bool


def staying(v_max: float, mass: float, path_speed: float, V_0: float, lambda_e_0: float) -> Staying:
    """The invariant sublevel set of V for a path that is nowhere faster than ``path_speed`` (m/s)."""
    speed_margin = max(v_max - path_speed, 0.0) / 2
    s_max = math.sqrt(2 * V_0 / mass)
    bound = path_speed + s_max + max(abs(lambda_e_0), s_max)
    return Staying(path_speed, mass * speed_margin**2 / 2, bound, bound < v_max)


@dataclass(frozen=True)
class Proof:
    """The result of an interval proof of dV/dt <= 0 for all s, p_err, z_err and a range of speeds."""

    proven: bool | None  # None: undecided
    boxes: int
    reason: str


def prove(law: Law, gains: Mapping[str, float], v: tuple[float, float]) -> Proof:
    """Prove with interval arithmetic that dV/dt <= 0 for every error and every speed in ``v`` (m/s).

    The quadratic form is non-negative if its diagonal and 4 ss zz - sz^2 are; w is divided out, so that it may be 0.
    """
    form = derive()
    tests = [decay(law), *(_graph_of(test, w=decay(law), sigma_1=damping(law)) for test in (form.exact, form.ss))]
    values = {**law.values, "K_D": gains["K_D"], "K": gains["K"]}
    constants = {name: (float(x), float(x)) for name, x in values.items() if x is not None}

    def least(part: Range) -> Range:
        box = Box({**constants, "v": part})
        lows, highs = zip(*(box(test) for test in tests), strict=True)
        return min(lows), min(highs)

    cover = not_negative(least, [(v[0], 0.0), (0.0, v[1])] if v[0] < 0 < v[1] else [v])
    if cover.where is None:
        return Proof(True, cover.parts, "")
    place = f"near v = {sum(cover.where) / 2:.6g} m/s"
    if cover.negative:
        return Proof(False, cover.parts, f"dV/dt can be positive {place}")
    return Proof(None, cover.parts, f"the sign is not settled {place}: {cover.reason}")


def _graph_of(expr: sympy.Expr, **replaced: Expr) -> Expr:
    """A SymPy expression of gains, constants and w as a graph, with some of them replaced."""
    import sympy

    inputs = sorted(expr.free_symbols, key=str)
    function = sympy.lambdify(inputs, expr, modules=[{}])
    return wrap(function(*(replaced.get(str(each), symbol(str(each))) for each in inputs)))

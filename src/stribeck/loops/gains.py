"""Do the gains make V decrease? The conditions that follow from dV/dt, up to which speed they hold, and better gains."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING

import numpy as np

from stribeck.arrays import Array
from stribeck.errors import needed
from stribeck.expressions.boxes import grid, not_negative
from stribeck.expressions.emit import python_function
from stribeck.expressions.graph import Expr, derivative, symbol, wrap
from stribeck.expressions.intervals import Evaluator, Interval, point
from stribeck.expressions.ops import Value
from stribeck.laws.base import Law
from stribeck.loops.proof import derive

if TYPE_CHECKING:
    import sympy

FASTEST = 1e6  # m/s: speeds are looked at up to here; "any speed" needs a proof for all of them
_SPEEDS = 4000


@dataclass(frozen=True)
class Condition:
    """A condition on the gains at the speed asked for: the K_D that it needs, in N s/m, by how much K_D exceeds that, and
    the largest speed at which it holds (None: at any speed)."""

    holds: bool
    least_K_D: float
    margin: float
    largest_speed: float | None


@dataclass(frozen=True)
class GainVerdict:
    """Whether V decreases for all errors, up to ``v_max``, while the valve is not at its limit."""

    v_max: float
    w_max: float
    exact: Condition
    sufficient: Condition
    largest_K_sufficient: float
    proposed: dict[str, float]

    def summary(self) -> dict[str, object]:
        """For programs."""
        return asdict(self)


def decay(law: Law) -> Expr:
    """w(v) of a law dz/dt = S_1 v - w z, its constants symbols."""
    p, v, z = law.symbolic(symbol, law.form), symbol("v"), symbol("z")
    return -derivative(wrap(law.dz_dt(p, v, z)), z)


def damping(law: Law) -> Expr:
    """sigma_1 of a law F = sigma_0 z + sigma_1 dz/dt + sigma_2 v: with v_d a function of v, largest at rest."""
    p, rate = law.symbolic(symbol, law.form), symbol("dz_dt")
    return derivative(wrap(law.friction(p, symbol("v"), symbol("z"), rate)), rate)


def at_speed(law: Law, expr: Expr) -> Callable[[Value], Value]:
    """An expression of the law's constants and v as a function of the speed."""
    numbers = law.p.numbers
    function = python_function([*numbers, "v"], [expr])
    return lambda v: function(*numbers.values(), v)[0]


def gain_verdict(law: Law, gains: Mapping[str, float], v_max: float) -> GainVerdict:
    """The conditions for gains K_D, K and a law that is linear in z, in plant and observer alike.

    With v_d they hold for sigma_1 at rest, its largest value: sufficient then, as both ask less of a smaller one.

    Raises:
        StribeckError: SymPy is not installed.
    """
    with needed("the proof of a servo's gains"):
        import sympy

    form, w = derive(), sympy.Symbol("w", real=True)
    K_D, K = (sympy.Symbol(n, positive=True) for n in ("K_D", "K"))
    p = {sympy.Symbol(n, positive=True): law.values[n] for n in ("sigma_0", "sigma_1")}
    of_speed = at_speed(law, decay(law))
    w_max = float(np.max(of_speed(_both_signs(_up_to(v_max)))))  # w need not rise with |v|
    exact = form.exact.subs(p)
    error, deflection = (each.subs(p) for each in form.sufficient)

    def condition(expr: sympy.Expr, also: bool) -> Condition:
        # without bristle damping any K_D > 0 will do, and no root is left
        found = sympy.solve(expr, K_D)
        least = float(found[0].subs({K: gains["K"], w: w_max})) if found else 0.0
        roots = sympy.solve(expr.subs({K: gains["K"], K_D: gains["K_D"]}), w)
        speed = _speed(law, of_speed, float(roots[0])) if roots else None
        margin = gains["K_D"] - least
        return Condition(also and margin >= 0, least, margin, speed if also else 0.0)

    largest_K = float(sympy.solve(deflection, K)[0]) if law.values["sigma_1"] else math.inf
    twice = 2.0 * condition(exact, True).least_K_D
    roots = sympy.solve(exact.subs({K_D: gains["K_D"], w: w_max}), K)
    limit = float(roots[0]) if roots else math.inf
    # half of what the condition allows; where it allows any K, what is given
    proposed = {"K_D": max(gains["K_D"], twice), "K": gains["K"] if limit <= 0 else min(gains["K"], limit / 2)}
    return GainVerdict(
        v_max, w_max, condition(exact, True), condition(error, gains["K"] < largest_K), largest_K, proposed
    )


def _up_to(v_max: float) -> Array:
    """Speeds from 0 to v_max, at every scale."""
    return np.unique([0.0, *np.geomspace(v_max * 1e-12, v_max, _SPEEDS), *np.linspace(0, v_max, _SPEEDS)])


def _both_signs(u: Array) -> Array:
    return np.concatenate([-u[::-1], u])


def _speed(law: Law, of_speed: Callable[[Value], Value], w: float) -> float | None:
    """The speed up to which w is not passed, at any lower one either; None where intervals show that it never is."""
    u = _up_to(FASTEST)
    passed = np.flatnonzero(np.maximum(of_speed(u), of_speed(-u)) > w)
    if not len(passed):
        return None if _never_above(law, w) else FASTEST
    if passed[0] == 0:
        return 0.0
    low, high = float(u[passed[0] - 1]), float(u[passed[0]])
    for _ in range(200):
        middle = 0.5 * (low + high)
        below = max(float(of_speed(middle)), float(of_speed(-middle))) <= w
        low, high = (middle, high) if below else (low, middle)
    return low


def _never_above(law: Law, w: float) -> bool:
    """Whether w(v) stays at or below a value at every speed, by interval arithmetic."""
    evaluate = Evaluator([decay(law)])
    constants = {name: point(x) for name, x in law.p.numbers.items()}

    def room(box: Sequence[Interval]) -> Interval:
        return point(w) - evaluate({**constants, "v": box[0]})[0]

    return all(not_negative(room, *grid([edges])).holds for edges in ([0.0, np.inf], [-np.inf, 0.0]))


@dataclass(frozen=True)
class Staying:
    """From which starts the speed stays below the one that the gains are good for, so that V falls for ever.

    As long as the speed is below v_max, V falls, so that |s| <= s_max = sqrt(2 V(0)/M). As de/dt = s - lambda e, lambda |e|
    stays below the larger of lambda |e(0)| and s_max. And |v| <= |dy_d/dt| + |s| + lambda |e|.

    Attributes:
        path_speed: the largest speed of the path, m/s.
        largest_V: every start with V(0) below this, and with lambda |e(0)| <= sqrt(2 V(0)/M), stays, J.
        bound: the speed that is not passed from the start of this run, m/s.
        holds: whether that is below v_max.
    """

    path_speed: float
    largest_V: float
    bound: float
    holds: bool


def staying(v_max: float, mass: float, path_speed: float, V_0: float, lambda_e_0: float) -> Staying:
    """The invariant sublevel set of V for a path that is nowhere faster than ``path_speed``."""
    room = max(v_max - path_speed, 0.0) / 2
    s_max = math.sqrt(2 * V_0 / mass)
    bound = path_speed + s_max + max(abs(lambda_e_0), s_max)
    return Staying(path_speed, mass * room**2 / 2, bound, bound < v_max)


@dataclass(frozen=True)
class Proof:
    """What intervals show about dV/dt <= 0 for all s, p_err and z_err and the speeds asked for."""

    proven: bool | None  # None: not settled
    boxes: int
    reason: str


def prove(law: Law, gains: Mapping[str, float], v: tuple[float, float]) -> Proof:
    """Show with interval arithmetic that dV/dt <= 0 for every error and every speed in ``v``.

    The quadratic form is non-negative where its diagonal and 4 ss zz - sz^2 are; w is divided out, so that it may be 0.
    """
    form = derive()
    tests = [decay(law), *(_in_graph(test, w=decay(law), sigma_1=damping(law)) for test in (form.exact, form.ss))]
    evaluate = Evaluator(tests)
    values = {**law.values, "K_D": gains["K_D"], "K": gains["K"]}
    constants = {name: point(x) for name, x in values.items() if x is not None}

    def least(box: Sequence[Interval]) -> Interval:
        found = evaluate({**constants, "v": box[0]})
        ends = [np.broadcast_arrays(*x) for x in ([f.low for f in found], [f.high for f in found])]
        return Interval(*(np.min(x, axis=0) for x in ends))

    cover = not_negative(least, *grid([[v[0], 0.0, v[1]] if v[0] < 0 < v[1] else v]))
    if cover.where is None:
        return Proof(True, cover.boxes, "")
    at = f"near v = {sum(cover.where[0]) / 2:.6g} m/s"
    if cover.negative:
        return Proof(False, cover.boxes, f"dV/dt can be positive {at}")
    return Proof(None, cover.boxes, f"the sign is not settled {at}: {cover.reason}")


def _in_graph(expr: sympy.Expr, **replaced: Expr) -> Expr:
    """A SymPy expression of gains, constants and w as a graph, with some of them replaced."""
    with needed("the proof of a servo's gains"):
        import sympy

    inputs = sorted(expr.free_symbols, key=str)
    function = sympy.lambdify(inputs, expr, modules=[{}])
    return wrap(function(*(replaced.get(str(each), symbol(str(each))) for each in inputs)))

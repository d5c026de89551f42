"""The functions of velocity that the laws share, as the paper prints them."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from types import SimpleNamespace

from stribeck.constants import Constant
from stribeck.expressions.ops import Value, atan, exp, pi, sqrt, where
from stribeck.laws.values import observer_of

K_V = Constant("s/m", "steepness of the smooth sign", above=0, rotary_unit="s/rad", example=1e7)
V_D = Constant(
    "m/s", "speed at which bristle damping has fallen to 1/e; constant damping unless given",
    above=0, optional=True, rotary_unit="rad/s",
)  # fmt: skip
DELTA = Constant("", "exponent of the Stribeck curve exp(-|v/v_s|^delta); 2 unless given", at_least=1, optional=True)
SMOOTH_ABS = Constant("", "smooth majorant of |v|; atan unless given", choices=("atan", "sqrt", "compact"))


def term(latex: str) -> Callable[[Callable[..., Value]], Callable[..., Value]]:
    """Name a function of an equation; generated C and rendered equations show this name."""

    def decorate(function: Callable[..., Value]) -> Callable[..., Value]:
        @wraps(function)
        def named(p: SimpleNamespace, *args: Value) -> Value:
            value = function(p, *args)
            on_term = observer_of(p)
            return value if on_term is None else on_term(function.__name__, latex, args, value)

        return named

    return decorate


def stribeck_level(p: SimpleNamespace, v: Value) -> Value:
    """The friction level in N, from F_s at rest to F_c far above v_s; the exponent is 2 unless delta is given."""
    x = (v / p.v_s) ** 2 if getattr(p, "delta", None) is None else abs(v / p.v_s) ** p.delta
    return p.F_c + (p.F_s - p.F_c) * exp(-x)


@term("g")
def g(p: SimpleNamespace, v: Value) -> Value:
    """Steady deflection in m (the paper's f_s, eq. 3; the exponent delta as in Tustin and Bo & Pavelescu 1982)."""
    return stribeck_level(p, v) / p.sigma_0


@term("S_0")
def S_0(p: SimpleNamespace, v: Value) -> Value:
    """Smooth sign of v (eq. 4)."""
    return (2 / pi) * atan(p.k_v * v)


def S_1(p: SimpleNamespace, v: Value) -> Value:
    """Factor of the drive of z in the proposed law (eqs 7-9), close to 1 away from rest."""
    return S_0(p, v) ** 2


def S_2(p: SimpleNamespace, v: Value) -> Value:
    """Smooth |v| of the paper in m/s, from below (eqs 7-9)."""
    return v * S_0(p, v)


@term("m")
def m(p: SimpleNamespace, v: Value) -> Value:
    """Smooth majorant of |v| in m/s: |v| <= m(v) <= |v| + m(0). docs/explanation/theory.md has the proofs."""
    if p.smooth_abs == "sqrt":
        return sqrt(v**2 + (1 / p.k_v) ** 2)
    if p.smooth_abs == "compact":
        return where(p.k_v * abs(v) < 1, (3 + 6 * (p.k_v * v) ** 2 - (p.k_v * v) ** 4) / (8 * p.k_v), abs(v))
    return S_2(p, v) + m_0(p)


def m_0(p: SimpleNamespace) -> Value:
    """m(0), the largest excess of m over |v|, m/s."""
    if p.smooth_abs == "sqrt":
        return 1 / p.k_v
    return 3 / (8 * p.k_v) if p.smooth_abs == "compact" else 2 / (pi * p.k_v)


@term("\\sigma_1")
def sigma_1(p: SimpleNamespace, v: Value) -> Value:
    """Bristle damping that falls with speed, N s/m (Olsson et al., Eur. J. Control 4(3):176-195, 1998)."""
    return p.sigma_1 * exp(-((v / p.v_d) ** 2))

"""Sanity tests of a law's equations: finite values, symmetry, arrays, derivatives.

Sampling finds counterexamples and proves nothing; :func:`stribeck.check` decides a law's claims.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from stribeck import laws
from stribeck.arrays import Array
from stribeck.expressions.ops import Value
from stribeck.laws.base import Law

_SPEEDS = (1e-9, 1e4)  # range of samples, as multiples of the law's natural speed
_ROUNDING = 1e-12  # of the largest term: a smaller difference is rounding


def problems(law: Law, seed: int = 0) -> list[str]:
    """The faults in a law's equations, a line each.

    F and dz/dt must be finite, and change sign with (v, z) unless ``symmetric = False``. Arrays must give the values of
    single numbers. Derivatives must agree with differences.

    Args:
        law: the law, with its constants.
        seed: of the random samples.
    """
    if trouble := laws.trouble(law):
        return [trouble]
    problems = []
    for name, test in _TESTS.items():
        try:
            with np.errstate(all="ignore"):
                text = test(_Samples(law, np.random.default_rng(seed)))
        except Exception as error:
            text = f"cannot be tested: {type(error).__name__}: {error}"
        problems += [f"{name}: {text}"] if text else []
    return problems


class _Samples:
    """Random velocities and deflections in the relevant range of a law."""

    def __init__(self, law: Law, rng: np.random.Generator) -> None:
        self.law, self.rng = law, rng
        self.speed, self.length = law.scales(law.p).speed, law.scales(law.p).length
        self.bound = float(law.z_bound(law.p)) if law.has_z and law.guarantees()["bounded"] else 10 * self.length

    def v(self, *shape: int) -> Array:
        """Velocities of both signs with log-uniform magnitudes."""
        low, high = np.log(_SPEEDS)
        return self.rng.choice([-1.0, 1.0], shape) * self.speed * np.exp(self.rng.uniform(low, high, shape))

    def z(self, *shape: int) -> Array:
        """Deflections within the bound."""
        return self.rng.uniform(-1, 1, shape) * self.bound

    def size(self, function: Callable[..., Value], v: Array, z: Array) -> Array:
        """The magnitude of the terms of F or dz/dt, which may cancel each other."""
        return np.asarray(np.max([abs(function(v, x)) for x in (z, -z, 0 * z)], axis=0))


def _where(wrong: Value, text: str, **values: Array | float) -> str | None:
    """The text with the values at the first fault, or None without a fault."""
    if not np.any(wrong):
        return None
    i = int(np.argmax(wrong))
    units = {"v": "m/s", "z": "m", "dv_dt": "m/s^2"}
    words = (f"{name} = {np.broadcast_to(x, np.shape(wrong)).flat[i]:.6g} {units[name]}" for name, x in values.items())
    return f"{text} at {', '.join(words)}"


def _values(s: _Samples) -> str | None:
    v, z = np.append(s.v(500), 0.0), np.append(s.z(500), 0.0)
    for name, function in (("F", s.law.force), ("dz/dt", s.law.rate)):
        values, opposite = function(v, z), function(-v, -z)
        odd = abs(values + opposite) <= _ROUNDING * s.size(function, v, z)
        text = _where(~np.isfinite(values), f"{name} is not finite", v=v, z=z) or _where(
            ~odd & (v != 0) & s.law.symmetric, f"{name} does not change sign with (v, z)", v=v, z=z
        )
        if text:
            return text
    return None


def _arrays(s: _Samples) -> str | None:
    v, z = s.v(4, 1), s.z(5)
    sliding = ("F when sliding", lambda v, z: s.law.steady_force(v) + 0 * z)
    for name, function in (("F", s.law.force), ("dz/dt", s.law.rate), sliding):
        table = np.asarray(function(v, z))
        single = np.array([[function(float(a), float(b)) for b in z] for a in v[:, 0]])
        same = abs(table - single) <= _ROUNDING * abs(single).max(axis=1, keepdims=True)
        if table.shape != (4, 5) or not same.all():
            return f"{name} of arrays differs from that of numbers"
    return None


def _differs(derivative: Value, of: Callable[[Array], Array], step: Array, size: Array) -> Value:
    """Where a derivative disagrees with all central differences of relative steps from 1e-3 to 1e-7."""
    h = 10.0 ** -np.arange(3, 8)[:, None] * step
    difference = (of(h) - of(-h)) / (2 * h)
    return ~(abs(difference - derivative) <= 1e-5 * abs(derivative) + 1e-14 * size / h).any(axis=0)


def _jacobian(s: _Samples) -> str | None:
    v, z = s.v(300), s.z(300)
    rate, (by_v, by_z), size = s.law.rate, s.law.jacobian(v, z), s.size(s.law.rate, v, z)
    wrong_v = _differs(by_v, lambda h: rate(v + h, z), abs(v), size)
    wrong_z = _differs(by_z, lambda h: rate(v, z + h), abs(z), size)
    text = "the derivative of dz/dt by {} disagrees with differences"
    return _where(wrong_v, text.format("v"), v=v, z=z) or _where(wrong_z, text.format("z"), v=v, z=z)


def _force_rate(s: _Samples) -> str | None:
    v, z = s.v(300), s.z(300)
    force, rate = s.law.force, s.law.rate(v, z)
    time = 1 / np.maximum(abs(rate / z), 1e-9 * s.speed / s.length)
    dv_dt = v / time * s.rng.uniform(-1, 1, 300)
    of, size = (lambda h: force(v + h * dv_dt, z + h * rate)), s.size(force, v, z)
    wrong = _differs(s.law.force_rate(v, z, dv_dt), of, time, size)
    return _where(wrong, "dF/dt disagrees with differences", v=v, z=z, dv_dt=dv_dt)


_TESTS: dict[str, Callable[[_Samples], str | None]] = {
    "values": _values, "arrays": _arrays, "derivatives": _jacobian, "force rate": _force_rate,
}  # fmt: skip

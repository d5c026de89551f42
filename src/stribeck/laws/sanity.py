"""Sanity tests of a law's equations: finite values, symmetry, arrays.

Sampling finds counterexamples and proves nothing; :func:`stribeck.check` decides a law's claims.
"""

from __future__ import annotations

import numpy as np

from stribeck import laws
from stribeck.arrays import Array
from stribeck.laws.base import Law

_SPEEDS = (1e-9, 1e4)  # range of samples, as multiples of the law's natural speed
_ROUNDING = 1e-12  # of the largest term: a smaller difference is rounding


def problems(law: Law) -> list[str]:
    """The faults in a law's equations, a line each.

    F and dz/dt must be finite, and change sign with (v, z) unless ``symmetric = False``. Arrays must give the values of
    single numbers.
    """
    if trouble := laws.trouble(law):
        return [trouble]
    problems = []
    for name, test in {"values": _values, "arrays": _arrays}.items():
        try:
            with np.errstate(all="ignore"):
                text = test(law, np.random.default_rng(0))
        except Exception as error:
            text = f"cannot be tested: {type(error).__name__}: {error}"
        problems += [f"{name}: {text}"] if text else []
    return problems


def _samples(law: Law, rng: np.random.Generator, *shapes: tuple[int, ...]) -> tuple[Array, Array]:
    """Velocities of both signs with log-uniform magnitudes, and deflections within the bound."""
    scales, (of_v, of_z) = law.scales(law.p), shapes
    bound = float(law.z_bound(law.p)) if law.has_z and law.guarantees()["bounded"] else 10 * scales.length
    low, high = np.log(_SPEEDS)
    v = rng.choice([-1.0, 1.0], of_v) * scales.speed * np.exp(rng.uniform(low, high, of_v))
    return v, rng.uniform(-1, 1, of_z) * bound


def _values(law: Law, rng: np.random.Generator) -> str | None:
    v, z = (np.append(x, 0.0) for x in _samples(law, rng, (500,), (500,)))
    for name, function in (("F", law.force), ("dz/dt", law.rate)):
        values, opposite = function(v, z), function(-v, -z)
        size = np.max(
            [abs(function(v, x)) for x in (z, -z, 0 * z)], axis=0
        )  # of the terms, which may cancel each other
        even = ~(abs(values + opposite) <= _ROUNDING * size) & (v != 0) & law.symmetric
        for wrong, text in ((~np.isfinite(values), "is not finite"), (even, "does not change sign with (v, z)")):
            if wrong.any():
                i = int(wrong.argmax())
                return f"{name} {text} at v = {v[i]:.6g} m/s, z = {z[i]:.6g} m"
    return None


def _arrays(law: Law, rng: np.random.Generator) -> str | None:
    v, z = _samples(law, rng, (4, 1), (5,))
    sliding = ("F when sliding", lambda v, z: law.steady_force(v) + 0 * z)
    for name, function in (("F", law.force), ("dz/dt", law.rate), sliding):
        table = np.asarray(function(v, z))
        single = np.array([[function(float(a), float(b)) for b in z] for a in v[:, 0]])
        close = abs(table - single) <= _ROUNDING * abs(single).max(axis=1, keepdims=True)
        same = close | (table == single)  # a deflection that grows without end has an infinite steady force
        if table.shape != (4, 5) or not same.all():
            return f"{name} of arrays differs from that of numbers"
    return None

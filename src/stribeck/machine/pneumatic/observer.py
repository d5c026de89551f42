"""Friction observers: the controller's estimate of the friction force, from any law with a time derivative."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace

from stribeck.constants import Column
from stribeck.expressions.ops import Value, clip, where
from stribeck.laws.base import Law
from stribeck.laws.values import Constants, observer_of

Z_HAT = Column("z_hat", "m", "the observer's deflection")
_LAYER = 0.05  # share of a bound within which the projection reduces the rate to 0

# Adapted factors on sigma_0, sigma_1, sigma_2 and 1/g.
SCALES = (
    Column("a_0", "1", "adapted scale of sigma_0"),
    Column("a_1", "1", "adapted scale of sigma_1"),
    Column("a_2", "1", "adapted scale of sigma_2"),
    Column("a_g", "1", "adapted scale of 1/g"),
)
ETA = Column("eta", "m", "how much z_hat grows by a_g")
START = {Z_HAT.name: 0.0, ETA.name: 0.0, **{scale.name: 1.0 for scale in SCALES}}  # initial states


def least_K_D(K: Value, sigma_0: Value, sigma_1: Value, w: Value) -> Value:
    """The smallest gain on s, N s/m, with which V never grows.

    The law is linear in z, and w = -d(dz/dt)/dz is at most ``w``: the root of ``QuadraticForm.exact`` of
    :func:`stribeck.loops.proof.derive`.
    """
    return K * sigma_1 * (sigma_1 * w / 4 - sigma_0)


@dataclass(frozen=True)
class Observed:
    """An observer's output: the friction force (N), the deflection (m), and the rates of its states."""

    F: Value
    z: Value
    rates: dict[str, Value]


def correction(p: SimpleNamespace, K: Value, s: Value) -> Value:
    """The term of the rate of z_hat from the tracking error s, m/s (the last term of eq. 15)."""
    return -K * p.sigma_0 * s


def observe(law: type[Law] | None, p: SimpleNamespace, K: Value, v: Value, s: Value, x: dict[str, Value]) -> Observed:
    """Eqs 14 and 15: measured velocity and tracking error s drive the law. Without a law, friction is 0."""
    if law is None:
        return Observed(0.0 * v, 0.0 * v, {})
    if not law.has_z:
        return Observed(law.friction(p, v, 0.0 * v, 0.0 * v), 0.0 * v, {})
    z = x["z_hat"]
    rate = law.dz_dt(p, v, z) + correction(p, K, s)
    return Observed(law.friction(p, v, z, rate), z, {"z_hat": rate})


def adapt(
    law: type[Law], p: SimpleNamespace, a: SimpleNamespace, K: Value, v: Value, s: Value, x: dict[str, Value]
) -> Observed:
    """The adaptive observer (docs/explanation/servo.md). The law is linear in z; ``a`` holds the gains.

    a_g multiplies the part that is linear in z, so it scales 1/g. eta is the sensitivity of z_hat to a_g. With eta,
    a_g enters the error of F_hat linearly, up to terms of second order.
    """
    z, eta, scale = x["z_hat"], x["eta"], x["a_g"]
    scaled = {f"sigma_{i}": getattr(p, f"sigma_{i}") * x[f"a_{i}"] for i in range(3)}
    known = Constants({**vars(p), **scaled}, observer_of(p))

    def decay(z: Value) -> Value:  # -w z
        return law.dz_dt(p, v, z) - law.dz_dt(p, v, 0.0 * z)

    rate = law.dz_dt(p, v, 0.0 * z) + scale * decay(z) + correction(p, K, s)
    eta_rate = scale * decay(eta) + decay(z)
    forces = {  # the friction force of each scale: dF_hat/da
        "a_0": p.sigma_0 * z, "a_1": p.sigma_1 * rate, "a_2": p.sigma_2 * v,
        "a_g": known.sigma_0 * eta + known.sigma_1 * eta_rate,
    }  # fmt: skip
    gains = {"a_0": a.gamma_0, "a_1": a.gamma_1, "a_2": a.gamma_2, "a_g": a.gamma_g}
    rates = {name: projected(x[name], -gains[name] * forces[name] * s, a.range) for name in forces}
    F = law.friction(known, v, z, rate)
    return Observed(F, z, {"z_hat": rate + eta * rates["a_g"], "eta": eta_rate, **rates})


def projected(value: Value, rate: Value, bound: Value) -> Value:
    """The rate, reduced to 0 at 1/bound and bound, so that the value stays between them."""
    above = clip((bound - value) / (_LAYER * bound), 0.0, 1.0)
    below = clip((value - 1 / bound) / (_LAYER / bound), 0.0, 1.0)
    return rate * where(rate >= 0, above, below)

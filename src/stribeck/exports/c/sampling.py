"""Limits of a law in discrete time, reported before an export is written."""

from __future__ import annotations

import numpy as np

from stribeck.errors import arg
from stribeck.exports.request import Request
from stribeck.laws.base import Law

_FASTEST_CREEP = 300.0  # of the Stribeck velocity: self-tests pass at 60, one does not at 600
_LIMIT = 1 + 1e-9  # an undamped body has 1, apart from rounding


def resolution(request: Request) -> list[str]:
    """Notes on whether the given time step, or any step, resolves the bristles' motion."""
    law, step = request.law, request.step
    if not law.has_z:
        return []
    warnings, speed = _creeping(law), law.scales(law.p).speed
    if step is None:
        return warnings
    relaxation = 1 / abs(float(law.jacobian(speed, law.steady_deflection(speed))[1]))
    if step > relaxation:
        warnings.append(
            f"{arg('step')}: {step:g} s is longer than the bristles' time constant at {speed:g} m/s ({relaxation:.2g} s): "
            "the step stays stable, but it does not show how the force builds up"
        )
    return warnings


def _creeping(law: Law) -> list[str]:
    """A note about creep at rest, if a law is not linear in z: substeps linearize its curve."""
    scales = law.scales(law.p)
    speed, z = float(scales.speed), float(scales.length)
    creep = abs(float(law.rate(0.0, z)))
    straight = law.jacobian(0.0, z)[1] == law.jacobian(0.0, 0.0)[1]
    if straight or not creep > _FASTEST_CREEP * speed:
        return []
    text = f"|v| is so smooth that at rest the deflection decays at {creep:.3g} m/s, {creep / speed:.2g} times {speed:g} m/s"
    return [f"law '{law.name}': {text}: the error of a step may be a large part of F_s/sigma_0; take a larger k_v"]


def unstable(request: Request) -> list[str]:
    """A note about instability of the streaming step, at the given time step if there is one."""
    law, step, warnings = request.law, request.step, resolution(request)
    if step is None or not law.has_z:
        return warnings
    mass = request.moved_mass
    if mass is not None and radius(law, mass, step) > _LIMIT:
        low, high = 0.0, step
        for _ in range(60):
            middle = (low + high) / 2
            low, high = (low, middle) if radius(law, mass, middle) > _LIMIT else (middle, high)
        warnings.append(
            f"{arg('step')}: at {step:g} s the sampled friction and a mass of {mass:g} kg are unstable together "
            f"(stable below {low:.3g} s), so the law is not passive there: use {request.name}_body_step, which is stable"
        )
    return warnings


def radius(law: Law, mass: float, step: float) -> float:
    """Spectral radius of a mass under sampled friction with a zero-order hold of the force.

    It is the largest of the linearizations at z = 0 and speeds up to the law's natural speed. A free body has 1.
    """
    speeds = law.scales(law.p).speed * np.logspace(-9, 0, 40)
    _, by_v, by_z, force_v, force_z = law._evaluate(speeds, np.zeros_like(speeds))
    x = by_z * step
    grown = np.exp(x)
    driven = step * by_v * np.where(abs(x) > 1e-12, np.expm1(x) / np.where(x == 0, 1, x), 1)
    # v and z after a sample: z first, then the force of the new z moves the body
    lost = step / mass
    matrix = np.array([[1 - lost * (force_v + force_z * driven), -lost * force_z * grown], [driven, grown]])
    return float(np.max(abs(np.linalg.eigvals(np.moveaxis(matrix, -1, 0)))))

"""What a law in discrete time cannot keep: said before an export is written."""

from __future__ import annotations

import numpy as np

from stribeck.errors import arg
from stribeck.export.request import Request
from stribeck.laws.base import Law

_LIMIT = 1 + 1e-9  # a body that nothing damps has 1, but for rounding


def resolution(request: Request) -> list[str]:
    """Whether the request's time step resolves the bristles' motion; nothing where no step is given."""
    law, step = request.law, request.step
    if step is None or not law.has_z:
        return []
    speed = law.scales(law.p).speed
    relaxation = 1 / abs(float(law.jacobian(speed, law.steady_deflection(speed))[1]))
    if step > relaxation:
        return [
            f"{arg('step')}: {step:g} s is longer than the bristles' time constant at {speed:g} m/s ({relaxation:.2g} s): "
            "the step stays stable, but it does not show how the force builds up"
        ]
    return []


def unstable(request: Request) -> list[str]:
    """What the streaming step loses at the request's time step; nothing where no step is given."""
    law, step, found = request.law, request.step, resolution(request)
    if step is None or not law.has_z:
        return found
    mass = getattr(request.scenario, "mass", None)
    if mass is not None and radius(law, mass, step) > _LIMIT:
        low, high = 0.0, step
        for _ in range(60):
            middle = (low + high) / 2
            low, high = (low, middle) if radius(law, mass, middle) > _LIMIT else (middle, high)
        found.append(
            f"{arg('step')}: at {step:g} s the sampled friction and a mass of {mass:g} kg are unstable together "
            f"(stable below {low:.3g} s), so the law is not passive there: use {request.name}_body_step, which is stable"
        )
    return found


def radius(law: Law, mass: float, step: float) -> float:
    """Spectral radius of a mass under the sampled friction, the force of each sample held: linearised at z = 0, the
    greatest at speeds up to the law's own. It is 1 for a body that nothing holds."""
    speeds = law.scales(law.p).speed * np.logspace(-9, 0, 40)
    _, by_v, by_z, force_v, force_z = law._evaluate(speeds, np.zeros_like(speeds))
    x = by_z * step
    grown = np.exp(x)
    driven = step * by_v * np.where(abs(x) > 1e-12, np.expm1(x) / np.where(x == 0, 1, x), 1)
    # v and z after a sample: z first, then the force of the new z moves the body
    lost = step / mass
    matrix = np.array([[1 - lost * (force_v + force_z * driven), -lost * force_z * grown], [driven, grown]])
    return float(np.max(abs(np.linalg.eigvals(np.moveaxis(matrix, -1, 0)))))

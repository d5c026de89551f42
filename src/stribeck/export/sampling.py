"""What a law in discrete time cannot keep: said before an export is written."""

from __future__ import annotations

import numpy as np

from stribeck.export.request import Request
from stribeck.laws.base import Law


def resolution(request: Request) -> list[str]:
    """Whether the request's time step resolves the bristles' motion; nothing where no step is given."""
    law, step = request.law, request.step
    if step is None or not law.has_z:
        return []
    speed = law.scales(law.p).speed
    relaxation = 1 / abs(float(law.jacobian(speed, law.steady_deflection(speed))[1]))
    if step > relaxation:
        return [
            f"--step: {step:g} s is longer than the bristles' time constant at {speed:g} m/s ({relaxation:.2g} s): "
            "the step stays stable, but it does not show how the force builds up"
        ]
    return []


def unstable(request: Request) -> list[str]:
    """What the streaming step loses at the request's time step; nothing where no step is given."""
    law, step, found = request.law, request.step, resolution(request)
    if step is None or not law.has_z:
        return found
    mass = getattr(request.scenario, "mass", None)
    if mass is not None and radius(law, mass, step) > 1:
        low, high = 0.0, step
        for _ in range(60):
            middle = (low + high) / 2
            low, high = (low, middle) if radius(law, mass, middle) > 1 else (middle, high)
        found.append(
            f"--step: at {step:g} s the sampled friction and a mass of {mass:g} kg are unstable together "
            f"(stable below {low:.3g} s), so the law is not passive there: use {request.name}_body_step, which is stable"
        )
    return found


def radius(law: Law, mass: float, step: float) -> float:
    """Spectral radius of a mass under the sampled friction, the force of each sample held; about rest, z = 0, at the
    speed where the bristles are stiffest. 1 is a body that is free to go on."""
    speeds = law.scales(law.p).speed * np.logspace(-9, 0, 40)
    by_v, by_z = law.jacobian(speeds, np.zeros_like(speeds))
    i = int(np.argmax(by_v))
    a, b = float(by_z[i]), float(by_v[i])
    _, _, _, force_v, force_z = (float(x) for x in law._evaluate(np.asarray(speeds[i]), np.asarray(0.0)))
    x = a * step
    grown, driven = np.exp(x), step * b * (np.expm1(x) / x if abs(x) > 1e-12 else 1.0)
    # v and z after a sample: z first, then the force of the new z moves the body
    z_v, z_z = driven, grown
    matrix = np.array([[1 - step / mass * (force_v + force_z * z_v), -step / mass * force_z * z_z], [z_v, z_z]])
    return float(max(abs(np.linalg.eigvals(matrix)))) - 1e-12

"""python-control: a law, or a body with it, as a nonlinear I/O system, and a solver that suits it."""

from __future__ import annotations

from types import ModuleType, SimpleNamespace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from stribeck.constants import show
from stribeck.errors import InputError
from stribeck.exports.optional import package
from stribeck.expressions.ops import Value
from stribeck.laws.base import Law
from stribeck.machine.elements.bodies import MASS, sum_of_forces

if TYPE_CHECKING:
    import control

_RTOL = 1e-8  # the default of a scenario, solve.rtol


def to_control(law: Law, mass: float | None = None) -> control.NonlinearIOSystem:
    """A law for python-control: input v, output F, state z; with a ``mass`` in kg a body: input u, outputs y, v, F.

    Constants are the system's parameters: ``params={"F_s": 2.0}`` replaces one. Simulate it with :func:`response`.
    The default of python-control, RK45 with an absolute tolerance of 1e-6, is wrong for friction.

    Raises:
        InputError: the mass is not a finite number > 0.
        MissingExtra: python-control is not installed.
    """
    ct: ModuleType = package("control")
    if mass is not None and (text := MASS.problem(mass)):
        raise InputError(f"mass: {show(mass)}: {text}")
    plant = SimpleNamespace(mass=mass)

    def quantities(x: Value, u: Value, params: dict[str, Value]) -> tuple[Value, ...]:
        p = law.p.replaced({n: a for n, a in params.items() if n in law.values})
        v = u[0] if mass is None else x[1]
        z = x[-1] if law.has_z else 0.0
        rate = law.dz_dt(p, v, z)
        return v, rate, law.friction(p, v, z, rate)

    def derivatives(t: float, x: Value, u: Value, params: dict[str, Value]) -> Value:
        v, rate, force = quantities(x, u, params)
        body = [] if mass is None else [v, sum_of_forces(u[0], force) / plant.mass]
        return np.array([*body, *([rate] if law.has_z else [])], float)

    def outputs(t: float, x: Value, u: Value, params: dict[str, Value]) -> Value:
        v, _, force = quantities(x, u, params)
        return np.array([force] if mass is None else [x[0], v, force], float)

    body, bristle = ([] if mass is None else ["y", "v"]), (["z"] if law.has_z else [])
    system = ct.nlsys(
        derivatives if body or bristle else None, outputs, name=law.name, inputs=["v" if mass is None else "u"],
        outputs=[*body, "F"], **({"states": [*body, *bristle]} if body or bristle else {}),
        params=law.p.numbers,
    )  # fmt: skip
    system.friction = law
    return system


def response(system: Value, T: ArrayLike, U: ArrayLike = 0.0, X0: ArrayLike = 0.0, **options: Value) -> Value:
    """``control.input_output_response`` with a solver that suits friction.

    The solver is LSODA, which becomes implicit if the contact is stiff. The relative tolerance is 1e-8. The absolute one is
    1e-9 of the smallest deflection F_s/sigma_0 in the system. SciPy's default, 1e-6, is as large as z itself. Steps are
    at most 1/100 of the time span, so that no corner of the input is missed.

    Args:
        system: a system of :func:`to_control`, or an interconnection of them.
        T, U, X0: times, inputs and initial states of python-control.
        **options: further arguments of ``control.input_output_response``; ``solve_ivp_kwargs`` are merged.
    """
    ct: ModuleType = package("control")
    T = np.asarray(T, float)
    lengths = [law.scales(law.p).length for law in _laws(system)]
    chosen = {"rtol": _RTOL, "atol": 0.1 * _RTOL * min(lengths, default=1.0), "max_step": float(np.ptp(T)) / 100}
    chosen |= {"method": options.pop("solve_ivp_method", "LSODA"), **options.pop("solve_ivp_kwargs", {})}
    return ct.input_output_response(system, T, U, X0, solve_ivp_kwargs=chosen, **options)


def _laws(system: Value) -> list[Law]:
    laws = [system.friction] if hasattr(system, "friction") else []
    return laws + [law for part in getattr(system, "syslist", ()) for law in _laws(part)]

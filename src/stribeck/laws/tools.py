"""A law in other tools: the methods by which users reach :mod:`stribeck.export` from a law."""

from __future__ import annotations

import importlib
from collections.abc import Sequence
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import casadi
    import control


class ToTools:
    """What hands a law to a design tool; each method needs the tool's package (``pip install control`` or ``casadi``).

    The exporters stand above the laws, so they are found by name and only when they are called.
    """

    def to_control(self, mass: float | None = None) -> control.NonlinearIOSystem:
        """The law for python-control: input v, output F, state z; with a ``mass`` in kg a body: input u, outputs y, v, F.

        Constants are the system's parameters: ``params={"F_s": 2.0}`` replaces one.

        Simulate it with :func:`stribeck.export.python.python_control.response`: python-control's own default, RK45 with
        an absolute tolerance of 1e-6, is wrong for friction.

        Raises:
            InputError: the mass is no finite number > 0.
        """
        return _exporter("python_control").to_control(self, mass)

    def to_casadi(self, free: Sequence[str] = ()) -> casadi.Function:
        """The law as a CasADi function (v, z) -> (dz_dt, F); static laws have no z and give F alone.

        Args:
            free: constants that become further inputs, after the others, in this order.

        Raises:
            InputError: the law is not smooth, so that optimisation would rely on derivatives that do not exist; or it
                has no such constant.
        """
        function: casadi.Function = _exporter("casadi").to_casadi(self, free)
        return function

    def to_jax(self) -> Any:
        """The law in JAX: ``rate``, ``force``, and ``step`` for simulators; for grad, jit and vmap.

        See :class:`stribeck.export.python.jax.JaxLaw`.
        """
        return _exporter("jax").to_jax(self)

    def to_torch(self) -> Any:
        """The law in PyTorch: ``rate``, ``force``, and ``step(state, v, effort, inertia, dt, load) -> (state, friction)``.

        See :class:`stribeck.export.python.torch.TorchLaw`.
        """
        return _exporter("torch").to_torch(self)

    def to_warp(self, precision: str = "single") -> Any:
        """The law as kernels of NVIDIA Warp: ``step(state, v, effort, inertia, dt) -> (state, friction)``.

        See :class:`stribeck.export.python.warp.WarpLaw`.

        Args:
            precision: ``single`` or ``double``.

        Raises:
            InputError: no such precision.
        """
        return _exporter("warp").to_warp(self, precision)


def _exporter(tool: str) -> ModuleType:
    return importlib.import_module(f"stribeck.export.python.{tool}")

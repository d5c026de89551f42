"""JAX: a law's equations on JAX arrays, with gradients by every argument and constant."""

from __future__ import annotations

from typing import Any

from stribeck.constants import show
from stribeck.errors import InputError, nearest, note
from stribeck.export.optional import package
from stribeck.expressions import ops
from stribeck.laws.base import Law
from stribeck.laws.values import Constants


class _Backend:
    """The operations of :mod:`stribeck.expressions.ops` on JAX arrays and tracers."""

    _names = {"atan": "arctan", "both": "logical_and", "either": "logical_or"}

    def __getattr__(self, op: str) -> Any:
        return getattr(package("jax.numpy", "jax"), self._names.get(op, op))


for _package in ("jax", "jaxlib"):  # tracers live in the one, arrays in the other
    ops.register(_package, _Backend())


class JaxLaw:
    """A law on JAX arrays; a pure function of its arguments, so grad, jit and vmap apply.

    The law's constants hold unless they are given by name: ``jax.grad(lambda F_s: law.force(v, z, F_s=F_s))(1.5)``.
    At a kink (v = 0 of a law with \\|v\\|) the gradient is that of sgn 0 = 0, halfway between the two sides.
    """

    def __init__(self, law: Law) -> None:
        self.law = law

    def _constants(self, given: dict[str, Any]) -> Constants:
        known = list(self.law.p.numbers)
        if odd := [name for name in given if name not in known]:
            raise InputError(
                [f"{n} = {show(given[n])}: law '{self.law.name}' has no such constant{nearest(n, known)}" for n in odd]
            )
        return self.law.p.replaced(given)

    def rate(self, v: Any, z: Any, **constants: Any) -> Any:
        """dz/dt in m/s for velocities v (m/s) and deflections z (m)."""
        v, z = self._arrays(v, z)
        return self.law.dz_dt(self._constants(constants), v, z)

    def force(self, v: Any, z: Any = 0.0, **constants: Any) -> Any:
        """Friction force in N for velocities v (m/s) and deflections z (m)."""
        v, z = self._arrays(v, z)
        p = self._constants(constants)
        return self.law.friction(p, v, z, self.law.dz_dt(p, v, z))

    @staticmethod
    def _arrays(*values: Any) -> tuple[Any, ...]:
        return tuple(package("jax.numpy", "jax").asarray(x, float) for x in values)


def to_jax(law: Law) -> JaxLaw:
    """See :meth:`stribeck.laws.Law.to_jax`."""
    jax: Any = package("jax", "jax")
    if not jax.config.jax_enable_x64:
        note(
            "JAX computes in single precision unless told otherwise: jax.config.update('jax_enable_x64', True) gives "
            "the numbers of Stribeck"
        )
    return JaxLaw(law)

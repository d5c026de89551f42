"""JAX: a law's equations on JAX arrays, with gradients by every argument and constant."""

from __future__ import annotations

from types import ModuleType, SimpleNamespace

from stribeck.errors import note
from stribeck.exports.optional import Operations, package
from stribeck.exports.python import stepping
from stribeck.exports.python.arrays import ArrayLaw
from stribeck.expressions import ops
from stribeck.expressions.ops import Value
from stribeck.laws.base import Law

_NUMPY = Operations("jax.numpy", atan="arctan", both="logical_and", either="logical_or")
for _package in ("jax", "jaxlib"):  # packages of tracers and of arrays
    ops.register(_package, _NUMPY)


class JaxLaw(ArrayLaw):
    """A law on JAX arrays; a pure function of its arguments, so grad, jvp, jit, vmap and scan apply.

    Constants given by name replace those of the law: ``jax.grad(lambda F_s: law.force(v, z, F_s=F_s))(1.5)``.
    At a kink (v = 0 of a law with \\|v\\|) the gradient is that of sgn 0 = 0, halfway between the two sides.
    """

    def __init__(self, law: Law) -> None:
        super().__init__(law, _NUMPY, package("jax.numpy").broadcast_arrays)
        self._differentiable = _differentiable(self._equations)

    def _arrays(self, *values: Value) -> list[Value]:
        return [package("jax.numpy").asarray(x, float) for x in values]

    def _step(self, p: dict[str, Value], given: tuple[Value, ...]) -> tuple[Value, Value]:
        x, force, _, _ = self._differentiable(p, given)
        return x, force


def _loop(body: Value, state: Value) -> Value:
    """Repeat body while any entry of state[0] is unfinished."""
    lax: ModuleType = package("jax.lax")
    return lax.while_loop(lambda s: s[0].any(), lambda s: tuple(body(s)), tuple(state))


def _differentiable(equations: Value) -> Value:
    """The step with its derivative by the implicit function theorem."""
    jax: ModuleType = package("jax")
    jnp = jax.numpy

    @jax.custom_jvp  # type: ignore[untyped-decorator]
    def step(p: Value, given: Value) -> Value:
        return stepping.solved(jnp, _loop, equations, SimpleNamespace(**p), given)

    @step.defjvp  # type: ignore[untyped-decorator]
    def derivative(values: Value, moved: Value) -> Value:
        (p, given), (constants, changes) = values, moved
        x, force, w, jump = step(p, given)
        x_, force_ = stepping.tangent(jnp, equations, SimpleNamespace(**p), (x, w, jump), given, changes, constants)
        nothing = jnp.zeros(jump.shape, jax.dtypes.float0)
        return (x, force, w, jump), (x_, force_, 0 * w, nothing)

    return step


def to_jax(law: Law) -> JaxLaw:
    """A law in JAX: ``rate``, ``force``, and ``step`` for simulators; for grad, jit and vmap."""
    jax: ModuleType = package("jax")
    if not jax.config.jax_enable_x64:
        note(
            "JAX computes in single precision by default: jax.config.update('jax_enable_x64', True) gives "
            "the numbers of Stribeck"
        )
    return JaxLaw(law)

"""JAX: a law's equations on JAX arrays, with gradients by every argument and constant."""

from __future__ import annotations

from types import ModuleType, SimpleNamespace

from stribeck.errors import note
from stribeck.exports.optional import Operations, package
from stribeck.exports.python import stepping
from stribeck.exports.python.constants import with_load
from stribeck.exports.python.written import FUNCTIONS, written_equations
from stribeck.expressions import ops
from stribeck.expressions.ops import Value
from stribeck.laws.base import Law
from stribeck.laws.values import Constants

_NUMPY = Operations("jax.numpy", atan="arctan", both="logical_and", either="logical_or")
for _package in ("jax", "jaxlib"):  # packages of tracers and of arrays
    ops.register(_package, _NUMPY)


class JaxLaw:
    """A law on JAX arrays; a pure function of its arguments, so grad, jit and vmap apply.

    Constants given by name replace those of the law: ``jax.grad(lambda F_s: law.force(v, z, F_s=F_s))(1.5)``.
    At a kink (v = 0 of a law with \\|v\\|) the gradient is that of sgn 0 = 0, halfway between the two sides.
    """

    def __init__(self, law: Law) -> None:
        self.law = law
        self._step: Value = None

    def _values_at_load(self, constants: dict[str, Value], load: Value) -> dict[str, Value]:
        return with_load(self.law, constants, None if load is None else self._arrays(load)[0])

    def _constants(self, given: dict[str, Value], load: Value) -> Constants:
        return self.law.p.replaced(self._values_at_load(given, load))

    def rate(self, v: Value, z: Value, load: Value = None, **constants: Value) -> Value:
        """dz/dt in m/s for velocities v (m/s) and deflections z (m)."""
        v, z = self._arrays(v, z)
        return self.law.dz_dt(self._constants(constants, load), v, z)

    def force(self, v: Value, z: Value = 0.0, load: Value = None, **constants: Value) -> Value:
        """Friction force in N for velocities v (m/s) and deflections z (m)."""
        v, z = self._arrays(v, z)
        p = self._constants(constants, load)
        return self.law.friction(p, v, z, self.law.dz_dt(p, v, z))

    def step(
        self,
        state: Value,
        v: Value,
        effort: Value,
        inertia: Value,
        dt: Value,
        load: Value = None,
        **constants: Value,
    ) -> tuple[Value, Value]:
        """One implicit step of joints and their bristles: the next state, and the friction during the step.

        See :meth:`stribeck.exports.python.torch.TorchLaw.step`; grad, jvp, jit, vmap and scan apply.
        """
        given = self._values_at_load(constants, load)
        numbers = {n: x for n, x in {**self.law.values, **given}.items() if x is not None}
        jnp: ModuleType = package("jax.numpy")
        arrays = jnp.broadcast_arrays(*self._arrays(state, v, effort, inertia, dt, *numbers.values()))
        if self._step is None:
            self._step = _differentiable(self.law)
        x, force, _, _ = self._step(dict(zip(numbers, arrays[5:], strict=True)), tuple(arrays[:5]))
        return x, force

    @staticmethod
    def _arrays(*values: Value) -> tuple[Value, ...]:
        return tuple(package("jax.numpy").asarray(x, float) for x in values)


def _loop(body: Value, state: Value) -> Value:
    """Repeat body while any entry of state[0] is unfinished."""
    lax: ModuleType = package("jax.lax")
    return lax.while_loop(lambda s: s[0].any(), lambda s: tuple(body(s)), tuple(state))


def _equations(law: Law) -> Value:
    return written_equations(law, {name: getattr(_NUMPY, name) for name in FUNCTIONS} | {"like": _NUMPY.full_like})


def _differentiable(law: Law) -> Value:
    """The step with its derivative by the implicit function theorem."""
    jax: ModuleType = package("jax")
    jnp, equations = jax.numpy, _equations(law)

    @jax.custom_jvp  # type: ignore[untyped-decorator]
    def step(p: Value, given: Value) -> Value:
        return stepping.solved(jnp, _loop, equations, SimpleNamespace(**p), given)

    @step.defjvp  # type: ignore[untyped-decorator]
    def derivative(values: Value, moved: Value) -> Value:
        (p, given), (constants, changes) = values, moved
        x, force, w, jump = step(p, given)
        x_, force_ = stepping.tangent(jnp, equations, SimpleNamespace(**p), (x, w, jump), given, changes, constants)
        nothing = jax.numpy.zeros(jump.shape, jax.dtypes.float0)
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

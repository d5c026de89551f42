"""PyTorch: a law's equations on tensors, and an implicit step of thousands of joints, with gradients."""

from __future__ import annotations

from types import ModuleType, SimpleNamespace

from stribeck.exports.optional import Operations, package
from stribeck.exports.python import stepping
from stribeck.exports.python.constants import with_load
from stribeck.exports.python.written import FUNCTIONS, written_equations
from stribeck.expressions import ops
from stribeck.expressions.ops import Value
from stribeck.laws.base import Law

_TENSORS = Operations("torch", both="logical_and", either="logical_or")
ops.register("torch", _TENSORS)


class TorchLaw:
    """A law on PyTorch tensors.

    Constants given by name replace those of the law, as a number or one for each world. Example:

        law.step(z, v, effort, inertia, dt, F_s=1.5 + torch.rand(4096))

    Tensors have the type of ``v`` (or of ``z``). Single precision is sufficient; double precision is accurate to about 1e-9.
    """

    def __init__(self, law: Law) -> None:
        torch: ModuleType = package("torch")
        self.law = law
        self._torch = torch
        scope = {name: getattr(_TENSORS, name) for name in FUNCTIONS}
        self._equations = written_equations(law, {**scope, "like": torch.full_like})

    def rate(self, v: Value, z: Value, load: Value = None, **constants: Value) -> Value:
        """dz/dt in m/s for velocities v (m/s) and deflections z (m)."""
        p, (v, z) = self._prepared(load, constants, v, z)
        return self._equations.slopes(p, v, z)[0] + 0 * v

    def force(self, v: Value, z: Value = 0.0, load: Value = None, **constants: Value) -> Value:
        """Friction force in N for velocities v (m/s) and deflections z (m)."""
        p, (v, z) = self._prepared(load, constants, v, z)
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

        The engine's next velocity is ``v + dt (effort - friction)/inertia``. The engine is then as stable as the law at any step,
        and sticks when the law sticks. First-order gradients exist for every argument and constant.

        Args:
            state: z of every joint, m (rad); zeros at first. All arguments broadcast.
            v: the velocities at the start of the step, m/s (rad/s).
            effort: all other forces on the joints during the step, N (N m): drives, gravity, the rest of the machine.
            inertia: effective inertia of the joints, kg (kg m^2); a value below the true one is safe.
            dt: the step, s.
            load: inputs of a contact (:func:`stribeck.exports.contact_law`), constant over the step: along the last axis,
                or a single input.
            **constants: constants that replace those of the law.

        Returns:
            z and the friction, N (N m), positive against positive velocity; nan if a number was not finite.
        """
        p, given = self._prepared(load, constants, v, state, effort, inertia, dt)
        v, state, *rest = self._torch.broadcast_tensors(*given, *vars(p).values())[:5]
        names = [name for name, value in vars(p).items() if value.requires_grad]
        arguments = (state, v, *rest)
        if self._torch.is_grad_enabled() and (names or any(x.requires_grad for x in arguments)):
            step = _differentiable(self._torch)
            z, friction = step(self._equations, p, names, *arguments, *(getattr(p, n) for n in names))
            return z, friction
        z, friction, _, _ = stepping.solved(self._torch, stepping.loop, self._equations, p, arguments)
        return z, friction

    def _prepared(
        self, load: Value, constants: dict[str, Value], *values: Value
    ) -> tuple[SimpleNamespace, list[Value]]:
        """The constants and the values as tensors of one type, on one device."""
        given = with_load(self.law, constants, None if load is None else self._torch.as_tensor(load))
        tensors = [x for x in values if self._torch.is_tensor(x)]
        like = next((x for x in tensors if x.is_floating_point()), self._torch.zeros((), dtype=self._torch.float64))

        def tensor(x: Value) -> Value:
            return self._torch.as_tensor(x, dtype=like.dtype, device=like.device)

        numbers = {n: tensor(x) for n, x in {**self.law.values, **given}.items() if x is not None}
        return SimpleNamespace(**numbers), [tensor(x) for x in values]


_function: list[Value] = []


def _differentiable(torch: Value) -> Value:
    """The step as a function with its own gradient, defined when torch is available."""
    if not _function:
        from torch.autograd.function import once_differentiable

        class Step(torch.autograd.Function):  # type: ignore[misc]
            @staticmethod
            def forward(ctx: Value, law: Value, p: Value, names: Value, *values: Value) -> Value:
                given = tuple(x.detach() for x in values[:5])
                bare = SimpleNamespace(**{n: x.detach() for n, x in vars(p).items()})
                x, force, w, jump = stepping.solved(torch, stepping.loop, law, bare, given)
                ctx.law, ctx.p, ctx.names, ctx.solution, ctx.given = law, bare, names, (x, w, jump), given
                ctx.shapes = [value.shape for value in values]
                return x, force

            @staticmethod
            @once_differentiable  # type: ignore[untyped-decorator]
            def backward(ctx: Value, by_z: Value, by_force: Value) -> Value:
                first, each = stepping.adjoint(torch, ctx.law, ctx.p, ctx.solution, ctx.given, by_z, by_force)
                gradients = [*first, *(each[name] for name in ctx.names)]
                return None, None, None, *(g.sum_to_size(s) for g, s in zip(gradients, ctx.shapes, strict=True))

        _function.append(Step.apply)
    return _function[0]


def to_torch(law: Law) -> TorchLaw:
    """A law in PyTorch: ``rate``, ``force``, and ``step(state, v, effort, inertia, dt, load) -> (state, friction)``."""
    return TorchLaw(law)

"""PyTorch: a law's equations on tensors, and an implicit step of thousands of joints, with gradients."""

from __future__ import annotations

from types import ModuleType, SimpleNamespace

from stribeck.exports.optional import Operations, package
from stribeck.exports.python import stepping
from stribeck.exports.python.arrays import ArrayLaw
from stribeck.expressions import ops
from stribeck.expressions.ops import Value
from stribeck.laws.base import Law

_TENSORS = Operations("torch", both="logical_and", either="logical_or")
ops.register("torch", _TENSORS)


class TorchLaw(ArrayLaw):
    """A law on PyTorch tensors.

    Tensors have the type of ``v`` (or of ``z``). Single precision is sufficient; double precision is accurate to about 1e-9.
    """

    def __init__(self, law: Law) -> None:
        torch: ModuleType = package("torch")
        super().__init__(law, _TENSORS, torch.broadcast_tensors)
        self._torch = torch

    def _arrays(self, *values: Value) -> list[Value]:
        tensors = [x for x in values if self._torch.is_tensor(x) and x.is_floating_point()]
        like = tensors[0] if tensors else self._torch.zeros((), dtype=self._torch.float64)
        return [self._torch.as_tensor(x, dtype=like.dtype, device=like.device) for x in values]

    def _step(self, p: dict[str, Value], given: tuple[Value, ...]) -> tuple[Value, Value]:
        """The solution, plus its tangent along what each argument differs from itself: 0, with the gradient."""
        numbers, at = SimpleNamespace(**{n: x.detach() for n, x in p.items()}), tuple(x.detach() for x in given)
        z, friction, w, jump = stepping.solved(self._torch, stepping.loop, self._equations, numbers, at)
        moved = {n: x - x.detach() for n, x in p.items() if x.requires_grad}
        if not self._torch.is_grad_enabled() or not (moved or any(x.requires_grad for x in given)):
            return z, friction
        changes, solution = tuple(x - x.detach() for x in given), (z, w, jump)
        z_, friction_ = stepping.tangent(self._torch, self._equations, numbers, solution, at, changes, moved)
        return z + z_, friction + friction_


def to_torch(law: Law) -> TorchLaw:
    """A law in PyTorch: ``rate``, ``force``, and ``step(state, v, effort, inertia, dt, load) -> (state, friction)``."""
    return TorchLaw(law)

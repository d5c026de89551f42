"""A law's equations on the arrays of another library, and an implicit step of thousands of joints, with gradients."""

from __future__ import annotations

from abc import ABC, abstractmethod

from stribeck.constants import show
from stribeck.errors import InputError, nearest
from stribeck.exports.optional import Operations
from stribeck.exports.python.written import FUNCTIONS, written_equations
from stribeck.expressions.ops import Value
from stribeck.laws.base import Law


class ArrayLaw(ABC):
    """A law on arrays.

    Constants given by name replace those of the law, as a number or one for each world:
    ``law.step(z, v, effort, inertia, dt, F_s=1.5 + torch.rand(4096))``.

    Args:
        law: the law.
        operations: the library's functions.
        broadcast: the library's function that brings arrays to one shape.
    """

    def __init__(self, law: Law, operations: Operations, broadcast: Value) -> None:
        self.law, self._broadcast = law, broadcast
        scope = {name: getattr(operations, name) for name in (*FUNCTIONS, "full_like")}
        self._equations = written_equations(law, {**scope, "like": scope["full_like"]})

    def rate(self, v: Value, z: Value, load: Value = None, **constants: Value) -> Value:
        """dz/dt in m/s for velocities v (m/s) and deflections z (m)."""
        p, (v, z) = self._prepared(load, constants, v, z)
        return self.law.dz_dt(self.law.p.replaced(p), v, z) + 0 * v

    def force(self, v: Value, z: Value = 0.0, load: Value = None, **constants: Value) -> Value:
        """Friction force in N for velocities v (m/s) and deflections z (m)."""
        p, (v, z) = self._prepared(load, constants, v, z)
        numbers = self.law.p.replaced(p)
        return self.law.friction(numbers, v, z, self.law.dz_dt(numbers, v, z))

    def step(
        self, state: Value, v: Value, effort: Value, inertia: Value, dt: Value, load: Value = None, **constants: Value
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
        p, given = self._prepared(load, constants, state, v, effort, inertia, dt)
        arrays = self._broadcast(*given, *p.values())
        return self._step(p, tuple(arrays[:5]))

    @abstractmethod
    def _arrays(self, *values: Value) -> list[Value]:
        """The values as arrays of one type."""

    @abstractmethod
    def _step(self, p: dict[str, Value], given: tuple[Value, ...]) -> tuple[Value, Value]:
        """The step (:func:`stribeck.exports.python.stepping.solved`) with its derivative."""

    def _prepared(
        self, load: Value, constants: dict[str, Value], *values: Value
    ) -> tuple[dict[str, Value], list[Value]]:
        """The constants and the values as arrays of one type.

        Raises:
            InputError: the law has no such constant, or it has inputs but no load is given, or the reverse.
        """
        law, known = self.law, list(self.law.p.numbers)
        if odd := [name for name in constants if name not in known]:
            raise InputError(
                [f"{n} = {show(constants[n])}: law '{law.name}' has no such constant{nearest(n, known)}" for n in odd]
            )
        numbers = {**law.p.numbers, **constants, **self._inputs(load)}
        arrays = self._arrays(*values, *numbers.values())
        return dict(zip(numbers, arrays[len(values) :], strict=True)), arrays[: len(values)]

    def _inputs(self, load: Value) -> dict[str, Value]:
        """The law's inputs: the entries of ``load`` along its last axis, or ``load`` itself."""
        names = self.law.inputs
        if load is None and names:
            raise InputError(f"load: missing: must be an array whose last axis has {', '.join(names)}")
        if load is None:
            return {}
        if not names:
            raise InputError(f"load: must be left out: law '{self.law.name}' has no inputs")
        (load,) = self._arrays(load)
        if len(names) > 1 and load.shape[-1] != len(names):
            raise InputError(f"load: {load.shape[-1]} entries along the last axis: must be {', '.join(names)}")
        entries = [load] if len(names) == 1 else [load[..., i] for i in range(len(names))]
        return dict(zip(names, entries, strict=True))

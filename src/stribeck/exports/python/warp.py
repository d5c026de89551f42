"""NVIDIA Warp: a law's implicit step as kernels, one thread a joint, with gradients on Warp's tape."""

from __future__ import annotations

import hashlib
import linecache
from types import ModuleType

import numpy as np

from stribeck.errors import InputError, arg
from stribeck.exports.c.ccode import render
from stribeck.exports.optional import package
from stribeck.exports.python.constants import checked
from stribeck.exports.python.written import Written
from stribeck.exports.request import Content, Request
from stribeck.expressions.ops import Value
from stribeck.laws.base import Law

PRECISIONS = {"single": "float32", "double": "float64"}


def text(law: Law, real: str, template: str = "kernels_warp.txt", **values: Value) -> str:
    """Python source of the law's functions and kernels for Warp."""
    return render(template, eq=Written(law), real=real, **values)


def joints(tool: str, request: Request) -> Content:
    """The Python file with joint friction for an engine of learning, which computes in single precision."""
    about, law = request.in_docstring(), request.law
    content = text(law, "float32", f"{tool}.txt", about=about, inputs=law.inputs, start=request.z)
    return {f"{request.name}_{tool}.py": content}


def load(source: str) -> dict[str, Value]:
    """The definitions in a source of kernels. Warp reads a kernel's text by file name and line, so it is registered."""
    name = f"stribeck_warp_{hashlib.sha256(source.encode()).hexdigest()[:16]}"
    file = f"<{name}>"
    linecache.cache[file] = (len(source), None, source.splitlines(keepends=True), file)
    scope: dict[str, Value] = {"__name__": name}  # a separate module of Warp
    exec(compile(source, file, "exec"), scope)
    return scope


class WarpLaw:
    """A law on Warp's arrays: every argument an array of one entry a joint (``inertia``, ``dt``: or one for all).

    ``constants`` is the array of the law's constants in the order of ``names``. It has one row for all joints, or one a
    joint; ``step`` takes another one. Numbers are float32, or float64 with ``precision="double"``.
    """

    def __init__(self, law: Law, precision: str = "single") -> None:
        if precision not in PRECISIONS:
            raise InputError(f"{arg('precision')}: {precision!r}: must be one of {', '.join(PRECISIONS)}")
        self.law = law
        self._wp: ModuleType = package("warp")
        self._scope = load(text(law, PRECISIONS[precision]))
        self.real = self._scope["real"]
        self.names: list[str] = list(self._scope["CONSTANTS"])

    def constants(self, count: int = 1, device: Value = None, requires_grad: bool = False, **given: Value) -> Value:
        """The array of constants with ``count`` rows; ``given`` replaces some by name, by a number or one for each row.

        Raises:
            InputError: the law has no such constant.
        """
        known = {**self.law.values, **checked(self.law, given)}
        table = np.stack([np.broadcast_to(np.asarray(known[n], float), (count,)) for n in self.names], axis=1)
        return self._wp.array(table, dtype=self.real, device=device, requires_grad=requires_grad)

    def step(
        self,
        state: Value,
        v: Value,
        effort: Value,
        inertia: Value,
        dt: Value,
        load: Value = None,
        constants: Value = None,
    ) -> tuple[Value, Value]:
        """One implicit step of joints and their bristles: the next state, and the friction during the step.

        See :meth:`stribeck.exports.python.torch.TorchLaw.step`. ``inertia`` and ``dt`` may be numbers. On an active
        ``wp.Tape`` the step is recorded, with gradients to every array that requires one, ``constants`` included.
        """
        wp, count = self._wp, len(v)
        inputs = [self._array(x, v.device) for x in (state, v, effort, inertia, dt)]
        p = self._at_load(constants, load, count, v.device)
        tape = wp._src.context.runtime.tape
        wanted = tape is not None and any(x.requires_grad for x in (p, *inputs))
        z, force, end = (wp.zeros(count, dtype=self.real, device=v.device, requires_grad=wanted) for _ in range(3))
        jump = wp.zeros(count, dtype=int, device=v.device)
        self._launch("forward", count, [p, *inputs], [z, force, end, jump], v.device)
        if wanted:
            _, v_, _, inertia_, dt_ = inputs

            def backward() -> None:
                given = [p, v_, inertia_, dt_, z, end, jump, z.grad, force.grad]
                self._launch("backward", count, given, [self._gradient(x) for x in (p, *inputs)], v.device)

            tape.record_func(backward, [x for x in (p, *inputs, z, force) if x.requires_grad])
        return z, force

    def _at_load(self, constants: Value, load: Value, count: int, device: Value) -> Value:
        """The table of constants with the inputs of a contact's law; recorded on an active tape."""
        p = self.constants(device=device) if constants is None else constants
        names = self.law.inputs
        if (load is None) != (not names):
            text = (
                f"must be an array of {', '.join(names)} a joint" if names else "must be left out: there are no inputs"
            )
            raise InputError(f"load: {text}")
        if load is None:
            return p
        load = load.reshape((count, 1)) if load.ndim == 1 else load
        wanted = p.requires_grad or load.requires_grad
        table = self._wp.zeros((count, len(self.names)), dtype=self.real, device=device, requires_grad=wanted)
        self._wp.launch(self._scope["at_load"], count, inputs=[p, load], outputs=[table], device=device)
        return table

    def _launch(self, kernel: str, count: int, inputs: list[Value], outputs: list[Value], device: Value) -> None:
        self._wp.launch(self._scope[kernel], count, inputs=inputs, outputs=outputs, device=device, record_tape=False)

    def _array(self, x: Value, device: Value) -> Value:
        if isinstance(x, self._wp.array):
            return x
        return self._wp.array(np.atleast_1d(np.asarray(x, float)), dtype=self.real, device=device)

    def _gradient(self, x: Value) -> Value:
        """The array to which the gradient is added, or an empty one if none is requested."""
        if x.requires_grad:
            return x.grad
        return self._wp.empty((0,) * x.ndim, dtype=self.real, device=x.device)


def to_warp(law: Law, precision: str = "single") -> WarpLaw:
    """A law as kernels of NVIDIA Warp: ``step(state, v, effort, inertia, dt) -> (state, friction)``.

    Args:
        law: the law with its constants.
        precision: ``single`` or ``double``.

    Raises:
        InputError: the precision is unknown.
        MissingExtra: Warp is not installed.
    """
    return WarpLaw(law, precision)

"""The operations that equations are written in.

An equation of Stribeck is a plain Python function over these operations, the arithmetic operators, ``abs`` and
comparisons. The same function then runs on NumPy arrays, on the nodes of
:mod:`stribeck.expressions.graph` (Jacobian, C) and on SymPy symbols (LaTeX, proofs). The type of the arguments decides.
:func:`register` adds a further kind of value.
"""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np

from stribeck.expressions.exact import Exact, function
from stribeck.expressions.exact import pi as pi

# A number, an array, a graph node, an interval, a SymPy expression, a JAX, PyTorch or Warp value: whatever a backend works
# on. A protocol of its operators would reject the results of foreign ones.
Value = Any


class _Sympy:
    """SymPy expressions; SymPy is imported only when one arrives."""

    def __getattr__(self, name: str) -> Callable[..., Value]:
        import sympy

        table = {
            "where": lambda c, a, b: sympy.Piecewise((a, c), (b, True)),
            "both": sympy.And, "either": sympy.Or,
        }  # fmt: skip
        return table.get(name) or getattr(sympy, name)  # type: ignore[no-any-return]


def _where(condition: Value, a: Value, b: Value) -> Value:
    chosen: Any = np.where(condition, a, b)
    return chosen[()]  # a number for numbers


_numeric: Any = SimpleNamespace(
    exp=np.exp, log=np.log, sqrt=np.sqrt, sin=np.sin, cos=np.cos, atan=np.arctan, tanh=np.tanh, sign=np.sign,
    floor=np.floor,
    where=_where, both=np.logical_and, either=np.logical_or,
)  # fmt: skip


class _Exact:
    """Exact numbers: results carry their exact number too."""

    def __getattr__(self, name: str) -> Callable[..., Value]:
        operation = getattr(_numeric, name)
        if name in ("where", "both", "either"):
            return operation  # type: ignore[no-any-return]
        return lambda x: function(name, x, float(operation(float(x))))


_by_package: dict[str, Any] = {"sympy": _Sympy()}
_by_type: dict[type, Any] = {Exact: _Exact()}


def register(package: str, backend: Any) -> None:
    """Handle values whose type is defined in ``package`` with the operations of ``backend``."""
    _by_package[package] = backend
    _by_type.clear()
    _by_type[Exact] = _Exact()


def _backend(*values: Value) -> Any:
    for value in values:
        kind = type(value)
        if kind not in _by_type:
            _by_type[kind] = _by_package.get(kind.__module__.split(".")[0], _numeric)
        if _by_type[kind] is not _numeric:
            return _by_type[kind]
    return _numeric


def exp(x: Value) -> Value:
    """e to the power x."""
    return _backend(x).exp(x)


def log(x: Value) -> Value:
    """Natural logarithm."""
    return _backend(x).log(x)


def sqrt(x: Value) -> Value:
    """Square root."""
    return _backend(x).sqrt(x)


def sin(x: Value) -> Value:
    """Sine of x in radians."""
    return _backend(x).sin(x)


def cos(x: Value) -> Value:
    """Cosine of x in radians."""
    return _backend(x).cos(x)


def atan(x: Value) -> Value:
    """Arc tangent, in radians."""
    return _backend(x).atan(x)


def tanh(x: Value) -> Value:
    """Hyperbolic tangent."""
    return _backend(x).tanh(x)


def sign(x: Value) -> Value:
    """-1, 0 or 1; its derivative is taken as 0."""
    return _backend(x).sign(x)


def floor(x: Value) -> Value:
    """The largest whole number that is at most x; its derivative is taken as 0."""
    return _backend(x).floor(x)


def where(condition: Value, a: Value, b: Value) -> Value:
    """a where the condition holds, else b."""
    return _backend(condition, a, b).where(condition, a, b)


def both(a: Value, b: Value) -> Value:
    """Logical and of two conditions."""
    return _backend(a, b).both(a, b)


def either(a: Value, b: Value) -> Value:
    """Logical or of two conditions."""
    return _backend(a, b).either(a, b)


def smaller(a: Value, b: Value) -> Value:
    """The smaller of two values."""
    return where(a < b, a, b)


def larger(a: Value, b: Value) -> Value:
    """The larger of two values."""
    return where(a > b, a, b)


def clip(x: Value, low: Value, high: Value) -> Value:
    """x limited to [low, high]."""
    return where(x < low, low, where(x > high, high, x))

"""A law's equations and their derivatives as Python text, from the graph: for array libraries, and for Warp's kernels."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

from stribeck.errors import InputError
from stribeck.exports.c.ccode import LawCode
from stribeck.expressions import ops
from stribeck.expressions.emit import ATOM, PYTHON, Dialect, Writer
from stribeck.expressions.graph import Expr, derivative, rewrite, symbol
from stribeck.expressions.ops import Value
from stribeck.laws.base import Law

FUNCTIONS = ("exp", "log", "sqrt", "sin", "cos", "atan", "tanh", "sign", "floor", "where", "both", "either")
_NAMES = ("p", "v", "z", "i", "wp", "torch", "law", "sign_of")
_TAKEN = frozenset({*FUNCTIONS, "abs", "pow", "like", "real", *_NAMES})
ARRAYS = replace(PYTHON, value="like(v, {0})")
WARP = Dialect(
    declare="",
    functions={n: f"wp.{n}" for n in ("exp", "log", "sqrt", "sin", "cos", "atan", "tanh", "floor", "abs", "pow")}
    | {"sign": "sign_of"},
    both="and",
    either="or",
    where="wp.where({0}, {1}, {2})",
    statement_end="",
)


class _WarpWriter(Writer):
    """Writer of numbers as real(x), because Warp mixes no types; literals then have the type of the kernels."""

    def _format(self, node: Expr) -> tuple[str, int]:
        text, precedence = super()._format(node)
        return (f"real({text})", ATOM) if node.op == "constant" else (text, precedence)


def _safe(node: Expr) -> Expr:
    """log with log 0 = 0, because |v|^delta log|v|, the derivative by delta, is 0 at v = 0."""
    return ops.log(ops.where(node.args[0] <= 0, 1.0, node.args[0])) if node.op == "log" else node


class Written:
    """The text of one law's equations."""

    def __init__(self, law: Law) -> None:
        self.law = law
        self.names = list(law.numbers(law.form))
        if bad := [n for n in self.names if n in ("has_z", "linear") or not n.isascii()]:
            raise InputError([f"{n}: a constant of this name cannot be exported to Python: rename it" for n in bad])
        self._equations = LawCode(law)

    @property
    def columns(self) -> list[tuple[int, int]]:
        """Each column of the table of constants, and the index of the law's input in it, or -1."""
        inputs = self.law.inputs
        return [(k, inputs.index(n) if n in inputs else -1) for k, n in enumerate(self.names)]

    @property
    def linear(self) -> bool:
        """True if dz/dt is linear in z."""
        return self.law.has_z and self._equations.linear

    @cached_property
    def _by_constants(self) -> dict[str, tuple[Expr, Expr]]:
        expressions, by = self._equations.expressions, [symbol(n) for n in self.names]
        safe = iter(rewrite([derivative(expressions[output], c) for c in by for output in ("rate", "force")], _safe))
        return {n: (next(safe), next(safe)) for n in self.names}

    def _body(self, outputs: list[tuple[str, Expr]], ends: str, warp: bool, indent: str) -> str:
        """Statements that assign the outputs, and the constants that they need before them."""
        local = {n: f"p_{n}" for n in self.names} if warp else {n: f"p.{n}" for n in self.names}
        inputs = {**local, "v": "v", "z": "z"}
        writer, dialect = (_WarpWriter, WARP) if warp else (Writer, ARRAYS)
        kind = writer(dialect, inputs, taken=_TAKEN, names=self._equations.names)
        lines = kind.write(outputs)
        if warp:
            used = "\n".join(lines)
            lines = [f"p_{n} = p[i, {k}]" for k, n in enumerate(self.names) if f"p_{n}" in used] + lines
        return "\n".join(f"{indent}{line}" for line in [*lines, ends])

    def function(self, *names: str, warp: bool = False, indent: str = "    ") -> str:
        """Lines that compute some of :attr:`LawCode.expressions` from p, v and z, and return them."""
        targets = [f"{name}_" for name in names]
        outputs = [(t, self._equations.expressions[n]) for t, n in zip(targets, names, strict=True)]
        return self._body(outputs, f"return {', '.join(targets)}", warp, indent)

    def of_constants(self) -> str:
        """Lines that return the derivatives of dz/dt and F by each constant, by name."""
        pairs = enumerate(self._by_constants.values())
        outputs = [(f"{output}{i}_", e) for i, pair in pairs for output, e in zip("rf", pair, strict=True)]
        text = ", ".join(f'"{n}": (r{i}_, f{i}_)' for i, n in enumerate(self.names))
        return self._body(outputs, f"return {{{text}}}", False, " " * 8)

    def equations(self, gradients: bool = True) -> str:
        """The class ``law`` that :mod:`stribeck.exports.python.stepping` takes, as text; gradients: by the constants."""
        parts = [
            "class law:",
            '    """The law: dz/dt, F and their derivatives."""',
            "",
            f"    has_z, linear = {self.law.has_z}, {self.linear}",
        ]
        methods: list[tuple[str, str, tuple[str, ...]]] = [
            ("slopes", "p, v, z", ("rate", "force", "rate_v", "rate_z", "force_v", "force_z"))
        ]
        methods.append(("hold", "p, v", ("a", "b")) if self.linear else ("rate", "p, v, z", ("rate", "rate_z")))
        for name, arguments, outputs in methods:
            parts += ["", "    @staticmethod", f"    def {name}({arguments}):", self.function(*outputs, indent=" " * 8)]
        if gradients:
            parts += ["", "    @staticmethod", "    def by_constants(p, v, z):", self.of_constants()]
        return "\n".join(parts)


def written_equations(law: Law, scope: dict[str, Value]) -> Value:
    """The class of :meth:`Written.equations`, made with the functions of an array library in ``scope``."""
    exec(compile(Written(law).equations(), f"<equations of {law.name}>", "exec"), scope)
    return scope["law"]

"""The equations of a law as C functions of double or float: what the exports in C share."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from importlib.resources import files
from typing import Any

import jinja2

from stribeck.expressions.emit import C, Dialect, Writer
from stribeck.expressions.graph import Expr, derivative, ordered, substitute, symbol, symbols, wrap
from stribeck.laws.base import Law

_FUNCTIONS = ("exp", "log", "sqrt", "sin", "cos", "atan", "tanh", "pow")
DIALECT = Dialect(
    declare="const real ",
    functions={name: f"FN({name})" for name in _FUNCTIONS} | {"abs": "FN(fabs)", "sign": "sign_of"},
    both=C.both,
    either=C.either,
    where=C.where,
    statement_end=";",
)

# Of C and of the templates' macros: neither a variable nor a member can be called so.
_WORDS = """
    auto break case char const continue default do double else enum extern float for goto if inline int long register
    restrict return short signed sizeof static struct switch typedef union unsigned void volatile while
    EPSILON SLOWEST NAN INFINITY unix linux
"""
_LOCALS = "p v z s l dt a b x y u w real R FN exp log sqrt sin cos atan tanh fabs pow sign_of rate force dv_dt"
WORDS = frozenset(_WORDS.split())
_TAKEN = WORDS | frozenset(_LOCALS.split())

_labels = threading.Lock()  # nodes are shared, and so are the names they carry


class CWriter(Writer):
    """Writes numbers as R(x), so that float code holds no double."""

    def _format(self, node: Expr) -> tuple[str, int]:
        text, precedence = super()._format(node)
        if node.op != "constant":
            return text, precedence
        assert isinstance(node.value, float)
        sign, size = ("-", text[1:]) if text.startswith("-") else ("", text)
        return (f"{sign}R({size})" if size[0].isdigit() else f"(real)({text})"), precedence


@dataclass(frozen=True)
class Equations:
    """A law's equations and their derivatives as expressions of v, z and the constants' names; ``rate`` is dz/dt as
    an argument of the force."""

    law: Law

    @cached_property
    def expressions(self) -> dict[str, Expr]:
        """dz/dt, F, F for a given dz/dt, their derivatives by v and z, and the bound of z where the law has one."""
        with _labels:
            self._build()  # labels of other uses of the same nodes are cleared, then set anew
            for node in ordered(self._build().values()):
                node.label = None
            return self._build()

    def _build(self) -> dict[str, Expr]:
        law, v, z, rate = self.law, symbol("v"), symbol("z"), symbol("rate")
        p = law.symbolic(symbol, law.structure)
        found = {"rate": wrap(law.dz_dt(p, v, z) if law.has_z else 0.0)}
        found["force_at_rate"] = wrap(law.friction(p, v, z, rate if law.has_z else wrap(0.0)))
        found["force"] = wrap(law.friction(p, v, z, found["rate"]))
        found |= {f"{of}_{by.value}": derivative(found[of], by) for of in ("rate", "force") for by in (v, z)}
        found["stiffness"] = derivative(found["force_at_rate"], z)
        # a law linear in z: dz/dt = a z + b at held v
        found["a"], found["b"] = found["rate_z"], substitute([found["rate"]], {z: wrap(0.0)})[0]
        if self.bounded:
            found["bound"] = wrap(law.z_bound(p))
        return found

    @property
    def linear(self) -> bool:
        """True where dz/dt is linear in z: the zero-order hold is exact then."""
        return "z" not in symbols([self.expressions["rate_z"]])

    @property
    def bounded(self) -> bool:
        """True where the law claims a bound of z."""
        return bool(self.law.has_z and self.law.guarantees()["bounded"])

    def body(self, outputs: Sequence[tuple[str, str]], arguments: Sequence[str]) -> str:
        """Statements that assign expressions, given as (target, name), for a function that has these arguments."""
        found = self.expressions
        inputs = {name: f"p->{name}" for name in self.law.symbolic(symbol, self.law.structure).__dict__}
        inputs |= {name: name for name in arguments if name != "p"}
        used = symbols(found[name] for _, name in outputs)
        unused = [name for name in arguments if name != "p" and name not in used]
        if not used - {"v", "z", "rate"}:
            unused.insert(0, "p")
        lines = [f"(void){name};" for name in unused]
        writer = CWriter(DIALECT, inputs, taken=_TAKEN | {target for target, _ in outputs})
        targets = [(target, found[name]) for target, name in outputs]
        returned = [target for target, _ in outputs if target == "return"]
        written = writer.write(targets)
        if returned:
            written = [
                line.replace("return = ", "return ", 1) if line.startswith("return = ") else line for line in written
            ]
        return "\n".join(f"    {line}" for line in [*lines, *written])

    def uses(self, *operations: str) -> bool:
        """True where any expression needs one of these operations."""
        return any(node.op in operations for node in ordered(self.expressions.values()))


def condition(holds: Callable[[Any], Any], law: Law) -> str:
    """A relation between the constants as a condition in C."""
    writer = CWriter(DIALECT, {name: f"p->{name}" for name in law.constants()}, taken=_TAKEN)
    line = writer.write([("result", wrap(holds(law.symbolic(symbol, law.structure))))])[-1]
    return line.removeprefix("result = ").removesuffix(";")


def expression(node: Expr, names: Iterable[str]) -> str:
    """An expression of these symbols in C, on one line."""
    line = CWriter(DIALECT, {name: name for name in names}, taken=_TAKEN).write([("result", node)])[-1]
    return line.removeprefix("result = ").removesuffix(";")


def render(template: str, **values: Any) -> str:
    """A template of this package, filled in."""
    text = files("stribeck.export").joinpath("templates", template).read_text(encoding="utf-8")
    environment = jinja2.Environment(
        trim_blocks=True, lstrip_blocks=True, keep_trailing_newline=True, undefined=jinja2.StrictUndefined,
        comment_start_string="{##", autoescape=False,
    )  # fmt: skip
    return environment.from_string(text).render(repr=repr, **values)

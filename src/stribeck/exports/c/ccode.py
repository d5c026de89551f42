"""The equations of a law as C functions of double or float, for all exports in C."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache, cached_property
from typing import TYPE_CHECKING
from xml.sax.saxutils import escape

from stribeck.errors import needed, printable
from stribeck.exports.request import ascii_only, wrapped
from stribeck.expressions.emit import C_FUNCTIONS, C_WORDS, Dialect, Writer
from stribeck.expressions.graph import Expr, derivative, ordered, substitute, symbol, symbols, wrap
from stribeck.expressions.names import Names
from stribeck.laws.base import STATIC_ABOVE_COULOMB, Law
from stribeck.laws.steady import steady_force
from stribeck.machine.elements import bodies
from stribeck.machine.pneumatic.observer import correction

if TYPE_CHECKING:
    import jinja2

_FUNCTIONS = ("exp", "log", "sqrt", "sin", "cos", "atan", "tanh", "pow")
DIALECT = Dialect(
    declare="const real ",
    functions={name: f"FN({name})" for name in _FUNCTIONS} | {"abs": "FN(fabs)", "sign": "sign_of"},
    both="&&",
    either="||",
    where="{0} ? {1} : {2}",
    statement_end=";",
    variable="real ",
)

# Words of C and macros of the templates: no variable or member can have these names.
WORDS = C_WORDS | {"EPSILON", "SLOWEST"}
_LOCALS = "p v z s l dt a b x y u w side real R FN sign_of rate force dv_dt"
ARGUMENTS = frozenset({"K", "error"})  # of the equations below: no constant can have these names
_TAKEN = WORDS | C_FUNCTIONS | frozenset(_LOCALS.split())


class CWriter(Writer):
    """Writer of numbers as R(x), so that float code contains no double."""

    def _format(self, node: Expr) -> tuple[str, int]:
        text, precedence = super()._format(node)
        return (f"R({text})" if node.op == "constant" else text), precedence


def statements(outputs: Sequence[tuple[str, Expr]], inputs: Mapping[str, str], names: Names) -> str:
    """Lines of C that assign expressions to their targets, or return them."""
    roots = {re.split(r"\W", text)[0] for text in (*inputs.values(), *(target for target, _ in outputs))}
    written = CWriter(DIALECT, inputs, taken=_TAKEN | roots, names=names).write(outputs)
    return "\n".join(f"    {line}" for line in written)


@dataclass(frozen=True)
class LawCode:
    """A law's equations and their derivatives as expressions of v, z and the constants' names.

    ``rate`` is dz/dt as an argument of the force.
    """

    law: Law
    names: Names = field(default_factory=Names, init=False, compare=False)  # of the symbols in the equations

    @cached_property
    def expressions(self) -> dict[str, Expr]:
        """dz/dt, F, F for a given dz/dt, their derivatives by v and z, and the bound of z if there is one."""
        law, v, z, rate = self.law, symbol("v"), symbol("z"), symbol("rate")
        p = law.symbolic(symbol, law.form, self.names.term)
        outputs = {"rate": wrap(law.dz_dt(p, v, z) if law.has_z else 0.0)}
        outputs["force_at_rate"] = wrap(law.friction(p, v, z, rate if law.has_z else wrap(0.0)))
        outputs["force"] = wrap(law.friction(p, v, z, outputs["rate"]))
        outputs |= {
            f"{output}_{by.value}": derivative(outputs[output], by) for output in ("rate", "force") for by in (v, z)
        }
        if self.observable:
            outputs["pull"] = wrap(correction(p, symbol("K"), symbol("error")))
        # a law linear in z: dz/dt = a z + b at constant v
        outputs["a"], outputs["b"] = outputs["rate_z"], substitute([outputs["rate"]], {z: wrap(0.0)}, self.names)[0]
        outputs["steady_force"] = steady_force(type(law), p, v, symbol("side"))
        if self.bounded:
            outputs["bound"] = wrap(law.z_bound(p))
        return outputs

    @property
    def linear(self) -> bool:
        """True if dz/dt is linear in z: the zero-order hold is then exact."""
        return "z" not in symbols([self.expressions["rate_z"]])

    @property
    def bounded(self) -> bool:
        """True where the law claims a bound of z."""
        return bool(self.law.has_z and self.law.guarantees()["bounded"])

    @property
    def observable(self) -> bool:
        """True if the tracking error can correct z, as in laws with sigma_0."""
        return self.law.has_z and "sigma_0" in self.law.constants()

    def body(self, outputs: Sequence[tuple[str, str]], arguments: Sequence[str]) -> str:
        """Statements that assign expressions, given as (target, name), in a function with these arguments."""
        expressions = self.expressions
        inputs = {name: f"p->{self.inside(name)}" for name in self.law.numbers(self.law.form)}
        inputs |= {name: name for name in arguments if name != "p"}
        used = symbols(expressions[name] for _, name in outputs)
        unused = [name for name in arguments if name != "p" and name not in used]
        if not used & set(self.law.numbers(self.law.form)):
            unused.insert(0, "p")
        written = statements([(target, expressions[name]) for target, name in outputs], inputs, self.names)
        return "\n".join([*(f"    (void){name};" for name in unused), written])

    def inside(self, name: str) -> str:
        """A constant as a member of the struct that the equations take in C."""
        law = self.law
        return name if not law.inputs else f"load.{name}" if name in law.inputs else f"p.{name}"

    def uses(self, *operations: str) -> bool:
        """True if any expression needs one of these operations."""
        return any(node.op in operations for node in ordered(self.expressions.values()))


@dataclass(frozen=True)
class Call:
    """The arguments of a law's functions in C for its constants and for the loads of a contact."""

    name: str
    inputs: Sequence[str]

    @property
    def type(self) -> str:
        """The type that the equations take."""
        return "given" if self.inputs else "parameters"

    @property
    def declared(self) -> str:
        """The first arguments of each function in the header."""
        return f"const {self.name}_parameters *p" + (f", const {self.name}_load *load" if self.inputs else "")

    @property
    def declared_inside(self) -> str:
        """The first arguments in the definition of each function."""
        return f"const parameters *constants, const {self.name}_load *load" if self.inputs else "const parameters *p"

    @property
    def begin(self) -> str:
        """Lines that define ``p`` from these arguments."""
        if not self.inputs:
            return ""
        finite = " || ".join(f"!isfinite(load->{name})" for name in self.inputs)
        lines = (
            "const given now = { *constants, *load }, *const p = &now;",
            f"if ({finite}) return {self.name}_NOT_FINITE;",
        )
        return "".join(f"    {line}\n" for line in lines)

    def arguments(self, p: str, load: str) -> str:
        """The arguments in a call."""
        return f"{p}, {load}" if self.inputs else p


def c_conditions(law: Law, places: Mapping[str, str]) -> list[tuple[str, str, str]]:
    """The constant at fault, the allowed values and the condition in C, for each relation of the law's constants.

    Args:
        law: the law.
        places: the text of each constant in C; relations of other constants are left out.
    """
    p, found = law.symbolic(symbol, law.form), []
    for r in dict.fromkeys((*law.relations, *STATIC_ABOVE_COULOMB)):
        if all(name in places for name in (r.key, *r.needs)):
            used = {name: places.get(name, name) for name in law.constants()}
            found.append((r.key, r.allowed, _one_line(wrap(r.holds(p)), used)))
    return found


def _one_line(node: Expr, inputs: Mapping[str, str]) -> str:
    line = CWriter(DIALECT, inputs, taken=_TAKEN).write([("result", node)])[-1]
    return line.removeprefix("result = ").removesuffix(";")


def net_force() -> dict[str, str]:
    """The net force on a body under the drive's force u and the friction F, and its derivatives by both, in C."""
    u, F = symbol("u"), symbol("F")
    value = wrap(bodies.sum_of_forces(u, F))
    parts = {"value": value, "by_u": derivative(value, u), "by_F": derivative(value, F)}
    return {name: _one_line(part, {"u": "u", "F": "F"}) for name, part in parts.items()}


def pair(name: str, part: str, values: Mapping[str, object]) -> dict[str, str]:
    """``NAME.h`` and ``NAME.c`` from the templates of the part."""
    return {f"{name}.{kind}": render(f"{part}.{kind}", **values) for kind in ("h", "c")}


def _number(x: object) -> str:
    """A number, also of NumPy, as text for C and Python."""
    return repr(float(x) if isinstance(x, float) else x)


def _quoted(value: object) -> str:
    """A value as an attribute of XML, which has no control characters."""
    return escape(printable(str(value)), {'"': "&quot;"})


def render(template: str, **values: object) -> str:
    """A template of this package, filled in."""
    return _templates().get_template(template).render(repr=_number, **values)


@cache
def _templates() -> jinja2.Environment:
    """The templates of this package, compiled once, as this takes most of an export's time."""
    with needed("an export", "fmu"):
        import jinja2

    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("stribeck.exports"), trim_blocks=True, lstrip_blocks=True,
        keep_trailing_newline=True, undefined=jinja2.StrictUndefined,
        comment_start_string="{##", autoescape=False,
    )  # fmt: skip
    environment.filters |= {"plain": ascii_only, "wrapped": wrapped, "quoted": _quoted}
    return environment

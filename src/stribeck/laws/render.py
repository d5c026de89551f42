"""Equations of a law as LaTeX and text, from the functions that are simulated."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import SimpleNamespace
from typing import TYPE_CHECKING

from stribeck.expressions import pretty
from stribeck.expressions.graph import symbol, wrap
from stribeck.expressions.ops import Value
from stribeck.laws.form import USUAL, Form

if TYPE_CHECKING:
    from stribeck.laws.base import Law


@dataclass(frozen=True)
class Equation:
    """One equation, as LaTeX and as a line of text."""

    latex: str
    text: str


def equations(law: type[Law], form: Form = USUAL) -> list[Equation]:
    """The law's equations: dz/dt (if it has a z), F, then the functions that they use, each once.

    ``form`` is one of :meth:`Law.forms`.
    """
    names = [*law.constants(), "v", "z"]
    latex = {name: pretty.name(name, latex=True) for name in names} | {"dz_dt": r"\dot{z}"}
    text = {name: pretty.name(name, latex=False) for name in names} | {"dz_dt": "dz/dt"}
    terms = _Terms(latex, text)
    p, v, z, rate = law.symbolic(symbol, form, terms.by_name), symbol("v"), symbol("z"), symbol("dz_dt")
    expressions = {"dz_dt": law.dz_dt(p, v, z)} if law.has_z else {}
    force = law.friction(p, v, z, rate if law.has_z else wrap(0))
    definitions = terms.definitions
    rows = [(latex[name], text[name], value) for name, value in expressions.items()]
    rows.append(("F", "F", force))
    rows += [(latex[name], text[name], value) for name, value in definitions.items()]
    return [
        Equation(
            f"{left} = {pretty.write(wrap(value), latex, latex=True)}",
            f"{plain} = {pretty.write(wrap(value), text, latex=False)}",
        )
        for left, plain, value in rows
    ]


def condition(claim: Callable[[SimpleNamespace], Value], law: type[Law], form: Form = USUAL) -> Equation | bool:
    """A claim as a condition on the constants, or as its value if it does not depend on them."""
    value = claim(law.symbolic(symbol, form))
    if isinstance(value, bool):
        return value
    latex, text = ({n: pretty.name(n, latex=way) for n in law.constants()} for way in (True, False))
    return Equation(pretty.write(value, latex, latex=True), pretty.write(value, text, latex=False))


class _Terms:
    """Terms such as g(p, v) as a symbol that reads g(v), with their definitions apart."""

    def __init__(self, latex: dict[str, str], text: dict[str, str]) -> None:
        self.latex, self.text = latex, text
        self.definitions: dict[str, Value] = {}

    def by_name(self, name: str, sign: str, args: tuple[Value, ...], value: Value) -> Value:
        """The symbol; its name as text is added to the names."""
        arguments = [
            [pretty.write(wrap(a), names, latex=way) for a in args]
            for names, way in ((self.latex, True), (self.text, False))
        ]
        call = f"{name}({', '.join(arguments[1])})"
        self.latex[call] = f"{sign}({', '.join(arguments[0])})"
        self.text[call] = f"{pretty.name(name, latex=False)}({', '.join(arguments[1])})"
        self.definitions.setdefault(call, value)
        return symbol(call)


def ranges_in_words(ranges: Mapping[str, Sequence[float | None]], law: Law) -> str:
    """'F_c from 1 to 2 N, F_s from 1.5 N up, sigma_2 held at 3 N s/m': ranges of the constants of a law."""

    def words(unit: str, low: float | None, high: float | None) -> str:
        if low == high:
            return f"held at {low:.6g}{unit}"
        return f"from {low:.6g}" + (f"{unit} up" if high is None else f" to {high:.6g}{unit}")

    units = {name: c.unit_for(law.rotary) for name, c in law.constants().items()}
    shown = {name: f" {unit}" if unit not in ("", "1") else "" for name, unit in units.items()}
    return ", ".join(f"{name} {words(shown[name], *ends)}" for name, ends in ranges.items())

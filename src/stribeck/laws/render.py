"""Equations of a law for people, from the functions that are simulated."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from stribeck.expressions import pretty
from stribeck.expressions.graph import symbol, wrap
from stribeck.expressions.ops import Value
from stribeck.laws import terms
from stribeck.laws.base import Law


@dataclass(frozen=True)
class Equation:
    """One equation, as LaTeX and as a line of text."""

    latex: str
    text: str


def equations(law: type[Law], options: tuple[str, ...] = ()) -> list[Equation]:
    """The law's equations: dz/dt (where it has a z), F, then the functions that they use, each once.

    ``options`` is the form that they take, one of :meth:`Law.structures`.
    """
    p, v, z, rate = law.symbolic(symbol, options), symbol("v"), symbol("z"), symbol("dz_dt")
    names = [*law.constants(), "v", "z"]
    latex = {name: pretty.name(name, latex=True) for name in names} | {"dz_dt": r"\dot{z}"}
    text = {name: pretty.name(name, latex=False) for name in names} | {"dz_dt": "dz/dt"}
    with _named_terms(latex, text) as definitions:
        found = {"dz_dt": law.dz_dt(p, v, z)} if law.has_z else {}
        force = law.friction(p, v, z, rate if law.has_z else wrap(0))
    rows = [(latex[name], text[name], value) for name, value in found.items()]
    rows.append(("F", "F", force))
    rows += [(latex[name], text[name], value) for name, value in definitions.items()]
    return [
        Equation(
            f"{left} = {pretty.write(wrap(value), latex, latex=True)}",
            f"{plain} = {pretty.write(wrap(value), text, latex=False)}",
        )
        for left, plain, value in rows
    ]


def condition(claim: Any, law: type[Law], options: tuple[str, ...] = ()) -> Equation | bool:
    """A claim that depends on the constants, as a condition; or what it is in a form where it does not."""
    value = claim(law.symbolic(symbol, options))
    if isinstance(value, bool):
        return value
    latex, text = ({n: pretty.name(n, latex=way) for n in law.constants()} for way in (True, False))
    return Equation(pretty.write(value, latex, latex=True), pretty.write(value, text, latex=False))


@contextmanager
def _named_terms(latex: dict[str, str], text: dict[str, str]) -> Iterator[dict[str, Value]]:
    """Within, terms such as g(p, v) return a symbol that reads g(v), and leave their definition here."""
    definitions: dict[str, Value] = {}

    def by_name(name: str, sign: str, args: tuple[Value, ...], value: Value) -> Value:
        arguments = [
            [pretty.write(wrap(a), names, latex=way) for a in args] for names, way in ((latex, True), (text, False))
        ]
        call = f"{name}({', '.join(arguments[1])})"
        latex[call] = f"{sign}({', '.join(arguments[0])})"
        text[call] = f"{pretty.name(name, latex=False)}({', '.join(arguments[1])})"
        definitions.setdefault(call, value)
        return symbol(call)

    token = terms.on_term.set(by_name)
    try:
        yield definitions
    finally:
        terms.on_term.reset(token)

"""Writes proofs/Laws.v: the equations of the built-in laws, from the functions that are simulated.

python proofs/generate.py          # writes it
python proofs/generate.py --check  # exit status 1 where the file differs from the laws

Nothing in Laws.v is typed by hand, and every theorem in this folder is about what stands there.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import coq

from stribeck.expressions.exact import Exact
from stribeck.expressions.graph import Expr, symbol, wrap
from stribeck.laws import builtin, lugre
from stribeck.laws.base import BristleLaw
from stribeck.laws.form import Form
from stribeck.laws.values import OnTerm

FILE = Path(__file__).with_name("Laws.v")
HEAD = """\
(* The equations of the laws, as they are simulated. Written by proofs/generate.py: do not edit. *)
From Coq Require Import Reals.
From Coquelicot Require Import Coquelicot.
Open Scope R_scope.
"""
V, Z = symbol("v"), symbol("z")
LEFT_OUT = {"delta"}  # the Stribeck curve with another exponent than 2: the proofs do not cover it
RENAMED = {"sigma_1": "sigma_1_at"}  # a term that has the name of a constant


def laws_text() -> str:
    """The whole file."""
    laws = [law for law in builtin().values() if issubclass(law, BristleLaw)]
    numbers: dict[str, None] = {}
    for law in laws:
        numbers |= dict.fromkeys(n for n, c in law.constants().items() if not c.choices and n not in LEFT_OUT)
    record = "; ".join(f"{n} : R" for n in numbers)
    found: dict[str, str] = {}
    with _exact_e():
        modules = [text for law in laws for text in _law(law, found)]
    return "\n".join([HEAD, f"Record constants := {{ {record} }}.\n", *found.values(), "", *modules])


@contextmanager
def _exact_e() -> Iterator[None]:
    """Within, the e of the laws' conditions is the number and not the float."""
    held = lugre.e
    lugre.e = Exact(held, ("exp", 1.0))
    try:
        yield
    finally:
        lugre.e = held


def _named_terms(found: dict[str, str], words: dict[str, str]) -> OnTerm:
    """Writes terms such as g(p, v) as (g p v), and leaves their definitions in ``found``."""

    def by_name(name: str, _: str, args: tuple[Expr, ...], value: Expr) -> Expr:
        own = RENAMED.get(name, name) + (f"_{words['smooth_abs']}" if name == "m" else "")
        inputs = [str(a.value) for a in args]
        assert all(a.op == "symbol" for a in args)
        text = f"Definition {own} (p : constants) ({' '.join(inputs)} : R) : R :=\n  {coq.write(value, words)}.\n"
        assert found.setdefault(own, text) == text, f"{own} has two meanings"
        call = f"{own} p {' '.join(inputs)}"
        words[call] = call
        return symbol(call)

    return by_name


def _law(law: type[BristleLaw], found: dict[str, str]) -> Iterator[str]:
    """A module for each choice of the law's words, with the forms that the optional constants give."""
    every = [form for form in law.forms() if not LEFT_OUT & set(form.on)]
    for choices in dict.fromkeys(form.choices for form in every):
        forms = [form for form in every if form.choices == choices]
        name = "_".join([law.name, *(word for _, word in choices)])
        lines = [f"Module {name}."]
        for form in forms:
            lines += _definitions(law, form, found)
        yield "\n".join([*lines, f"End {name}.\n"])


def _definitions(law: type[BristleLaw], form: Form, found: dict[str, str]) -> list[str]:
    suffix = "".join(f"_{name}" for name in form.on)
    p = law.symbolic(symbol, form)
    words = {n: f"{n} p" for n in law.constants()} | {"dz_dt": "dz_dt p v z"}
    words["smooth_abs"] = getattr(p, "smooth_abs", "")
    lines = []

    def define(name: str, inputs: str, kind: str, value: object) -> None:
        typed = f" ({inputs} : R)" if inputs else ""
        text = coq.write(wrap(value), words)
        lines.append(f"Definition {name} (p : constants){typed} : {kind} :=\n  {text}.")

    named = law.symbolic(symbol, form, _named_terms(found, words))
    values = {
        "dz_dt": law.dz_dt(named, V, Z), "friction": law.friction(named, V, Z, symbol("dz_dt")),
        "stored_energy": law.stored_energy(named, Z), "z_bound": law.z_bound(named),
    }  # fmt: skip
    if law.claims.drift_free:
        values["z_elastic"] = law.z_elastic(named)
    for name, value in values.items():
        if not suffix or name == "friction":
            inputs = {"dz_dt": "v z", "friction": "v z", "stored_energy": "z"}.get(name, "")
            define(name + suffix, inputs, "R", value)
    signs = [
        symbol(n) > 0 if c.above == 0 else symbol(n) >= 0
        for n, c in law.numbers(form).items()
        if c.above == 0 or c.at_least == 0
    ]
    conditions = [*signs, *(relation.holds(p) for relation in law.relations)]
    body = " /\\ ".join(coq.write(wrap(c), words) for c in conditions)
    lines.append(f"Definition allowed{suffix} (p : constants) : Prop :=\n  {body}.")
    if callable(law.claims.passive):
        define(f"claims_passive{suffix}", "", "Prop", law.claims.passive(p))
    return lines


if __name__ == "__main__":
    text = laws_text()
    if "--check" in sys.argv[1:]:
        if not FILE.exists() or FILE.read_text() != text:
            sys.exit(f"{FILE} is not what the laws say: run python proofs/generate.py")
    else:
        FILE.write_text(text)

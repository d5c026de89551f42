"""The model of a fit as lines of text: the force, term by term, then the law's equations."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from stribeck import laws
from stribeck.constants import Column
from stribeck.identify.models.forms import in_words
from stribeck.identify.models.terms import TERMS
from stribeck.laws.base import Law
from stribeck.laws.form import Form
from stribeck.laws.render import equations

if TYPE_CHECKING:
    from stribeck.identify.result import LogFit

_MEANING = {
    "a": ("acceleration", "m/s^2"), "y": ("position", "m"), "p": ("pressure", "Pa"), "N": ("load", "N"),
    "v": ("velocity", "m/s"), "z": ("deflection of the bristles", "m"),
}  # fmt: skip


def model_lines(fit: LogFit) -> list[str]:
    """The force that is fitted, the law's equations, and what the letters are."""
    law = laws.find(fit.law_name)
    term_names = [n for n, t in TERMS.items() if n in fit.values and t.column is not None]
    beside = [_product(n) for n in term_names if not TERMS[n].level and not (n == "mass" and fit.values[n] == 0)]
    lines = [" + ".join(["force = F", *beside, *(f"({in_words(form)})" for form in fit.forms or ())])]
    growth = [_product(n) for n in term_names if TERMS[n].level]
    lines += [f"{level} grows by {' + '.join(growth)}" for level in ("F_c", "F_s") if growth and level in fit.values]
    if fit.values.get("delay"):
        lines.append("force: at t, of the motion measured at t + delay")
    given = {n: x for n, x in fit.values.items() if n in fit.given and n in law.constants()}
    lines += [each.text for each in equations(law, form_of(law, given))]
    letters = {"v", *(["z"] if law.has_z else []), *(TERMS[n].factor for n in term_names)}
    letters |= {"y"} if any(letter.endswith("y)") for letter in letters) else set()
    turns = fit.log is not None and fit.log.rotary
    named = [
        Column(letter, unit, words).of_motion(turns) for letter, (words, unit) in _MEANING.items() if letter in letters
    ]
    return [*lines, *(f"{x.name}: {x.meaning} ({x.unit})" for x in named)]


def _product(name: str) -> str:
    factor = TERMS[name].factor
    return name if factor == "1" else f"{name} {factor}"


def form_of(law: type[Law], given: Mapping[str, float | str]) -> Form:
    """The form of the law's equations: optional constants that are given, and words."""
    constants = law.constants()
    on = tuple(n for n, c in constants.items() if c.optional and n in given)
    given_words = ((n, str(given[n])) for n, c in constants.items() if c.choices and n in given)
    return Form(on, tuple((n, word) for n, word in given_words if word != constants[n].choices[0]))

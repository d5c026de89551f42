"""Expressions for people: LaTeX and plain text, in the order of operations in which they were written."""

from __future__ import annotations

import re
from collections.abc import Mapping
from fractions import Fraction
from math import isfinite, pi

from stribeck.expressions.graph import Expr

_GREEK = ("alpha", "beta", "gamma", "delta", "lambda", "mu", "rho", "sigma", "tau", "omega")
_LETTERS = dict(zip(_GREEK, "αβγδλμρστω", strict=True))
_SUBSCRIPTS = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")
_POWERS = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")
_FUNCTIONS = {"exp": "exp", "log": "ln", "sqrt": "sqrt", "sin": "sin", "cos": "cos", "atan": "arctan", "tanh": "tanh"}
_SUM, _PRODUCT, _FACTOR, _ATOM = range(4)


def name(text: str, latex: bool) -> str:
    """The name of a constant as mathematics: sigma_0, z_ba, g1."""
    match = re.fullmatch(r"([A-Za-z]+?)_?(\d+)", text) or re.fullmatch(r"([A-Za-z]+)_(\w+)", text)
    stem, index = match.groups() if match else (text, "")
    if latex:
        stem = f"\\{stem}" if stem in _GREEK else stem if len(stem) == 1 else rf"\mathrm{{{stem}}}"
        return f"{stem}_{{{index}}}" if index else stem
    stem = _LETTERS.get(stem, stem)
    return f"{stem}{index.translate(_SUBSCRIPTS)}" if index.isdigit() else f"{stem}_{index}" if index else stem


def write(expr: Expr, names: Mapping[str, str], latex: bool) -> str:
    """The expression as LaTeX or as text; ``names`` maps symbols to their text."""
    return _Writer(names, latex).text(expr)[0]


def multiple_of_pi(x: float) -> tuple[Fraction, bool] | None:
    """q and True if x is the float nearest to q pi, q and False if it is nearest to q/pi; otherwise None."""
    for factor, above in ((pi, True), (1 / pi, False)):
        if x and isfinite(x):
            ratio = Fraction(x / factor).limit_denominator(64)
            if ratio and abs(float(ratio) * factor - x) < 4e-16 * abs(x):
                return ratio, above
    return None


class _Writer:
    def __init__(self, names: Mapping[str, str], latex: bool) -> None:
        self.names, self.latex = names, latex

    def text(self, e: Expr) -> tuple[str, int]:
        """The text of an expression, and its precedence."""
        if e.op == "symbol":
            return self.names[str(e.value)], _ATOM
        if e.op == "constant":
            assert isinstance(e.value, float)
            return self._number(e.value)
        if e.op in ("add", "sub"):
            sign = "+" if e.op == "add" else "-"
            return f"{self._at(e.args[0], _SUM)} {sign} {self._at(e.args[1], _PRODUCT)}", _SUM
        if e.op == "neg":
            return f"-{self._at(e.args[0], _PRODUCT)}", _SUM
        if e.op == "mul":
            return self._product(e)
        if e.op == "div":
            return self._quotient(e)
        if e.op == "pow":
            return self._power(e.args[0], self.text(e.args[1])[0]), _FACTOR
        if e.op == "abs":
            inner = self.text(e.args[0])[0]
            return (rf"\left|{inner}\right|" if self.latex else f"|{inner}|"), _ATOM
        if e.op == "where":
            return self._cases(e)
        if e.op in ("lt", "le"):
            sign = {"lt": "<", "le": r"\le" if self.latex else "<="}[e.op]
            return f"{self.text(e.args[0])[0]} {sign} {self.text(e.args[1])[0]}", _SUM
        if e.op in ("both", "either"):
            word = {"both": "and", "either": "or"}[e.op]
            sign = rf"\text{{ {word} }}" if self.latex else f" {word} "
            return f"{self.text(e.args[0])[0]}{sign}{self.text(e.args[1])[0]}", _SUM
        return self._function(e), _FACTOR

    def _at(self, e: Expr, level: int) -> str:
        text, precedence = self.text(e)
        return text if precedence >= level else self._parentheses(text)

    def _parentheses(self, text: str) -> str:
        return rf"\left({text}\right)" if self.latex else f"({text})"

    def _number(self, x: float) -> tuple[str, int]:
        if x < 0:
            return f"-{self._number(-x)[0]}", _SUM
        if not isfinite(x):
            return {True: (r"\infty" if self.latex else "inf"), False: "nan"}[x > 0], _ATOM
        if x == int(x) and x < 1e15:
            return str(int(x)), _ATOM
        if multiple := multiple_of_pi(x):
            ratio, above = multiple
            sign = r"\pi" if self.latex else "π"
            top = str(ratio.numerator)
            bottom = str(ratio.denominator)
            if above:
                top = sign if ratio.numerator == 1 else f"{ratio.numerator}{sign}"
            else:
                bottom = sign if ratio.denominator == 1 else f"{ratio.denominator}{sign}"
            return self._fraction(top, bottom) if bottom != "1" else (top, _ATOM if top == sign else _PRODUCT)
        return f"{x:.15g}", _ATOM

    def _fraction(self, top: str, bottom: str) -> tuple[str, int]:
        if self.latex:
            return rf"\frac{{{top}}}{{{bottom}}}", _FACTOR
        return f"{top}/{bottom}", _PRODUCT

    def _quotient(self, e: Expr) -> tuple[str, int]:
        top, bottom = e.args
        if self.latex:
            return self._fraction(self.text(top)[0], self.text(bottom)[0])
        return self._fraction(self._at(top, _PRODUCT), self._at(bottom, _FACTOR))

    def _product(self, e: Expr) -> tuple[str, int]:
        factors: list[Expr] = []

        def flatten(node: Expr) -> None:
            if node.op == "mul":
                flatten(node.args[0])
                flatten(node.args[1])
            else:
                factors.append(node)

        flatten(e)
        parts = []
        while factors:
            same = next((i for i, f in enumerate(factors) if f is not factors[0]), len(factors))
            base, factors = factors[0], factors[same:]
            parts.append(self._at(base, _FACTOR) if same == 1 else self._power(base, str(same)))
        return " ".join(parts), _FACTOR if len(parts) == 1 else _PRODUCT

    def _power(self, base: Expr, power: str) -> str:
        text = self._at(base, _ATOM)
        if self.latex:
            return f"{text}^{{{power}}}"
        return f"{text}{power.translate(_POWERS)}" if power.isdigit() else f"{text}^{power}"

    def _function(self, e: Expr) -> str:
        inner = self.text(e.args[0])[0]
        if e.op == "exp" and self.latex:
            return f"e^{{{inner}}}"
        if e.op == "sqrt" and self.latex:
            return rf"\sqrt{{{inner}}}"
        if e.op == "floor":
            return rf"\left\lfloor {inner} \right\rfloor" if self.latex else f"floor({inner})"
        word = "sgn" if e.op == "sign" else _FUNCTIONS[e.op]
        return f"{self._word(word)}{self._parentheses(inner)}"

    def _word(self, word: str) -> str:
        if not self.latex:
            return word
        return r"\operatorname{sgn}" if word == "sgn" else rf"\{word}"

    def _cases(self, e: Expr) -> tuple[str, int]:
        rows, rest = [], e
        while rest.op == "where":
            rows.append((self.text(rest.args[1])[0], self.text(rest.args[0])[0]))
            rest = rest.args[2]
        last = self.text(rest)[0]
        if self.latex:
            body = r" \\ ".join(rf"{value} & \text{{if }} {condition}" for value, condition in rows)
            return rf"\begin{{cases}}{body} \\ {last} & \text{{else}}\end{{cases}}", _ATOM
        return "".join(f"{value} if {condition}, " for value, condition in rows) + f"else {last}", _SUM

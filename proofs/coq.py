"""Expressions as terms of the Coq proof assistant, over its real numbers; and inequalities as goals for it.

A term has the equation's meaning over the real numbers. A float is written as the dyadic fraction that it equals. An exact
constant such as pi is written as itself (:mod:`stribeck.expressions.exact`).
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from fractions import Fraction

from stribeck.errors import InputError
from stribeck.expressions.exact import Exact
from stribeck.expressions.graph import Expr, ordered, symbols
from stribeck.expressions.ops import Value

_PROP, _SUM, _PRODUCT, _APPLIED, _ATOM = range(5)  # precedence of a text, loosest first
_FUNCTIONS = {
    "abs": "Rabs", "exp": "exp", "log": "ln", "sqrt": "sqrt", "sin": "sin", "cos": "cos", "atan": "atan",
    "tanh": "tanh", "sign": "sign",
}  # fmt: skip
_RELATIONS = {"lt": ("<", "Rlt_dec"), "le": ("<=", "Rle_dec")}
_SIGNS = {"add": "+", "sub": "-", "mul": "*", "div": "/"}
_NO_INTERVAL = frozenset({"where", "sign", "pow", "tanh", "floor", "lt", "le", "both", "either"})


def number(x: Fraction | float) -> str:
    """A number as a term: a float as the dyadic fraction that it equals, an exact constant as its definition."""
    if not math.isfinite(x):
        raise InputError(f"{x}: not a real number")
    if isinstance(x, Exact):
        return _tree(x.tree)
    q = Fraction(x)
    top = str(q.numerator) if q >= 0 else f"(- {-q.numerator})"
    return top if q.denominator == 1 else f"({top} / {q.denominator})"


def _tree(tree: Value) -> str:
    if not isinstance(tree, tuple):
        return "PI" if tree == "pi" else number(tree)
    op, args = tree[0], [_tree(t) for t in tree[1:]]
    if op in _SIGNS:
        return f"({f' {_SIGNS[op]} '.join(args)})"
    if op == "neg":
        return f"(- {args[0]})"
    if op == "pow" and (whole := abs(float(tree[2]))).is_integer():
        power = f"({args[0]} ^ {whole:.0f})"
        return power if float(tree[2]) >= 0 else f"(/ {power})"
    if op == "pow":  # of a number above 0: nothing else is a float
        return f"(Rpower {args[0]} {args[1]})"
    return f"({_FUNCTIONS[op]} {' '.join(args)})"


def write(expr: Expr, names: Mapping[str, str] | None = None) -> str:
    """An expression as a term of type R, a condition as one of type Prop.

    Args:
        expr: the expression.
        names: the term for each symbol: a name, or a function with its arguments. Other symbols are written as they are.

    Raises:
        InputError: if a constant is not finite, a symbol's name is invalid in Coq, or a power is not a whole one.
    """
    known = names or {}
    texts: dict[Expr, tuple[str, int]] = {}
    for node in ordered([expr]):
        texts[node] = _text(node, texts, known)
    return texts[expr][0]


def _text(node: Expr, texts: Mapping[Expr, tuple[str, int]], names: Mapping[str, str]) -> tuple[str, int]:
    def operand(i: int, level: int) -> str:
        text, precedence = texts[node.args[i]]
        return text if precedence >= level else f"({text})"

    op = node.op
    if op == "symbol":
        text = names.get(str(node.value), str(node.value))
        if str(node.value) not in names and not re.fullmatch(r"[A-Za-z_]\w*", text):
            raise InputError(f"{text!r}: not a name in Coq")
        return text, _ATOM if re.fullmatch(r"\w+", text) else _APPLIED
    if op == "constant":
        assert isinstance(node.value, float)
        return number(node.value), _ATOM
    if op in ("add", "sub"):
        return f"{operand(0, _SUM)} {'+' if op == 'add' else '-'} {operand(1, _PRODUCT)}", _SUM
    if op in ("mul", "div"):
        return f"{operand(0, _PRODUCT)} {'*' if op == 'mul' else '/'} {operand(1, _APPLIED)}", _PRODUCT
    if op == "neg":
        return f"- {operand(0, _APPLIED)}", _SUM
    if op in _RELATIONS:
        return f"{operand(0, _SUM)} {_RELATIONS[op][0]} {operand(1, _SUM)}", _PROP
    if op in ("both", "either"):
        return f"({operand(0, _PROP)}) {'/' + chr(92) if op == 'both' else chr(92) + '/'} ({operand(1, _PROP)})", _PROP
    if op == "where":
        return _if_then_else(node.args[0], operand(1, _PROP), operand(2, _PROP), texts), _PROP
    if op == "pow":
        raise InputError(
            "x^y: Coq's power is another function where x may be 0 or below; write exp(y log(x)) for x > 0"
        )
    if op == "floor":
        return f"IZR (Int_part {operand(0, _ATOM)})", _APPLIED
    return f"{_FUNCTIONS[op]} {operand(0, _ATOM)}", _APPLIED


def _if_then_else(condition: Expr, yes: str, no: str, texts: Mapping[Expr, tuple[str, int]]) -> str:
    """A choice between two numbers: Coq decides one comparison at a time."""
    a, b = condition.args
    if condition.op == "both":
        return _if_then_else(a, _if_then_else(b, yes, no, texts), no, texts)
    if condition.op == "either":
        return _if_then_else(a, yes, f"({_if_then_else(b, yes, no, texts)})", texts)
    sides = " ".join(text if precedence == _ATOM else f"({text})" for text, precedence in (texts[a], texts[b]))
    return f"if {_RELATIONS[condition.op][1]} {sides} then {yes}\n  else {no}"


def coq_goal(
    expression: Expr,
    box: Mapping[str, tuple[Fraction | float, Fraction | float]],
    name: str = "goal",
    above: bool = False,
    digits: int = 60,
) -> str:
    """A lemma of Coq: an expression is not negative on a box, proved by the tactic ``interval``, which halves the box.

    The tactic computes with intervals inside Coq's kernel, so the lemma relies on the text of the expression alone. If it
    fails, the box is too wide for ``digits``, or the inequality does not hold.

    Args:
        expression: the expression that is >= 0, in the box's symbols.
        box: the ends of each symbol's range; equal ends for a constant, which is written as a number.
        name: the lemma's name.
        above: prove > 0 instead.
        digits: the precision in bits.

    Returns:
        The lemma with its proof; :data:`GOAL_HEADER` must precede the first one.

    Raises:
        InputError: if a symbol has no range, a range is empty or not finite, or the tactic does not support an operation
            (a choice between cases: give each case its own box).
    """
    free = symbols([expression])
    problems = [f"{n}: has no range" for n in sorted(free - set(box))]
    for n in sorted(free & set(box)):
        low, high = box[n]
        if not (math.isfinite(low) and math.isfinite(high) and low <= high):
            problems.append(f"{n}: [{low}, {high}]: must be two finite numbers in rising order")
    odd = sorted({node.op for node in ordered([expression])} & _NO_INTERVAL)
    problems += [f"{op!r}: the tactic interval does not know it; give each case its own box" for op in odd]
    if problems:
        raise InputError(problems)
    fixed = {n: number(box[n][0]) for n in free if Fraction(box[n][0]) == Fraction(box[n][1])}
    moving = sorted(free - set(fixed))
    term = write(expression, fixed)
    quantified = f"forall {' '.join(moving)} : R, " if moving else ""
    ranges = "".join(f"{number(box[n][0])} <= {n} <= {number(box[n][1])} -> " for n in moving)
    halved = "".join(f"i_bisect {n}, " for n in moving)
    depth = ", i_depth 40" if moving else ""
    return (
        f"Lemma {name} : {quantified}{ranges}0 {'<' if above else '<='} {term}.\n"
        f"Proof. intros. interval with ({halved}i_prec {digits}{depth}). Qed.\n"
    )


GOAL_HEADER = "From Coq Require Import Reals.\nFrom Interval Require Import Tactic.\nOpen Scope R_scope.\n\n"

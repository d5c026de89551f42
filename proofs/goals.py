"""A certificate of passivity as goals for Coq's tactic ``interval``: the power inequality on boxes, checked by Coq's kernel.

``python proofs/goals.py FILE SLOWEST FASTEST`` prints them for a file of ``stribeck check --certificate``.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping
from fractions import Fraction
from pathlib import Path

from coq import GOAL_HEADER, coq_goal

from stribeck.errors import InputError
from stribeck.expressions import ops
from stribeck.expressions.graph import Expr, rewrite, substitute, symbol, wrap
from stribeck.properties.model import RATE, SIGNS, U, V, W, Z, positive
from stribeck.properties.plain import Json

_BINARY = {
    "add": lambda a, b: a + b, "sub": lambda a, b: a - b, "mul": lambda a, b: a * b, "div": lambda a, b: a / b,
    "pow": lambda a, b: a**b, "lt": lambda a, b: a < b, "le": lambda a, b: a <= b,
}  # fmt: skip


def goals(certificate: Mapping[str, Json], slowest: Fraction, fastest: Fraction) -> str:
    """Lemmas that F v - S' dz/dt > 0 for slowest <= |v| <= fastest and |z| <= Z, in all four quadrants.

    They use only the equations and the slope of the storage function in the certificate.

    Args:
        certificate: of passivity with one slope for all z and a finite Z, as ``stribeck check --certificate`` writes it.
        slowest: speed above 0, m/s; intervals cannot show the equality at rest.
        fastest: speed, m/s.

    Raises:
        InputError: an operation that the tactic does not know.
    """
    numbers: dict[str, Fraction] = {}
    known: dict[str, Expr] = {"v": V, "z": Z, "dz_dt": RATE, "pi": wrap(ops.pi)}
    for name, expression in certificate["definitions"]:
        known[name] = _read(expression, known, numbers)
    rate, force, slope = (_read(x, known, numbers) for x in (
        certificate["dz_dt"], certificate["force"], certificate["data"]["slope"]))  # fmt: skip
    lost = substitute([force], {RATE: rate})[0] * V - slope * rate
    fixed = {name: (x, x) for name, x in numbers.items()}
    box = {**fixed, "u": (slowest, fastest), "w": (Fraction(0), Fraction(certificate["Z"]))}
    lemmas = []
    for s in SIGNS:
        for t in SIGNS:
            here = substitute([lost], {V: U * s, Z: W * t})
            form = rewrite(here, lambda node: positive(node, numbers))[0]
            lemmas.append(coq_goal(form, box, f"power_{'np'[s > 0]}{'np'[t > 0]}", above=True))
    return GOAL_HEADER + "\n".join(lemmas)


def _read(data: Json, known: Mapping[str, Expr], numbers: dict[str, Fraction]) -> Expr:
    """An expression of a certificate; its numbers become symbols with exact values."""
    if isinstance(data, str):
        if data[:1].isdigit() or data[:1] == "-":
            name = f"q{len(numbers)}"
            numbers[name] = Fraction(data)
            return symbol(name)
        return known[data]
    op, *rest = data
    args = [_read(x, known, numbers) for x in rest]
    if op == "neg":
        return -args[0]
    if op == "abs":
        return abs(args[0])
    applied: Expr = _BINARY[op](*args) if op in _BINARY else getattr(ops, op)(*args)
    return applied


def main(arguments: list[str]) -> int:
    """Print the goals of a file's certificate of passivity; returns 2 if it has no suitable one."""
    try:
        file, slowest, fastest = arguments
        certificate = json.loads(Path(file).read_text(encoding="utf-8"))["certificates"]["passive"]
        print(goals(certificate, Fraction(slowest), Fraction(fastest)))
    except (OSError, ValueError, KeyError, TypeError, InputError) as error:
        print(f"no goals: {type(error).__name__}: {error}\n{__doc__}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

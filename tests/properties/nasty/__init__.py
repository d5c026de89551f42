"""Nasty user laws, each with the truth of the five properties derived by hand in its docstring.

A law states ``truth``, one word for each property: ``passive`` it holds, ``-passive`` it does not, ``?passive`` not
derived (any verdict will do). ``values`` are changes to MILD below.

The properties are those of docs/explanation/check.md: Z is ``z_bound`` (F_s/sigma_0 unless the law says otherwise), ``passive``
restricts z to it where ``bounded`` holds and not at all where it does not; ``smooth`` is about dz/dt and F both;
equations are over the real numbers, and a solution obeys dz/dt = f almost everywhere (v(t) may jump).

Facts that the derivations use, for MILD, where Z = 1.5e-5 m, 1e-5 <= g(v) <= Z, g_N = sigma_0 g in [1, 1.5] N,
r = z sgn(v)/g, |r| <= 1.5 for |z| <= Z, and dz/dt = f = v - |v| z/g = v (1 - r) is LuGre's:

B0. LuGre's f is Lipschitz in z and grows linearly: unique. f sgn z <= |v| (1 - Z/g) <= 0 at |z| = Z: bounded. df/dv
    at v = 0 is 1 - z/g from above and 1 + z/g from below: not smooth. f != v for z, v != 0: not drift_free.
B1. Passive, with W = sigma_0 z^2/2: D0 = F v - W' f = v^2 (sigma_1 (1 - r) + sigma_2) + g_N |v| r^2
    >= 50 v^2 + g_N |v| r^2 for |z| <= Z. An added force h has D = D0 + h v; h v >= 0 keeps the law passive.
B2. For unrestricted z no law with LuGre's f at large |v|, sigma_1 = sigma_2 and F = sigma_0 z + sigma_1 f + sigma_2 v is passive:
    from r > 2 a pulse at v draws |F v/f| = v (100 r - 200)/(r - 1) - O(1) J for each meter of z, without limit in v.
B3. A held v takes z to where f = 0, g sgn v for LuGre; F v < 0 there draws energy for ever: not passive.
B4. An added force h(z) with LuGre's f: S = W + integral of h has D = D0 + h z |v|/g >= 50 v^2 + (|v| z/g)(sigma_0 z + h):
    passive if z (sigma_0 z + h) >= 0 on |z| <= Z. If it is < 0 on an interval within |z| < Z the law is not passive: to
    and fro on it, ever slower, costs the integral of D over dz, whose limit is 2 (z/g)(sigma_0 z + h)/(1 - z^2/g^2) < 0.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import stribeck
from stribeck import laws

PROPERTIES = ("unique", "bounded", "smooth", "passive", "drift_free")
MILD = {"sigma_0": 1e5, "sigma_1": 100.0, "sigma_2": 100.0, "F_c": 1.0, "F_s": 1.5, "v_s": 1e-3}
FOLDER = Path(__file__).parent


@dataclass(frozen=True)
class Case:
    """A law of this folder, and what is true of it: True, False or None (not derived)."""

    kind: str
    name: str
    truth: dict[str, bool | None]

    def law(self) -> Any:
        """The law as a user gets it."""
        cls = laws.find(f"{FOLDER / self.kind}.py:{self.name}")
        values = {**MILD, **getattr(cls, "values_changed", {})}
        known = set(cls.constants())
        return stribeck.law(f"{FOLDER / self.kind}.py:{self.name}", {n: x for n, x in values.items() if n in known})


def cases() -> Iterator[Case]:
    """Every law of the folder, in the order in which they are written."""
    for file in sorted(FOLDER.glob("*.py")):
        if file.name == "__init__.py":
            continue
        for node in ast.parse(file.read_text()).body:
            if truth := _truth(node):
                yield Case(file.stem, node.name, parsed(truth))


def parsed(truth: str) -> dict[str, bool | None]:
    """The truth of each property from a class's ``truth``."""
    values = {"-": False, "?": None}
    result = {word.lstrip("-?"): values.get(word[0], True) for word in truth.split()}
    assert tuple(result) == PROPERTIES, truth
    return result


def _truth(node: ast.stmt) -> str | None:
    """The ``truth`` that a class states, or a decorator of base.py of the law that it makes."""
    match node:
        case ast.ClassDef():
            lines = [n for n in node.body if isinstance(n, ast.Assign) and isinstance(n.targets[0], ast.Name)]
            return next((ast.literal_eval(n.value) for n in lines if n.targets[0].id == "truth"), None)
        case ast.FunctionDef(decorator_list=[ast.Call(func=ast.Name(id="added" | "rate" | "friction")) as call]):
            return ast.literal_eval(call.args[0])
    return None

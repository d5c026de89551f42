"""Certificates written by hand, for LuGre and an elasto-plastic law with a ramp: what a prover would write."""

from __future__ import annotations

from fractions import Fraction
from itertools import product
from typing import Any

import stribeck
from tests.properties.nasty import FOLDER, MILD

Z, ALL = "3/200000", ["0", "inf"]
SIGNS = (1, -1, 0)


def text(x: float | Fraction) -> str:
    return str(Fraction(x))


SIGMA_0, SIGMA_1, SIGMA_2 = (text(MILD[n]) for n in ("sigma_0", "sigma_1", "sigma_2"))
V_S = text(MILD["v_s"])


def exponential(x: str) -> Any:
    return ["exp", ["neg", ["mul", ["div", x, V_S], ["div", x, V_S]]]]


DEFINITIONS = [["n0", exponential("v")], ["n1", ["div", ["add", "1", ["mul", "1/2", "n0"]], SIGMA_0]]]
LUGRE = ["sub", "v", ["mul", ["div", ["abs", "v"], "n1"], "z"]]
FORCE = ["add", ["add", ["mul", SIGMA_0, "z"], ["mul", SIGMA_1, "dz_dt"]], ["mul", SIGMA_2, "v"]]
STRIBECK = [exponential("u"), "range", "0", "1"]
LEAF = ["leaf", [STRIBECK]]


def claim(about: str, s: int, t: int, relation: str, u: Any = ALL, w: Any = ALL, **more: Any) -> dict[str, Any]:
    built = {"about": about, "v": s, "z": t, "relation": relation, "tree": LEAF, **more}
    return built | ({"u": u} if s else {}) | ({"w": w} if t else {})


def certificate(name: str, theorem: str, claims: list[Any], rate: Any = LUGRE, **more: Any) -> dict[str, Any]:
    return {
        "format": 1, "law": "lugre", "property": name, "v_max": "inf", "constants": {}, "definitions": DEFINITIONS,
        "dz_dt": rate, "force": FORCE, "Z": Z, "theorem": theorem, "data": {}, "claims": claims, "hypotheses": {}, **more,
    }  # fmt: skip


def bounded(rate: Any = LUGRE, leaf: Any = LEAF) -> dict[str, Any]:
    claims = [claim("inward", s, t, ">=0", w=[Z, "inf"], tree=leaf) for s, t in product(SIGNS, (1, -1))]
    return certificate("bounded", "outside", claims, rate)


def unique(rate: Any = LUGRE) -> dict[str, Any]:
    slopes = [
        claim("lipschitz", s, t, ">=0", sign=sign, a="0", b="50001", k=1, l="1", m=0)
        for s, t, sign in product(SIGNS, (1, -1), (1, -1))
    ]
    finite = [claim("finite", s, 0, ">=0", sign=sign, a="0", b="1", k=1) for s, sign in product(SIGNS, (1, -1))]
    grows = [claim("growth", s, t, ">=0", a="0", b="1", l="1", k=1) for s, t in product(SIGNS, (1, -1))]
    return certificate("unique", "lipschitz", slopes + finite + grows, rate)


def bounded_at_its_edge() -> dict[str, Any]:
    claims = [claim("inward", s, t, ">=0", w=[Z, Z]) for s, t in product(SIGNS, (1, -1))]
    return certificate("bounded", "edge", claims, hypotheses={"unique": unique()})


def passive(rate: Any = LUGRE, leaf: Any = LEAF, inner: Any = None) -> dict[str, Any]:
    slope = ["mul", SIGMA_0, "z"]
    claims = [
        claim("power", s, t, ">=0", w=["0", Z], slope=slope, tree=leaf) for s, t in product(SIGNS, SIGNS)
    ]  # fmt: skip
    return certificate("passive", "storage", claims, rate, hypotheses={"bounded": inner or bounded(rate)})


def passive_at_any_z(slope: Any = ("mul", SIGMA_0, "z")) -> dict[str, Any]:
    """LuGre without sigma_1, whose power has a storage function that no bound on z is needed for."""
    slope = list(slope)
    claims = [claim("power", s, t, ">=0", slope=slope) for s, t in product(SIGNS, SIGNS)]
    claims += [claim("slope sign", 0, t, ">=0", slope=slope) for t in (1, -1)]
    return certificate("passive", "storage", claims, force=["add", slope, ["mul", SIGMA_2, "v"]])


# sqrt(v^2 + 1e-12) in place of |v|: the law constants.. of nasty/literature.py:RootMajorant
SMALL = text(1e-12)
ROOT = ["sub", "v", ["mul", ["div", ["sqrt", ["add", ["mul", "v", "v"], SMALL]], "n1"], "z"]]


def smooth(rate: Any = ROOT) -> dict[str, Any]:
    closed = {"tree": ["leaf", []]}
    claims = [
        claim("divisor", s, t, ">0", expression=["add", ["mul", "u", "u"], SMALL], **closed)
        for s, t in product((1, -1), (1, -1))
    ]
    return certificate("smooth", "switching", claims, rate)


RAMP = ["div", ["sub", ["abs", "z"], "1/200000"], "1/200000"]
SHARE = ["where", ["lt", RAMP, "0"], "0", ["where", ["lt", "1", RAMP], "1", RAMP]]
ELASTIC = ["sub", "v", ["mul", ["div", ["mul", SHARE, ["abs", "v"]], "n1"], "z"]]


def drift_free() -> dict[str, Any]:
    claims = [
        claim("elastic", s, t, "=0", w=["0", "1/200000"], tree=LEAF) for s, t in product(SIGNS, SIGNS)
    ]  # fmt: skip
    return certificate("drift_free", "elastic", claims, ELASTIC, data={"z_0": "1/200000"})


def law(name: str) -> Any:
    """LuGre or one of the nasty laws with MILD."""
    return stribeck.law(
        name if "." not in name else f"{FOLDER / name.partition('.')[0]}.py:{name.partition('.')[2]}", MILD
    )

"""Built-in laws make sense and keep what they claim; laws that do not are caught."""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np
import pytest

from stribeck.expressions.ops import sqrt, where
from stribeck.laws import builtin
from stribeck.laws.form import Form
from stribeck.laws.lugre import LuGre, LuGreMajorant
from stribeck.laws.sanity import problems
from stribeck.laws.static import CoulombViscous
from stribeck.laws.terms import S_0
from stribeck.parameter_sets import parameters
from stribeck.properties import WORK
from stribeck.properties.checked import Checked

CANUDAS = parameters()["canudas1995"].values


def make(law: type, set_name: str = "canudas1995", **constants: Any):
    """A law for a machine; its own constants suit the machine's scales unless given."""
    values: dict[str, Any] = dict(parameters()[set_name].values)
    own = law.own_constants()
    values |= {name: c.example for name, c in own.items() if c.example is not None}
    values |= {"z_ba": 0.7 * values["F_c"] / values["sigma_0"]} if "z_ba" in own else {}
    values |= {"k_v": 1e3 / values["v_s"]} if "k_v" in own else {}
    known = {n: x for n, x in values.items() if n in parameters()[set_name].values or n in own}
    return law({**known, **constants})


def test_a_law_that_cannot_be_used_is_told_once(monkeypatch):
    law = make(LuGreMajorant)
    monkeypatch.setattr("stribeck.laws.sanity.laws.trouble", lambda law: "no equations")
    assert problems(law) == ["no equations"]


def test_a_bristle_that_never_slides_has_an_infinite_steady_force_and_no_fault():
    class Spring(LuGre):
        @staticmethod
        def dz_dt(p, v, z):
            return v + 0 * z

    assert problems(make(Spring)) == []


@pytest.mark.parametrize("set_name", parameters())
@pytest.mark.parametrize("name", builtin())
def test_built_in_laws_make_sense(name, set_name):
    assert problems(make(builtin()[name], set_name)) == []


@pytest.mark.share(4)
@pytest.mark.parametrize("k_v", [1e2, 1e8])
@pytest.mark.parametrize("name", [name for name, law in builtin().items() if "k_v" in law.constants()])
def test_at_any_steepness(name, k_v):
    for form in builtin()[name].forms():
        assert problems(make(builtin()[name], k_v=k_v, **dict(form.choices))) == []


P = parameters()["canudas1995"].values
CONDITIONS = {  # constants at which a law is passive, and with which it is not
    "lugre": ({"sigma_1": 0.8 * (1 - 1e-12)}, {"sigma_1": 0.8 * (1 + 1e-9)}),
    "lugre_majorant": ({"sigma_1": 0.8 * (1 - 1e-12)}, {"sigma_1": 0.81}),
    "elastoplastic": ({"sigma_1": 0.8 * (1 - 1e-12)}, {"sigma_1": 0.81}),
    "lugre_arctan": ({"sigma_1": 0.0}, {"sigma_1": 1.0}),
    "dahl": ({}, None),
}


@pytest.mark.parametrize("name", CONDITIONS)
def test_a_claim_of_passivity_is_what_check_proves(name):
    for constants, passive in zip(CONDITIONS[name], (True, False), strict=True):
        if constants is not None:
            law = make(builtin()[name], **constants)
            assert law.guarantees()["passive"] is passive
            assert Checked(law, None, WORK).passive().holds is passive


@pytest.mark.parametrize(("smooth_abs", "gap"), [("atan", 2 / pi), ("sqrt", 1.0), ("compact", 0.375)])
def test_the_steepness_that_a_majorant_needs(smooth_abs, gap):
    """LuGre's condition carries over while sigma_1 m(0) <= F_s; F_s = F_c makes it hold for any sigma_1."""
    table = {"sigma_1": 100.0, "F_s": 1.0, "smooth_abs": smooth_abs}
    enough = make(LuGreMajorant, k_v=100.001 * gap, **table)
    assert enough.guarantees()["passive"]
    assert Checked(enough, None, WORK).passive().holds
    assert not make(LuGreMajorant, k_v=99.999 * gap, **table).guarantees()["passive"]


# -- equations without sense --------------------------------------------------------------------------------------------


class Steep:
    k_v = 1e6


class Lopsided(CoulombViscous):
    name = "broken"

    @staticmethod
    def friction(p, v, z, dz_dt):
        return p.F_c * S_0(Steep, v) + where(v > 0, 2.0, 1.0) * p.sigma_2 * v


class LopsidedOnPurpose(Lopsided):
    symmetric = False


class NotFinite(Lopsided):
    @staticmethod
    def friction(p, v, z, dz_dt):
        return p.F_c * sqrt(v * abs(v)) / sqrt(abs(v))


class ForgetsArrays(Lopsided):
    @staticmethod
    def friction(p, v, z, dz_dt):
        return p.F_c * v if np.ndim(v) == 0 else p.F_c * v * 1.01


@pytest.mark.parametrize(
    ("law", "lines"),
    [
        (Lopsided, ["values: F does not change sign with (v, z) at v = "]),
        (LopsidedOnPurpose, []),
        (NotFinite, ["values: F is not finite at v = ", "arrays: "]),
        (ForgetsArrays, ["arrays: F of arrays differs from that of numbers"]),
    ],
)
def test_laws_without_sense(law, lines):
    result = problems(law({"F_c": 1.0, "sigma_2": 0.4}))
    assert len(result) == len(lines), result
    assert all(line.startswith(start) for line, start in zip(result, lines, strict=True)), result


def test_the_forms_of_a_law():
    assert [form.words for form in LuGre.forms()] == [(), ("delta",), ("v_d",), ("v_d", "delta")]
    assert [form.words for form in LuGreMajorant.forms()[:4]] == [
        (), ("smooth_abs=sqrt",), ("smooth_abs=compact",), ("delta",),
    ]  # fmt: skip
    assert len(LuGreMajorant.forms()) == 12
    assert make(LuGreMajorant).form == make(LuGreMajorant, smooth_abs="atan").form == Form()
    both = make(LuGreMajorant, smooth_abs="sqrt", v_d=1.0)
    assert both.form == Form(("v_d",), (("smooth_abs", "sqrt"),)) in LuGreMajorant.forms()
    assert both.choices == {"smooth_abs": "sqrt"}
    assert builtin()["dahl"].forms() == [Form()]

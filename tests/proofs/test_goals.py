"""Expressions as terms of Coq, and inequalities as goals that its kernel checks."""

from __future__ import annotations

import json
import random
from fractions import Fraction
from types import SimpleNamespace

import pytest

from stribeck import check, law
from stribeck.expressions.graph import substitute, symbol
from stribeck.laws import builtin
from stribeck.laws.form import USUAL
from tests.proofs.coq import compiles, needs_coq, script

coq, goals, main = script("coq"), script("goals").goals, script("goals").main
TENTH, FIFTH = (f"({Fraction(a).numerator} / {Fraction(a).denominator})" for a in (0.1, 0.2))
x, y, v, z = (symbol(n) for n in "xyvz")


def dissipation(name, form=USUAL):
    """The power lost, F v - W' dz/dt, of a law's equations with W' = sigma_0 z, and its constants as symbols."""
    cls = builtin()[name]
    p = cls.symbolic(symbol, form)
    rate = cls.dz_dt(p, v, z)
    return cls.friction(p, v, z, rate) * v - p.sigma_0 * z * rate, p


@pytest.mark.thorough
@needs_coq
def test_a_certificate_of_a_law_is_checked_by_coq(tmp_path):
    """lugre_majorant, Table 1 with sigma_2 = 200: the power lost at the z that loses least, up to the speed at which that z
    is the bound, and at the bound beyond; from 0.15 mm/s to 0.15 m/s."""
    result = law("lugre_majorant", "canudas1995", sigma_2=200.0, k_v=1e6)
    lost, p = dissipation("lugre_majorant")
    fixed = {n: (x, x) for n, x in result.values.items() if x is not None}
    q = SimpleNamespace(**{n: Fraction(x) for n, (x, _) in fixed.items()})
    turn = 2 * q.F_s / q.sigma_1
    slow = substitute([lost], {z: p.sigma_1 * v / (2 * p.sigma_0)})[0]
    fast = substitute([lost], {z: p.F_s / p.sigma_0})[0]
    goals = [
        coq.coq_goal(slow, {**fixed, "v": (turn / 64, turn)}, "slow", above=True),
        coq.coq_goal(fast, {**fixed, "v": (turn, 16 * turn)}, "fast", above=True),
    ]
    answer = compiles(coq.GOAL_HEADER + "\n".join(goals), tmp_path)
    assert answer.returncode == 0, answer.stderr


@pytest.fixture(scope="module")
def certificates():
    return check(law("lugre_majorant", "canudas1995", sigma_2=200.0, k_v=1e6)).certificates()


@needs_coq
def test_the_certificate_that_check_writes_is_checked_by_coq(certificates, tmp_path):
    """The power inequality for all |z| <= Z, from the equations and the slope in the certificate; make proofs checks it from
    20 mm/s on, where it takes longer."""
    text = goals(certificates["certificates"]["passive"], Fraction(1, 15), Fraction(1, 10))
    assert text.count("Lemma power_") == 4
    answer = compiles(text, tmp_path)
    assert answer.returncode == 0, answer.stderr


def test_goals_of_a_file(certificates, tmp_path, capsys):
    file = tmp_path / "proofs.json"
    file.write_text(json.dumps(certificates))
    assert main([str(file), "1/50", "0.1"]) == 0
    assert "(1 / 50) <= u <= (1 / 10)" in capsys.readouterr().out
    assert main([str(file), "1/50"]) == 2
    file.write_text(json.dumps({"certificates": {}}))
    assert main([str(file), "1/50", "0.1"]) == 2
    assert "no goals" in capsys.readouterr().err


@needs_coq
def test_a_wrong_certificate_is_refused(tmp_path):
    """Table 1 itself is not passive: the same inequality fails."""
    result = law("lugre_majorant", "canudas1995", k_v=1e6)
    lost, p = dissipation("lugre_majorant")
    fixed = {n: (x, x) for n, x in result.values.items() if x is not None}
    fast = substitute([lost], {z: p.F_s / p.sigma_0})[0]
    answer = compiles(coq.GOAL_HEADER + coq.coq_goal(fast, {**fixed, "v": (0.5, 1)}), tmp_path)
    assert answer.returncode != 0


@pytest.mark.thorough
@needs_coq
def test_terms_mean_what_is_evaluated(tmp_path):
    """The force of every law without cases, as a term, has the value that is simulated: within 1e-12, by intervals."""
    rng, goals = random.Random(5), []
    for name in ("lugre", "lugre_arctan", "lugre_sobczyk", "lugre_majorant", "dahl"):
        result = law(name, "canudas1995", **({} if name in ("lugre", "dahl") else {"k_v": 1e4}))
        at = {"v": rng.uniform(-0.01, 0.01), "z": rng.uniform(-1e-5, 1e-5)}
        p = type(result).symbolic(symbol, result.form)
        force = result.friction(p, v, z, result.dz_dt(p, v, z))
        numbers = {n: a for n, a in {**result.values, **at}.items() if a is not None}
        value = float(result.force(at["v"], at["z"]))
        box = {n: (a, a) for n, a in numbers.items()}
        near = 1e-12 * max(1.0, abs(value))
        goals += [
            coq.coq_goal(force - (value - near), box, f"{name}_above"),
            coq.coq_goal((value + near) - force, box, f"{name}_below"),
        ]
    answer = compiles(coq.GOAL_HEADER + "\n".join(goals), tmp_path)
    assert answer.returncode == 0, answer.stderr

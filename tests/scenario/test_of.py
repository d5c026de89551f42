"""What a scenario may be made of, and what a solution answers to."""

from __future__ import annotations

import copy
import pickle
import tomllib

import numpy as np
import pytest

import stribeck
from stribeck import Scenario, examples
from stribeck.identify.synthetic import experiment
from stribeck.laws import BristleLaw, Claims, Scales
from stribeck.scenario.said import file

TABLES = {
    "plant": {"mass": 1.0}, "drive": {"kind": "force", "signal": {"kind": "sine", "amplitude": 2.0, "frequency": 1.0}},
    "solve": {"t_end": 0.5}, "output": {"step": 0.01},
}  # fmt: skip
OPEN = {"sigma_0": 1e5, "sigma_1": 316.2, "sigma_2": 0.4, "F_c": 1.0, "F_s": 1.5, "v_s": 1e-3}


class Mine(BristleLaw):
    """dz/dt of Dahl's, written in a program."""

    claims = Claims()
    uses = tuple(OPEN)

    @staticmethod
    def dz_dt(p, v, z):
        return v - abs(v) * p.sigma_0 / p.F_c * z

    @staticmethod
    def scales(p):
        return Scales(p.F_c / p.sigma_0, p.v_s, p.F_c)


def test_a_path_and_tables_are_simulated_as_a_scenario_is():
    path = examples.path("break_away")
    expected = stribeck.simulate(Scenario.load(path))
    for given in (path, str(path), Scenario.load(path).data):
        np.testing.assert_array_equal(stribeck.simulate(given)["F"], expected["F"])


def test_a_solution_knows_its_columns():
    solution = stribeck.simulate(examples.path("break_away"))
    assert "y" in solution
    assert "t" in solution
    assert "Y" not in solution
    assert list(solution)[:5] == ["t", "y", "v", "z", "F"]
    assert set(dict(solution)) == set(solution)


@pytest.mark.parametrize("choices", [{}, {"smooth_abs": "sqrt"}])
def test_a_law_is_a_table_of_a_scenario(choices):
    law = stribeck.law("lugre_majorant", parameters="canudas1995", k_v=1e6, **choices)
    scenario = Scenario(law=law, **TABLES)
    assert scenario.law.same_as(law)
    assert scenario.with_changes({"law.k_v": 2e5}).law.values["k_v"] == 2e5
    other = stribeck.law("dahl", parameters="canudas1995")
    assert scenario.with_changes({"law": other}).law.same_as(other)


def test_a_law_of_a_program_is_simulated():
    solution = stribeck.simulate(Scenario(law=Mine(OPEN), **TABLES))
    assert solution.status == "done"
    dahl = stribeck.simulate(Scenario(law=stribeck.law("dahl", OPEN), **TABLES))
    assert np.abs(solution["z"]).max() == pytest.approx(np.abs(dahl["z"]).max(), rel=1e-6)


def test_a_law_of_a_file_keeps_its_name(tmp_path):
    source = "from stribeck.laws.lugre import LuGre\n\n\nclass Own(LuGre):\n    pass\n"
    (tmp_path / "own.py").write_text(source)
    law = stribeck.law(f"{tmp_path}/own.py:Own", parameters="canudas1995")
    assert law.to_dict()["name"] == f"{tmp_path / 'own.py'}:Own"
    assert Scenario(law=law, **TABLES).law.same_as(law)


def test_a_law_keeps_its_choices_where_it_is_simulated_for_another_purpose():
    plain, other = (
        stribeck.law("lugre_majorant", parameters="canudas1995", k_v=3e3, **chosen)
        for chosen in ({}, {"smooth_abs": "sqrt"})
    )
    assert not plain.same_as(other)
    t = np.linspace(0, 1, 1001)
    v = 1e-3 * np.sin(2 * np.pi * t)
    truth = {law: experiment(law, (t, v)).log.force for law in (plain, other)}
    assert np.abs(truth[plain] - truth[other]).max() > 1e-3
    drive = {"kind": "velocity", "signal": {"kind": "points", "t": t.tolist(), "value": v.tolist()}}
    simulated = stribeck.simulate(Scenario(law=other, drive=drive, solve={"t_end": 1.0}, output={"step": 1e-3}))
    np.testing.assert_allclose(truth[other], simulated["F"], atol=1e-12)


def test_a_scenario_does_not_change():
    """Nor does a law: what a solution belongs to stays what it was solved for. Copies and pickles are equal."""
    scenario = Scenario(law={"name": "lugre", "parameters": OPEN}, **TABLES)
    for name, value in (("mass", 2.0), ("law", None), ("other", 1)):
        with pytest.raises(AttributeError, match=f"{name}: a Scenario does not change"):
            setattr(scenario, name, value)
    with pytest.raises(AttributeError, match="F_c: the constants of a law do not change"):
        scenario.law.p.F_c = 2.0
    again = pickle.loads(pickle.dumps(scenario))
    assert again.law.p == copy.deepcopy(scenario.law).p == scenario.law.p
    heavier = scenario.elements.with_values({("bodies", "mass"): 2.0})
    assert (scenario.elements.mass, heavier.mass) == (1.0, 2.0)
    assert heavier.system is scenario.system
    assert heavier.laws == scenario.elements.laws
    slippery = scenario.elements.with_values({("contacts.law", "F_c"): 0.5})
    assert slippery.contacts[""].friction.p.F_c == 0.5
    assert slippery.laws == {}  # a law of a file has the numbers of the file


def test_long_lists_of_a_page_are_cut():
    points = {"kind": "points", "t": list(range(40)), "value": [*range(39), 7.5]}
    law = {"name": "lugre", "parameters": OPEN}
    code = file(Scenario({"schema": 1, "law": law, **TABLES, "drive": {"kind": "force", "signal": points}})).code
    shown = tomllib.loads(code)["drive"]["signal"]["value"]
    assert shown == [*range(8), "... 24 more ...", *range(32, 39), 7.5]

"""Changes to a scenario: --set PATH=VALUE, another law, and scenarios built in Python."""

from __future__ import annotations

import copy
import math

import numpy as np
import pytest

from stribeck import InputError, Scenario
from stribeck.scenario import parse_assignment
from tests.scenario.valid_scenarios import CANUDAS, VALID, edited, write

SCENARIO = Scenario(VALID["force_points"])


@pytest.mark.parametrize(
    ("text", "path", "value"),
    [
        ("law.k_v=1e7", "law.k_v", 1e7),
        ("law.k_v = 10_000", "law.k_v", 10_000),
        ("law.k_v=-.5e3", "law.k_v", -500.0),
        ("law.k_v=5.", "law.k_v", 5.0),
        ("name=.a5", "name", ".a5"),
        ("output.energy=true", "output.energy", True),
        ("law.name=lugre", "law.name", "lugre"),
        ("law.name='lugre'", "law.name", "lugre"),
        ('law.name="lugre"', "law.name", "lugre"),
        ("law.name=mylaw.py:MyLaw", "law.name", "mylaw.py:MyLaw"),
        ("name=a = b", "name", "a = b"),
        ("name=", "name", ""),
        ("name=  spaced out ", "name", "spaced out"),
        ("drive.signal.t=[0.0, 1]", "drive.signal.t", [0.0, 1]),
        ("law.parameters={F_s = 2.0}", "law.parameters", {"F_s": 2.0}),
        ("solve.t_end=inf", "solve.t_end", math.inf),
        ("solve.t_end=1.0 # s", "solve.t_end", 1.0),
        ("name=1\nlaw.k_v = 3", "name", "1\nlaw.k_v = 3"),
        ("name=" + "[" * 50_000, "name", "[" * 50_000),
        ("name=" + "9" * 5_000, "name", "9" * 5_000),
    ],
    ids=range(20),
)
def test_assignments(text, path, value):
    assert parse_assignment(text) == (path, value)
    assert type(parse_assignment(text)[1]) is type(value)


@pytest.mark.parametrize("text", ["", "=", "=1", "law.k_v", "law..k_v=1", ".=1", "law.=1"])
def test_what_is_no_assignment(text):
    with pytest.raises(InputError, match="must be PATH=VALUE"):
        parse_assignment(text)


def test_values_are_replaced_and_the_original_is_untouched():
    before = copy.deepcopy(SCENARIO.data)
    new = SCENARIO.with_changes({"law.k_v": 1e7, "law.parameters.F_s": 2.0, "drive.signal.value": [0.0, 1.0, 2.0, 5.0]})
    assert (new.law.p.k_v, new.law.p.F_s, new.signal.at(2.0)) == (1e7, 2.0, 5.0)
    assert SCENARIO.data == before
    assert (SCENARIO.law.p.k_v, SCENARIO.law.p.F_s, SCENARIO.signal.at(2.0)) == (1e6, 1.5, 0.0)
    assert SCENARIO.with_changes({"solve.atol": {"z": 1e-9}}).solve.atol == {"z": 1e-9}
    assert SCENARIO.with_changes({}).data == before


def test_a_scenario_keeps_no_hold_on_what_it_was_made_from():
    data = copy.deepcopy(VALID["force_points"])
    scenario = Scenario(data)
    data["law"]["parameters"]["F_s"] = 0.1
    data["drive"]["signal"]["t"].append(0.0)
    assert scenario.with_changes({}).law.p.F_s == 1.5


@pytest.mark.parametrize("changes", [{"law.name": "lugre"}, {"law.parameters.F_s": 2.0}, {"law.k_v": 1.0}])
def test_a_law_that_is_no_table(changes, tmp_path):
    path = write(edited(VALID["force_points"], "law", value="lugre"), tmp_path)
    with pytest.raises(InputError, match=r"^law"):
        Scenario.load(path, changes)


def test_a_parameter_of_a_named_set(tmp_path):
    scenario = Scenario(VALID["pid_step"])
    new = scenario.with_changes({"law.parameters.F_s": 2.0})
    assert (new.law.p.F_s, new.law.p.F_c, scenario.law.p.F_s) == (2.0, 1.0, 1.5)
    assert scenario.data["law"]["parameters"] == "canudas1995"
    both = {"law.parameters.F_s": 9.0, "law.parameters": "liu2015"}  # in any order
    assert scenario.with_changes({**both, "law.z_ba": 1e-9}).law.p.F_s == 9.0
    (tmp_path / "x.toml").write_text(
        "[parameters]\nk_v = 1e6\nz_ba = 6e-6\n" + "".join(f"{n} = {x}\n" for n, x in CANUDAS.items())
    )
    path = write(edited(VALID["pid_step"], "law", value={"name": "elastoplastic", "parameters": "x.toml"}), tmp_path)
    new = Scenario.load(path, {"law.parameters.F_s": 3.0})
    assert (new.law.p.F_s, new.law.p.z_ba) == (3.0, 6e-6)


def test_numpy_values_and_paths_are_taken():
    t = np.array([0.0, 0.5, 1.0])
    new = SCENARIO.with_changes(
        {
            "law.k_v": np.int64(7),
            "drive.signal": {"kind": "points", "t": t, "value": tuple(t)},
            "plant.mass": np.float32(2),
        }
    )
    assert (new.law.p.k_v, new.data["plant"]["mass"], new.signal.at(0.25)) == (7.0, 2.0, 0.25)


def test_tables_as_keywords():
    tables = {name: table for name, table in VALID["pid_step"].items() if name != "schema"}
    assert Scenario(**tables).law.name == "elastoplastic"
    assert Scenario(VALID["pid_step"], name="mine").name == "mine"

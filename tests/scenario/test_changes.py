"""Changes to a scenario: --set PATH=VALUE, another law, and scenarios built in Python."""

from __future__ import annotations

import copy
import math
import warnings
from pathlib import Path

import numpy as np
import pytest

from stribeck import InputError, Scenario
from stribeck.errors import StribeckNote
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


def test_missing_tables_are_made(tmp_path):
    path = write(VALID["spring_ramp"], tmp_path)
    assert Scenario.load(path, {"plant.initial.y": 0.5}).initial["y"] == 0.5
    assert Scenario.load(path, {"solve.atol.z": 1e-12}).solve.atol == {"z": 1e-12}


def test_the_result_is_validated():
    with pytest.raises(InputError) as error:
        SCENARIO.with_changes({"law.k_v": -1.0, "law.kv": 1.0, "solve.t_end": math.nan, "a.b.c": 1, "": 1})
    assert {line.split(": ")[0] for line in error.value.problems} == {"a", "''", "law.k_v", "law.kv", "solve.t_end"}


@pytest.mark.parametrize(
    ("path", "said"),
    [
        ("name.x", "name.x: name is not a table, so it has no key 'x'"),
        ("solve.t_end.x.y", "solve.t_end.x.y: solve.t_end is not a table, so it has no key 'y'"),
        ("drive.signal.t.x", "drive.signal.t.x: 'x': must be a number from 0 to 3, an entry of the list"),
        ("drive.signal.t.4", "drive.signal.t.4: '4': must be a number from 0 to 3, an entry of the list"),
    ],
)
def test_paths_into_what_is_no_table(path, said):
    with pytest.raises(InputError) as error:
        SCENARIO.with_changes({path: 1.0})
    assert error.value.problems == [said]


@pytest.mark.parametrize("changes", [{"law.name": "lugre"}, {"law.parameters.F_s": 2.0}, {"law.k_v": 1.0}])
def test_a_law_that_is_no_table(changes, tmp_path):
    path = write(edited(VALID["force_points"], "law", value="lugre"), tmp_path)
    with pytest.raises(InputError, match=r"^law"):
        Scenario.load(path, changes)


def test_another_law_drops_what_it_does_not_have():
    with pytest.warns(StribeckNote) as notes:
        new = SCENARIO.with_changes({"law.name": "lugre"})
    assert [str(n.message) for n in notes] == ["law.k_v: dropped: law 'lugre' has no such constant"]
    assert (new.law.name, new.law.values) == ("lugre", {**CANUDAS, "v_d": None, "delta": None})
    with pytest.warns(StribeckNote) as notes:
        new = SCENARIO.with_changes({"law.name": "coulomb_viscous"})
    assert [str(n.message) for n in notes] == ["plant.initial.z: dropped: law 'coulomb_viscous' has no z"]
    assert (new.law.p.k_v, new.initial["y"]) == (1e6, 0.1)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        new = SCENARIO.with_changes({"law.z_ba": 7e-6, "law.name": "elastoplastic_sobczyk"})
    assert (new.law.p.k_v, new.law.p.z_ba) == (1e6, 7e-6)


def test_constants_given_with_the_law_are_not_dropped():
    with pytest.warns(StribeckNote, match="dropped"), pytest.raises(InputError, match=r"law\.k_v: .* no such constant"):
        SCENARIO.with_changes({"law.name": "lugre", "law.k_v": 1e6})


def test_own_constants_among_the_parameters_are_dropped_too():
    inside = {"name": "lugre_sobczyk", "parameters": {**CANUDAS, "k_v": 1e6}}
    with pytest.warns(StribeckNote, match=r"^law\.parameters\.k_v: dropped"):
        Scenario(edited(VALID["force_points"], "law", value=inside)).with_changes({"law.name": "lugre"})


def test_an_unknown_law():
    with pytest.raises(InputError, match=r"^law.name: 'lugree': no such law \(did you mean 'lugre'\?\)$"):
        SCENARIO.with_changes({"law.name": "lugree"})


def test_a_parameter_of_a_named_set(tmp_path):
    scenario = Scenario(VALID["pid_step"])
    new = scenario.with_changes({"law.parameters.F_s": 2.0})
    assert (new.law.p.F_s, new.law.p.F_c, scenario.law.p.F_s) == (2.0, 1.0, 1.5)
    assert scenario.data["law"]["parameters"] == "canudas1995"
    both = {"law.parameters.F_s": 9.0, "law.parameters": "liu2015"}  # in any order
    assert scenario.with_changes({**both, "law.z_ba": 1e-9}).law.p.F_s == 9.0
    with pytest.raises(InputError, match=r"^law.parameters: 'canudas1996': no such parameter set"):
        scenario.with_changes({"law.parameters": "canudas1996", "law.parameters.F_s": 2.0})
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
    assert (new.law.p.k_v, new.mass, new.signal.at(0.25)) == (7.0, 2.0, 0.25)
    with pytest.raises(InputError, match=r"^law.k_v: true: must be a finite number > 0, not a true/false value$"):
        SCENARIO.with_changes({"law.k_v": np.bool_(True)})
    with pytest.raises(InputError, match=r"^drive.signal.path: .*missing.csv': cannot be read"):
        SCENARIO.with_changes(
            {"drive.signal": {"kind": "file", "path": Path("missing.csv"), "time": "t", "value": "v"}}
        )


def test_tables_as_keywords():
    tables = {name: table for name, table in VALID["pid_step"].items() if name != "schema"}
    assert Scenario(**tables).law.name == "elastoplastic"
    assert Scenario(VALID["pid_step"], name="mine").name == "mine"
    with pytest.raises(InputError, match=r"^laws: .*: unknown key \(did you mean 'law'\?\)$"):
        Scenario(**tables, laws={})

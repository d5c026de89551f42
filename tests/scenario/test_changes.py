"""Changes to a scenario: --set PATH=VALUE, another law, and scenarios built in Python."""

from __future__ import annotations

import copy

from stribeck import Scenario
from tests.scenario.valid_scenarios import VALID

SCENARIO = Scenario(VALID["force_points"])


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


def test_tables_as_keywords():
    tables = {name: table for name, table in VALID["pid_step"].items() if name != "schema"}
    assert Scenario(**tables).law.name == "elastoplastic"
    assert Scenario(VALID["pid_step"], name="mine").name == "mine"

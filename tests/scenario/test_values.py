"""What a valid scenario holds: rows, signals, defaults, tolerances, constants."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stribeck import InputError, Scenario, platforms
from stribeck.parameter_sets import parameters
from tests.machine.machines import edited
from tests.scenario.valid_scenarios import CANUDAS, VALID

SPRING = VALID["spring_ramp"]
QUICK = settings(deadline=None, derandomize=True, database=None)


def with_values(t_end: float, step: float) -> Scenario:
    return Scenario(edited(SPRING, {"solve.t_end": t_end, "output.step": step}))


@QUICK
@given(st.integers(1, 10_000), st.floats(1e-6, 1e3))
def test_whole_multiples_of_the_step_reach_t_end(n, step):
    assert with_values(n * step, step).rows == n + 1


@QUICK
@given(st.floats(1e-3, 1e3), st.floats(1e-3, 1e3))
def test_the_rule_for_rows(t_end, step):
    scenario = with_values(t_end, step)
    last = scenario.rows - 1
    assert last == math.floor(t_end / step + 1e-9)
    assert last * step <= t_end * (1 + 2e-9) + 1e-9 * step
    assert (last + 1) * step > t_end
    assert scenario.end == max(t_end, last * step)


def test_defaults():
    scenario = Scenario(SPRING)
    assert scenario.name == "scenario"
    assert (scenario.solve.rtol, scenario.solve.atol) == (1e-8, {})
    assert scenario.output.energy is False
    assert scenario.initial == {}  # all of them 0
    assert scenario.elements.mass == 1.0
    assert isinstance(scenario.elements.mass, float)  # the file says 1


def test_tolerances_scale_with_the_law():
    base = Scenario(edited(SPRING, {"law": {"name": "lugre", "parameters": CANUDAS}}))
    atol = base.atol()
    finer = base.with_changes({"law.parameters.sigma_0": 1e7, "law.parameters.v_s": 0.1}).atol()
    assert finer["y"] == pytest.approx(atol["y"] / 100)
    assert finer["z"] == pytest.approx(atol["z"] / 100)
    assert finer["v"] == pytest.approx(atol["v"] * 100)
    assert base.with_changes({"solve.atol": {"y": 1e-3}}).atol() == {**atol, "y": 1e-3}


def test_scenarios_that_differ_in_numbers_share_a_system():
    one, other = Scenario(SPRING), with_values(7.0, 0.3).with_changes({"law.k_v": 3.0, "drive.signal.rate": 9.0})
    assert one.system == other.system
    assert one.system != Scenario(SPRING).with_changes({"output.energy": True}).system


@pytest.mark.parametrize("name", parameters())
def test_every_built_in_set_serves(name):
    law = {"name": "lugre_majorant", "k_v": 1e6, "parameters": name}
    assert Scenario(edited(SPRING, {"law": law})).law.machine == parameters()[name].values


@pytest.mark.parametrize(
    ("t_end", "step", "said"),
    [
        (1e6, 1e-6, r"1e\+12 rows would take \d+ TB of memory, and .* are free; must be larger"),
        (1.0, 1e-320, r"more than 1e\+15 rows would take more than \d+ PB of memory, and .*; must be larger"),
        (1e308, 1e-308, r"more than 1e\+15 rows would take more than \d+ PB of memory, and .*; must be larger"),
    ],
)
def test_more_rows_than_memory_holds(t_end, step, said):
    data = edited(VALID["force_points"], {"solve.t_end": t_end, "output.step": step})
    with pytest.raises(InputError, match=f"^output.step: .*: {said}$") as error:
        Scenario(data)
    assert f"{step}: " in str(error.value)
    assert len(error.value.problems) == 1


def test_rows_are_kept_twice_in_the_memory_that_is_free(monkeypatch):
    data = edited(VALID["force_points"], {"output.step": 1e-4})
    columns = 1 + len(Scenario(data).system.columns)  # and the time
    needed = 2 * np.zeros((10_001, columns)).nbytes
    monkeypatch.setattr(platforms, "free_memory", lambda: float(needed))
    Scenario(data)
    monkeypatch.setattr(platforms, "free_memory", lambda: needed - 1.0)
    with pytest.raises(InputError, match="rows would take"):
        Scenario(data)

"""Computations that fail: the status, the reason, and the rows that were reached."""

from contextlib import suppress

import numpy as np
import pytest

from stribeck import InputError, Scenario, simulate
from tests.simulation.rig import machine, needs_compiler, rig, spring

LAWS = '''
from stribeck.expressions.ops import sqrt, where
from stribeck.laws import BristleLaw
from stribeck.laws.terms import g

class Ends(BristleLaw):
    """Not a number once z has passed 0.5e-5 m."""

    @staticmethod
    def dz_dt(p, v, z):
        return v - abs(v) / g(p, v) * z * sqrt(0.5e-5 - z) / sqrt(0.5e-5 - z)

class Escapes(BristleLaw):
    """Infinite within a finite time."""

    @staticmethod
    def dz_dt(p, v, z):
        return 1e-3 + 1e9 * z * z

class Chatters(BristleLaw):
    """A rate that jumps against itself, so that no step is small enough."""

    @staticmethod
    def dz_dt(p, v, z):
        return where(z < 1e-6, 1.0, -1.0) + 0.0 * v

class Flutters(BristleLaw):
    """The same, faster than 1e12 steps can follow."""

    @staticmethod
    def dz_dt(p, v, z):
        return where(z < 1e-12, 1e9, -1e9) + 0.0 * v

class Edge(BristleLaw):
    """Comes to the end of its equations in a finite time and goes along it: many steps look beyond."""

    @staticmethod
    def dz_dt(p, v, z):
        return v * sqrt(1 - z / 1e-5)
'''


def compiled_run(scenario):
    solution = simulate(scenario)
    assert solution.stats["solver"] == "rodas5p"
    return solution


def wasm_run(scenario):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("STRIBECK_BACKEND", "wasm")
        return simulate(scenario)


both = pytest.mark.parametrize("run", [pytest.param(compiled_run, marks=needs_compiler), wasm_run])


def failed(run, data, folder=None):
    """The reason of a failed run, after a look at its rows."""
    solution = run(Scenario(data, folder=folder))
    assert solution.status == "failed"
    assert len(solution.t) == len(solution["F"]) < solution.scenario.rows
    assert all(np.isfinite(solution[name]).all() for name in ("t", "y", "v", "z"))
    assert solution.summary()["reason"] == solution.reason
    assert "\n" not in solution.reason
    return solution


def user_law(name, tmp_path, **solve):
    (tmp_path / "laws.py").write_text(LAWS)
    law = {"name": f"laws.py:{name}", "parameters": "canudas1995"}
    return rig(law, "force", {"kind": "ramp", "rate": 1.0}, 2.0, **solve)


@both
def test_equations_that_end(run, tmp_path):
    solution = failed(run, user_law("Ends", tmp_path), tmp_path)
    assert "no longer finite" in solution.reason
    assert 0.4 < solution.t[-1] < 0.8
    assert solution["z"][-1] == pytest.approx(0.5e-5, rel=0.05)


@both
def test_equations_that_escape(run, tmp_path):
    solution = failed(run, user_law("Escapes", tmp_path), tmp_path)
    assert "no longer finite" in solution.reason
    np.testing.assert_array_equal(solution.t, np.arange(len(solution.t)) * 0.01)


@both
def test_steps_that_run_out(run, tmp_path):
    solution = failed(run, user_law("Chatters", tmp_path, max_steps=2000), tmp_path)
    assert "solve.max_steps = 2000" in solution.reason or "Radau failed" in solution.reason
    data = rig("lugre", "force", {"kind": "sine", "amplitude": 2.0, "frequency": 1.0}, 20.0, max_steps=300)
    solution = failed(run, data)
    assert "gave up at t = " in solution.reason
    assert "solve.max_steps = 300" in solution.reason
    assert 0 < solution.t[-1] < 20
    assert solution.stats["accepted"] <= 300


@needs_compiler
@pytest.mark.parametrize(
    ("name", "reason"), [("Edge", "no longer finite"), ("Flutters", "the end is 1e12 of them away")]
)
def test_what_no_steps_can_follow_ends_soon(name, reason, tmp_path, monkeypatch):
    """They took solve.max_steps = 1e9 attempts, minutes of processor time; a lane of an ensemble too. By C: another order
    of operations, and less optimization, goes along the edge and does not look beyond it."""
    monkeypatch.setenv("STRIBECK_BACKEND", "c")
    monkeypatch.delenv("STRIBECK_CC", raising=False)
    data = user_law(name, tmp_path)
    solution = failed(compiled_run, data, tmp_path)
    assert reason in solution.reason
    assert solution.stats["accepted"] + solution.stats["rejected"] <= 2_000_001
    lanes = simulate(Scenario(data, folder=tmp_path), {"plant.mass": [1.0, 1.1]})
    assert all(reason in text for text in lanes.reason), lanes.reason
    assert (lanes.accepted + lanes.rejected <= 2_000_001).all()


def test_a_step_that_is_too_small():
    """After 10^12 s two times lie 10^-4 s apart: too far for a body that jumps off."""
    solution = failed(compiled_run, rig("lugre", "force", {"kind": "step", "value": 5.0, "time": 1e12}, 2e12))
    assert solution.reason.startswith("at t = 1e+12 s the step needed")
    assert solution.t[-1] == 1e12
    assert solution["y"][-1] == 0


def test_rows_of_a_failed_run_are_those_of_a_shorter_one():
    data = rig("lugre", "force", {"kind": "sine", "amplitude": 2.0, "frequency": 1.0}, 20.0, rows=2000)
    whole, cut = simulate(Scenario(data)), simulate(Scenario({**data, "solve": {"t_end": 20.0, "max_steps": 1500}}))
    assert 0 < len(cut.t) < len(whole.t)
    for name in ("t", "y", "v", "z", "F"):
        np.testing.assert_array_equal(cut[name], whole[name][: len(cut.t)])
    for kind, times in cut.events.items():
        np.testing.assert_array_equal(times, whole.events[kind][: len(times)])


@pytest.mark.parametrize("path", ["v_s", "sigma_0", "sigma_2", "F_s"])
@pytest.mark.parametrize("value", [1e-320, 1e-300, 1e300])
def test_constants_at_the_ends_of_floats_end_without_a_warning(path, value):
    """Warnings are errors here: what comes is a result, or one line of what is wrong."""
    data = rig("lugre", spring("canudas1995"), {"kind": "ramp", "rate": 1e-3}, 0.01, rows=5)
    scenario = Scenario({**data, "law": {"name": "lugre", "parameters": machine("canudas1995")}})
    place = f"law.parameters.{path}"
    with suppress(InputError):
        assert simulate(scenario.with_changes({place: value})).status in ("done", "failed")
    assert len(simulate(scenario, vary={place: [value]})) == 1

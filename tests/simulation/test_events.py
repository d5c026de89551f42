"""Slip and stick: where |v| rises, and falls, through v_s."""

import ctypes
import math

import numpy as np
import pytest

from stribeck import Scenario
from tests.codegen.harness import compiled
from tests.simulation.rig import law_table, needs_compiler, rig, solved

V_S = 1e-3
RIGS = {
    "spring": rig("lugre", {"kind": "spring", "stiffness": 2.0}, {"kind": "ramp", "rate": 0.1}, 40.0),
    "pid": rig(
        "lugre_sobczyk", {"kind": "pid", "K_p": 3.0, "K_i": 4.0, "K_d": 6.0},
        {"kind": "step", "value": 1.0, "time": 10.0}, 100.0,
    ),
    "force": rig("elastoplastic", "force", {"kind": "sine", "amplitude": 1.8, "frequency": 0.5}, 12.0),
    "static": rig("coulomb_viscous", "force", {"kind": "sine", "amplitude": 3.0, "frequency": 0.5}, 6.0),
}  # fmt: skip
RIGS["static"]["law"]["parameters"] = {"F_c": 1.0, "sigma_2": 0.4, "v_s": V_S}


def in_order(solution):
    """The events as (time, True for slip), in order of time."""
    events = solution.events
    return sorted([(t, True) for t in events["slip"]] + [(t, False) for t in events["stick"]])


@pytest.mark.parametrize("name", RIGS)
def test_events_are_those_of_a_tight_run(name):
    result = in_order(solved(RIGS[name]))
    tight = {**RIGS[name], "solve": {**RIGS[name]["solve"], "rtol": 1e-12}}
    expected = in_order(solved(tight))
    assert len(result) > 4
    assert [rises for _, rises in result] == [rises for _, rises in expected]
    np.testing.assert_allclose([t for t, _ in result], [t for t, _ in expected], rtol=0, atol=1e-6)


def test_an_event_is_a_root_of_the_dense_output():
    """A run whose rows fall on an event finds v_s there: rows do not change the steps."""
    slip = float(solved(RIGS["spring"]).events["slip"][0])
    again = solved({**RIGS["spring"], "output": {"step": slip}})
    assert again["v"][1] == pytest.approx(V_S, rel=1e-9)


def test_no_threshold_no_events():
    law = law_table("coulomb_viscous", k_v=1e6)
    law["parameters"] = {"F_c": 1.0, "sigma_2": 0.4}
    solution = solved(rig(law, "force", {"kind": "ramp", "rate": 3.0}, 1.0))
    assert solution["v"][-1] > V_S
    assert in_order(solution) == []


def test_more_events_than_the_buffer_holds(monkeypatch):
    whole = in_order(solved(RIGS["force"]))
    monkeypatch.setattr("stribeck.simulation.native.EVENT_ROOM", 1)  # the least that one step may need is taken
    assert in_order(solved(RIGS["force"])) == whole
    assert len(whole) > 32


def test_a_prescribed_velocity_passes_where_its_signal_does():
    points = {"kind": "points", "t": [0, 1, 2, 2, 3, 4], "value": [0, 2e-3, 0, -3e-3, -1e-3, -2e-3]}
    solution = solved(rig("lugre", "velocity", points, 4.0))
    np.testing.assert_allclose(solution.events["slip"], [0.5, 2.0], atol=1e-12)
    np.testing.assert_allclose(solution.events["stick"], [1.5], atol=1e-12)
    sine = {"kind": "sine", "amplitude": 2e-3, "frequency": 1.0}
    solution = solved(rig("lugre", "velocity", sine, 1.0))
    np.testing.assert_allclose(solution.events["slip"], [1 / 12, 7 / 12], atol=1e-12)
    np.testing.assert_allclose(solution.events["stick"], [5 / 12, 11 / 12], atol=1e-12)


def bernstein(values):
    """v0, v1 and the dense coefficients of the quartic through values at s = 0, 1/4, 1/2, 3/4, 1."""
    s = np.array([0.25, 0.5, 0.75])
    v0, v1 = values[0], values[-1]
    rest = (np.array(values[1:-1]) - (1 - s) * v0 - s * v1) / (s * (1 - s))
    return v0, v1, np.linalg.solve(np.stack([np.ones(3), s, s * s], axis=1), rest)


def events_of(library, v0, v1, d, threshold):
    times, rises, number = np.zeros(16), np.zeros(16, np.int8), ctypes.c_double
    arrays = (each.ctypes for each in (np.ascontiguousarray(d), times, rises))
    count = library.test_events(number(threshold), number(v0), number(v1), *arrays)
    return [(float(t), not what & 1) for t, what in zip(times[:count], rises[:count], strict=True)]


@needs_compiler
def test_every_crossing_within_one_step(tmp_path):
    """Quartics of all shapes through both levels, against NumPy's roots."""
    library = compiled(Scenario(RIGS["spring"]).system, tmp_path)
    random, most = np.random.default_rng(1), 0
    for _ in range(3000):
        values = random.uniform(-1, 1, 5) * random.choice([0.5, 2.0, 4.0])
        v0, v1, d = bernstein(values)
        result = events_of(library, v0, v1, d, 0.3)
        quartic = np.polyfit(np.linspace(0, 1, 5), values, 4)
        expected = []
        for level in (0.3, -0.3):
            roots = np.roots(quartic - np.array([0, 0, 0, 0, level]))
            real = roots.real[(np.abs(roots.imag) < 1e-9) & (roots.real > 0) & (roots.real < 1)]
            expected += [(s, np.polyval(np.polyder(quartic), s) * level > 0) for s in real]
        expected.sort()
        assert [up for _, up in result] == [up for _, up in expected]
        np.testing.assert_allclose([s for s, _ in result], [s for s, _ in expected], rtol=0, atol=1e-7)
        most = max(most, len(result))
    assert most >= 6
    coefficients, s = np.zeros(5), np.linspace(0, 1, 5)
    library.test_values(values.ctypes, coefficients.ctypes)
    basis = [math.comb(4, i) * s**i * (1 - s) ** (4 - i) for i in range(5)]
    np.testing.assert_allclose(coefficients @ basis, values, rtol=1e-13, atol=1e-13)


@needs_compiler
def test_a_speed_that_rests_at_the_threshold_does_not_search_for_ever(tmp_path):
    """Rounding around v_s has many signs and no crossings worth finding."""
    library = compiled(Scenario(RIGS["spring"]).system, tmp_path)
    random = np.random.default_rng(2)
    for _ in range(200):
        v0, v1, *d = 1e-19 * random.uniform(-1, 1, 5)
        assert len(events_of(library, 1e-3 + v0, 1e-3 + v1, np.array(d), 1e-3)) <= 16
    for _ in range(200):
        v0, v1, *d = 1e90 * random.uniform(-1, 1, 5)
        assert len(events_of(library, v0, v1, np.array(d), 1e-3)) <= 16
    assert events_of(library, 1e300, -1e300, np.array([1e308, -1e308, 1e308]), 1e-3) == []

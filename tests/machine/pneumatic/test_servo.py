"""Servos in real conditions, adapted parameters, paths, and what is refused."""

import itertools

import numpy as np
import pytest

from stribeck import Scenario, simulate
from stribeck.waveforms import PointToPointSignal, SplineSignal
from tests.machine.pneumatic.servos import data, last, servo, solved

# -- paths -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("cls", [PointToPointSignal, SplineSignal])
def test_curves_pass_their_points_with_three_derivatives(cls):
    t, value = np.array([0.5, 1.0, 2.5, 3.0]), np.array([0.1, 0.4, 0.2, 0.3])
    curve = cls(t, value)
    assert curve.at(t) == pytest.approx(value, abs=1e-12)
    assert curve.at([0.0, 0.5, 3.0, 9.0]) == pytest.approx([0.1, 0.1, 0.3, 0.3], abs=1e-12)
    pieces = [(start, np.polynomial.Polynomial([values[f"c{n}"] for n in range(8)])) for start, values in curve.pieces]
    for (begin, before), (end, after) in itertools.pairwise(pieces):
        for order in range(4):
            left = before.deriv(order)(end - begin) if order else before(end - begin)
            right = after.deriv(order)(0.0) if order else after(0.0)
            assert left == pytest.approx(right, abs=1e-9), (end, order)
    if cls is PointToPointSignal:
        assert curve.at(0.75) == pytest.approx(0.25)


def test_a_spline_through_two_points_is_the_move():
    t, value = np.array([0.0, 2.0]), np.array([0.1, 0.4])
    x = np.linspace(-1, 3, 50)
    assert SplineSignal(t, value).at(x) == pytest.approx(PointToPointSignal(t, value).at(x), abs=1e-12)


def test_a_curve_moves_a_spring_too():
    """Any drive takes it; the velocity drive finds its slips and sticks."""
    law = {"name": "lugre", "parameters": "canudas1995"}
    signal = {"kind": "point_to_point", "t": [0.0, 1.0, 2.0], "value": [0.0, 0.01, 0.0]}
    base = {"schema": 1, "law": law, "solve": {"t_end": 3.0}, "output": {"step": 0.001}}
    solution = simulate(Scenario({**base, "drive": {"kind": "velocity", "signal": signal}}))
    assert solution["y"][-1] == pytest.approx(0.01, rel=1e-6)  # half of 0.01 in each move
    (slip,), (stick,) = solution.events["slip"], solution.events["stick"]
    assert solution.scenario.signal.at([slip, stick]) == pytest.approx([1e-3, 1e-3])


# -- real conditions -------------------------------------------------------------------------------------------------


def test_wrong_knowledge_costs():
    exact = last(solved())
    for changes in ({"drive__supply_droop": 2e7}, {"drive__model": {"mass": 3.5}},
                    {"drive__observer__parameters": {"F_c": 40.0, "F_s": 46.0}}):  # fmt: skip
        assert last(solved(**changes)) > 1e4 * exact


# -- adaptation ------------------------------------------------------------------------------------------------------


def half(factor, **more):
    known = data()["law"]["parameters"]
    wrong = {n: factor * x for n, x in known.items() if n != "v_s"}
    return {"drive__observer__parameters": wrong, "drive__adaptive": True, **more}


def test_V_never_rises_where_the_argument_is_exact():
    """All parameters wrong by one factor leave g right: with a_g held, V of the adaptive loop decreases."""
    gains = {"gamma_0": 0.1, "gamma_1": 0.1, "gamma_2": 0.1, "gamma_g": 0.0}
    start = {"y": 0.5, "v": 0.2513274122871834, "p_1": 4e5, "p_2": 4e5}
    solution = solved(**half(0.5, drive__adaptation=gains, plant__initial=start, solve__t_end=60.0))
    V, free = solution["V"], abs(solution["u"]) < 10 * (1 - 1e-9)
    assert (np.diff(V)[free[:-1] & free[1:]] < 1e-10 * V[0]).all()
    assert V[-1] < 0.7 * V[0]


@pytest.mark.thorough
@pytest.mark.parametrize(("factor", "middle", "late"), [(0.5, 1e-6, 1e-8), (1.5, 5e-6, 3e-7)])
def test_adaptation_recovers(factor, middle, late):
    """On the sine every parameter is found, and the error goes on falling exponentially."""
    wrong = half(factor, solve__t_end=2000.0, output__step=0.1)
    fixed = last(solved(**{**wrong, "drive__adaptive": False, "solve__t_end": 20.0}))
    assert 0.016 < fixed < 0.021
    solution = solved(**wrong)
    e = abs(solution["e"])
    assert e[9950:10000].max() < middle
    assert e[-50:].max() < late
    true = solution.scenario.law.values
    for name in ("sigma_0", "sigma_1", "sigma_2", "F_c"):
        assert solution.final[f"{name}_hat"] == pytest.approx(true[name], rel=1e-3), name
        scale = solution[f"{name}_hat"] / (factor * true[name])
        assert scale.min() > 0.2
        assert scale.max() < 5.0


# -- what is refused, and what fails ----------------------------------------------------------------------------------


@pytest.mark.thorough
@pytest.mark.share(2)
@pytest.mark.parametrize(("start", "cover"), [({"y": 0.99, "v": 3.5}, "y = 1 m"), ({"y": 0.01, "v": -3.5}, "y = 0 m")])
def test_the_end_of_the_stroke(start, cover):
    initial = {"p_1": 4e5, "p_2": 4e5, **start}
    solution = simulate(servo(plant__initial=initial, output__step=1e-4))
    assert solution.status == "failed"
    assert "reached the end of its stroke" in solution.reason
    assert cover in solution.reason
    assert 0 < len(solution.t) < 200


def test_a_valve_that_is_always_at_its_limit():
    with pytest.warns(UserWarning, match="limit of 0.01 V from t = "):
        solution = simulate(servo(drive__u_max=0.01))
    assert solution.status == "done"


def test_the_report_finds_stick_slip_only_where_the_seal_sticks():
    from examples.paper import servo as chapter

    without, compensated, example = (chapter._stick_slips(s) for s in chapter._slow().values())
    assert without >= 10
    assert compensated == example == 0

"""Verdicts of loops that move for long before they rest, or rest for long before they break away; a simulator on equations
written apart (benchmarks/design_attack.py) comes to the same."""

import numpy as np
import pytest

from stribeck import InputError, Scenario
from stribeck.loops.boundary import Turned, line
from stribeck.loops.judge import _LaneRecord, judge
from stribeck.loops.loop import loop_of, time_constant
from stribeck.loops.starts import from_starts
from tests.loops.axis import axis
from tests.machine.machines import law, machine

SOFT = {"sigma_0": 1e5, "sigma_1": 316.22776601683796, "sigma_2": 0.4, "F_c": 1.0, "F_s": 1.5, "v_s": 1e-3}


def loop(mass, guide, t, value, t_end, **controller):
    """A mass on a guide under a controller that moves it once."""
    signal = {"kind": "point_to_point", "t": t, "value": [0.0, value]}
    data = machine(
        {"body": {"mass": mass}}, t_end, energy=False, contacts={"guide": {"from": "body", "law": guide}},
        controllers={"axis": {"on": "body", "signal": signal, **controller}},
    )  # fmt: skip
    return loop_of(Scenario(data))


def cascade(**more):
    guide = law(k_v=1e5, sigma_0=2e5, sigma_1=500.0, sigma_2=20.0, F_c=4.0, F_s=6.0, v_s=5e-3)
    return loop(2.0, guide, [0.2, 0.8], 0.05, 4.0, kind="cascade", K_p=20.0, **more)


def test_a_motion_that_grows_on_its_way_to_rest_is_quiet():
    sampling = {"period": 1e-3, "delay": 1e-3, "resolution": 1e-6}
    assert judge(cascade(K_v=100.0, T_i=0.05, sampling=sampling))[0].verdict == "quiet"


def test_the_body_that_moves_is_named():
    """Beside an axis at rest, negative damping shakes a body on a spring."""
    data = axis()
    data["bodies"]["b"] = {"mass": 1.0}
    data["links"] = {"spring": {"from": "b", "to": "ground", "stiffness": 100.0, "damping": 3.0}}
    shaken = {**data["controllers"]["hold"], "on": "b", "K_p": 10.0, "K_d": -9.0, "limit": 1.0}
    data["controllers"]["shaken"] = shaken
    (result,) = judge(loop_of(Scenario(data)))
    assert (result.verdict, result.body) == ("unstable", "b")


@pytest.mark.thorough
def test_what_saturates_on_its_way_to_rest_is_quiet():
    sampling = {"period": 1e-3, "delay": 5e-4, "resolution": 2e-5}
    fitted = from_starts(cascade(K_v=60.0, T_i=0.1, limit=40.0, sampling=sampling), "axis")
    rests = {abs(s.off) for s in fitted if s.judgment.quiet and s.off}
    assert {0.00025, 0.0025} <= {float(f"{x:.3g}") for x in rests}


def test_a_slow_integral_breaks_away_in_the_end():
    """It sticks for 185 s of each cycle, and the first verdict took more than 400 s."""
    guide = {"name": "elastoplastic", "z_ba": 8e-6, "parameters": SOFT}
    (result,) = judge(loop(1.0, guide, [0.5, 1.5], 0.02, 40.0, kind="pid", K_p=40.0, K_i=2.0, K_d=8.0))
    assert result.verdict == "hunting"
    assert result.period == pytest.approx(373, rel=0.01)


def test_a_force_that_grows_breaks_away_unless_it_settles_below():
    held, t = loop_of(Scenario(axis(contact=law("lugre", F_s=1.4)))), np.linspace(0.0, 8.0, 801)
    settles = 1 - np.exp(-t / 6)
    at_its_rate = (1.4 - 1.6 * settles[700]) / (1.6 / 6 * np.exp(-1))  # mean and rate as seen
    for force, breaks in ((-0.1 * t, (1.4 - 0.7) / 0.1), (1.2 * settles, np.inf), (1.6 * settles, at_its_rate)):
        lanes = type("Lanes", (dict,), {"t": t})({"a.y": [0 * t], "guide.F": [force]})
        assert (_LaneRecord(held, lanes, 0, 1.0, {})._break_away_time() or np.inf) == pytest.approx(breaks, rel=0.02)


@pytest.mark.parametrize(
    ("gains", "verdict"),
    [({"K_p": -1e308, "sampling": {"period": 1e-3}}, "failed"), ({"K_p": 3.0, "K_i": 1e308}, "unstable")],
)
def test_a_loop_of_which_no_row_can_be_simulated_is_not_judged_by_rows(gains, verdict):
    """One was called quiet by the rows before its equations were no longer finite, the other ended in a traceback."""
    guide = law("lugre", **SOFT)
    (result,) = judge(loop(1.0, guide, [0.0, 0.8], 0.05, 1.0, kind="pid", K_d=2.0, **gains))
    assert result.verdict == verdict
    assert result.note


def test_gains_whose_product_is_no_number_are_refused():
    with pytest.raises(
        InputError, match="the machine's numbers are so large that its rates have no finite derivatives"
    ):
        time_constant(cascade(K_v=1e308).scenario)


@pytest.mark.thorough
def test_a_narrow_quiet_stretch_is_found():
    """K_d from 100 to 126: runs at 102, 105, 110 and 120 rest, those at 98 and 130 hunt."""
    built = loop(1.0, law("lugre", **SOFT), [0.5, 1.5], 0.05, 20.0, kind="pid", K_p=300.0, K_i=400.0, K_d=20.0)
    result = line(built, Turned("controllers.axis.K_d", 60.0, 180.0))
    assert [b.value for b in result.boundaries] == pytest.approx([100.0, 125.9, 156.8], rel=5e-3)
    assert result.boundaries[0].above == "quiet"
    assert result.resolution <= 0.035


@pytest.mark.thorough
def test_an_irregular_cycle_whose_last_rows_hold_one_slip_hunts():
    """A coarse encoder: slips of 66 mm every 20 to 80 s, of which the end of the longest run holds one. It was called creep."""
    guide = law(
        "lugre", sigma_0=12227.736864284316, sigma_1=148.09662006790956, sigma_2=2.6854262060787746, F_c=7.313158110393403,
        F_s=11.675640021747082, v_s=0.0054506096791777274,
    )  # fmt: skip
    sampling = {"period": 0.004952917062426853, "delay": 0.0024764585312134265, "resolution": 0.0013926044961556463}
    own = {"K_p": 20.954666775385373, "K_i": 19.421709278300884, "K_d": 12.15969733558843, "limit": 583.782001087354}
    controller = {"on": "body", "kind": "pid", "signal": {"kind": "step", "time": 0.0, "value": 6.963022480778231}}
    data = machine(
        {"body": {"mass": 1.2851176226912764}}, 1.0, energy=False, contacts={"guide": {"from": "body", "law": guide}},
        controllers={"axis": {**controller, **own, "sampling": sampling}},
    )  # fmt: skip
    (result,) = judge(loop_of(Scenario(data)))
    assert result.verdict == "hunting"
    assert 0.03 < result.amplitude < 0.07
    assert "by chance" in result.note

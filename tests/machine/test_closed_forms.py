"""What can be said in closed form: play, a level that follows a load, ties, energy of jumps, limits, sampling."""

import numpy as np
import pytest

from tests.machine.machines import law, machine, push, solved
from tests.reference.random_machines import random_machine

pytestmark = [pytest.mark.usefixtures("each_system_is_run_once")]
A = {"a": {"mass": 0.5}}


def test_free_flight_through_play_and_a_bounce():
    """Within the play nothing acts; beyond it the body is an oscillator: half a period, then back with the same speed."""
    mass, stiffness, half, v = 0.5, 200.0, 0.01, 0.4
    link = {"from": "a", "to": "ground", "stiffness": stiffness, "gap": 2 * half}
    s = solved(machine({"a": {"mass": mass, "initial": {"v": v}}}, links={"k": link}, t_end=0.4))
    meets, omega = half / v, (stiffness / mass) ** 0.5
    leaves = meets + np.pi / omega
    t = s.t
    expected = np.where(t < meets, v * t, half + v / omega * np.sin(omega * (t - meets)))
    expected = np.where(t > leaves, half - v * (t - leaves), expected)
    inside = t < leaves + 2 * half / v
    np.testing.assert_allclose(s["a.y"][inside], expected[inside], rtol=0, atol=1e-9)
    events = s.events["k"]
    assert events["flank_up"][0] == pytest.approx(meets, abs=1e-9)
    assert events["flank_up_left"][0] == pytest.approx(leaves, abs=1e-9)
    assert events["flank_down"][0] == pytest.approx(leaves + 2 * half / v, abs=1e-8)
    np.testing.assert_allclose(s["E_stored"], mass * v * v / 2, rtol=1e-8)


def test_the_damper_of_play_never_pulls():
    link = {"from": "a", "to": "ground", "stiffness": 200.0, "damping": 50.0, "gap": 0.02}
    s = solved(machine(A, links={"k": link}, loads={"p": push(2.0, 3.0)}))
    assert s.peaks["k.f"] > 1
    assert np.all(s["k.f"] * s["a.y"] >= 0)
    assert np.all(s["k.f"][np.abs(s["a.y"]) <= 0.01] == 0)


def test_sliding_at_a_level_that_follows_a_load():
    """At a held speed far above v_s the friction is F_c + gain |load| + sigma_2 v, whatever the load's sign."""
    bodies = {"a": {"velocity": {"signal": {"kind": "points", "t": [0], "value": [1.0]}}}}
    loads = {"n": {"on": "a", "kind": "signal", "signal": {"kind": "points", "t": [0, 1], "value": [-5.0, 5.0]}}}
    contact = {"from": "a", "law": law("lugre", sigma_1=0.0), "loads": [{"force": {"n": 2.0}, "F_c": 0.3, "F_s": 0.3}]}
    s = solved(machine(bodies, loads=loads, contacts={"c": contact}, t_end=1.0))
    late = s.t > 0.05
    expected = 1.0 + 0.3 * 2 * np.abs(s["n.f"]) + 1.5
    np.testing.assert_allclose(s["c.F"][late], expected[late], rtol=2e-3)  # the bristles lag behind a level that falls


def test_tied_bodies_are_one_body():
    """Mass m + ratio^2 m_2, force ratio f_2: the same motion as one body under one force."""
    tied = {**A, "b": {"inertia": 0.03, "tied_to": "a", "ratio": 5.0}}
    two = solved(machine(tied, loads={"p": push(1.0, on="b")}, contacts={"c": {"from": "a", "law": law()}}))
    one = solved(
        machine({"a": {"mass": 0.5 + 25 * 0.03}}, loads={"p": push(5.0)}, contacts={"c": {"from": "a", "law": law()}})
    )
    for name in ("a.y", "a.v", "c.F", "E_in", "E_stored"):
        np.testing.assert_allclose(two[name], one[name], rtol=0, atol=1e-8 * one.peaks[name])
    np.testing.assert_allclose(two["b.y"], 5 * two["a.y"], rtol=1e-15)


def test_a_far_end_that_jumps_puts_in_what_the_spring_stores():
    step = {"kind": "step", "time": 0.1, "value": 0.05}
    s = solved(machine(A, links={"k": {"from": {"signal": step}, "to": "a", "stiffness": 80.0}}, t_end=0.2, rows=20))
    np.testing.assert_allclose(s["E_in"][s.t >= 0.1], 80 * 0.05**2 / 2, rtol=1e-12)
    assert s["E_in"][s.t < 0.1].max() == 0
    np.testing.assert_allclose(s["E_stored"][10:], 80 * 0.05**2 / 2, rtol=1e-9)


def test_an_integral_slides_along_its_limit():
    """The unlimited output stays at the limit as long as the error drives it further, and leaves it at once afterwards."""
    pid = {"kind": "pid", "on": "a", "K_p": 0.0, "K_i": 10.0, "limit": 1.0,
           "signal": {"kind": "points", "t": [0, 1, 1, 2], "value": [1.0, 1.0, -1.0, -1.0]}}  # fmt: skip
    s = solved(machine({"a": {"mass": 1e9}}, controllers={"u": pid}, t_end=2.0, rows=200))
    expected = np.where(s.t < 0.1, 10 * s.t, np.where(s.t < 1, 1.0, np.maximum(1 - 10 * (s.t - 1), -1.0)))
    np.testing.assert_allclose(s["u.u"], expected, rtol=0, atol=1e-6)
    assert s.events["u"]["limit_reached"] == pytest.approx([0.1, 1.2], abs=1e-6)
    assert s.events["u"]["limit_left"] == pytest.approx([1.0], abs=1e-6)


@pytest.mark.parametrize("delay", [0.0, 0.004, 0.025])
def test_outputs_act_after_their_delay(delay):
    """A body that hardly moves: u is -K_p (y - r) of the sample before, held; the reading is a whole count."""
    pid = {"kind": "pid", "on": "a", "K_p": 3.0, "signal": {"kind": "ramp", "rate": 2.0},
           "sampling": {"period": 0.01, "delay": delay, "resolution": 0.07}}  # fmt: skip
    s = solved(machine({"a": {"mass": 1e12, "initial": {"y": 0.3}}}, controllers={"u": pid}, t_end=0.1, rows=200))
    k = np.floor((s.t - delay) / 0.01 * (1 + 1e-12) + 1e-9)
    reading = 0.07 * round(0.3 / 0.07)
    expected = np.where(k < 0, 0.0, -3 * (reading - 2.0 * 0.01 * k))
    np.testing.assert_allclose(s["u.u"], expected, rtol=0, atol=1e-12)


def test_a_belt_that_jumps_makes_an_event():
    belt = {"kind": "step", "time": 0.3, "value": 0.5}
    s = solved(machine(
        {"belt": {"velocity": {"signal": belt}}, **A}, contacts={"c": {"from": "a", "to": "belt", "law": law()}}, t_end=1.0
    ))  # fmt: skip
    assert s.events["c"]["slip"] == pytest.approx([0.3])
    assert len(s.events["c"]["stick"]) == 1


@pytest.mark.share(3)
@pytest.mark.parametrize("seed", [0, *range(2, 9)])  # nothing drives machine 1
def test_the_energy_of_random_machines_balances(seed):
    assert solved(random_machine(seed)).peaks["E_in"] > 0


def test_compensation_at_a_reference_that_rests_is_a_number():
    """LuGre's steady deflection is 0/0 at rest: a move that begins and ends at rest must not meet it."""
    controller = {
        "kind": "pid", "on": "a", "signal": {"kind": "point_to_point", "t": [0.1, 0.6], "value": [0.0, 0.05]},
        "K_p": 200.0, "K_d": 20.0, "compensation": {"contact": "guide", "speed": "reference"},
    }  # fmt: skip
    data = machine(
        {"a": {"mass": 1.0}}, contacts={"guide": {"from": "a", "law": law("lugre")}}, controllers={"c": controller}
    )
    solution = solved(data)
    assert np.isfinite(solution["c.u"]).all()
    assert solution["a.y"][-1] == pytest.approx(0.05, rel=0.05)


def test_names_that_begin_with_digits():
    """The same machine under other names moves the same; the names stand in the generated code."""
    move = {"kind": "point_to_point", "t": [0.0, 0.2], "value": [0.0, 0.05]}

    def named(body, contact, link, controller, motor, load):
        return solved(machine(
            {body: {"mass": 0.5}, f"{body}b": {"mass": 0.2}}, t_end=0.2,
            links={link: {"from": body, "to": f"{body}b", "stiffness": 90.0, "gap": 1e-3}},
            contacts={contact: {"from": body, "law": law(), "loads": [{"force": link, "F_c": 0.1}],
                                "factors": {"level": {"signal": {"kind": "points", "t": [0, 1], "value": [1, 2]}}}}},
            loads={load: push(on=body)}, motors={motor: {"on": body, "K": 0.5, "R": 1.0, "L": 0.01}},
            controllers={
                controller: {"kind": "cascade", "on": motor, "K_p": 8.0, "K_v": 3.0, "T_i": 0.2, "signal": move,
                             "compensation": {"contact": contact, "speed": "measured"},
                             "sampling": {"period": 0.01, "bandwidth": 100.0}},
                f"{controller}c": {"kind": "pid", "on": f"{body}b", "K_p": 8.0, "K_i": 1.0, "signal": move, "limit": 1.0},
            },
        ))  # fmt: skip

    plain, digits = named("a", "c", "k", "u", "m", "p"), named("1", "2", "3", "4", "5", "6")
    np.testing.assert_allclose(digits["1.y"], plain["a.y"], rtol=1e-12)
    np.testing.assert_allclose(digits["2.F"], plain["c.F"], rtol=1e-12)

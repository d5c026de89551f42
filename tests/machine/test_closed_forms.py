"""What can be said in closed form: play, a level that follows a load, ties, energy of jumps, limits, sampling."""

import numpy as np
import pytest

from tests.machine.machines import law, machine, push, solved

pytestmark = [pytest.mark.usefixtures("each_system_is_run_once")]
A = {"a": {"mass": 0.5}}


def test_a_far_end_that_jumps_puts_in_what_the_spring_stores():
    step = {"kind": "step", "time": 0.1, "value": 0.05}
    s = solved(machine(A, links={"k": {"from": {"signal": step}, "to": "a", "stiffness": 80.0}}, t_end=0.2, rows=20))
    np.testing.assert_allclose(s["E_in"][s.t >= 0.1], 80 * 0.05**2 / 2, rtol=1e-12)
    assert s["E_in"][s.t < 0.1].max() == 0
    np.testing.assert_allclose(s["E_stored"][10:], 80 * 0.05**2 / 2, rtol=1e-9)


def test_a_belt_that_jumps_makes_an_event():
    belt = {"kind": "step", "time": 0.3, "value": 0.5}
    s = solved(machine(
        {"belt": {"velocity": {"signal": belt}}, **A}, contacts={"c": {"from": "a", "to": "belt", "law": law()}}, t_end=1.0
    ))  # fmt: skip
    assert s.events["c"]["slip"] == pytest.approx([0.3])
    assert len(s.events["c"]["stick"]) == 1


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

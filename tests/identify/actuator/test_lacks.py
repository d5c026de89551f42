"""What a machine may lack: slopes of each form, ranges that hold, and forms that are named. Records by SciPy."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import odeint

from stribeck import Scenario
from stribeck.identify.actuator import Logs, fit_machine
from stribeck.identify.actuator.coordinates import MachineCoordinate
from stribeck.identify.actuator.guides import Guides
from stribeck.identify.actuator.lacks import RunMotion, _terms, missing_forms
from stribeck.identify.actuator.recordings import Channel, Recording, Sought
from stribeck.identify.actuator.starts import problem_of

STEP, NOISE, STEEP = 0.005, 5e-4, 50.0
LAW = "contacts.joint.law.parameters."
TRUTH = {"bodies.arm.inertia": 0.15, f"{LAW}F_c": 0.1, f"{LAW}sigma_2": 0.05}
T = STEP * np.arange(301)
STILL = {"kind": "points", "t": [0.0, 1.0], "value": [0.0, 0.0]}


def pushed(size, fast=1.0):
    """A torque that turns the arm to and fro."""
    return size * (np.sin(7 * fast * T) + 0.8 * np.sin(3.1 * fast * T + 1) - 0.8 * np.sin(1))


def sign(v):
    return 2 / np.pi * np.arctan(STEEP * v)


def turned(u, more=lambda y, v, push, z: 0.0):
    """Where the arm is under the torque u, with a further friction torque; z: the bent share of bristles of 10 mrad."""
    inertia, level, viscous = TRUTH.values()

    def rates(x, s):
        y, v, z = x
        push = np.interp(s, T, u)
        return [v, (push - level * sign(v) - viscous * v - more(y, v, push, z)) / inertia, (v - abs(v) * z) / 0.01]

    return odeint(rates, [0.0, 0.0, 0.0], T, rtol=1e-9, atol=1e-11, hmax=STEP)[:, 0]


def arm(**more):
    law = {"name": "coulomb_viscous", "k_v": STEEP, "parameters": {"F_c": 0.12, "sigma_2": 0.06}}
    return {
        "schema": 2, "name": "arm", "bodies": {"arm": {"inertia": 0.2, "initial": {"y": 0.0, "v": 0.0}}},
        "contacts": {"joint": {"from": "arm", "law": law}},
        "loads": {"push": {"on": "arm", "kind": "signal", "signal": STILL}},
        "solve": {"t_end": float(T[-1])}, "output": {"step": STEP}, **more,
    }  # fmt: skip


def recording(u, y, seed=0, **more):
    y = y + NOISE * np.random.default_rng(seed).standard_normal(len(T))
    channels = {"arm.y": Channel("y", T, y)}, {"loads.push.signal": Channel("u", T, u)}
    return Recording(f"run{seed}", T, *channels, {}, **more)


def fitted(more=lambda y, v, push, z: 0.0, change=lambda y: y):
    runs = tuple(recording(pushed(x), change(turned(pushed(x), more)), i) for i, x in enumerate((0.6, 1.2)))
    return fit_machine(
        arm(), Logs(runs, tuple(Sought(n, x / 5, 5 * x) for n, x in TRUTH.items())), starts=1, baselines=False
    )


def outside(found, how="range"):
    return [n for n, e in found.estimates.items() if not getattr(e, how)[0] < TRUTH[n] < getattr(e, how)[1]]


def named(found):
    return [n for n in found.notes if n.startswith("These effects would lower ")]


LACKS = {
    "differs by direction": lambda y, v, push, z: 4e-4 * abs(sign(v)),
    "bend": lambda y, v, push, z: 1.5e-3 * np.exp(-((v / 0.4) ** 2)) * sign(v),
    "drag": lambda y, v, push, z: 1e-4 * v * abs(v),
    "grows with push.f": lambda y, v, push, z: 1.8e-3 * abs(push) * sign(v),
    "reverses over": lambda y, v, push, z: 0.1 * (z - sign(v)),
}


@pytest.mark.share(6)
@pytest.mark.parametrize("what", LACKS)
def test_ranges_hold_where_a_term_lacks(what):
    """White residuals hide the bump and the drag."""
    result = fitted(LACKS[what])
    assert not outside(result), {n: (e.value, e.range) for n, e in result.estimates.items()}
    if what in ("differs by direction", "grows with push.f", "reverses over"):
        assert any(what in note for note in named(result)), result.notes


def test_friction_that_lacks_nothing_is_identified():
    result = fitted()
    assert {e.state for e in result.estimates.values()} == {"identified"}
    assert outside(result, "interval") + named(result) == []
    for e in result.estimates.values():
        assert e.interval[1] - e.interval[0] < 0.05 * e.value
    for name, e in [x for x in result.levels.items() if x[0] != "joint level slow"]:
        v = result.speeds[name]
        assert e.range[0] < TRUTH[f"{LAW}F_c"] * sign(v) + TRUTH[f"{LAW}sigma_2"] * v < e.range[1]
    assert result["F_c"] is result.estimates[f"{LAW}F_c"]


def test_an_encoder_that_is_3_ms_late_is_not_taken_for_friction():
    result = fitted(change=lambda y: np.interp(T - 0.003, T, y))
    assert any("outputs.arm.y.delay = 0.00" in note for note in named(result))
    assert not outside(result)


@pytest.mark.share(2)
@pytest.mark.parametrize("every", [10, 4])
def test_a_torque_that_was_sampled_too_coarsely_is_named(every):
    """A clock was blamed, or nothing, where the torque between samples 20 and 50 ms apart is no straight line."""
    runs = []
    for i, size in enumerate((0.6, 1.2)):
        run = recording(pushed(size), turned(pushed(size)), i)
        runs.append(replace(run, inputs={"loads.push.signal": Channel("u", T[::every], pushed(size)[::every])}))
    sought = tuple(Sought(n, x / 5, 5 * x) for n, x in TRUTH.items())
    result = fit_machine(arm(), Logs(tuple(runs), sought), starts=1, baselines=False)
    assert any("inputs smooth between samples" in note for note in named(result))
    assert not outside(result)


def arms_problem(data=None):
    u, scenario = pushed(1.0), Scenario(data or arm())
    sought = [MachineCoordinate(n, x / 5, 5 * x, x, None, {n: 1.0}) for n, x in TRUTH.items()]
    return problem_of(scenario, [(0, recording(u, turned(u)))], sought, {"arm.y": NOISE})


def slopes(problem):
    """Of all forms, by name and, of forms with several columns, which."""
    u, result = problem.start(), {}
    for x in missing_forms(problem, u, RunMotion.of(problem, u), {}):
        result[x.name, sum(x.name == n for n, _ in result)] = problem.whitened(x.slopes)
    return result


def test_slopes_of_a_term_are_those_of_scipy():
    """The residuals with a small term, and without, by equations that share nothing with ours."""
    u, result = pushed(1.0), slopes(arms_problem())
    plain = turned(u)
    v = np.gradient(plain, T)
    size = np.sqrt(np.mean((TRUTH[f"{LAW}F_c"] * sign(v) + TRUTH[f"{LAW}sigma_2"] * v) ** 2))  # of the friction
    along = {
        "offset": (lambda y, v, push: 1.0, np.ones_like(v)),
        "growth 2.0": (lambda y, v, push: v * abs(v), v * abs(v)),
        "weight": (lambda y, v, push: np.sin(y), np.sin(plain)),
        "level by push.f": (lambda y, v, push: abs(push) * sign(v), abs(u) * sign(v)),
    }
    for name, (term, force) in along.items():
        share = 1e-3 * size / np.sqrt(np.mean(force**2))
        moved = (turned(u, lambda y, v, push, z, f=term, a=share: a * f(y, v, push)) - plain) / 1e-3 / NOISE
        assert np.linalg.norm(result[f"joint: {name}", 0] - moved) < 0.03 * np.linalg.norm(moved), name


def test_a_spring_of_a_contact_is_deflected_by_what_slides_in_it():
    """Between two bodies and at a ratio: its deflection grows with the contact's own speed."""
    turning = {"kind": "sine", "amplitude": 0.5, "frequency": 2.0}
    bodies = {"arm": {"inertia": 0.2, "initial": {"y": 0.0, "v": 0.0}}, "belt": {"velocity": {"signal": turning}}}
    law = {"name": "coulomb_viscous", "k_v": STEEP, "parameters": {"F_c": 0.12, "sigma_2": 0.06}}
    contacts = {"joint": {"from": "arm", "to": "belt", "ratio": 2.0, "law": law}}
    problem = arms_problem(data=arm(bodies=bodies, contacts=contacts))
    motion = RunMotion.of(problem, problem.start())
    terms = {name: rows[0] for name, rows, _ in _terms(problem, problem.start(), motion, "joint")}
    w, F = (motion.each(f"joint.{n}")[0] for n in "wF")
    grown = np.concatenate([[0.0], np.cumsum((w[1:] + w[:-1]) / 2 * np.diff(motion.each("t")[0]))])
    assert np.allclose(terms["spring"] - terms["spring"][0], grown, atol=1e-3 * np.ptp(grown))
    assert np.allclose(terms["level by position"], (F - TRUTH[f"{LAW}sigma_2"] * w) * terms["spring"])
    assert np.allclose(terms["growth 2.0"], w * abs(w))


@pytest.mark.parametrize(
    ("what", "error"), [("offset", lambda y: np.ones_like(y)), ("delay", lambda y: -np.gradient(y, T))]
)
@pytest.mark.parametrize("white", [True, False])
def test_errors_of_a_sensor_act_through_the_guide_too(what, error, white):
    """The residuals of two recordings, of which one reads more: the guide draws the arm along what was read."""
    u, scenario = pushed(1.0), Scenario(arm())
    sought = [MachineCoordinate(n, x / 5, 5 * x, x, None, {n: 1.0}) for n, x in TRUTH.items()]
    y = turned(u)

    def problem(y):
        guides = Guides(scenario, [(0, recording(u, y))])
        guided = guides.at(guides.bandwidths[-4])  # a stiff one would see the jumps of the acceleration
        colored = {} if white else {"arm.y": np.array([2.0, -1.0])}
        return problem_of(
            guided.scenario, guided.recordings, sought, {"arm.y": NOISE}, guide=guided.prefix, whitening=colored
        )

    small = 1e-4 / abs(error(y)).max()
    here, there = problem(y), problem(y - small * error(y))
    start = here.start()
    moved = (there.residuals(start[None])[0] - here.residuals(start[None])[0]) / small
    result = slopes(here)[f"outputs.arm.y.{what}", 0]
    assert np.linalg.norm(result - moved) < 0.01 * np.linalg.norm(moved)


def test_a_term_adds_to_the_friction_of_a_measured_motion():
    """Nothing moves otherwise: its slopes are its force. What the friction's fitted terms contain is no term."""
    v = np.cos(7 * T) + 0.5 * np.sin(3 * T)
    driven = {"arm": {"velocity": {"signal": {"kind": "points", "t": T.tolist(), "value": v.tolist()}}, "rotary": True}}
    scenario = Scenario({**arm(), "bodies": driven, "loads": {}})
    sought = [MachineCoordinate(n, x / 5, 5 * x, x, None, {n: 1.0}) for n, x in list(TRUTH.items())[1:]]
    sought += [MachineCoordinate(n, -9.0, 9.0, 0.0, output=("joint.F", n)) for n in ("offset", "weight")]
    F = TRUTH[f"{LAW}F_c"] * sign(v) + TRUTH[f"{LAW}sigma_2"] * v
    y = np.concatenate([[0.0], np.cumsum((v[1:] + v[:-1]) / 2 * STEP)])
    run = Recording("run", T, {"joint.F": Channel("F", T, F, beside={"weight": 3 * y})})
    of_sensors = problem_of(scenario, [(0, run)], sought[-2:], {"joint.F": NOISE})
    assert np.isfinite(of_sensors.residuals(of_sensors.start()[None])).all()  # nothing of the machine is sought
    result = slopes(problem_of(scenario, [(0, run)], sought, {"joint.F": NOISE}))
    drag = v * abs(v) * np.sqrt(np.mean(F**2) / np.mean((v * abs(v)) ** 2)) / NOISE
    assert np.allclose(result["joint: growth 2.0", 0], drag, atol=1e-2 * abs(drag).max())
    names = {n.removeprefix("joint: ") for n, _ in result}
    assert {"growth 3.0", "level by direction", "weight"} < names
    assert not {"offset", "spring"} & names


@pytest.mark.thorough
def test_a_driven_body_feels_no_term():
    """A belt that is driven: the term acts on the mass alone."""
    belt = {"arm": {"inertia": 0.2, "initial": {"y": 0.0, "v": 0.0}}, "belt": {"velocity": {"signal": STILL}}}
    law = {"name": "coulomb_viscous", "k_v": STEEP, "parameters": {"F_c": 0.12, "sigma_2": 0.06}}
    data = arm(bodies=belt, contacts={"joint": {"from": "arm", "to": "belt", "law": law}})
    beside = slopes(arms_problem())
    for name, x in slopes(arms_problem(data=data)).items():
        if name in beside and name[0].startswith("joint"):
            assert np.allclose(x, beside[name], atol=1e-3 * abs(x).max()), name

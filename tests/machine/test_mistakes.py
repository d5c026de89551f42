"""A mistake in a machine file is one clear line: the key's path, the value, what is allowed."""

import copy
import tomllib

import pytest

from stribeck import InputError, Scenario, examples

ARM, GEAR = (tomllib.loads(examples.path(name).read_text()) for name in ("arm", "gear"))
RAMP = {"kind": "ramp", "rate": 1.0}
GONE = object()


def edited(data, changes):
    data = copy.deepcopy(data)
    for path, value in changes.items():
        *parents, last = path.split(".")
        table = data
        for name in parents:
            table = table.setdefault(name, {})
        if value is GONE:
            del table[last]
        else:
            table[last] = value
    return data


def problems(data):
    with pytest.raises(InputError) as error:
        Scenario(data)
    return error.value.problems


ARM_MISTAKES = {
    "an unknown body": ({"links.gear.from": "rotr"}, "links.gear.from: 'rotr': there is no such body (did you mean 'rotor'?)"),
    "a link from nowhere": ({"links.gear": {"to": "arm", "stiffness": 1.0}}, "links.gear.from: missing: must be given"),
    "an unknown key": ({"links.gear.stifness": 1.0}, "links.gear.stifness: 1.0: unknown key (did you mean 'stiffness'?)"),
    "a ratio whose square no float holds": ({"links.gear.ratio": 1e200}, "links.gear.ratio: 1e+200: must be a finite number"),
    "a ratio whose square is 0": ({"links.gear.ratio": -1e-200}, "links.gear.ratio: -1e-200: must be a finite number"),
    "a ratio of 0": ({"links.gear.ratio": 0}, "links.gear.ratio: 0: must be a finite number from 1e-30 to 1e+30"),
    "to itself": ({"links.gear.to": "rotor"}, "links.gear.to: 'rotor': must be another body than from, or 'ground'"),
    "no inertia": ({"bodies.arm": {}}, "bodies.arm.mass: missing: must be given"),
    "mass and inertia": ({"bodies.arm.mass": 1.0}, "bodies.arm.inertia: 0.12: must be left out where mass is given"),
    "a tie to itself": ({"bodies.arm.tied_to": "arm"}, "bodies.arm.tied_to: 'arm': a body cannot be tied to itself"),
    "a ring of ties": (
        {"bodies.x": {"mass": 1.0, "tied_to": "y"}, "bodies.y": {"mass": 1.0, "tied_to": "x"}},
        "bodies.x.tied_to: 'y': tied in a ring: x -> y -> x",
    ),
    "a name used twice": (
        {"loads.seal": {"on": "arm", "kind": "pendulum", "amplitude": 1.0}},
        "loads.seal: 'seal': must be another name: it is that of contacts.seal already",
    ),
    "a bad name": ({"bodies.a-b": {"mass": 1.0}}, "bodies.a-b: 'a-b': a name must be letters, digits and underscores"),
    "the ground's name": ({"bodies.ground": {"mass": 1.0}}, "bodies.ground: 'ground': must be another name"),
    "a driven body with mass": (
        {"bodies.belt": {"mass": 1.0, "velocity": {"signal": RAMP}}},
        "bodies.belt.mass: 1.0: must be left out: the velocity of this body is given",
    ),
    "two drives: a given velocity and a tie": (
        {"bodies.belt": {"tied_to": "arm", "velocity": {"signal": RAMP}}},
        "bodies.belt.tied_to: 'arm': must be left out: the velocity of this body is given",
    ),
    "two drives: controllers on one motor": (
        {"controllers.b": ARM["controllers"]["axis"]},
        "controllers.b.on: 'drive': must be another motor: controllers.axis drives it already",
    ),
    "two drives: controllers on one body": (
        {f"controllers.{n}": {"kind": "pid", "on": "arm", "K_p": 1.0, "signal": RAMP} for n in "bc"},
        "controllers.c.on: 'arm': must be another body: controllers.b drives it already",
    ),
    "two drives: a controller on a driven body": (
        {"bodies.belt": {"velocity": {"signal": RAMP}},
         "controllers.b": {"kind": "pid", "on": "belt", "K_p": 1.0, "signal": RAMP}},
        "controllers.b.on: 'belt': must be another body: the velocity of belt is given, and nothing acts on it",
    ),
    "a motor that nothing drives": (
        {"controllers": {}}, "motors.drive.signal: missing: must be given (the voltage), or a controller must be on the motor",
    ),
    "a motor with two": ({"motors.drive.signal": RAMP}, "motors.drive.signal: a signal: must be left out"),
    "feedforward without derivative": (
        {"controllers.axis.signal": {"kind": "step", "time": 0.1, "value": 1.0},
         "controllers.axis.feedforward": {"inertia": 1.0}},
        "controllers.axis.signal.kind: 'step': has no second derivative, which feedforward needs",
    ),
    "a square dither without samples": (
        {"controllers.b": {"kind": "pid", "on": "arm", "K_p": 1.0, "signal": RAMP,
                           "dither": {"kind": "square", "amplitude": 1.0, "frequency": 9.0}}},
        "controllers.b.dither.kind: 'square': a continuous controller's must be 'sine'",
    ),
    "a dither above half of the sampling": (
        {"controllers.axis.sampling": {"period": 0.01}, "controllers.axis.dither": {"amplitude": 1.0, "frequency": 51.0}},
        "controllers.axis.dither.frequency: 51: must be at most 50, half of the sampling's rate",
    ),
    "a compensation of nothing": (
        {"controllers.axis.compensation": {"speed": "measured"}},
        "controllers.axis.compensation.contact: missing: must be given (a contact, or else a law)",
    ),
    "an unknown speed": (
        {"controllers.axis.compensation": {"contact": "bearing", "speed": "fast"}},
        "controllers.axis.compensation.speed: 'fast': must be one of reference, measured",
    ),
    "no period": ({"controllers.axis.sampling": {"delay": 0.1}}, "controllers.axis.sampling.period: missing"),
    "lists of two lengths": (
        {"loads.cogging.waves": [14, 28]}, "loads.cogging.waves: a list of 2: must be as long as amplitude (1)",
    ),
    "a factor that reaches 0": (
        {"contacts.seal.factors": {"level": {"amplitude": [0.6, 0.5], "waves": [1, 2]}}},
        "contacts.seal.factors.level.amplitude: [0.6, 0.5]: the magnitudes must sum to less than 1",
    ),
    "a factor on sigma_0": (
        {"contacts.seal.factors": {"sigma_0": {"signal": {"kind": "points", "t": [0], "value": [1.0]}}}},
        "contacts.seal.factors.sigma_0: must be left out",
    ),
    "a law with F_s < F_c": (
        {"contacts.seal.law.parameters.F_s": 0.1}, "contacts.seal.law.parameters.F_s: 0.1: must be at least F_c",
    ),
    "a law that jumps": (
        {"contacts.seal.law": {"name": "stribeck", "parameters": {"F_c": 1.0, "F_s": 1.0, "v_s": 1.0, "sigma_2": 0.0}}},
        "contacts.seal.law.k_v: missing",
    ),
    "an unknown section": ({"gears": {}}, "gears: an empty table: unknown key"),
    "a wrong tolerance": (
        {"solve.atol": {"arm.x": 1e-9}}, "solve.atol.arm.x: 1e-09: there is no such state (did you mean 'arm.y'?)",
    ),
    "a wrong version": ({"schema": 3}, "schema: 3: must be 1 (a law on a body) or 2 (a machine)"),
    "an end that is no name": ({"links.gear.from": 3}, "links.gear.from: 3: must be a body's name, or a table with the signal"),
    "no end": ({"links.gear.from": GONE}, "links.gear.from: missing: must be given (a body, or { signal = ... }"),
    "a list in the place of a name": ({"motors.drive.on": [1, 2]}, "motors.drive.on: [1, 2]: must be text, not a list"),
    "a move too steep for numbers": (
        {"controllers.axis.signal.value": [0.0, 1e308]}, "controllers.axis.signal.value[1]: 1e+308: too far from",
    ),
    "a body's table that is none": ({"bodies.arm": 3}, "bodies.arm: 3: must be a table, not a number"),
}  # fmt: skip
GEAR_MISTAKES = {
    "a load that names itself": ({"contacts.mesh.loads": [{"force": "mesh", "F_c": 0.1}]}, "force: 'mesh': names itself"),
    "a load on a contact": ({"contacts.mesh.loads": [{"force": "bearing", "F_c": 0.1}]}, "force: 'bearing': there is no such"),
    "a load without gain": ({"contacts.mesh.loads": [{"force": "gear"}]}, "F_c: missing: must be given"),
    "a weight of text": ({"contacts.mesh.loads": [{"force": {"gear": "x"}, "F_c": 0.1}]}, "force.gear: 'x': must be a finite"),
}  # fmt: skip


@pytest.mark.parametrize("name", ARM_MISTAKES)
def test_arm(name):
    changes, text = ARM_MISTAKES[name]
    found = problems(edited(ARM, changes))
    assert sum(line.startswith(text) for line in found) == 1, found
    assert all("\n" not in line and line.split(":")[0].count(" ") == 0 for line in found)


@pytest.mark.parametrize("name", GEAR_MISTAKES)
def test_gear(name):
    changes, text = GEAR_MISTAKES[name]
    assert [line.startswith(f"contacts.mesh.loads[0].{text}") for line in problems(edited(GEAR, changes))] == [True]


def test_every_problem_is_told():
    changes = {"links.gear.ratio": 0, "bodies.arm.inertia": -1.0, "loads.gravity.on": "x", "output.step": "x"}
    found = problems(edited(ARM, changes))
    assert [line.split(":")[0] for line in found] == [
        "output.step",
        "bodies.arm.inertia",
        "links.gear.ratio",
        "loads.gravity.on",
    ]


def test_what_may_be_left_out():
    Scenario(edited(ARM, {"loads.cogging.phase": GONE, "contacts.seal.factors": GONE, "name": GONE}))

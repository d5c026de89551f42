"""A mistake anywhere in a machine file is one line that begins with the key and says the value and what is allowed."""

import tomllib
from math import inf, nan
from pathlib import Path

import pytest

from stribeck import InputError, Scenario
from stribeck.cli import _status
from tests.machine.test_mistakes import GONE, RAMP, edited

FILE = Path(__file__).parent.parent / "reference" / "unseen" / "everything.toml"
DATA = tomllib.loads(FILE.read_text())
MISTAKES = [
    ({'bodies.cart.mass': 0.0},
     'bodies.cart.mass: 0.0: must be a finite number > 0'),
    ({'bodies.cart.mass': '1 kg'},
     "bodies.cart.mass: '1 kg': must be a finite number > 0, not text"),
    ({'bodies.cart.mass': True},
     'bodies.cart.mass: true: must be a finite number > 0, not a true/false value'),
    ({'bodies.cart.mass': [1.0]},
     'bodies.cart.mass: [1.0]: must be a finite number > 0, not a list'),
    ({'bodies.cart': {}},
     'bodies.cart.mass: missing: must be given (mass in kg, or inertia in kg m^2 for a body that turns)'),
    ({'bodies': {}},
     'bodies: missing: a machine must have at least one body'),
    ({'bodies': [1, 2]},
     'bodies: [1, 2]: must be a table, not a list'),
    ({'bodies.drum.tied_to': 'ground'},
     "bodies.drum.tied_to: 'ground': there is no such body (there is rotor, drum, cart, hook, swing, belt)"),
    ({'bodies.drum.tied_to': 3},
     'bodies.drum.tied_to: 3: must be text, not a number'),
    ({'bodies.drum.initial': {'y': 1.0}},
     'bodies.drum.initial: a table with y, v: must be left out: a body that is tied to another has no stat'),
    ({'links.rope.ratio': '1:100'},
     "links.rope.ratio: '1:100': must be a finite number, not text"),
    ({'bodies.cart.ratio': 2.0},
     'bodies.cart.ratio: 2.0: needs tied_to: it says how far the body moves by another'),
    ({'bodies.cart.initial': {'x': 1.0}},
     'bodies.cart.initial.x: 1.0: unknown key (known here: y, v)'),
    ({'bodies.belt.velocity': {}},
     'bodies.belt.velocity.signal: missing: must be given (the velocity: a table with kind and its constan'),
    ({'bodies.belt.velocity': {'signal': {'kind': 'sinus'}}},
     "bodies.belt.velocity.signal.kind: 'sinus': must be one of points, ramp, sine, step, file, point_to_p"),
    ({'bodies.belt.velocity': {'signal': {'rate': 1.0}}},
     'bodies.belt.velocity.signal.kind: missing: must be given (one of points, ramp, sine, step, file, poi'),
    ({'bodies.belt.velocity': {'signal': {'kind': 3}}},
     'bodies.belt.velocity.signal.kind: 3: must be one of points, ramp, sine, step, file, point_to_point, '),
    ({'bodies.belt.velocity': {'signal': {'kind': 'sine', 'amplitude': 1.0}}},
     'bodies.belt.velocity.signal.frequency: missing: must be given (frequency, Hz)'),
    ({'bodies.belt.velocity': {'signal': {'kind': 'points', 't': [0, 1], 'value': [1.0]}}},
     'bodies.belt.velocity.signal.value: a list of 1: must be as long as t (2)'),
    ({'bodies.belt.velocity': {'signal': {'kind': 'points', 't': [], 'value': [1.0]}}},
     'bodies.belt.velocity.signal.t: []: must hold at least one number'),
    ({'bodies.belt.velocity': {'signal': {'kind': 'points', 't': [0, 1, 0.5], 'value': [1.0, 2, 3]}}},
     'bodies.belt.velocity.signal.t[2]: 0.5: times must not decrease (the one before is 1.0)'),
    ({'links.hang.stiffness': GONE},
     'links.hang.stiffness: missing: must be given (stiffness, N/m)'),
    ({'links.hang.stiffness': -5.0},
     'links.hang.stiffness: -5.0: must be a finite number >= 0'),
    ({'links.far.to': GONE},
     "links.far.to: 'ground': must be a body, as a far end is the other side"),
    ({'links.far.from': {'signal': {}}},
     'links.far.from.signal.kind: missing: must be given (one of points, ramp, sine, step, file, point_to_'),
    ({'links.hang.kind': 'sprung'},
     "links.hang.kind: 'sprung': must be one of link, spring"),
    ({'contacts.rail.law': GONE},
     'contacts.rail.law: missing: must be given (the friction law: a table with name and parameters)'),
    ({'contacts.rail.law': 'lugre'},
     "contacts.rail.law: 'lugre': must be a table, not text"),
    ({'contacts.rail.law.name': 'lugree'},
     "contacts.rail.law.name: 'lugree': no such law (did you mean 'lugre'?)"),
    ({'contacts.rail.law.parameters': GONE},
     "contacts.rail.law.parameters: missing: must be a table of numbers or the name of a set; law 'lugre_m"),
    ({'contacts.rail.law.k_v': GONE},
     "contacts.rail.law.k_v: missing: law 'lugre_majorant' needs it (steepness of the smooth sign, a finit"),
    ({'contacts.rail.from': {'signal': RAMP}},
     'contacts.rail.from: a table with signal: must be text, not a table'),
    ({'contacts.rail.loads': [{'force': 'rail', 'F_c': 0.1}]},
     "contacts.rail.loads[0].force: 'rail': names itself: must be a link, a motor or a load"),
    ({'contacts.rail.loads': [{'force': 'felt', 'F_c': 0.1}]},
     "contacts.rail.loads[0].force: 'felt': there is no such link or motor or load (there is rope, hang, f"),
    ({'contacts.rail.loads': [{'force': 'rope'}]},
     'contacts.rail.loads[0].F_c: missing: must be given (the rise of the level by the force; F_s likewise'),
    ({'contacts.rail.loads': {'force': 'rope', 'F_c': 0.1}},
     'contacts.rail.loads: a table with force, F_c: must be a list, not a table'),
    ({'contacts.rail.loads': [{}]},
     'contacts.rail.loads[0].force: missing: must be given (a link, motor or load, or a table of weights o'),
    ({'contacts.rail.loads': [{'force': {}, 'F_c': 0.1}]},
     'contacts.rail.loads[0].force: an empty table: must be a table that is not empty'),
    ({'contacts.rail.loads': [{'force': 1.0, 'F_c': 0.1}]},
     'contacts.rail.loads[0].force: 1.0: must be a link, motor or load, or a table of weights, not a numbe'),
    ({'contacts.rail.factors.sigma_3': {'signal': RAMP}},
     "contacts.rail.factors.sigma_3: unknown key: law 'lugre_majorant' has no such constant (did you mean 's"),
    ({'contacts.pin.factors': {'z_ba': {'signal': {'kind': 'points', 't': [0], 'value': [9.0]}}}},
     'contacts.pin.factors.z_ba: z_ba (up to 0.018) must stay below F_c/sigma_0, which factors bring down '),
    ({'contacts.pin.factors': {'level': {'amplitude': [0.7], 'waves': [3]}}},
     'contacts.pin.factors.level: z_ba (up to 0.002) must stay below F_c/sigma_0, which factors bring down'),
    ({'contacts.rail.law.delta': 1.2, 'contacts.rail.factors.delta': {'amplitude': [0.5], 'waves': [3]}},
     'contacts.rail.factors.delta: brings delta down to 0.6: it must stay a finite number >= 1'),
    ({'contacts.rail.factors.F_c': {}},
     'contacts.rail.factors.F_c: an empty table: must have a signal, or amplitude and waves (by position)'),
    ({'contacts.rail.factors.F_c': {'signal': RAMP}},
     "contacts.rail.factors.F_c.signal: 'ramp': begins at 0: a factor must be > 0 at all times"),
    ({'contacts.rail.factors.F_c': {'signal': {'kind': 'sine', 'amplitude': 2.0, 'frequency': 1.0, 'offset': 1.0}}},
     'contacts.rail.factors.F_c.signal: reaches -1: a factor must be > 0 at all times'),
    ({'loads.cog.on': GONE},
     'loads.cog.on: missing: must be given (the body)'),
    ({'loads.cog.kind': GONE},
     'loads.cog.kind: missing: must be given (one of signal, pendulum, ripple, by_position)'),
    ({'loads.gravity.kind': 'weight'},
     "loads.gravity.kind: 'weight': must be one of signal, pendulum, ripple"),
    ({'loads.x': {'on': 'cart', 'kind': 'signal'}},
     'loads.x.signal: missing: must be given (the signal: a table with kind and its constants)'),
    ({'loads.gravity.amplitude': GONE},
     'loads.gravity.amplitude: missing: must be given (largest force, N)'),
    ({'loads.cog.amplitude': 0.1},
     'loads.cog.amplitude: 0.1: must be a list, not a number'),
    ({'motors.m.R': GONE},
     'motors.m.R: missing: must be given (resistance of the winding, ohm)'),
    ({'motors.m.signal': RAMP},
     'motors.m.signal: a signal: must be left out: controllers.axis drives the motor'),
    ({'controllers.b': {'kind': 'pid', 'on': 'swing', 'K_p': 1.0, 'signal': RAMP}},
     "controllers.b.on: 'swing': must be another body: controllers.damper drives it already"),
    ({'controllers.axis.kind': 'pi'},
     "controllers.axis.kind: 'pi': must be one of pid, cascade, pressure_cascade (did you mean 'pid'?)"),
    ({'controllers.damper.feedforward': {'inertia': 1.0}},
     "controllers.damper.signal.kind: 'step': has no second derivative, which feedforward needs: must be s"),
    ({'controllers.axis.compensation.contact': 'mesh'},
     "controllers.axis.compensation.contact: 'mesh': there is no such contact (there is rail, felt, pin, b"),
    ({'controllers.axis.compensation.speed': GONE},
     'controllers.axis.compensation.speed: missing: must be given (speed for the law: reference or measured)'),
    ({'controllers.axis.compensation.law': {'name': 'lugre'}},
     'controllers.axis.compensation.law.parameters: missing: must be a table of numbers or the name of a s'),
    ({'controllers.axis.sampling.period': GONE},
     'controllers.axis.sampling.period: missing: must be given (time between two samples, s)'),
    ({'controllers.axis.sampling.seed': 1.5},
     'controllers.axis.sampling.seed: 1.5: must be a whole number >= 0 and <= 4294967295'),
    ({'solve': GONE},
     'solve: missing: the table [solve] must be given (with t_end)'),
    ({'output': GONE},
     'output: missing: the table [output] must be given (with step)'),
    ({'solve.rtol': 1e-20},
     'solve.rtol: 1e-20: must be a finite number >= 1e-13 and <= 0.1'),
    ({'schema': GONE},
     'schema: missing: must be given (schema = 2, the version of the file format: a machine)'),
    ({'loads.rope': {'on': 'cart', 'kind': 'pendulum', 'amplitude': 1.0}},
     "loads.rope: 'rope': must be another name: it is that of links.rope already"),
]  # fmt: skip


MISTAKES += [  # each of these was two or three lines: what follows from a mistake is none
    ({"controllers.axis.on": ["m"]}, "controllers.axis.on: ['m']: must be text, not a list"),
    ({"controllers.axis.on": "mm"}, "controllers.axis.on: 'mm': there is no such motor or body"),
    ({"solve.t_end": inf}, "solve.t_end: inf: must be a finite number > 0"),
    ({"contacts.pin.factors": {"level": {"amplitude": [1.0], "waves": [3]}}},
     "contacts.pin.factors.level.amplitude: [1.0]: the magnitudes must sum to less than 1"),
    ({"contacts.pin.factors": {"level": {"amplitude": [], "waves": [3], "phase": [0.1]}}},
     "contacts.pin.factors.level.amplitude: []: must hold at least one number"),
]  # fmt: skip
MISTAKES += [
    (
        {"controllers.axis.sampling.period": 1e-12},
        "controllers.axis.sampling.period: 1e-12: more than 1e+08 samples until",
    ),
    (
        {"solve.t_end": 1e300, "output.step": 1e299},
        "controllers.axis.sampling.period: 0.005: more than 1e+08 samples until solve.t_end = 1e+300 s",
    ),
    ({"bodies.drum.ratio": 0.0}, "bodies.drum.ratio: 0.0: must be a finite number from 1e-30 to 1e+30"),
    (
        {"motors.m.on": "belt"},
        "motors.m.on: 'belt': must be another body: the velocity of belt is given, and nothing acts on it",
    ),
    (
        {"bodies.bt": {"mass": 1.0, "tied_to": "belt"}, "controllers.damper.on": "bt"},
        "controllers.damper.on: 'bt': must be another body: the velocity of belt is given, and nothing acts o",
    ),
    ({"contacts.rail.to": "cart"}, "contacts.rail.to: 'cart': must be another body than from, or 'ground'"),
    ({"contacts.rail.law.delta": 0.5}, "contacts.rail.law.delta: 0.5: must be a finite number >= 1"),
    (
        {"contacts.rail.loads": [{"force": "rope", "F_c": -0.1}]},
        "contacts.rail.loads[0].F_c: -0.1: must be a finite number >= 0",
    ),
    (
        {"contacts.rail.factors.level": {"amplitude": [0.1, 0.2], "waves": [1]}},
        "contacts.rail.factors.level.waves: a list of 1: must be as long as amplitude (2)",
    ),
    ({"schema": 2.0}, "schema: 2.0: must be 1 (a law on a body) or 2 (a machine)"),
]


@pytest.mark.parametrize(("changes", "line"), MISTAKES, ids=lambda x: x if isinstance(x, str) else "")
def test_one_line(changes, line):
    with pytest.raises(InputError) as error:
        Scenario(edited(DATA, changes))
    (found,) = error.value.problems
    assert found.startswith(line)
    assert "\n" not in found


ABOVE_0 = """
bodies.cart.mass bodies.rotor.inertia contacts.rail.law.k_v contacts.rail.law.v_d motors.m.R motors.m.L motors.m.K
motors.m.voltage motors.m.current_time controllers.axis.T_i controllers.axis.limit controllers.axis.sampling.period
controllers.axis.sampling.bandwidth solve.t_end output.step"""
FROM_0 = """
links.hang.stiffness links.hang.damping links.rope.gap controllers.axis.compensation.share
controllers.axis.sampling.delay controllers.axis.sampling.resolution controllers.axis.sampling.noise"""


@pytest.mark.parametrize(
    ("path", "bound"), [*((p, ">") for p in ABOVE_0.split()), *((p, ">=") for p in FROM_0.split())]
)
def test_the_end_of_what_is_allowed(path, bound):
    for value in (0.0, -1e-9):
        lines = []
        try:
            Scenario(edited(DATA, {path: value}))
        except InputError as error:
            lines = [line for line in error.problems if line.startswith(f"{path}: ")]
        refused = [f"{path}: {value}: must be a finite number {bound} 0"]
        assert lines == (refused if value < 0 or bound == ">" else [])


def places(table, path=()):
    """Every key of a file."""
    for name, value in table.items():
        yield ".".join([*path, name])
        if isinstance(value, dict):
            yield from places(value, [*path, name])


@pytest.mark.parametrize("wrong", [True, nan, "?", [{}], {"?": 1}], ids=repr)
def test_a_value_of_a_wrong_kind_is_refused_at_its_place(wrong):
    for path in places(DATA):
        if (path, wrong) in (("name", "?"), ("output.energy", True)):
            continue
        with pytest.raises(InputError) as error:
            Scenario(edited(DATA, {path: wrong}))
        assert all("\n" not in line for line in error.value.problems)
        assert any(line.startswith(path) for line in error.value.problems), (path, error.value.problems)


@pytest.mark.parametrize(
    ("before", "after", "key"),
    [
        ('to = "cart"', 'to = "crt"', "bodies.hook.tied_to: 'crt'"),
        ("mass = 1.0", "mass = nan", "bodies.cart.mass: nan"),
        ("[bodies.cart]", "[bodies.cärt]", ":"),
        ("[bodies.cart]", "[bodies.rotor]", ":"),
        ("schema = 2", "schema = 2\nschema = 2", ":"),
    ],
)
def test_on_the_command_line(before, after, key, tmp_path, capsys):
    file = tmp_path / "wrong.toml"
    file.write_text(FILE.read_text().replace(before, after, 1), encoding="utf-8")
    assert _status(["run", str(file), "--out", str(tmp_path / "out")]) == 2
    shown = capsys.readouterr()
    assert (shown.out, len(shown.err.splitlines())) == ("", 1)
    assert key in shown.err
    assert "Traceback" not in shown.err
    assert list(tmp_path.iterdir()) == [file]

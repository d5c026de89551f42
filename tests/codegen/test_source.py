"""The generated C as a text: it compiles without a warning, its names are readable and clash with nothing."""

import cProfile
import ctypes
import subprocess
import threading

import numpy as np
import pytest

from stribeck import Scenario
from stribeck.codegen import source
from stribeck.codegen.source import SAME, runtime_text
from stribeck.codegen.source import STRICT as AS_WRITTEN
from stribeck.laws import BristleLaw
from stribeck.laws.form import USUAL
from stribeck.simulation import compiler, simulate
from tests.codegen.systems import IDS, VARIANTS, systems
from tests.machine import machines
from tests.simulation.rig import needs_compiler, rig, solved

STRICT = ("-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror")


@pytest.mark.share(20)
@needs_compiler
@pytest.mark.parametrize(("law", "form"), VARIANTS, ids=IDS)
def test_compiles_without_a_warning(law, form, tmp_path):
    """One system goes through the whole compiler, the others are parsed; neighboring variants differ in the energy."""
    turn = VARIANTS.index((law, form))
    every = systems(law, form, energy=(turn % 2 == 1,))
    files = [tmp_path / f"system{i}.c" for i in range(len(every))]
    for file, system in zip(files, every, strict=True):
        file.write_text(source(system))
    whole = files[turn % len(files)]
    commands = [["-fsyntax-only", *files], ["-c", "-o", whole.with_suffix(".o"), whole]]
    for command in commands:
        words = [*compiler.find().command, *STRICT, *command]
        process = subprocess.run(words, capture_output=True, text=True, check=False)
        assert process.returncode == 0, process.stderr


@pytest.mark.share(10)
@needs_compiler
@pytest.mark.parametrize(("law", "form"), VARIANTS, ids=IDS)
def test_compiles_for_lanes_without_a_warning(law, form, tmp_path):
    """For one width of the processor's vectors; every width is run by tests/simulation/test_lanes.py."""
    every = [system for system in systems(law, form, energy=(True,)) if system.signals[0].kind is None]
    files = [tmp_path / f"system{i}.c" for i in range(len(every))]
    for file, system in zip(files, every, strict=True):
        file.write_text(source(system, lanes=4))
    words = [*compiler.find().command, *STRICT, "-Wno-psabi", "-fsyntax-only", *files]
    process = subprocess.run(words, capture_output=True, text=True, check=False)
    assert process.returncode == 0, process.stderr


@pytest.mark.share(20)
@pytest.mark.parametrize(("law", "form"), VARIANTS, ids=IDS)
def test_depends_on_the_system_alone(law, form):
    """Neither on what else there is, nor on what else is being made: or the cache would miss."""
    before = [source(system) for system in systems(law, form)]
    turn = VARIANTS.index((law, form))
    others = [system for other, on in (*VARIANTS, *VARIANTS)[turn + 1 : turn + 6] for system in systems(other, on)]
    alive = [system.rates() for system in others]
    threads = [threading.Thread(target=source, args=(system,)) for system in others[:8]]
    for thread in threads:
        thread.start()
    assert [source(system) for system in reversed(systems(law, form))] == before[::-1]
    for thread in threads:
        thread.join()
    assert len(alive) == len(others)


AWKWARD = '''
from stribeck.constants import Constant
from stribeck.laws import BristleLaw

class Awkward(BristleLaw):
    """A law whose constants have the names of C's words, of states and of the code's own variables. */"""

    source = "nobody */ #error"
    uses = ("sigma_0", "v_s", "F_c")
    relations = ()
    {}

    @staticmethod
    def dz_dt(p, v, z):
        return v - abs(v) * z * p.sigma_0 / p.F_c * ({}) / {}

    @staticmethod
    def friction(p, v, z, dz_dt):
        return p.sigma_0 * z

    @staticmethod
    def scales(p):
        from stribeck.laws import Scales
        return Scales(p.F_c / p.sigma_0, p.v_s, p.F_c)
'''
NAMES = (
    "g", "x", "c", "k", "h", "I", "mass", "stiffness", "double", "start", "value",
    "slope", "exp", "atan", "run", "N", "right", "shift", "jac", "fac", "piece", "dx", "df_dt", "c0", "c1", "inv_mass",
    "t1", "t2", "sign_of", "prepare", "solve", "A", "C", "NODE", "STAGES", "attempt", "Run", "Jacobian", "E_in",
    "M_PI", "NAN", "linux", "real", "mask", "choose", "splat", "any", "exp_of", "LANES", "BY_LANE", "dense",
)  # fmt: skip


@needs_compiler
@pytest.mark.parametrize("drive", ["force", {"kind": "spring", "stiffness": 2.0}])
def test_constants_of_any_name(drive, tmp_path):
    declared = "\n    ".join(f"{name} = Constant('', 'awkward', above=0)" for name in NAMES)
    mean = " + ".join(f"p.{name}" for name in NAMES)
    (tmp_path / "law.py").write_text(AWKWARD.format(declared, mean, float(len(NAMES))))
    own = dict.fromkeys(NAMES, 1.0)
    parameters = {"sigma_0": 1e5, "F_c": 1.0, "v_s": 1e-3}
    data = rig({"name": "law.py:Awkward", "parameters": parameters, **own}, drive, {"kind": "ramp", "rate": 0.8}, 1.0)
    plain = rig({"name": "dahl", "parameters": parameters}, drive, {"kind": "ramp", "rate": 0.8}, 1.0)
    np.testing.assert_allclose(solved(data, folder=tmp_path)["y"], solved(plain)["y"], rtol=1e-7, atol=1e-12)


def test_a_law_whose_terms_are_named_like_its_constants(tmp_path):
    class Twice(BristleLaw):
        """A law with a constant g beside the term g."""

        @staticmethod
        def dz_dt(p, v, z):
            from stribeck.laws.terms import g

            return v - abs(v) / g(p, v) * z

    assert "const real g = " in source(systems(Twice, USUAL)[0])


def named(body, contact):
    """A body on a spring with friction, under these names."""
    return machines.machine(
        {body: {"mass": 1.0}},
        links={"spring": {"from": body, "to": "ground", "stiffness": 1e3, "damping": 1.0}},
        contacts={contact: {"from": body, "law": machines.law("lugre_sobczyk")}},
        loads={"push": machines.push(on=body)},
    )


@needs_compiler
def test_names_do_not_change_a_bit():
    """Of any length: neither a name of 80 letters nor one of a single letter decides where a statement is broken."""
    short, long = simulate(named("b", "c")), simulate(named("b" * 80, "c" * 80))
    assert short.reason is long.reason is None
    assert short.stats["solver"] == long.stats["solver"] == "rodas5p"
    for name in ("y", "v"):
        assert np.array_equal(short[f"b.{name}"], long[f"{'b' * 80}.{name}"])
    assert np.array_equal(short["c.F"], long[f"{'c' * 80}.F"])


def chain(count):
    """A system of many bodies in a row, each with a contact to the ground."""
    bodies = {f"b{i}": {"mass": 1.0} for i in range(count)}
    links = {f"l{i}": {"from": f"b{i}", "to": f"b{i + 1}", "stiffness": 1e4} for i in range(count - 1)}
    contacts = {f"c{i}": {"from": f"b{i}", "law": machines.law()} for i in range(count)}
    return Scenario(machines.machine(bodies, energy=False, links=links, contacts=contacts)).system


@pytest.mark.thorough
def test_the_work_grows_little_faster_than_the_machine():
    """Calls of functions, so that no clock decides: as n^1.3, where a search of all rows for each pivot made n^1.6."""
    calls = []
    for count in (20, 40):
        system, profile = chain(count), cProfile.Profile()
        profile.enable()
        source(system)
        profile.disable()
        calls.append(sum(each.callcount for each in profile.getstats()))
    assert calls[1] < 2.6 * calls[0]


@needs_compiler
@pytest.mark.parametrize("name", SAME)
def test_functions_of_plus_and_times_alone_are_near_those_of_numpy(name, tmp_path):
    """Within the units of the last place that runtime/portable.c states, and one of NumPy's."""
    head = "#define UNUSED __attribute__((unused))\n#include <math.h>\n#pragma GCC visibility push(default)\n"
    text = f"{runtime_text('portable.c')}\ndouble call(double x) {{ return same_{name}(x); }}\n"
    (tmp_path / "same.c").write_text(head + AS_WRITTEN + text)
    compiler.find().build(tmp_path / "same.c", tmp_path / "same.so")
    called = ctypes.CDLL(str(tmp_path / "same.so")).call
    called.restype, called.argtypes = ctypes.c_double, [ctypes.c_double]
    random = np.random.default_rng(0)
    x = np.concatenate([random.uniform(-3, 3, 2000), random.choice([-1, 1], 2000) * 10 ** random.uniform(-8, 2, 2000)])
    exact = {"atan": np.arctan}.get(name, getattr(np, name, None))(x)
    off = abs(np.array([called(each) for each in x]) - exact) / np.spacing(abs(exact))
    assert np.max(off) <= {"atan": 4, "tanh": 7}.get(name, 2)

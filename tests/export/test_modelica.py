"""The Modelica package, compiled and simulated as it stands by Rumoca, a Modelica compiler."""

import numpy as np
import pytest

import stribeck
from stribeck.export import export
from stribeck.laws import builtin, find
from tests.laws.test_claims import CANUDAS, make

rumoca = pytest.importorskip("rumoca")


def write(law, folder):
    path = folder / f"Friction{type(law).__name__}.mo"
    export(law, "modelica", path)
    return path


def simulated(path, rig, t_end, step, atol):
    """The result of a model that uses the package."""
    folder = path.parent / "rig"
    folder.mkdir()
    (folder / "Rig.mo").write_text(f"model Rig\n{rig}\nend Rig;\n", encoding="utf-8")
    model = rumoca.Session(roots=[str(path.parent)]).load(str(folder / "Rig.mo"), model="Rig")
    config = rumoca.SimConfig(solver="bdf", rtol=1e-9, atol=atol, max_wall_seconds=60)
    return model.simulate(t=(0, t_end), dt=step, config=config)


@pytest.mark.parametrize("name", builtin())
def test_block_has_the_numbers_of_the_law(name, tmp_path):
    """Driven by a velocity that reverses: F for the v and z of every row, and z against Stribeck's own solver."""
    law = make(builtin()[name])
    scales = law.scales(law.p)
    speed, frequency = 5 * float(scales.speed), 0.2 * float(scales.speed / scales.length)
    t_end, step = 2 / frequency, 1 / (100 * frequency)
    rig = (
        f"  Friction{type(law).__name__}.{type(law).__name__} friction;\nequation\n"
        f"  friction.v = {speed!r}*sin(2*3.141592653589793*{frequency!r}*time);"
    )
    got = simulated(write(law, tmp_path), rig, t_end, step, 1e-9 * scales.length)
    v, F = np.array(got["friction.v"]), np.array(got["friction.F"])
    z = np.array(got["friction.z"]) if law.has_z else np.zeros_like(v)
    assert np.ptp(v) == pytest.approx(2 * speed, rel=1e-3)
    size = abs(law.force(v, z)) + abs(law.force(v, -z))
    moving = abs(v) > 1e-9 * speed  # rounding decides on which side of a jump v = 0 is
    assert np.all(abs(F - law.force(v, z))[moving] <= 1e-9 * size[moving])
    if law.has_z:
        own = {n: x for n, x in law.values.items() if n in law.own_constants() and x is not None}
        scenario = stribeck.Scenario(
            law={"name": law.name, **own, "parameters": CANUDAS},
            drive={"kind": "velocity", "signal": {"kind": "sine", "amplitude": speed, "frequency": frequency}},
            solve={"t_end": t_end},
            output={"step": step},
        )
        reference = stribeck.simulate(scenario)["z"]
        rows = min(len(z), len(reference))
        assert rows >= 200
        assert np.max(abs(z[:rows] - reference[:rows])) < 1e-5 * np.max(abs(reference))


@pytest.mark.parametrize("name", ["lugre_majorant", "elastoplastic_majorant"])
def test_body_sticks_and_slips_as_simulated(name, tmp_path):
    """With a constant replaced as a Modelica user would."""
    law = stribeck.law(
        name, "canudas1995", k_v=1e6, **({"z_ba": 7e-6} if "z_ba" in builtin()[name].constants() else {})
    )
    package = f"Friction{type(law).__name__}"
    rig = (
        f"  {package}.Body body(mass=1.5, friction(F_s=1.8));\n  {package}.RealOutput pull;\nequation\n"
        "  pull = 2.0*(0.1*time - body.y);\n  connect(pull, body.u);"
    )
    got = np.array(simulated(write(law, tmp_path), rig, 20.0, 0.1, 1e-12)["body.y"])
    scenario = stribeck.Scenario(
        law={
            "name": name,
            **{n: x for n, x in law.values.items() if n in law.own_constants() and x is not None},
            "parameters": {**CANUDAS, "F_s": 1.8},
        },
        plant={"mass": 1.5},
        drive={"kind": "spring", "stiffness": 2.0, "signal": {"kind": "ramp", "rate": 0.1}},
        solve={"t_end": 20.0},
        output={"step": 0.1},
    )
    reference = stribeck.simulate(scenario)["y"]
    assert reference[-1] > 1
    assert np.max(abs(got - reference)) < 1e-5 * reference[-1]


def test_header_carries_parameters_units_source_and_version(tmp_path):
    law = stribeck.law("lugre", "canudas1995", F_s=2.25)
    text = write(law, tmp_path).read_text(encoding="utf-8")
    assert f"Made by stribeck {stribeck.__version__}" in text
    assert law.source in text
    assert 'parameter Real F_s(unit="N", min=0) = 2.25 "static friction force";' in text
    assert 'parameter Real sigma_1(unit="N.s/m", min=0) = 316.22776601683796 "bristle damping";' in text


def test_jump_at_rest_is_said_before_writing(tmp_path):
    law = stribeck.law("stribeck", "canudas1995")
    with pytest.warns(stribeck.StribeckNote, match="jumps at v = 0"):
        export(law, "modelica", tmp_path / "x.mo")


def test_awkward_names_and_signs_of_a_users_law(tmp_path):
    (tmp_path / "mine.py").write_text(
        "from stribeck.constants import Constant\n"
        "from stribeck.laws import StaticLaw\n"
        "from stribeck.expressions.ops import tanh, where\n"
        'class Odd(StaticLaw):\n    """Says "hello" \\\\ and <b>."""\n'
        '    end = Constant("s/m", "a keyword of \\"Modelica\\"", above=0)\n    mass = Constant("N", "a name that is taken")\n'
        "    @staticmethod\n    def friction(p, v, z, dz_dt):\n"
        "        bent = where(v * v <= 1, p.mass * tanh(p.end * v), p.mass * v)\n"
        "        return bent - v * -2.5 + (-3.5 + v) * (-v) + abs(v) ** 1.5 / -p.end\n",
        encoding="utf-8",
    )
    law = find("mine.py:Odd", tmp_path)({"end": 3.0, "mass": -2.0})
    rig = "  FrictionOdd.Odd friction;\nequation\n  friction.v = 4*time - 2;"
    got = simulated(write(law, tmp_path), rig, 1.0, 0.05, 1e-12)
    v = np.array(got["friction.v"])
    assert np.ptp(v) == pytest.approx(4.0)
    assert np.array(got["friction.F"]) == pytest.approx(law.force(v), rel=1e-12, abs=1e-12)

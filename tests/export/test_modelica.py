"""The Modelica package, read by pymoca's parser and run by CasADi and SUNDIALS on the equations that pymoca found."""

import re
import shutil

import numpy as np
import pytest

import stribeck
from stribeck.export import export, modelica
from stribeck.export.request import Request
from stribeck.laws import builtin, find
from tests.laws.test_claims import make

ca = pytest.importorskip("casadi")
parser = pytest.importorskip("pymoca.parser")
api = pytest.importorskip("pymoca.backends.casadi.api")

CONNECTOR = re.compile(r"connector Real(In|Out)put = (in|out)put Real [^;]*;")


@pytest.fixture(autouse=True)
def _functions(monkeypatch):
    """Two functions of Modelica that pymoca 0.12 does not know, and division as CasADi 3.8 calls it."""
    monkeypatch.setattr(ca.MX, "atan", ca.MX.arctan, raising=False)
    monkeypatch.setattr(ca.MX, "noEvent", lambda self: self, raising=False)
    monkeypatch.setattr(ca.MX, "__div__", ca.MX.__truediv__, raising=False)


def write(law, folder):
    path = folder / f"Friction{type(law).__name__}.mo"
    export(law, "modelica", path)
    return path


def read(path, name, folder):
    """A class of the package as pymoca understands it; it knows no connectors that are signals, so those are put in."""
    text = path.read_text(encoding="utf-8")
    assert len(CONNECTOR.findall(text)) == 2
    text = CONNECTOR.sub("", text).replace("RealInput ", "input Real ").replace("RealOutput ", "output Real ")
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    (folder / path.name).write_text(text, encoding="utf-8")
    return api.transfer_model(str(folder), f"{path.stem}.{name}", {})


def solved(model):
    """Every derivative and variable of the model in terms of states, inputs and parameters, from its equations alone."""
    unknown = {v.symbol.name(): v.symbol for v in (*model.der_states, *model.alg_states)}
    equations, found = list(model.equations), {}
    while equations:
        inside = [[s for s in ca.symvar(e) if s.name() in unknown] for e in equations]
        k = next(k for k, symbols in enumerate(inside) if len(symbols) == 1)  # or the equations do not determine all
        (symbol,), equation = inside[k], equations.pop(k)
        rest = ca.substitute(equation, symbol, 0)
        value = -rest / ca.substitute(ca.jacobian(equation, symbol), symbol, 0)
        found[symbol.name()] = value
        del unknown[symbol.name()]
        equations = [ca.substitute(e, symbol, value) for e in equations]
    assert not unknown
    return found


@pytest.mark.parametrize("name", builtin())
def test_block_has_the_numbers_of_the_law(name, tmp_path):
    law = make(builtin()[name])
    path = write(law, tmp_path)
    tree = parser.parse(path.read_text(encoding="utf-8"))
    assert {type(law).__name__, "Body", "RealInput", "RealOutput"} <= set(tree.classes[path.stem].classes)

    model = read(path, type(law).__name__, tmp_path / "plain")
    values = solved(model)
    parameters = {p.symbol.name(): p for p in model.parameters}
    assert {n: float(p.value) for n, p in parameters.items()} == {n: x for n, x in law.values.items() if x is not None}
    v = next(i.symbol for i in model.inputs)
    states = [s.symbol for s in model.states]
    constants = [p.symbol for p in parameters.values()]
    outputs = [values["der(z)"], values["F"]] if law.has_z else [values["F"]]
    function = ca.Function("f", [v, *states, *constants], outputs)

    rng, scales = np.random.default_rng(0), law.scales(law.p)
    speed = rng.choice([-1, 1], 200) * scales.speed * 10 ** rng.uniform(-6, 4, 200)
    z = rng.uniform(-1.2, 1.2, 200) * scales.length
    numbers = [float(p.value) for p in parameters.values()]
    for a, b in zip(speed, z, strict=True):
        got = np.array([float(x) for x in function.call([a, *([b] if law.has_z else []), *numbers])])
        wanted = [law.rate(a, b), law.force(a, b)] if law.has_z else [law.force(a)]
        size = [abs(a), abs(law.force(a, b)) + abs(law.force(a, -b))] if law.has_z else [abs(law.force(a))]
        assert np.all(abs(got - wanted) <= 1e-13 * np.array(size)), (a, b)


def test_body_sticks_and_slips_as_simulated(tmp_path):
    law = stribeck.law("lugre_majorant", "canudas1995", k_v=1e6)
    model = read(write(law, tmp_path), "Body", tmp_path / "plain")
    values = solved(model)
    x = [s.symbol for s in model.states]
    t = ca.MX.sym("t")
    constants = {p.symbol: float(p.value) for p in model.parameters}
    u = model.inputs[0].symbol
    y = next(s for s in x if s.name() == "y")
    rates = ca.vertcat(*(values[f"der({s.name()})"] for s in x))
    rates = ca.substitute([rates], [u, *constants], [2 * (0.1 * t - y), *map(ca.MX, constants.values())])[0]
    times = np.linspace(0, 20, 201)
    problem = {"x": ca.vertcat(*x), "t": t, "ode": rates}
    options = {"abstol": 1e-12, "reltol": 1e-9, "max_num_steps": 1000000}
    got = np.array(ca.integrator("body", "cvodes", problem, 0, times[1:], options)(x0=[0] * len(x))["xf"])
    position = got[[s.name() for s in x].index("y")]
    scenario = stribeck.Scenario(
        law={"name": law.name, "k_v": 1e6, "parameters": "canudas1995"},
        plant={"mass": 1.0},
        drive={"kind": "spring", "stiffness": 2.0, "signal": {"kind": "ramp", "rate": 0.1}},
        solve={"t_end": 20.0},
        output={"step": 0.1},
    )
    reference = stribeck.simulate(scenario)["y"]
    assert reference[-1] > 1
    assert np.max(abs(position - reference[1:])) < 1e-5 * reference[-1]


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


def test_awkward_names_of_a_users_law(tmp_path):
    (tmp_path / "mine.py").write_text(
        "from stribeck.constants import Constant\n"
        "from stribeck.laws import StaticLaw\n"
        "from stribeck.expressions.ops import tanh, where\n"
        'class Odd(StaticLaw):\n    """Says "hello" \\\\ and <b>."""\n'
        '    end = Constant("s/m", "a keyword of \\"Modelica\\"", above=0)\n    mass = Constant("N", "a name that is taken")\n'
        "    @staticmethod\n    def friction(p, v, z, dz_dt):\n"
        "        return where(v * v <= 1, p.mass * tanh(p.end * v), p.mass * v) - v * -2.5 + (-3.5 + v) * (-v)\n",
        encoding="utf-8",
    )
    law = find("mine.py:Odd", tmp_path)({"end": 3.0, "mass": -2.0})
    text = modelica.files(Request(law))["FrictionOdd.mo"]
    assert parser.parse(text) is not None
    path = tmp_path / "FrictionOdd.mo"
    path.write_text(text, encoding="utf-8")
    model = read(path, "Odd", tmp_path / "plain")
    function = ca.Function("f", [model.inputs[0].symbol, *(p.symbol for p in model.parameters)], [solved(model)["F"]])
    numbers = [float(p.value) for p in model.parameters]
    for v in (-2.0, -0.3, 0.4, 3.0):
        assert float(function(v, *numbers)) == pytest.approx(float(law.force(v)), rel=1e-14)

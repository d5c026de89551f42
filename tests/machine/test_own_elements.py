"""Elements of the user's own, in a file: a link, a load and a controller."""

import re
import shlex
from pathlib import Path

import numpy as np
import pytest

from stribeck import InputError, Scenario, simulate
from stribeck.cli import _status
from stribeck.machine.elements.bodies.cylinder import Piston
from stribeck.machine.elements.contacts import Factor, Raise
from stribeck.machine.elements.controllers import Compensation, Sampling
from stribeck.machine.machine import SECTIONS
from stribeck.machine.reading import family_of
from stribeck.scenario import schematic
from tests.machine.machines import assert_balanced, law, machine, push, solved
from tests.properties.nasty import constants

FILE = '''
from typing import Literal

from pydantic import Field

from stribeck.machine.element import State
from stribeck.machine.elements.bodies import Body
from stribeck.machine.elements.contacts import Contact
from stribeck.machine.elements.controllers import Controller
from stribeck.machine.elements.links import Link
from stribeck.machine.elements.loads import Load
from stribeck.machine.elements.motors import Motor
from stribeck.machine.table import quantity


class Hardening(Link):
    """A spring that hardens: stiffness d + cubic d^3, with a damper."""

    cubic: float = quantity("N/m^3", "hardening", at_least=0)

    def force(self, d, w, x=()):
        return self.stiffness * d + self.cubic * d**3 + (0.0 if self.damping is None else self.damping * w)

    def stored_energy(self, d, x=()):
        return self.stiffness * d**2 / 2 + self.cubic * d**4 / 4


class Maxwell(Link):
    """A spring with a damper in series: the damper's stretch is a state."""

    viscosity: float = quantity("N s/m", "of the damper", above=0)
    states = (State("x", "m", "stretch of the damper"),)

    def force(self, d, w, x):
        return self.stiffness * (d - x["x"])

    def rates(self, d, w, x):
        return {"x": self.stiffness * (d - x["x"]) / self.viscosity}

    def stored_energy(self, d, x):
        return self.stiffness * (d - x["x"]) ** 2 / 2


class Forgetful(Link):
    """A link whose force leaves out the argument x."""

    def force(self, d, w):
        return self.stiffness * d


class Drag(Load):
    """Air: -drag v |v|."""

    drag: float = quantity("kg/m", "drag", at_least=0)

    def force(self, r, y, v, x=()):
        return -self.drag * v * abs(v)


class Proportional(Controller):
    """u = gain (r - y) - damper v."""

    gain: float = quantity("N/m", "gain")
    damper: float = quantity("N s/m", "damping", default=1.0)

    def output(self, r, y, v, x):
        return self.gain * (r.value - y) - self.damper * v


class Heavier(Body):
    """A body that carries a load."""

    load: float = quantity("kg", "mass of the load", at_least=0)

    @property
    def heavy(self):
        return self.mass + self.load


class Oily(Contact):
    """A contact with a part of viscous friction that the law does not have."""

    oil: float = quantity("N s/m", "viscous friction", at_least=0)

    def parameters(self, a, d):
        p = super().parameters(a, d)
        return p.replaced({"sigma_2": p.sigma_2 + self.oil})


class Weak(Motor):
    """A motor whose torque is a share of K i."""

    share: float = quantity("", "share of the torque", above=0)

    def limited(self, V):
        return self.share * super().limited(V)
'''
LINK = {"from": "a", "to": "ground", "stiffness": 30.0}


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "own.py").write_text(FILE)
    return tmp_path


def rig(**sections):
    return machine({"a": {"mass": 0.5}}, contacts={"c": {"from": "a", "law": law()}}, loads={"p": push()}, **sections)


def test_a_link(folder):
    hard = {**LINK, "kind": "own.py:Hardening", "cubic": 4000.0, "damping": 0.5}
    s = solved(rig(links={"k": hard}), folder)
    d = s["a.y"]
    np.testing.assert_allclose(s["k.f"], 30 * d + 4000 * d**3 + 0.5 * s["a.v"], rtol=1e-9, atol=1e-12)
    assert_balanced(s, 1e-8)
    linear = solved(rig(links={"k": {**hard, "cubic": 0.0}}), folder)
    plain = solved(rig(links={"k": {**LINK, "damping": 0.5}}))
    np.testing.assert_allclose(linear["a.y"], plain["a.y"], rtol=0, atol=1e-8 * plain.peaks["a.y"])


def test_a_link_with_a_state(folder):
    s = solved(rig(links={"k": {**LINK, "kind": "own.py:Maxwell", "viscosity": 1e9}}), folder)
    plain = solved(rig(links={"k": LINK}))  # a damper that does not give
    np.testing.assert_allclose(s["a.y"], plain["a.y"], rtol=0, atol=1e-6 * plain.peaks["a.y"])
    soft = solved(rig(links={"k": {**LINK, "kind": "own.py:Maxwell", "viscosity": 3.0}}), folder)
    assert_balanced(soft, 1e-8)
    assert abs(soft.peaks["a.y"] - plain.peaks["a.y"]) > 0.03 * plain.peaks["a.y"]


def test_a_drawing_has_the_units_of_a_machine_that_turns(folder):
    """Also of constants that do not say what they are where it turns."""
    data = machine({"a": {"inertia": 0.5}}, links={"k": {**LINK, "kind": "own.py:Maxwell", "viscosity": 3.0}})
    assert "viscosity 3 N m s/rad" in schematic.text(Scenario(data, folder=folder, trust=True).elements, "m")


def test_a_load_and_a_controller(folder):
    data = rig(controllers={"u": {
        "kind": "own.py:Proportional", "on": "a", "gain": 90.0, "limit": 2.0,
        "signal": {"kind": "step", "time": 0.1, "value": 0.1},
    }})  # fmt: skip
    data["loads"]["air"] = {"kind": "own.py:Drag", "on": "a", "drag": 3.0}
    s = solved(data, folder)
    np.testing.assert_allclose(s["air.f"], -3 * s["a.v"] * abs(s["a.v"]), rtol=1e-12, atol=1e-300)
    expected = np.clip(90 * (s["u.r"] - s["a.y"]) - s["a.v"], -2, 2)
    np.testing.assert_allclose(s["u.u"], expected, rtol=1e-12, atol=1e-15)
    assert_balanced(s, 1e-8)
    data["controllers"]["u"]["sampling"] = {"period": 5e-3}
    assert solved(data, folder).peaks["u.u"] == 2.0


@pytest.mark.parametrize(
    ("kind", "text"),
    [
        ("own.py:Hard", "has no link 'Hard' (it has Hardening, Maxwell, Forgetful)"),
        ("own.py:Forgetful", "force must take the arguments (self, d, w, x)"),
        ("own.py:Drag", "Drag must be derived from stribeck.machine.elements's Link"),
        ("other.py:Hardening", "cannot read"),
        ("Hardening", "must be one of link"),
    ],
)
def test_mistakes(kind, text, folder):
    with pytest.raises(InputError) as error:
        Scenario(rig(links={"k": {**LINK, "kind": kind}}), folder=folder)
    assert [line.startswith("links.k.kind: ") and text in line for line in error.value.problems] == [True]


@pytest.mark.thorough
def test_the_machine_of_the_documentation(tmp_path, monkeypatch):
    """docs/reference/machines.md: its machine, its commands, its Python."""
    monkeypatch.chdir(tmp_path)
    text = (Path(__file__).parent.parent.parent / "docs" / "reference" / "machines.md").read_text(encoding="utf-8")
    toml, shell, python = (re.search(rf"```{kind}\n(.*?)```", text, re.DOTALL)[1] for kind in ("toml", "sh", "python"))
    (tmp_path / "joint.toml").write_text(toml.replace("t_end = 3.0", "t_end = 0.1"))
    for command in shell.splitlines():
        words = shlex.split(command, comments=True)
        assert words[0] == "stribeck"
        assert _status(words[1:]) == 0, command
    for name in (
        "joint/plot.svg",
        "laws/compare.svg",
        "sweep/part-000000.parquet",
        "joint.fmu",
        "mesh/lugre_majorant.c",
    ):
        assert (tmp_path / name).exists(), name
    scope: dict = {}
    exec(python.replace("t_end=3.0", "t_end=0.2"), scope)
    assert scope["ensemble"].status == ["done"] * 3


def test_the_reference_lists_every_table_and_key(monkeypatch):
    """docs/reference/elements.md, made from the schema, has each key that the reader takes, of every table."""
    monkeypatch.syspath_prepend(str(Path(__file__).parent.parent.parent / "docs" / "_ext"))
    pytest.importorskip("sphinx")
    from reference import tables

    text = "".join(tables("elements"))
    kinds = [kind for section in SECTIONS for kind in family_of(section).kinds.values() if kind is not Piston]
    for model in (*kinds, Compensation, Sampling, Raise, Factor):
        for key in model.file_keys():
            assert re.search(rf"\b{key}\b", text), f"{model.__name__}: {key}"


def test_a_body_a_contact_and_a_motor(folder):
    """A kind of each of the other families, from the same file: what each makes of the equations."""
    plain = solved(rig())
    heavier = solved(rig() | {"bodies": {"a": {"kind": "own.py:Heavier", "mass": 0.3, "load": 0.2}}}, folder)
    np.testing.assert_allclose(heavier["a.y"], plain["a.y"], rtol=0, atol=1e-9 * plain.peaks["a.y"])
    oily = rig() | {"contacts": {"c": {"from": "a", "law": law(), "kind": "own.py:Oily", "oil": 0.5}}}
    thick = law()
    thick["parameters"] = {**thick["parameters"], "sigma_2": thick["parameters"]["sigma_2"] + 0.5}
    s, t = solved(oily, folder), solved(rig() | {"contacts": {"c": {"from": "a", "law": thick}}})
    np.testing.assert_allclose(s["a.y"], t["a.y"], rtol=0, atol=1e-6 * t.peaks["a.y"])
    motor = {"on": "a", "K": 0.5, "R": 2.0, "signal": {"kind": "step", "time": 0.0, "value": 3.0}}
    weak = solved(rig(motors={"m": {**motor, "kind": "own.py:Weak", "share": 0.5}}), folder)
    half = solved(rig(motors={"m": {**motor, "signal": {"kind": "step", "time": 0.0, "value": 1.5}}}))
    np.testing.assert_allclose(weak["m.torque"], half["m.torque"], rtol=1e-9, atol=1e-12)


def test_a_law_that_does_not_say_what_it_stores_runs_without_energy_columns():
    own = {"name": f"{constants.__file__}:OwnConstants", "k": 1e3, "c": 0.0, "G": 1e-4}
    data = {
        "schema": 2, "name": "m", "bodies": {"a": {"mass": 1.0}},
        "contacts": {"c": {"from": "a", "law": own}},
        "loads": {"p": {"kind": "signal", "on": "a", "signal": {"kind": "sine", "amplitude": 0.2, "frequency": 1.0}}},
        "solve": {"t_end": 0.1}, "output": {"step": 0.01},
    }  # fmt: skip
    assert simulate(Scenario(data)).status == "done"
    data["output"]["energy"] = True
    with pytest.raises(InputError, match=r"output\.energy: true: must be false for a law without sigma_0"):
        simulate(Scenario(data))

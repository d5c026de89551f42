"""The Python side: public names with documentation, laws and scenarios as objects, what notebooks show."""

import subprocess
import sys
from html import escape

import numpy as np
import pytest

import stribeck as st

SMALL = {"law": {"name": "lugre_majorant", "parameters": "canudas1995", "k_v": 1e6}, "plant": {"mass": 1.0},
         "drive": {"kind": "force", "signal": {"kind": "sine", "amplitude": 2.0, "frequency": 1.0}},
         "solve": {"t_end": 0.2}, "output": {"step": 1e-2}}  # fmt: skip


@pytest.fixture
def law():
    return st.law("lugre_majorant", parameters="canudas1995", k_v=1e6)


def test_import_costs_nothing():
    code = "import sys, stribeck; print(len([m for m in sys.modules if m.startswith(('numpy', 'pydantic', 'scipy'))]))"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "0\n"


def test_a_law_is_an_object(law):
    assert law == st.law("lugre_majorant", parameters="canudas1995", k_v=1e6)
    assert eval(repr(law), {"law": st.law}) == law
    other = law.replace(F_s=2.0)
    assert (other.p.F_s, law.p.F_s) == (2.0, 1.5)
    assert other != law
    assert other.replace(F_s=1.5) == law
    assert hash(other.replace(F_s=1.5)) == hash(law)
    assert law.replace(v_d=0.1).replace(v_d=None) == law
    assert law != st.law("lugre_sobczyk", parameters="canudas1995", k_v=1e6)
    assert law != "lugre_majorant"
    turning = st.law("lugre_majorant", parameters="canudas1995", k_v=1e6, rotary=True)
    assert turning != law
    assert turning.replace(F_s=2.0).replace(F_s=1.5) == turning == eval(repr(turning), {"law": st.law})
    assert len({law, turning}) == 2
    assert st.law("lugre", parameters="olsson1998").rotary


def test_a_law_as_a_table(law):
    table = law.to_dict()
    assert table["name"] == "lugre_majorant"
    assert table["parameters"]["v_s"] == 1e-3
    assert st.Scenario(**{**SMALL, "law": table}).law == st.Scenario(**{**SMALL, "law": law}).law == law
    own = {n: x for n, x in table.items() if n not in ("name", "parameters")}
    assert st.law(table["name"], table["parameters"], **own) == law


def test_a_scenario_does_not_change(law):
    scenario = st.Scenario(**{**SMALL, "law": law})
    for name in ("law", "data", "solve", "rig", "mine"):
        with pytest.raises(AttributeError, match="does not change"):
            setattr(scenario, name, None)
    other = scenario.replace({"law.parameters.F_s": 2.0})
    assert (other.law.p.F_s, scenario.law.p.F_s) == (2.0, 1.5)
    assert other.replace({"law.parameters.F_s": 1.5}) == scenario != other
    assert len({scenario, other, other.replace({"law.parameters.F_s": 1.5})}) == 2
    assert repr(scenario) == "<Scenario scenario: law lugre_majorant, t_end 0.2 s>"
    assert scenario.replace({"law": law.replace(F_c=0.9)}).law.p.F_c == 0.9
    machine = st.Machine(st.Body("a", mass=1.0), st.Contact("c", "a", law))
    with pytest.raises(AttributeError, match="does not change"):
        machine.name = "other"
    assert machine.replace({"contacts.c.law": law.replace(F_c=0.9)}).scenario(1.0).law.p.F_c == 0.9


def test_sweep(tmp_path, law):
    result = st.sweep(SMALL, {"law.parameters.F_s": [1.5, 2.0]}, tmp_path / "one", summary=True)
    assert result.parts == 1
    assert result.files == [str(tmp_path / "one" / name) for name in ("_manifest.json", "part-000000.parquet")]
    machine = st.Machine(
        st.Body("a", mass=1.0), st.Contact("c", "a", law), st.Load.follow("p", "a", st.signals.Sine(2.0, 1.0))
    )
    varied = {"bodies.a.mass": [0.5, 1.0, 2.0]}
    assert len(st.sweep(machine, varied, tmp_path / "two", t_end=0.1, step=0.01).lanes) == 3


def test_a_fit_as_a_table(law):
    v = np.concatenate([np.linspace(0.002, 0.05, 60), -np.linspace(0.002, 0.05, 60)]).repeat(10)
    random = np.random.default_rng(1)
    F = law.steady_force(v) + 0.01 * random.standard_normal(len(v))
    t = 1e-3 * np.arange(len(v))
    fit = st.fit({"t": t, "v": v, "F": F}, "coulomb_viscous", time="t", velocity="v", force="F", mass=0.0)
    assert isinstance(fit, st.Fit)
    html = fit._repr_html_()
    assert html == f"<pre>{escape(str(fit))}</pre>"
    assert "F_c" in html
    assert repr(fit).startswith("<LogFit of the record: coulomb_viscous, relative residual ")
    assert "array" not in repr(fit)


WRONG = (None, 1, 1.5, True, b"x", [], object())


@pytest.mark.parametrize("given", WRONG, ids=[type(x).__name__ for x in WRONG])
def test_arguments_of_a_wrong_kind_are_named(given, tmp_path):
    rows = {"t": [0.0, 1.0], "y": [0.0, 1.0], "F": [0.0, 1.0]}
    calls = [
        lambda: st.load(given), lambda: st.Fit.load(given), lambda: st.import_("bam", given),
        lambda: st.import_(given, "x"), lambda: st.fit(given), lambda: st.fit(rows, given),
        lambda: st.export(st.law("lugre", "canudas1995"), given, tmp_path / "x"), lambda: st.new(given, tmp_path / "x"),
    ]  # fmt: skip
    beside_none = [lambda: st.simulate(SMALL, vary=given), lambda: st.explore(given, tmp_path / "x")]
    calls += [] if given is None else beside_none
    for call in calls:
        with pytest.raises(st.InputError):
            call()
    assert not list(tmp_path.iterdir())

"""Every law in every target that can be compiled, alone and in a machine: run, and as the simulation has it."""

import numpy as np
import pytest

import stribeck
from stribeck import Scenario
from stribeck.laws import builtin
from tests.exports.harness import law, need, output_of
from tests.machine.machines import machine, push

pytestmark = pytest.mark.thorough
LAWS = [name for name in builtin() if name != "none"]


def rig(name):
    """A body that a force moves to and fro, with this law of Table 1 on a smooth sign."""
    chosen = law(name, **({"k_v": 1e3} if "k_v" in builtin()[name].constants() else {}))
    if name == "stribeck":  # its sign is exact otherwise, and a body cannot come to rest
        chosen = chosen.replace(k_v=1e3)
    contacts = {"rub": {"from": "a", "law": chosen}}
    return Scenario(machine({"a": {"mass": 1.0}}, 0.4, energy=False, contacts=contacts, loads={"push": push(2.5, 3.0)}))


def close(found, exact):
    for name in ("a.y", "a.v", "rub.F"):
        assert np.abs(found[name] - exact[name]).max() <= 2e-4 * np.abs(exact[name]).max(), name


@pytest.mark.parametrize("name", LAWS)
def test_c(name, tmp_path):
    stribeck.export(law(name), "c", tmp_path / "law", self_test=True)
    assert "all checks passed" in output_of(tmp_path / "law", f"{name}.c", f"{name}_test.c", flags=("-O1",))
    scenario = rig(name)
    stribeck.export(scenario, "c", tmp_path / "machine")
    text = output_of(tmp_path / "machine", *(tmp_path / "machine").glob("*.c"), flags=("-O1",)).splitlines()
    rows = np.array([[float(x) for x in line.split(",")] for line in text[1:]]).T
    close(dict(zip(text[0].split(","), rows, strict=True)), stribeck.simulate(scenario))


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("name", LAWS)
def test_fmu(name, fmi, tmp_path):
    need("gcc")
    fmpy = pytest.importorskip("fmpy", reason="fmpy is not installed")
    (path,) = stribeck.export(law(name), "fmu", tmp_path / "law.fmu", fmi=fmi)
    solution = fmpy.simulate_fmu(str(path), stop_time=0.2, step_size=1e-3, start_values={"v": 1e-3}, output=["F"])
    assert solution["F"][-1] == pytest.approx(float(law(name).steady_force(1e-3)), rel=1e-3)
    scenario = rig(name)
    (path,) = stribeck.export(scenario, "fmu", tmp_path / "machine.fmu", fmi=fmi)
    exact = stribeck.simulate(scenario)
    times = {"stop_time": scenario.end, "output_interval": scenario.output.step}
    close(fmpy.simulate_fmu(str(path), **times, output=["a.y", "a.v", "rub.F"]), exact)

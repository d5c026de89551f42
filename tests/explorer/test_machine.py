"""Pages of machines: the modules against ``run`` at the file's numbers and after sliders were turned."""

import json
import re

import numpy as np
import pytest

pytest.importorskip("wasmtime")
pytest.importorskip("bokeh")

from stribeck import Scenario, examples, simulate
from stribeck.explorer import explore
from stribeck.explorer.measured import arrays_of, measured, moved
from tests.explorer.module import MachineModule
from tests.machine.test_servo import MACHINE as PISTON

TURNED = {
    "belt": {"contacts.sole.law.parameters.F_s": 6.5, "bodies.belt.velocity.signal.rate": 0.06, "links.spring.stiffness": 300.0},
    "arm": {
        "controllers.axis.K_v": 0.025, "controllers.axis.signal.value.1": 40.0, "controllers.axis.sampling.delay": 3e-4,
        "loads.gravity.amplitude": 3.0, "contacts.seal.factors.level.amplitude.0": 0.2,
    },
    "servo": {"law.parameters.F_s": 44.0, "drive.K_p": 48.0, "plant.mass": 3.3, "drive.observer.k_v": 1.2e6},
    "sine_force": {"law.k_v": 2e6, "drive.signal.value.2": 2.9, "plant.mass": 1.2},
}  # fmt: skip
CHANGES = {
    "belt": {"solve.t_end": 2.0},
    "servo": {"drive.sample_time": 1e-3, "drive.delay": 5e-4, "drive.quantization": 1e-6, "drive.bandwidth": 500.0},
    "sine_force": {"drive.signal": {"kind": "spline", "t": [0.0, 0.1, 0.2, 0.4], "value": [0.0, 1.0, 3.0, 0.0]}},
}


@pytest.fixture(scope="module", params=sorted(TURNED))
def page(request, tmp_path_factory):
    usual = {"solve.rtol": 1e-10, "solve.t_end": 0.4}
    scenario = Scenario.load(examples.path(request.param), usual | CHANGES.get(request.param, {}))
    out = explore(scenario, tmp_path_factory.mktemp("page") / "page.html", command="stribeck explore")
    text = out.read_text(encoding="utf-8")
    result = re.search(r'<script type="application/json" id="data">(.*?)</script>', text, re.S)[1]
    return scenario, json.loads(result), TURNED[request.param], len(text)


def same(shown, solution):
    for name, peak in solution.peaks.items():
        assert np.max(abs(shown[name] - solution[name])) <= 1e-9 * peak, name


@pytest.mark.share(2)
def test_the_page_computes_what_run_computes(page):
    scenario, data, turned, size = page
    module = MachineModule(data)
    assert module.imports == []
    assert size < 1.5e6
    same(module.run_machine({}), simulate(scenario))
    same(MachineModule(data).run_machine(turned), simulate(scenario.with_changes(turned)))


@pytest.mark.share(5)
@pytest.mark.parametrize("name", ["belt", "arm", "gear", "machine", "servo", "piston"])
def test_numbers_turned_together_do_what_the_file_says(name):
    result = measured(Scenario(PISTON) if name == "piston" else Scenario.load(examples.path(name)))
    numbers = [n for n in result.numbers if n.group not in ("solve", "output")]
    values = {n.path: n.value + 0.05 * (n.high - n.value) for n in numbers}
    assert len(numbers) > 9
    shown, reported = moved(result.arrays, numbers, values), arrays_of(result.scenario.with_changes(values))
    for array in set(reported) - {"atol", "fixed_atol"}:  # which stays that of the file
        assert shown[array] == pytest.approx(reported[array], rel=1e-12, abs=1e-300), array


def test_the_numbers_of_a_set_have_sliders():
    path = "contacts.sole.law.parameters"
    result = measured(Scenario.load(examples.path("belt"), {path: "canudas1995"}))
    assert {f"{path}.{n}" for n in ("F_c", "F_s", "sigma_0", "v_s")} <= {number.path for number in result.numbers}


def test_numbers_that_move_more_than_a_number_stay():
    result = measured(Scenario.load(examples.path("arm"), {"controllers.axis.sampling.delay": 9e-4}))
    free = {n.path for n in result.numbers}
    assert "controllers.axis.signal.value.1" in free
    assert {n.path: n.unit for n in result.numbers}["bodies.rotor.initial.v"] == "rad/s"
    assert {"controllers.axis.signal.t.0", "controllers.axis.signal.t.1"} <= set(result.fixed)  # other polynomials
    sampling = {f"controllers.axis.sampling.{n}" for n in ("period", "delay")}  # together they ask for a longer queue
    assert len(sampling & free) == len(sampling & set(result.fixed)) == 1

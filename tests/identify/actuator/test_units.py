"""The unit of a fitted number is that of what it is in the machine."""

import csv

import numpy as np
import pytest

from stribeck import Scenario
from stribeck.identify.actuator import fit_machine
from stribeck.identify.actuator.coordinates import MachineCoordinate
from stribeck.identify.actuator.judge import unit
from tests.identify.actuator.recorded import body, logs
from tests.identify.actuator.test_lacks import NOISE, TRUTH, T, arm, pushed, turned

LAW = "contacts.{}.law.parameters.{}"
OF_BODY = {
    "bodies.a.mass": "kg", "bodies.a.initial.y": "m", "bodies.a.initial.v": "m/s",
    LAW.format("guide", "F_c"): "N", LAW.format("guide", "sigma_0"): "N/m", LAW.format("guide", "v_s"): "m/s",
}  # fmt: skip
OF_ARM = {
    "bodies.arm.inertia": "kg m^2", "bodies.arm.initial.y": "rad", "bodies.arm.initial.v": "rad/s",
    LAW.format("joint", "F_c"): "N m", LAW.format("joint", "sigma_2"): "N m s/rad",
}  # fmt: skip
OF_SENSOR = {"offset": ("m", "rad"), "gain": ("1", "1"), "delay": ("s", "s"), "clock": ("s/s", "s/s"), "?": ("", "")}


def coordinate(name, output=None):
    return MachineCoordinate(name, 0.1, 1.0, targets={name: 1.0}, output=output)


@pytest.mark.parametrize(("data", "units"), [(body(), OF_BODY), (arm(), OF_ARM)], ids=["body", "arm"])
def test_a_number_of_the_machine_or_of_a_sensor(data, units):
    scenario = Scenario(data)
    assert {name: unit(scenario, coordinate(name)) for name in units} == units
    assert unit(scenario, coordinate("bodies.nobody.mass")) == ""
    name = next(iter(data["bodies"]))
    of_sensor = {what: unit(scenario, coordinate("s", (f"{name}.y", what))) for what in OF_SENSOR}
    assert of_sensor == {what: texts[name == "arm"] for what, texts in OF_SENSOR.items()}


def test_an_angle_that_begins_anew_after_each_turn_goes_on(tmp_path):
    u = pushed(4.0)
    y = np.rad2deg(turned(u) + NOISE * np.random.default_rng(0).standard_normal(len(T)))
    assert np.ptp(y) > 360
    with (tmp_path / "run.csv").open("w", newline="") as file:
        csv.writer(file).writerows([("t", "u", "y"), *zip(T, u, np.round(y % 360, 2), strict=True)])
    of = {"file": "run.csv", "outputs": {"arm.y": {"column": "y", "unit": "deg"}}}
    wanted = {name: {"low": x / 5, "high": 5 * x} for name, x in TRUTH.items()}
    fitted = fit_machine(arm(), logs(tmp_path, [of], wanted), starts=1, baselines=False)
    assert fitted.status == "done", fitted.reason
    assert [name for name, p in fitted.estimates.items() if not p.low < TRUTH[name] < p.high] == []
    assert any("run.csv: arm.y wraps after each turn" in note for note in fitted.notes)

"""stribeck fit MACHINE.toml --logs LOGS.toml."""

import json
import tomllib
from dataclasses import replace

import pytest
import tomli_w

from stribeck import Fit, InputError, Scenario, predict, simulate
from stribeck.identify.said import HEAD
from tests.identify.actuator.recorded import body, logs, record
from tests.pages import Page

F_C, MASS = "contacts.guide.law.parameters.F_c", "bodies.a.mass"


def test_the_command_writes_a_machine_that_runs(stribeck, tmp_path):
    record(tmp_path / "run.csv", body(amplitude=5.0))
    path = logs(tmp_path, ["run.csv"], {F_C: {"low": 2.0, "high": 10.0}})
    (tmp_path / "axis.toml").write_text(tomli_w.dumps(body(mass=1.5)))
    sought = ("--unknown", f"{F_C}=0.1:10", "--unknown", f"{MASS}={{ low = 0.2, high = 5, start = 2 }}")
    command = "fit", tmp_path / "axis.toml", "--logs", path, *sought, "--starts", "2", "--out", tmp_path / "out"
    done = stribeck(*command, "--json")
    assert done.status == 0, done.err
    found = json.loads(done.out)
    assert list(found["parameters"]) == [F_C, MASS]
    assert all(p["low"] < 1.0 < p["high"] for p in found["parameters"].values()), found
    page = Page(tmp_path / "out" / "report.html")
    shown = page.rows(HEAD)
    mass = found["parameters"][MASS]
    assert float(shown[MASS][0]) == pytest.approx(mass["value"], abs=0.1 * (mass["high"] - mass["low"]))
    assert shown[MASS][-2:] == ["kg", "identified"]
    (level,) = (name for name in shown if name.startswith("guide level half ("))
    assert level.endswith(" mm/s)")
    assert shown[level][-2:] == ["N", "identified"]
    assert "run.csv" in page.rows(["recording"])
    kept = tomllib.loads((tmp_path / "out" / "parameters.toml").read_text())
    assert kept["parameters"][MASS]["state"] == "identified"
    assert kept["levels"]["guide level half"]["speed"] > 0
    read = Fit.load(tmp_path / "out")
    assert read[MASS].interval == (mass["low"], mass["high"])
    assert read["F_c"] is read.parameters[F_C]
    assert read.error(False) == found["error"]["fitted"]
    assert read.machine.data["bodies"]["a"]["mass"] == mass["value"]
    with pytest.raises(InputError, match="it holds no recording"):
        read.plot()
    with pytest.raises(InputError, match="fit: stopped: there is no machine with these numbers"):
        _ = replace(read, status="stopped", data={}).machine
    assert simulate(Scenario.load(tmp_path / "out" / "machine.toml")).status == "done"
    with pytest.raises(InputError, match="as machine"):
        predict(tmp_path / "run.csv", fit=read)

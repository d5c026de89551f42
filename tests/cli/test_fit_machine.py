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
WANTED = {F_C: {"low": 0.1, "high": 10.0}, MASS: {"low": 0.2, "high": 5.0}}


def test_the_command_writes_a_machine_that_runs(stribeck, tmp_path):
    record(tmp_path / "run.csv", body(amplitude=5.0))
    path = logs(tmp_path, ["run.csv"], WANTED)
    (tmp_path / "axis.toml").write_text(tomli_w.dumps(body(mass=1.5)))
    command = "fit", tmp_path / "axis.toml", "--logs", path, "--starts", "2", "--out", tmp_path / "out"
    done = stribeck(*command, "--json")
    assert done.status == 0, done.err
    found = json.loads(done.out)
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


def test_the_command_refuses_what_it_cannot_take(stribeck, tmp_path):
    (tmp_path / "axis.toml").write_text(tomli_w.dumps(body()))
    done = stribeck("fit", tmp_path / "axis.toml", "--logs", tmp_path / "none.toml", "--out", tmp_path / "out")
    assert done.status == 2
    assert "none.toml" in done.err
    assert not list((tmp_path / "out").iterdir() if (tmp_path / "out").exists() else [])


def test_what_is_sought_may_stand_on_the_command_line(stribeck, tmp_path):
    record(tmp_path / "run.csv", body(amplitude=5.0))
    logs(tmp_path, ["run.csv"], {F_C: {"low": 2.0, "high": 10.0}})
    (tmp_path / "axis.toml").write_text(tomli_w.dumps(body(mass=1.5)))
    sought = ["--unknown", f"{F_C}=0.1:10", "--unknown", f"{MASS}={{ low = 0.2, high = 5, start = 2 }}"]
    done = stribeck("fit", tmp_path / "axis.toml", "--logs", tmp_path / "logs.toml", *sought, "--starts", "1", "--json")
    assert done.status == 0, done.err
    found = json.loads(done.out)["parameters"]
    assert list(found) == [F_C, MASS]
    assert all(p["low"] < 1.0 < p["high"] for p in found.values()), found


def test_what_cannot_be_sought_is_told_on_a_line_each(stribeck, tmp_path):
    record(tmp_path / "run.csv", body(amplitude=5.0))
    path = logs(tmp_path, [{"file": "run.csv", "hold_out": True}], WANTED)
    (tmp_path / "axis.toml").write_text(tomli_w.dumps(body()))
    for given, wanted in [
        (["a.b"], ["--unknown: 'a.b': must be PATH=LOW:HIGH, or PATH={ low = X, high = X, start = X }"]),
        (
            [f"{MASS}=2:1", f"{F_C}={{ low = 1, hihg = 2 }}"],
            [
                f"--unknown {MASS}.high: 1.0: must be > low (2.0)",
                f"--unknown {F_C}.hihg: 2: unknown key (did you mean 'high'?)",
            ],
        ),
        ([f"{MASS}=1:2", f"{MASS}=1:3"], [f"--unknown {MASS}: given 2 times; must be given once"]),
    ]:
        options = [word for x in given for word in ("--unknown", x)]
        logs(tmp_path, ["run.csv"], WANTED)
        done = stribeck("fit", tmp_path / "axis.toml", "--logs", path, *options, "--out", tmp_path / "out")
        assert (done.status, done.out) == (2, "")
        assert done.err.splitlines() == wanted
    logs(tmp_path, [{"file": "run.csv", "hold_out": True}], {})
    done = stribeck("fit", tmp_path / "axis.toml", "--logs", path, "--unknown", f"{MASS}=1:2")
    assert (done.status, done.err.strip()) == (2, "log.0.hold_out: true: at least one recording must be for fitting")
    assert not (tmp_path / "out").exists()


def test_units_and_names_that_do_not_fit_the_machine(stribeck, tmp_path):
    """A unit of another quantity was taken without a word, and the machine then followed nothing."""
    record(tmp_path / "run.csv", body(amplitude=5.0))
    (tmp_path / "axis.toml").write_text(tomli_w.dumps(body()))
    y, u = {"column": "y", "unit": "deg"}, {"column": "u", "unit": "rpm"}
    wrong = {"file": "run.csv", "outputs": {"a.y": y}, "inputs": {"loads.push.signal": u}}
    lost = {"file": "run.csv", "inputs": {"loads.pull.signal": "u"}}
    good = {
        "file": "run.csv",
        "outputs": {"a.y": {**y, "gain": 0.1}},
        "inputs": {"loads.push.signal": {"column": "u", "unit": "kN"}},
    }
    sought = {"outputs.a.y.gian": {"low": 0.5, "high": 2.0}}
    path = logs(tmp_path, [wrong, lost, good], WANTED | sought)
    done = stribeck("fit", tmp_path / "axis.toml", "--logs", path, "--out", tmp_path / "out")
    assert (done.status, done.out) == (2, "")
    assert done.err.splitlines() == [
        "log.0.outputs.a.y.unit: 'deg': must be a unit of m, or stand with a gain that turns it into m",
        "log.0.inputs.loads.push.signal.unit: 'rpm': must be a unit of N, or stand with a gain that turns it into N",
        "log.1.inputs.loads.pull.signal: no signal of the machine (did you mean 'loads.push.signal'?)",
        "unknown.outputs.a.y.gian: gian: must be offset, gain, delay, clock of a sensor",
    ]
    assert not (tmp_path / "out").exists()

"""stribeck fit MACHINE.toml --logs LOGS.toml."""

import json
import tomllib

import tomli_w

from stribeck import Scenario, simulate
from tests.identify.actuator.recorded import body, logs, record
from tests.pages import Page

F_C, MASS = "contacts.guide.law.parameters.F_c", "bodies.a.mass"
WANTED = {F_C: {"low": 0.1, "high": 10.0}, MASS: {"low": 0.2, "high": 5.0}}


def test_the_command_writes_a_machine_that_runs_and_says_what_moved_elsewhere(stribeck, tmp_path):
    record(tmp_path / "run.csv", body(amplitude=5.0))
    record(tmp_path / "other.csv", body(amplitude=5.0, F_c=1.2, F_s=1.3), seed=3)
    path = logs(tmp_path, ["run.csv"], WANTED)
    other = tmp_path / "other.toml"
    other.write_text(path.read_text().replace("run.csv", "other.csv"))
    (tmp_path / "axis.toml").write_text(tomli_w.dumps(body(mass=1.5)))
    command = (
        "fit",
        tmp_path / "axis.toml",
        "--logs",
        path,
        "--transfer",
        other,
        "--starts",
        "2",
        "--out",
        tmp_path / "out",
    )
    done = stribeck(*command, "--json")
    assert done.status == 0, done.err
    found = json.loads(done.out)
    assert [m["name"] for m in found["transfer"]["moved"]] == [F_C]
    assert found["transfer"]["same"] == [MASS]
    page = Page(tmp_path / "out" / "report.html")
    shown = page.rows(["number", "value", "95 % from", "to", "unit", "verdict"])
    assert shown[MASS][0] == f"{found['parameters'][MASS]['value']:.6g}"
    assert shown[MASS][-2:] == ["kg", "found"]
    (moved,) = page.rows(["number", "here", "there"])
    assert moved == F_C
    assert "run.csv" in page.rows(["recording"])
    kept = tomllib.loads((tmp_path / "out" / "parameters.toml").read_text())
    assert kept["parameters"][MASS]["verdict"] == "found"
    assert simulate(Scenario.load(tmp_path / "out" / "machine.toml")).status == "done"


def test_the_command_refuses_what_it_cannot_take(stribeck, tmp_path):
    (tmp_path / "axis.toml").write_text(tomli_w.dumps(body()))
    done = stribeck("fit", tmp_path / "axis.toml", "--logs", tmp_path / "none.toml", "--out", tmp_path / "out")
    assert done.status == 2
    assert "none.toml" in done.err
    assert not list((tmp_path / "out").iterdir() if (tmp_path / "out").exists() else [])

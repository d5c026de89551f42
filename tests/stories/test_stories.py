"""What README promises to each kind of reader: three commands, and the numbers that they give."""

import json
import re
import tomllib

import pytest

from stribeck.cli import _status
from tests.shared import SHARED

SERVO = SHARED / "data" / "servo-motor"


@pytest.fixture(autouse=True)
def in_a_folder_of_its_own(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def run(command):
    words = command.split()
    assert words[0] == "stribeck"
    assert _status(words[1:]) == 0, command


def test_a_law_is_compared_proved_and_shipped(tmp_path, capsys):
    """The researcher's story: the paper's law slips as LuGre does, and returns more energy than it took."""
    run("stribeck new stick-slip")
    run("stribeck run stick-slip.toml --law lugre --law lugre_sobczyk --out laws --json")
    run("stribeck check lugre_sobczyk --parameters canudas1995 --set k_v=1e7 --out proofs")
    run("stribeck export lugre_majorant --parameters canudas1995 --set k_v=1e6 --target c --self-test --out firmware")
    assert (tmp_path / "laws" / "compare.svg").exists()
    assert (tmp_path / "firmware" / "lugre_majorant_test.c").exists()
    run("stribeck run proofs/passive.toml --json")
    *_, replayed = (line for line in capsys.readouterr().out.splitlines() if line.startswith("{"))
    assert json.loads(replayed)["final"]["E_in"] < 0


@pytest.mark.thorough
def test_an_axis_is_found_to_hunt_and_its_controller_shipped(tmp_path, capsys):
    """The servo engineer's story: the integral winds up behind friction; with less of it the axis comes to rest."""
    run("stribeck new axis-hunts")
    capsys.readouterr()
    run("stribeck design axis-hunts.toml --json")
    verdict = json.loads(capsys.readouterr().out)
    assert verdict["verdict"] == "hunting"
    run("stribeck design axis-hunts.toml --set controllers.axis.K_i=2e4 --json")
    assert json.loads(capsys.readouterr().out)["verdict"] == "quiet"
    run("stribeck export axis-hunts.toml --part controller --target c --out drive")
    assert re.search(r"axis_hunts_axis_step\(", (tmp_path / "drive" / "axis_hunts_axis.h").read_text())


TRUTH = {
    "bodies.joint.inertia": 0.03, "loads.gravity.amplitude": 1.5, "contacts.gearbox.law.parameters.F_c": 0.12,
    "contacts.gearbox.law.parameters.sigma_2": 0.06, "contacts.gearbox.loads.0.F_c": 0.08,
}  # fmt: skip


@pytest.mark.thorough
def test_a_joint_is_fitted_and_put_into_a_simulator(tmp_path, capsys):
    """The roboticist's story: friction that grows with the gearbox's torque is found, and goes along."""
    run("stribeck new joint-from-log")
    capsys.readouterr()
    run("stribeck fit joint-from-log.toml --logs joint-from-log.logs.toml --out fit --json")
    parameters = json.loads(capsys.readouterr().out)["parameters"]
    for name, value in TRUTH.items():
        assert parameters[name]["low"] <= value <= parameters[name]["high"], name
        assert parameters[name]["value"] == pytest.approx(value, rel=0.01), name
    machine = tomllib.loads((tmp_path / "fit" / "machine.toml").read_text())
    assert machine["contacts"]["gearbox"]["loads"][0]["F_c"] == pytest.approx(0.08, rel=0.01)
    run("stribeck export fit/machine.toml --contact gearbox --target mujoco --out joint")
    assert any("0.0799" in file.read_text() for file in (tmp_path / "joint").iterdir())


@pytest.mark.thorough
@pytest.mark.skipif(not SERVO.is_dir(), reason="needs shared/data/servo-motor, which is not part of the project")
def test_the_log_of_a_closed_loop_becomes_a_compensator(tmp_path, capsys):
    """2000 counts a turn at 1 kHz: what the log does not determine is given, and the rest is the fit's."""
    run(
        f"stribeck fit {SERVO / 'closed.csv'} --time t --position theta --unit theta=rad --force i --force-gain 0.05 --out fit"
    )
    document = json.loads((tmp_path / "fit" / "fit.json").read_text())["estimates"]
    truth = {"F_c": 0.02, "F_s": 0.03, "v_s": 1.0, "sigma_2": 1e-4, "mass": 5e-5}
    open_ = [n for n in truth if document[n]["state"] == "not identifiable"]
    for name in (n for n in truth if n not in open_):
        assert document[name]["range"][0] <= truth[name] <= document[name]["range"][1], name
    assert {"F_c", "F_s", "mass"}.isdisjoint(open_)
    sharp = "" if "k_v" in document else "k_v = 1e3,"
    (tmp_path / "servo.toml").write_text(f"""
schema = 2
[bodies.rotor]
inertia = {document["mass"]["value"]}
[contacts.bearing]
from = "rotor"
law = {{ name = "stribeck", {sharp} parameters = "fit/parameters.toml" }}
[controllers.axis]
on = "rotor"
measures = "rotor"
kind = "pid"
K_p = 0.5
K_d = 5e-3
signal = {{ kind = "sine", amplitude = 1.0, frequency = 1.0 }}
sampling = {{ period = 1e-3, delay = 5e-4, resolution = 3.14159e-3 }}
compensation = {{ contact = "bearing", speed = "reference" }}
[solve]
t_end = 4.0
[output]
step = 1e-3
""")
    if document.get("k_v", {}).get("state") == "not identifiable":
        open_, truth = [*open_, "k_v"], {**truth, "k_v": 1e3}
    own = " ".join(f"--set contacts.bearing.law.parameters.{n}={truth[n]}" for n in open_ if n != "mass")
    run(f"stribeck design servo.toml {own}")
    assert "QUIET" in capsys.readouterr().out
    run(f"stribeck export servo.toml --part compensator --step 1e-3 --target c --self-test {own} --out firmware")
    assert (tmp_path / "firmware" / "servo_axis_friction_test.c").exists()

"""What README promises to each kind of reader: three commands, and the numbers that they give."""

import json
import tomllib

import pytest

from stribeck.cli import _status


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

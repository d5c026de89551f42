"""``stribeck check --level`` and of a machine, from the command line."""

import json

import pytest

from stribeck import Scenario, simulate
from tests.pages import Page
from tests.properties.test_ports import DAMPED, PASSIVE, machine

tomli_w = pytest.importorskip("tomli_w")


def test_a_level_with_its_files(stribeck, tmp_path):
    out, proofs = tmp_path / "found", tmp_path / "proofs.json"
    result = stribeck(
        "check", "lugre", "--parameters", "canudas1995", "--level", "1:2", "--verify", "--json",
        "--out", out, "--certificate", proofs,
    )  # fmt: skip
    assert result.status == 0, result.err
    data = json.loads(result.out)
    assert data["level"] == {"F_c": [1.0, 2.0], "F_s": [1.5, 3.0]}
    passive = data["properties"]["passive"]
    assert passive["holds"] is False
    assert passive["verified"] is True
    assert passive["evidence"]["sigma_2_needed"] == pytest.approx(2 * 1e5**0.5)
    solution = simulate(Scenario.load(out / "passive.toml"))
    assert solution.final["E_in"] == pytest.approx(-passive["evidence"]["energy_drawn"], rel=1e-9)
    assert Page(out / "report.html").rows(["property", "meaning", "holds"])["passive"][1] == "no"
    certificates = json.loads(proofs.read_text())["certificates"]
    assert certificates["bounded"]["level"]["F_c"] == ["1", "2"]


def test_a_machine_with_its_files(stribeck, tmp_path):
    file, out = tmp_path / "two.toml", tmp_path / "found"
    loads = [{"force": "gear", "F_c": 0.1, "F_s": 0.2}]
    file.write_text(tomli_w.dumps(machine(loads=loads)))
    result = stribeck("check", file, "--json", "--out", out)
    assert result.status == 0, result.err
    data = json.loads(result.out)
    assert data["machine"]["spoiled_by"] == ["mesh"]
    assert data["machine"]["passive"] is None
    assert data["contacts"]["mesh"]["ranges"] == {"F_c": [1.0, None], "F_s": [1.5, None]}
    assert simulate(Scenario.load(out / "mesh_passive.toml")).final["E_in"] < 0
    shown = Page(out / "report.html").rows(["contact", "law", "what varies", "passive"])
    assert shown["mesh"][-1] == "no"
    again = stribeck("check", file, "--force", "gear=20", "--set", "contacts.mesh.law.name=lugre")
    assert "passive at its ports (proved)" in " ".join(again.out.split())
    file.write_text(tomli_w.dumps(machine(DAMPED, loads=loads)))
    assert "passive at its ports (proved)" in " ".join(stribeck("check", file).out.split())


def test_passive_constants_are_passive(stribeck):
    """The set of the tests is passive at a level that is held, and as far as sigma_2 reaches."""
    values = [f"--set={n}={x}" for n, x in PASSIVE.items()]
    assert (
        '"holds": true'
        in stribeck("check", "lugre", *values, "--level", "1:4.66", "--json").out.partition("passive")[2]
    )

"""The pages that commands leave beside their numbers: what they show."""

import json

from stribeck import examples
from tests.pages import Page


def test_run(stribeck, scenario, tmp_path):
    data = json.loads(stribeck("run", scenario, "--out", tmp_path / "out", "--json").out)
    assert {p.name for p in (tmp_path / "out").iterdir()} == {
        "trajectory.csv", "trajectory.parquet", "plot.svg", "report.html", "summary.json"
    }  # fmt: skip
    page = Page(tmp_path / "out" / "report.html")
    rows = {row[0]: row for row in page.tables[0]}
    assert rows["F"][1:] == [f"{data['peaks']['F']:.4g}", f"{data['final']['F']:.4g}", "N", "friction force"]
    assert page.headings == ["1. Result", "2. Plots", "3. The law lugre_sobczyk", "4. The scenario"]


def test_compare(stribeck, scenario, tmp_path):
    words = ("run", scenario, "--law", "lugre", "--law", "dahl", "--out", tmp_path / "out", "--json")
    data = json.loads(stribeck(*words).out)
    rows = {row[0]: row for row in Page(tmp_path / "out" / "report.html").tables[0]}
    assert rows["dahl"][1:3] == ["y", f"{data['laws']['dahl']['deviations']['y']['max'] * 1e3:.4g} mm"]


def test_check(stribeck, tmp_path):
    words = ("check", "lugre_sobczyk", "--parameters", "canudas1995", "--set", "k_v=1e7", "--out", tmp_path / "out")
    data = json.loads(stribeck(*words, "--json").out)
    assert str(tmp_path / "out" / "report.html") in data["report"]
    page = Page(tmp_path / "out" / "report.html")
    holds = {row[0]: row[2] for row in page.tables[0]}
    for name, verdict in data["properties"].items():
        assert holds[name.replace("_", "-")] == {True: "yes", False: "no", None: "undecided"}[verdict["holds"]]
    assert (tmp_path / "out" / "not_passive.svg").exists()


def test_the_design_of_a_servo(stribeck, tmp_path):
    words = ("design", examples.path("servo"), "--set", "solve.t_end=1", "--out", tmp_path / "out", "--json")
    data = json.loads(stribeck(*words).out)
    assert json.loads((tmp_path / "out" / "summary.json").read_text())["files"] == data["files"]
    rows = {row[0]: row for row in Page(tmp_path / "out" / "report.html").tables[0]}
    assert rows["exact condition"][1] == ("yes" if data["exact"]["holds"] else "no")

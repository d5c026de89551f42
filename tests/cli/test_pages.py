"""The pages that commands leave beside their numbers: what they show."""

import csv
import json

import pyarrow.parquet as parquet
import pytest

from stribeck import examples
from tests.pages import Page


def test_run(stribeck, scenario, tmp_path):
    data = json.loads(stribeck("run", scenario, "--out", tmp_path / "out", "--json").out)
    assert {p.name for p in (tmp_path / "out").iterdir()} == {
        "trajectory.csv", "trajectory.parquet", "plot.svg", "plot.png", "plot.pdf", "report.html", "summary.json"
    }  # fmt: skip
    page = Page(tmp_path / "out" / "report.html")
    rows = {row[0]: row for row in page.tables[0]}
    assert rows["F"][1:] == ["friction force", f"{data['peaks']['F']:.6g}", f"{data['final']['F']:.6g}", "N"]
    assert page.headings == ["1. Result", "2. Plots", "3. The law lugre_sobczyk", "4. The scenario"]


def test_compare(stribeck, scenario, tmp_path):
    words = ("run", scenario, "--law", "lugre", "--law", "dahl", "--out", tmp_path / "out", "--json")
    data = json.loads(stribeck(*words).out)
    rows = {row[0]: row for row in Page(tmp_path / "out" / "report.html").tables[0]}
    assert rows["dahl"][1] == f"{data['laws']['dahl']['deviations']['y']['max']:.4g}"


@pytest.mark.parametrize("summary", [(), ("--summary",)])
def test_sweep_as_csv_holds_the_same_numbers(summary, stribeck, scenario, tmp_path):
    words = ("sweep", scenario, "--vary", "law.k_v=1e6:1e8:3:log", *summary, "--set", "solve.t_end=1", "--out")
    assert stribeck(*words, tmp_path / "a").status == 0
    assert stribeck(*words, tmp_path / "b", "--csv").status == 0
    table = parquet.read_table(tmp_path / "a")  # the folder, whatever else lies there
    rows = list(csv.DictReader((tmp_path / "b" / "part-000000.csv").read_text().splitlines()))
    assert len(rows) == table.num_rows
    assert list(rows[0]) == table.column_names
    for name in ("lane", "law.k_v", *(("peak_F", "final_y") if summary else ("t", "y", "F"))):
        assert [float(row[name]) for row in rows] == table.column(name).to_pylist()
    again = stribeck(*words, tmp_path / "b", "--csv")
    assert "1 of them there already" in again.out
    page = Page(tmp_path / "b" / "_report" / "report.html")
    assert (tmp_path / "b" / "_report" / "lanes.svg").exists()
    if summary:
        head, *body = page.tables[0]
        assert head[:2] == ["lane", "law.k_v"]
        assert [float(row[2]) for row in body] == pytest.approx([float(r["peak_F"]) for r in rows], rel=1e-5)


def test_check(stribeck, tmp_path):
    words = ("check", "lugre_sobczyk", "--parameters", "canudas1995", "--set", "k_v=1e7", "--out", tmp_path / "out")
    data = json.loads(stribeck(*words, "--json").out)
    assert str(tmp_path / "out" / "report.html") in data["report"]
    page = Page(tmp_path / "out" / "report.html")
    holds = {row[0]: row[2] for row in page.tables[0]}
    for name, verdict in data["properties"].items():
        assert holds[name.replace("_", "-")] == {True: "yes", False: "no", None: "undecided"}[verdict["holds"]]
    assert (tmp_path / "out" / "not_passive.png").exists()


def test_the_design_of_a_servo(stribeck, tmp_path):
    words = ("design", examples.path("servo"), "--set", "solve.t_end=1", "--out", tmp_path / "out", "--json")
    data = json.loads(stribeck(*words).out)
    assert json.loads((tmp_path / "out" / "summary.json").read_text())["files"] == data["files"]
    rows = {row[0]: row for row in Page(tmp_path / "out" / "report.html").tables[0]}
    assert rows["exact condition"][1] == ("yes" if data["exact"]["holds"] else "no")

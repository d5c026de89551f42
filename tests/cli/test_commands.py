"""compare, laws, new, doctor, paper."""

import json
import re

import pytest

from stribeck import Scenario, check, examples
from stribeck.laws import builtin


def test_compare_names_deviations_from_the_first(stribeck, scenario, tmp_path):
    laws = ["--law", "lugre", "--law", "lugre_sobczyk:k_v=1e6", "--law", "lugre_majorant:k_v=1e6,F_s=1.5"]
    out = tmp_path / "out"
    data = json.loads(stribeck("compare", scenario, *laws, "--json", "--out", out).out)
    assert data["reference"] == "lugre"
    assert list(data["laws"]) == laws[1::2]
    sobczyk, majorant = (data["laws"][name]["deviations"]["y"] for name in laws[3::2])
    assert sobczyk["max"] > 1e3 * majorant["max"] > 0
    assert sobczyk["max_relative"] == pytest.approx(sobczyk["max"] / data["laws"]["lugre"]["peaks"]["y"])
    assert sobczyk["rms"] < sobczyk["max"]
    assert (out / "compare.svg").exists()
    assert json.loads((out / "summary.json").read_text())["laws"].keys() == data["laws"].keys()


def test_compare_prints_a_table(stribeck, scenario):
    result = stribeck("compare", scenario, "--law", "lugre", "--law", "dahl")
    assert result.status == 0
    assert re.search(r"dahl +\S+ +\S+ %", result.out)


@pytest.mark.parametrize(
    ("law", "line"),
    [
        ("lugr", "law.name: 'lugr': no such law (did you mean 'lugre'?)"),
        ("lugre:k_v=1e6", "law.k_v: 1000000.0: law 'lugre' has no such constant (it has v_d, delta)"),
        ("lugre:k_v", "--law: 'lugre:k_v': must be NAME or NAME:KEY=VALUE,..."),
        ("lugre_majorant:k_v=-1", "law.k_v: -1: must be"),
    ],
)
def test_compare_refuses_a_bad_law(stribeck, scenario, law, line):
    result = stribeck("compare", scenario, "--law", "lugre_sobczyk", "--law", law, "--json")
    assert result.status == 2
    assert result.out == ""
    assert line in result.err


def test_a_law_of_the_users_own(stribeck, scenario):
    example = re.search(
        r"```python\n(.*?)```", (examples.path("x").parents[3] / "docs" / "adding-a-law.md").read_text(), re.S
    )
    (scenario.parent / "mylaw.py").write_text(example[1])
    result = stribeck("run", scenario, "--json", "--set", "law.name=mylaw.py:RootLuGre")
    assert json.loads(result.out)["law"]["name"] == "root_lugre"
    listing = stribeck("laws", f"{scenario.parent}/mylaw.py:RootLuGre")
    assert "dz/dt = v - (sqrt(v² + 1/k_v²)/g(v)) z" in listing.out
    assert stribeck("laws", f"{scenario.parent}/mylaw.py:RootLuGre", "--test").status == 0


def test_laws_lists_all_with_equations(stribeck):
    data = json.loads(stribeck("laws", "--json").out)
    assert [law["name"] for law in data["laws"]] == list(builtin())
    lugre = data["laws"][0]
    assert lugre["equations"][0]["latex"] == r"\dot{z} = v - \frac{\left|v\right|}{g(v)} z"
    assert lugre["parameters"]["sigma_0"]["unit"] == "N/m"
    assert lugre["guarantees"]["bounded"] is True
    assert lugre["guarantees"]["passive"]["if"]["text"] == "σ₁ (F_s - F_c) <= σ₂ F_c"
    assert set(data["parameter_sets"]["canudas1995"]) == {"title", "source", "motion", "values", "undetermined"}
    text = stribeck("laws").out
    assert all(f"{name}: " in text for name in builtin())


@pytest.mark.parametrize("name", [*examples.names(), "my rig-1"])
def test_new_writes_a_scenario_that_runs(stribeck, tmp_path, name, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert stribeck("new", name).status == 0
    assert Scenario.load(tmp_path / f"{name}.toml").name == name
    assert stribeck("run", f"{name}.toml", "--set", "solve.t_end=0.2").status == 0
    again = stribeck("new", name)
    assert again.status == 2
    assert "exists already" in again.err


def test_a_new_scenario_begins_with_a_law_that_is_proved_passive(stribeck, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    stribeck("new", "mine")
    law = Scenario.load("mine.toml").law
    assert law.name == "lugre_majorant"
    assert check(law)["passive"].holds is True


def test_doctor_passes_its_self_test(stribeck):
    data = json.loads(stribeck("doctor", "--json").out)
    assert data["self_test"]["passed"]
    assert {"compiler", "cache", "packages", "stribeck"} <= set(data)
    assert "self-test  passed" in stribeck("doctor").out


@pytest.mark.pictures
def test_paper_leaves_a_self_contained_page(stribeck, tmp_path):
    result = stribeck("paper", "--out", tmp_path / "report", "--json")
    data = json.loads(result.out)
    page = (tmp_path / "report" / "report.html").read_text()
    figures = sorted(path.stem for path in (tmp_path / "report" / "figures").glob("*.svg"))
    assert [name[:5] for name in figures if name.startswith("fig")] == [
        f"fig{n:02}" for n in (1, 2, 3, 4, 5, 6, 7, 8, 9, 10)
    ]
    assert figures == sorted(path.stem for path in (tmp_path / "report" / "figures").glob("*.png"))
    assert page.count("<svg") == page.count("</svg>") == len(figures)
    fetched = re.findall(r'(?:src|href)="(?!#)([^"]+)"|url\((?!#)([^)]+)\)|@import', page)
    assert fetched == []
    ids = re.findall(r'\bid="([^"]+)"', page)
    assert len(ids) == len(set(ids))
    assert sorted(data["files"]) == sorted(str(p) for p in (tmp_path / "report").rglob("*") if p.is_file())
    check_numbers(data["chapters"])


def check_numbers(chapters):
    """Known numbers, by two solvers of others on independently written equations."""
    y = chapters["presliding"]["y"]
    one, two, three = list(y)[1:]
    assert y["lugre"] == pytest.approx([44.86e-6, 45.31e-6, -9.564e-6, -10.02e-6], rel=1e-3)
    assert y[one] == pytest.approx([69.27e-6, 133.0e-6, 45.19e-6, -18.55e-6], rel=1e-3)
    assert y[two] == pytest.approx([47.47e-6, 54.25e-6, -4.292e-6, -11.07e-6], rel=1e-3)
    assert y[three] == pytest.approx([45.12e-6, 46.21e-6, -9.040e-6, -10.13e-6], rel=1e-3)
    assert list(chapters["presliding"]["deviation_of_peak"].values()) == pytest.approx([1.94, 0.197, 0.0198], rel=5e-3)
    assert list(chapters["stick_slip"]["y_end"].values()) == pytest.approx(
        [3.306801, 3.373043, 3.313143, 3.307430], abs=1e-6
    )
    cycle = chapters["limit_cycle"]
    assert [cycle["amplitude"][k] for k in ("lugre", one)] == pytest.approx([0.063902, 0.063093], abs=1e-6)
    assert [cycle["period"][k] for k in ("lugre", one)] == pytest.approx([24.44, 24.64], abs=5e-3)
    assert list(cycle["overshoot"].values()) == pytest.approx([1.50047] * 4, abs=1e-5)
    away = chapters["break_away"]
    known = {1.0: 1.43242, 5.0: 1.31321, 10.0: 1.21995, 20.0: 1.09861, 30.0: 1.02449, 40.0: 1.00425, 50.0: 1.00747}
    found = dict(zip(away["rates"], away["forces"]["lugre"], strict=True))
    assert {rate: found[rate] for rate in known} == pytest.approx(known, abs=1.1e-5)
    assert 0 < away["largest_shortfall"][two] < 5e-4
    assert 0 < away["largest_shortfall"][one] < 4.1e-3
    sine, sawtooth = chapters["evidence"]["drift"].values()
    assert sine["lugre"] == pytest.approx(0.24e-3, rel=0.01)
    assert sawtooth["elastoplastic_sobczyk"] / 16 == pytest.approx(1.1e-6, rel=0.05)
    for law in ("elastoplastic", "elastoplastic_majorant"):
        assert abs(sine[law]) < 1e-15
        assert abs(sawtooth[law]) < 1e-15
    verdicts = list(chapters["statements"].values())
    assert verdicts.count("not confirmed") == 2
    assert verdicts.count("confirmed with a remark") == 2
    assert len(verdicts) == 8

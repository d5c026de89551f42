"""``stribeck check --creep`` and the other tolerances."""

from __future__ import annotations

import json

import pytest

from stribeck.mouth.cells import rounded_up

SOBCZYK = ("check", "lugre_sobczyk", "--parameters", "canudas1995")


def test_the_smallest_k_v_and_the_verdicts_on_the_law_with_it(stribeck, tmp_path):
    asked = (*SOBCZYK, "--creep", "1e-6", "--sample-time", "1e-4")
    result = stribeck(*asked, "--out", tmp_path / "found")
    assert result.status == 0
    assert result.out.startswith("lugre_sobczyk: smallest k_v 1.271e+07 s/m; proved: unique, ")
    assert "lugre_majorant creep under 0.95 F_s, 1 µm/s 1.472e+06 s/m" in " ".join(result.out.split())
    assert "formula: k_v = tan(pi q/2)/v" in " ".join(result.out.split())
    assert (tmp_path / "found" / "steepness.svg").exists()
    assert "The smallest k_v" in (tmp_path / "found" / "report.html").read_text()
    found = json.loads(stribeck(*asked, "--json").out)
    creep = found["steepness"]["lugre_sobczyk"]["requirements"][0]
    assert creep["achieved"] == pytest.approx(1e-6)
    assert found["constants"]["k_v"] == found["steepness"]["lugre_sobczyk"]["k_v"]
    assert found["properties"]["bounded"]["holds"] is True
    own = json.loads(stribeck(*asked, "--set", "k_v=1e6", "--json").out)
    assert own["constants"]["k_v"] == 1e6
    assert own["steepness"] == found["steepness"]


def test_verdicts_are_on_the_k_v_that_a_scenario_s_position_needs(stribeck, tmp_path, monkeypatch):
    """They were on the k_v of the scenario's own law."""
    monkeypatch.chdir(tmp_path)
    assert stribeck("new", "presliding").status == 0
    words = ("check", "lugre_sobczyk", "--scenario", "presliding.toml", "--position-error", "1e-5", "--json")
    result = json.loads(stribeck(*words).out)
    assert result["constants"]["k_v"] == result["steepness"]["lugre_sobczyk"]["k_v"] != 1e7
    assert result["constants"]["F_s"] == 1.5
    given = json.loads(stribeck(*words, "--set", "k_v=2e7").out)
    assert given["constants"]["k_v"] == 2e7


def test_without_a_k_v_that_will_do_there_are_no_verdicts(stribeck):
    found = json.loads(stribeck(*SOBCZYK, "--creep", "2e-3", "--json").out)
    assert found["steepness"]["lugre_sobczyk"]["k_v"] is None
    assert found["properties"] == {}
    assert "no k_v meets the tolerances" in stribeck(*SOBCZYK, "--creep", "2e-3").out


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (("lugre", "--parameters", "canudas1995", "--creep", "1e-6"), "'lugre': must be a law with bristles and k_v"),
        (("lugree", "--parameters", "canudas1995", "--creep", "1e-6"), "'lugree': no such law"),
        (("lugre_sobczyk", "--creep", "fast"), "stribeck: "),
        (("lugre_sobczyk", "--creep", "nan"), "--creep: nan: must be a finite number > 0"),
        (("lugre_sobczyk", "--share", "0.5"), "missing: a tolerance: at least one of --creep, --steady-error"),
        (("lugre_sobczyk", "--steady-error", "0.01"), "--speed: missing: must be given with --steady-error"),
        (("lugre_majorant", "--creep", "1e-6", "--share", "3"), "--share: 3.0: must be between 0 and 1"),
        (("lugre_sobczyk", "--scenario", "none.toml", "--position-error", "1e-3"), "none.toml: cannot be read"),
        (("elastoplastic_majorant", "--parameters", "canudas1995", "--creep", "1e-6"), "z_ba: missing"),
        (("machine.toml", "--creep", "1e-6"), "--creep: must be left out for a machine"),
    ],
)
def test_bad_input_is_one_line_and_writes_nothing(stribeck, words, line, tmp_path):
    result = stribeck("check", *words, "--out", tmp_path / "found", "--json")
    assert result.status == 2
    assert result.out == ""
    assert line in result.err
    assert not (tmp_path / "found").exists()


@pytest.mark.parametrize(
    ("x", "text"), [(0.0, "0"), (1.0, "1"), (1.0001, "1.001"), (12706204.7, "1.271e+07"), (3e-5, "3e-05")]
)
def test_numbers_are_rounded_up(x, text):
    assert rounded_up(x) == text


TOLERANCES = """\
check lugre_sobczyk --parameters canudas1995 --creep 1e-6
check lugre_sobczyk --parameters canudas1995 --steady-error 0.01 --speed 1e-4
check lugre_sobczyk --parameters canudas1995 --presliding-error 0.02 --force-rate 0.1425
check lugre_sobczyk --scenario limit_cycle.toml --position-error 1e-3
check elastoplastic_sobczyk --parameters canudas1995 --set z_ba=7e-6 --creep 1e-6 --sample-time 1e-4 --v-max 0.1
"""


@pytest.mark.thorough
def test_each_tolerance_gives_a_steepness(stribeck, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert stribeck("new", "limit_cycle").status == 0
    outputs = [stribeck(*line.split()) for line in TOLERANCES.splitlines()]
    assert [result.status for result in outputs] == [0] * 5
    for number in ("1.271e+07", "1.472e+06"):
        assert number in outputs[0].out
    assert "lugre_sobczyk: smallest k_v 1.405e+08 s/m" in outputs[3].out

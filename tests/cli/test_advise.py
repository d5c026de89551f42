"""``stribeck advise``."""

from __future__ import annotations

import json
import re
import shlex
from pathlib import Path

import pytest

from stribeck.cli.advise import up
from tests.simulation.rig import needs_compiler


def test_advice_in_words_and_files(stribeck, tmp_path):
    asked = ("advise", "lugre_sobczyk", "--parameters", "canudas1995", "--creep", "1e-6", "--sample-time", "1e-4")
    result = stribeck(*asked, "--out", tmp_path / "found")
    assert result.status == 0
    assert "lugre_sobczyk: k_v = 1.271e+07 s/m" in result.out
    assert "lugre_majorant: k_v = 1.472e+06 s/m" in result.out
    assert "by formula: k_v = tan(pi q/2)/v" in result.out
    assert {path.name for path in (tmp_path / "found").iterdir()} == {"advise.svg", "summary.json"}
    summary = json.loads((tmp_path / "found" / "summary.json").read_text())
    result = stribeck(*asked, "--json")
    assert json.loads(result.out)["laws"] == summary["laws"]
    assert result.err == ""
    creep = summary["laws"]["lugre_sobczyk"]["requirements"][0]
    assert creep["achieved"] == pytest.approx(1e-6)


@pytest.mark.parametrize(
    ("asked", "line"),
    [
        (("lugre_sobczyk", "--parameters", "canudas1995"), "missing: what is tolerated"),
        (("lugre", "--parameters", "canudas1995", "--creep", "1e-6"), "'lugre': must be a law with bristles and k_v"),
        (("lugre_sobczyk", "--parameters", "canudas1996", "--creep", "1e-6"), "'canudas1996': no such parameter set"),
        (("lugre_sobczyk", "--creep", "1e-6"), "sigma_0: missing"),
        (("lugre_sobczyk", "--parameters", "canudas1995", "--creep", "fast"), "stribeck: "),
        (
            ("lugre_sobczyk", "--parameters", "canudas1995", "--creep", "nan"),
            "--creep: nan: must be a finite number > 0",
        ),
        (
            ("lugre_sobczyk", "--parameters", "canudas1995", "--creep", "1e-6", "--set", "k_v=1"),
            "k_v: 1: is what is asked",
        ),
        (
            ("lugre_sobczyk", "--parameters", "canudas1995", "--creep", "1e-6", "--set", "creep=1"),
            "--set: 'creep': must be",
        ),
        (("lugre_sobczyk", "--scenario", "none.toml", "--position-error", "1e-3"), "none.toml: cannot be read"),
    ],
)
def test_what_is_refused(stribeck, asked, line, tmp_path):
    result = stribeck("advise", *asked, "--out", tmp_path / "found", "--json")
    assert result.status == 2
    assert result.out == ""
    assert result.err.startswith(line)
    assert not (tmp_path / "found").exists()


@pytest.mark.parametrize(
    ("x", "text"), [(0.0, "0"), (1.0, "1"), (1.0001, "1.001"), (12706204.7, "1.271e+07"), (3e-5, "3e-05")]
)
def test_numbers_are_rounded_up(x, text):
    assert up(x) == text


@needs_compiler
def test_the_commands_of_the_guide(stribeck, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert stribeck("new", "limit_cycle").status == 0
    guide = (Path(__file__).parents[2] / "docs" / "advise.md").read_text(encoding="utf-8")
    (block,) = re.findall(r"```sh\n(.*?)```", guide, re.S)
    commands = [shlex.split(line, comments=True)[1:] for line in block.splitlines()]
    assert len(commands) == 6
    outputs = [stribeck(*words) for words in commands]
    assert [result.status for result in outputs] == [0] * 6
    for number in ("1.271e+07", "1.472e+06"):
        assert number in outputs[0].out
        assert number in guide
    for number in ("0.0294917", "1106.8", "99.9 %", ": 0 %", "1.06e+04 %"):
        assert number in outputs[5].out
        assert number in guide
    assert (tmp_path / "advice" / "advise.svg").exists()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ((), "at least one of --creep, --steady-error, --presliding-error"),
        (("--steady-error", "0.01"), "--speed: missing: must be given with --steady-error"),
        (("--creep", "1e-6", "--share", "3"), "--share: 3.0: must be between 0 and 1"),
    ],
)
def test_what_is_missing_is_told_by_its_option(stribeck, words, said):
    """It was told by the name that the argument has in Python, which no option has."""
    found = stribeck("advise", "lugre_majorant", "--parameters", "canudas1995", *words)
    assert (found.status, found.out) == (2, "")
    assert said in found.err

"""Every command, every Python line and every number of README works as it stands."""

import json
import re
import runpy
import shlex
from pathlib import Path

import pytest

from stribeck.cli import _status

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")


def blocks(language):
    return re.findall(rf"```{language}\n(.*?)```", README, re.S)


@pytest.mark.thorough
def test_commands(tmp_path, monkeypatch, capsys):
    """The commands in their order, in one folder."""
    monkeypatch.chdir(tmp_path)
    commands = [line for block in blocks("sh")[1:] for line in block.splitlines() if line]
    assert len(commands) == 11
    for command in commands:
        words = shlex.split(command, comments=True)
        assert words[0] == "stribeck"
        assert _status(words[1:]) == 0, command
    for file in (
        "first/trajectory.csv",
        "first/report.html",
        "drive/axis_hunts_axis.c",
        "fit/parameters.toml",
        "laws/compare.svg",
        "proofs/passive.toml",
        "firmware/lugre_majorant_test.c",
    ):
        assert (tmp_path / file).exists(), file
    assert "HUNTS" in capsys.readouterr().out


def test_python(capsys):
    scope = {}
    exec(compile(blocks("python")[0], "README.md", "exec"), scope)
    assert scope["solution"].status == "done"
    assert capsys.readouterr().out.splitlines()[-1] == "False"


def test_make_targets_exist():
    makefile = (ROOT / "Makefile").read_text()
    for line in blocks("sh")[0].splitlines():
        assert re.search(rf"^{line.split()[1]}:", makefile, re.M)


def test_it_is_short():
    assert len(README.split()) <= 800


@pytest.mark.pictures
def test_its_pictures_are_drawn_by_their_script(tmp_path):
    """What they show, too: the slider sticks, compensation lowers the error, the paper's law gives energy back."""
    module = runpy.run_path(str(ROOT / "docs" / "pictures" / "make.py"))
    for name in module["PICTURES"]:
        assert f"(docs/pictures/{name})" in README
        assert (ROOT / "docs" / "pictures" / name).stat().st_size > 1000
    module["draw_hunting"](tmp_path / "hunting.svg")
    assert "no compensation" in (tmp_path / "hunting.svg").read_text(encoding="utf-8")
    errors = []
    for compensation in (None, {"contact": "guide", "speed": "reference"}):
        solution = module["axis"](compensation)
        shown = solution.t > 2
        errors.append(abs(5e-3 * module["np"].sin(module["np"].pi * solution.t) - solution["slide.y"])[shown].max())
    assert errors[1] < errors[0] / 3
    assert len(module["stick_slip"]().events["slip"]) == 6


NAMES = {
    "Stribeck, compiled": "stribeck",
    "numbalsoda (LSODA, compiled equations)": "numbalsoda",
    "CasADi (SUNDIALS CVODES)": "CasADi CVODES",
    "SciPy odeint, Python equations": "SciPy odeint",
    "diffrax Kvaerno3 (compiled)": "diffrax Kvaerno3",
}


def test_speed_is_what_the_benchmark_measured():
    single = json.loads((ROOT / "benchmarks" / "results" / "single.json").read_text())
    measured = {row["solver"]: row for row in single["solvers"] if row.get("milliseconds")}
    rows = re.findall(r"^\| ([^|]+) \| ([\d.e+]+) \| ([\d.e+]+) \|$", README, re.M)
    assert [row[0] for row in rows] == list(NAMES)
    for name, milliseconds, ratio in rows:
        row = measured[NAMES[name]]
        assert (milliseconds, ratio) == (f"{row['milliseconds']['median']:.3g}", f"{row['ratio']['median']:.3g}")


def test_how_much_faster_a_compiler_makes_it():
    stored = json.loads((ROOT / "benchmarks/results/backends.json").read_text(encoding="utf-8"))
    assert f"With a C compiler it is {stored['geometric_mean']:.1f} times faster." in README

"""The base installation: what works with it, and the one line about each package that it does not have."""

import csv
import re
import subprocess
import sys

import numpy as np
import pytest

from stribeck import examples
from stribeck.errors import EXTRAS
from tests.absent import without


def base(code, folder, blocked=tuple(EXTRAS)):
    """Python code, run where the blocked packages are not installed."""
    text = without(blocked) + code
    return subprocess.run([sys.executable, "-c", text], cwd=folder, capture_output=True, text=True, check=False)


def command(folder, *words, blocked=tuple(EXTRAS)):
    return base(f"from stribeck.cli import main; main({[str(w) for w in words]!r})", folder, blocked)


@pytest.mark.share(2)
@pytest.mark.parametrize(
    "words",
    [
        ("--help",),
        ("run", examples.path("break_away"), "--json"),
        ("run", examples.path("break_away"), "--law", "lugre", "--law", "lugre_majorant"),
        ("library",),
        ("library", "lugre_majorant"),
        ("new", "mine"),
        ("doctor",),
    ],
    ids=lambda words: " ".join(map(str, words[:1])),
)
def test_the_base_installation_does_the_main_things(words, tmp_path):
    found = command(tmp_path, *words)
    assert (found.returncode, found.stderr) == (0, "")


def test_run_leaves_what_it_can_and_says_what_it_cannot(tmp_path):
    found = command(tmp_path, "run", examples.path("break_away"), "--out", "out")
    assert found.returncode == 0
    assert {p.name for p in (tmp_path / "out").iterdir()} == {"trajectory.csv", "summary.json"}
    said = found.stderr.splitlines()
    assert len(said) == 2
    assert said[0] == "stribeck: without trajectory.parquet: pyarrow is not installed (pip install 'stribeck[plot]')"
    assert said[1].endswith("(pip install 'stribeck[plot]')")
    assert command(tmp_path, "run", examples.path("break_away"), "--out", "full", blocked=()).stderr == ""
    base_table, full_table = (
        list(csv.reader((tmp_path / name / "trajectory.csv").read_text().splitlines())) for name in ("out", "full")
    )
    assert base_table[0] == full_table[0]
    np.testing.assert_array_equal(np.array(base_table[1:], float), np.array(full_table[1:], float))


@pytest.mark.share(2)
@pytest.mark.parametrize(
    ("words", "extra"),
    [
        (("check", "lugre_majorant", "--parameters", "canudas1995", "--set", "k_v=1e6"), "fit"),
        (("design", examples.path("servo"), "--set", "solve.t_end=0.1"), "fit"),
        (("fit", "log.csv", "--law", "lugre", "--time", "t", "--position", "y", "--force", "F"), "fit"),
        (("fit", "--plan", "stroke=0.1,speed=0.1,force=1", "--simulate", "--out", "rig"), "fit"),
        (("export", "lugre", "--parameters", "canudas1995", "--target", "c", "--out", "c"), "fmu"),
        (("sweep", examples.path("break_away"), "--vary", "law.k_v=1e6:1e7:2", "--out", "s"), "plot"),
    ],
    ids=lambda x: str(x[0]) if isinstance(x, tuple) else x,
)
def test_a_missing_package_is_one_line_that_names_its_extra(words, extra, tmp_path):
    (tmp_path / "log.csv").write_text("t,y,F\n0,0,1\n")
    found = command(tmp_path, *words)
    assert (found.returncode, found.stdout) == (2, "")
    assert len(found.stderr.splitlines()) == 1
    assert found.stderr.rstrip().endswith(f"pip install 'stribeck[{extra}]'")


def test_python_says_it_in_the_same_line(tmp_path):
    code = f"""
import stribeck
from stribeck.errors import MissingExtra
solution = stribeck.simulate({str(examples.path("break_away"))!r})
for call in (solution.to_pandas, lambda: stribeck.fit, lambda: stribeck.check(solution.scenario.law)):
    try:
        call()
    except MissingExtra as error:
        print(error)
"""
    found = base(code, tmp_path)
    assert re.sub("fit needs [a-z]+", "fit needs scipy", found.stdout).splitlines() == [
        "to_pandas() needs pandas: pip install 'stribeck[plot]'",
        "stribeck.fit needs scipy: pip install 'stribeck[fit]'",
        "a proof needs flint: pip install 'stribeck[fit]'",
    ]


@pytest.mark.thorough
def test_the_extra_for_pages_is_enough_for_pages(tmp_path):
    pytest.importorskip("bokeh")
    others = tuple(package for package, extra in EXTRAS.items() if extra != "plot")
    found = command(tmp_path, "explore", "lugre", "--law", "lugre", "--out", "page.html", blocked=others)
    assert (found.returncode, found.stderr) == (0, "")

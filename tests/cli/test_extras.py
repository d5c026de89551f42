"""The base installation: what works with it, and the one line about each package that it does not have."""

import csv
import json
import re
import subprocess
import sys

import numpy as np
import pytest

from stribeck import examples
from stribeck.errors import EXTRAS
from tests.absent import without

RUN_EACH = """
import contextlib, io, json
from stribeck.cli import _status
found = []
for words in {lines!r}:
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        status = _status(words)
    found.append((status, out.getvalue(), err.getvalue()))
print(json.dumps(found))
"""
MAIN_THINGS = (
    ("--help",), ("run", examples.path("break_away"), "--json"),
    ("run", examples.path("break_away"), "--law", "lugre", "--law", "lugre_majorant"), ("library",),
    ("library", "lugre_majorant"), ("new", "mine"), ("doctor",),
)  # fmt: skip
NEED_MORE = (
    (("check", "lugre_majorant", "--parameters", "canudas1995", "--set", "k_v=1e6"), "fit"),
    (("design", examples.path("servo"), "--set", "solve.t_end=0.1"), "fit"),
    (("fit", "log.csv", "--law", "lugre", "--time", "t", "--position", "y", "--force", "F"), "fit"),
    (("fit", "--plan", "stroke=0.1,speed=0.1,force=1", "--simulate", "--out", "rig"), "fit"),
    (("export", "lugre", "--parameters", "canudas1995", "--target", "c", "--out", "c"), "fmu"),
    (("explore", "lugre"), "plot"),
    (("sweep", examples.path("break_away"), "--vary", "law.k_v=1e6:1e7:2", "--out", "s"), "plot"),
)


def base(code, folder, blocked=tuple(EXTRAS)):
    """Python code, run where the blocked packages are not installed."""
    text = without(blocked) + code
    return subprocess.run([sys.executable, "-c", text], cwd=folder, capture_output=True, text=True, check=False)


def commands(folder, *lines, blocked=tuple(EXTRAS)):
    """Status, standard output and standard error of commands, in one process without the blocked packages."""
    done = base(RUN_EACH.format(lines=[[str(w) for w in words] for words in lines]), folder, blocked)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_the_base_installation_does_the_main_things(tmp_path):
    for words, (status, _, err) in zip(MAIN_THINGS, commands(tmp_path, *MAIN_THINGS), strict=True):
        assert (status, err) == (0, ""), words


@pytest.mark.thorough
def test_run_leaves_what_it_can_and_says_what_it_cannot(tmp_path):
    words = ("run", examples.path("break_away"), "--out")
    ((status, _, err),) = commands(tmp_path, (*words, "out"))
    assert status == 0
    assert {p.name for p in (tmp_path / "out").iterdir()} == {"trajectory.csv", "summary.json"}
    message = err.splitlines()
    assert len(message) == 2
    assert message[0] == "stribeck: without trajectory.parquet: pyarrow is not installed (pip install 'stribeck[plot]')"
    assert message[1].endswith("(pip install 'stribeck[plot]')")
    assert commands(tmp_path, (*words, "full"), blocked=())[0][2] == ""
    base_table, full_table = (
        list(csv.reader((tmp_path / name / "trajectory.csv").read_text().splitlines())) for name in ("out", "full")
    )
    assert base_table[0] == full_table[0]
    np.testing.assert_array_equal(np.array(base_table[1:], float), np.array(full_table[1:], float))


def test_a_missing_package_is_one_line_that_names_its_extra(tmp_path):
    (tmp_path / "log.csv").write_text("t,y,F\n0,0,1\n")
    result = commands(tmp_path, *(words for words, _ in NEED_MORE))
    for (words, extra), (status, out, err) in zip(NEED_MORE, result, strict=True):
        assert (status, out) == (2, ""), words
        assert len(err.splitlines()) == 1, words
        assert err.rstrip().endswith(f"pip install 'stribeck[{extra}]'"), words


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
    result = base(code, tmp_path)
    assert re.sub("fit needs [a-z]+", "fit needs scipy", result.stdout).splitlines() == [
        "to_pandas() needs pandas: pip install 'stribeck[plot]'",
        "stribeck.fit needs scipy: pip install 'stribeck[fit]'",
        "a proof needs flint: pip install 'stribeck[fit]'",
    ]


@pytest.mark.thorough
def test_the_extra_for_pages_is_enough_for_pages(tmp_path):
    pytest.importorskip("bokeh")
    others = tuple(package for package, extra in EXTRAS.items() if extra != "plot")
    words = ("explore", "lugre", "--law", "lugre", "--out", "page.html")
    ((status, _, err),) = commands(tmp_path, words, blocked=others)
    assert status == 0
    assert "pip install" not in err

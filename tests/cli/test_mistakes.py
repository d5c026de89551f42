"""What a user does wrong by hand: each ends in one clear line with status 2, or in a right result."""

import json
import os
import re
import subprocess
import sys

import numpy as np
import pytest

from stribeck import InputError, examples, export

COLUMNS = ("--time", "t", "--position", "y", "--force", "F")


def written(path, t, y, force):
    rows = zip(t.tolist(), y.tolist(), force.tolist(), strict=True)
    path.write_text("t,y,F\n" + "".join(f"{a!r},{b!r},{c!r}\n" for a, b, c in rows))
    return path


def test_a_body_that_rests_throughout_has_no_friction_to_fit(stribeck, tmp_path):
    """The filter of a constant position leaves its rounding, 1e-15 m/s, of which F_c < 0.06 N was told beside 2 N that moved
    nothing."""
    t = 0.01 * np.arange(600)
    rest = written(tmp_path / "rest.csv", t, np.full(600, 0.1), 2 * np.sin(1.3 * t))
    for words in (
        (),
        ("--law", "coulomb_viscous"),
        ("--law", "lugre", "--method", "dynamic"),
    ):
        found = stribeck("fit", rest, *COLUMNS, *words, "--out", tmp_path / "out")
        assert (found.status, found.out) == (2, ""), found.err
        assert found.err == "--velocity: 0 throughout: nothing moves, so there is no friction to fit\n"
    assert not (tmp_path / "out").exists()


def test_a_force_against_the_motion_identifies_no_friction(stribeck, tmp_path):
    """A sensor of the wrong sign: F_c is not identifiable, and the advice names motion in both directions."""
    t = 0.01 * np.arange(600)
    one_way = written(
        tmp_path / "one_way.csv", t, 0.1 * t - 0.02 * np.cos(3 * t), -1 - 3 * (0.1 + 0.06 * np.sin(3 * t))
    )
    found = stribeck("fit", one_way, *COLUMNS, "--law", "coulomb_viscous", "--law", "stribeck")
    assert found.status == 0, found.err
    assert re.search(r"F_c\s+\S.* not identifiable", found.out)  # a wide table has the names above their rows
    assert "in both directions" in found.out


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (("--vary", "controllers.axis.Kp=1:2"),
         "--vary: controllers.axis.Kp: no number of the machine (did you mean 'controllers.axis.K_p'?)"),
        (("--seed", "-1"), "--seed: -1: must be a whole number >= 0"),
    ],
)  # fmt: skip
def test_designs(words, line, stribeck, tmp_path):
    stribeck("new", "machine", "--out", tmp_path / "machine.toml")
    found = stribeck("design", tmp_path / "machine.toml", *words)
    assert (found.status, found.out, found.err) == (2, "", line + "\n")


@pytest.mark.parametrize("words", [("--part", "machine"), ("--part", "law", "--contact", "guide"), ()])
def test_a_controller_that_nothing_asks_for(words, stribeck, tmp_path):
    """It was left aside, misspelt ones too."""
    stribeck("new", "machine", "--out", tmp_path / "machine.toml")
    out = tmp_path / "out"
    found = stribeck("export", tmp_path / "machine.toml", "--target", "c", "--out", out, "--controller", "x", *words)
    part = words[1] if words else "machine"
    assert (found.status, found.out) == (2, "")
    assert found.err == f"--controller: 'x': must be left out: part '{part}' has no choice of controllers\n"
    assert not out.exists()


@pytest.mark.parametrize("part", ["machine", "controller"])
def test_a_contact_that_nothing_asks_for(part, tmp_path):
    with pytest.raises(InputError, match=f"contact: 'x': must be left out: part '{part}' has no choice of contacts"):
        export(examples.path("machine"), "c", tmp_path / "out", part=part, contact="x")
    assert not (tmp_path / "out").exists()


def test_a_contact_alone_asks_for_its_law(tmp_path):
    with pytest.raises(InputError, match="contact: 'x': "):
        export(examples.path("machine"), "c", tmp_path / "out", contact="x")
    export(examples.path("machine"), "c", tmp_path / "law", contact="guide")
    assert (tmp_path / "law" / "lugre_majorant.h").exists()


@pytest.mark.parametrize("words", [("--law", "dahl"), ("--seed", "3"), ("--law", "lugr")])
def test_options_of_a_synthetic_rig_that_is_not_asked_for(words, stribeck):
    found = stribeck("fit", "--plan", "stroke=0.05,speed=0.1,force=50", *words)
    assert (found.status, found.out) == (2, "")
    assert found.err == f"{words[0]}: goes with --simulate, which is not given\n"


def test_recordings_whose_time_stands_still(stribeck, scenario, tmp_path):
    """A run took the last of their values throughout."""
    y = 0.1 * np.sin(0.01 * np.arange(600))
    still = written(tmp_path / "still.csv", np.full(600, 3.0), y, y)
    text = scenario.read_text()
    head, _, tail = text.partition('kind = "ramp"\nrate = 0.1\n')
    scenario.write_text(head + 'kind = "file"\npath = "still.csv"\ntime = "t"\nvalue = "y"\n' + tail)
    found = stribeck("run", scenario)
    assert (found.status, found.out) == (2, "")
    assert found.err == f"drive.signal.path: {still}: column 't': 3.0 s in every row: must rise\n"
    scenario.write_text(text)
    found = stribeck("predict", still, "--machine", scenario, "--time", "t", "--position", "y")
    assert (found.status, found.out, found.err) == (2, "", "--time: must rise, over two rows or more\n")


@pytest.mark.thorough
def test_a_name_that_opens_a_script_within_the_pages_data(stribeck, scenario, tmp_path):
    """After <!--<script> a browser takes the end of the data for that of the inner script: the page stayed empty."""
    name, page = "<!--<script>", tmp_path / "page.html"
    scenario.write_text(scenario.read_text().replace('name = "rig"', f'name = "{name}"'))
    assert stribeck("explore", scenario, "--law", "dahl", "--out", page).status == 0
    data = page.read_text().partition('<script type="application/json" id="data">')[2].partition("</script>")[0]
    assert "<" not in data
    assert json.loads(data)["name"] == name


@pytest.mark.skipif(os.name != "posix", reason="needs POSIX signals")
@pytest.mark.parametrize("name", ["make_ready", "_command"])
def test_a_signal_while_the_command_is_made_ready(name):
    """It ended in a traceback and status 1 (3 of 187 that came in the first second)."""
    code = (
        f"import os, signal, stribeck.cli as c; c.{name} = lambda *_: os.kill(os.getpid(), signal.SIGTERM); "
        "signal.signal(signal.SIGTERM, signal.SIG_DFL); c.main(['laws'])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (143, "", "")

"""What a user does wrong by hand: each ends in one clear line with status 2, or in a right result."""

import json
import os
import re
import subprocess
import sys

import numpy as np
import pytest

COLUMNS = ("--time", "t", "--position", "y", "--force", "F")


def written(path, t, y, force):
    rows = zip(t.tolist(), y.tolist(), force.tolist(), strict=True)
    path.write_text("t,y,F\n" + "".join(f"{a!r},{b!r},{c!r}\n" for a, b, c in rows))
    return path


def test_a_force_against_the_motion_identifies_no_friction(stribeck, tmp_path):
    """A sensor of the wrong sign: F_c is not identifiable, and the advice names motion in both directions."""
    t = 0.01 * np.arange(600)
    one_way = written(
        tmp_path / "one_way.csv", t, 0.1 * t - 0.02 * np.cos(3 * t), -1 - 3 * (0.1 + 0.06 * np.sin(3 * t))
    )
    process = stribeck("fit", one_way, *COLUMNS, "--law", "coulomb_viscous", "--law", "stribeck")
    assert process.status == 0, process.err
    assert re.search(r"F_c\s+\S.* not identifiable", process.out)  # a wide table has the names above their rows
    assert "in both directions" in process.out


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
@pytest.mark.parametrize("name", ["make_ready", "_status"])
def test_a_signal_while_the_command_is_made_ready(name):
    """It ended in a traceback and status 1 (3 of 187 that came in the first second)."""
    code = (
        f"import os, signal, stribeck.cli as c; c.{name} = lambda *_: os.kill(os.getpid(), signal.SIGTERM); "
        "signal.signal(signal.SIGTERM, signal.SIG_DFL); c.main(['laws'])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (143, "", "")

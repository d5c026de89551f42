"""Recordings and LOGS.toml that nobody means well with: a line, early, and nothing executed."""

import math

import numpy as np
import pytest
import tomli_w

from stribeck import InputError
from stribeck.identify.actuator import fit_machine, read_logs
from stribeck.identify.data.quality import isolated_outliers
from stribeck.identify.work import Stopped
from tests.identify.actuator.recorded import body, logs
from tests.shared import needs_links

WANTED = {"bodies.a.mass": {"low": 0.2, "high": 5.0}}
STRANGE = "open('executed', 'w').close()\n"


def written(folder, y=lambda t: 0.01 * t, name="run.csv"):
    t = np.arange(60) * 0.01
    rows = "".join(
        f"{a!r},{b!r},{math.sin(9 * a)!r}\n" for a, b in zip(t.tolist(), (y(t) + 0 * t).tolist(), strict=True)
    )
    (folder / name).write_text("t,y,u\n" + rows)


@pytest.fixture
def place(tmp_path, monkeypatch):
    (tmp_path / "in" / "below").mkdir(parents=True)
    monkeypatch.chdir(tmp_path / "in")
    written(tmp_path / "in")
    (tmp_path / "in" / "axis.toml").write_text(tomli_w.dumps(body()))
    return tmp_path / "in"


@pytest.mark.parametrize(
    "name", ["../evil.py:X", "{}/evil.py:X", pytest.param("link.py:X", marks=needs_links), "below/../../evil.py:X"]
)
def test_laws_of_a_stranger_are_not_executed(place, stribeck, name):
    """[laws] of LOGS.toml was executed wherever it lay."""
    (place.parent / "evil.py").write_text(STRANGE)
    if "link" in name:
        (place / "link.py").symlink_to(place.parent / "evil.py")
    law = name.format(place.parent)
    logs(place, ["run.csv"], WANTED, laws={"guide": [law]})
    done = stribeck("fit", "axis.toml", "--logs", "logs.toml", "--out", "out")
    assert (done.status, done.out) == (2, "")
    assert "laws.guide" in done.err
    assert "must be in that folder or below it, or given with --law" in " ".join(done.err.split()), done.err
    assert not (place / "executed").exists()
    assert not (place / "out").exists()
    stribeck("fit", "axis.toml", "--logs", "logs.toml", "--law", f"guide={law}")
    assert (place / "executed").exists()  # named by the user


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"file": "a/" * 3000}, "log.0.file: "),
        ({"outputs": {"a.y": {"column": "y", "noise": 1e-300}}}, "noise: 1e-300: must lie between 1e-30 and 1e+30"),
        ({"outputs": {"a.y": {"column": "y", "gain": 1e308}}}, "log.0.outputs.a.y: 'y': values up to"),
        ({"time": {"column": "t", "gain": 1e300}}, "log.0.time: 't': values up to"),
        ({"inputs": {"loads.push.signal": {"column": "u", "gain": 1e200}}}, "log.0.inputs.loads.push.signal: 'u': values"),
    ],
)  # fmt: skip
def test_what_no_recording_can_be(place, stribeck, change, text):
    """Tracebacks, hangs, and lanes that wrote before their memory."""
    logs(place, [{"file": "run.csv", **change}], WANTED)
    done = stribeck("fit", "axis.toml", "--logs", "logs.toml", "--starts", "1", "--out", "out")
    assert (done.status, done.out) == (2, "")
    assert text in done.err
    assert not (place / "out").exists()


@pytest.mark.parametrize(("rest", "size"), [(0.0, 1e15), (1.0, 1e9), (1.0, -1e15)])
@pytest.mark.parametrize("role", ["inputs.loads.push.signal", "outputs.a.y"])
def test_a_single_wild_sample(place, stribeck, role, rest, size):
    """One of an input took a minute, with steps as small as it is large."""
    column = "u" if "inputs" in role else "y"
    x = rest * np.sin(0.1 * np.arange(60.0))
    x[30] = size
    other = np.sin(0.2 * np.arange(60.0))
    y, u = (other, x) if column == "u" else (x, other)
    rows = "".join(f"{0.01 * i!r},{a!r},{b!r}\n" for i, (a, b) in enumerate(zip(y.tolist(), u.tolist(), strict=True)))
    (place / "run.csv").write_text("t,y,u\n" + rows)
    logs(place, ["run.csv"], WANTED)
    done = stribeck("fit", "axis.toml", "--logs", "logs.toml", "--out", "out")
    assert (done.status, done.out) == (2, "")
    assert f"log.0.{role}: '{column}': isolated outliers: 1, up to {abs(size):.3g}" in done.err
    assert not (place / "out").exists()


@pytest.mark.parametrize("size", [1e-6, 1.0, 1e6])
def test_a_blow_and_a_short_move_are_not_wild(size):
    """Of one row in silence; of some rows over noise."""
    blow, move = np.zeros(300), 1e-12 * np.sin(np.arange(300.0))
    blow[100], move[100:103] = size, size
    assert isolated_outliers(blow) is None
    assert isolated_outliers(move) is None


def test_work_that_is_ended_while_recordings_are_looked_at(place, stribeck, monkeypatch):
    """What a signal ended there was shown as a traceback."""
    logs(place, ["run.csv"], WANTED)

    def ended(*rest):
        raise Stopped

    monkeypatch.setattr("stribeck.identify.actuator.api.checked", ended)
    done = stribeck("fit", "axis.toml", "--logs", "logs.toml", "--starts", "1")
    assert (done.status, done.out, done.err.splitlines()[-1]) == (130, "", "stribeck: interrupted")  # behind progress
    assert "Traceback" not in done.err


def test_a_law_in_a_file_that_is_not_there(place):
    path = logs(place, ["run.csv"], WANTED, laws={"guide": ["none.py:X"]})
    with pytest.raises(InputError, match="cannot read"):
        fit_machine(body(), read_logs(path))

"""stribeck predict as a user runs it."""

import json
from functools import reduce
from operator import getitem

import numpy as np
import pytest

from stribeck import Fit, InputError, predict
from stribeck.cli import _status
from stribeck.identify.saved import text_with_digest
from tests.kept import logs
from tests.shared import places as every_place

COLUMNS = ("--time", "t", "--velocity", "v", "--force", "F")


@pytest.fixture(scope="module")
def fitted(tmp_path_factory):
    folder = tmp_path_factory.mktemp("fit")
    logs.write("log.csv", folder / "train.csv")
    words = ["fit", str(folder / "train.csv"), "--law", "coulomb_viscous", *COLUMNS, "--out", str(folder / "out")]
    assert _status(words) == 0
    return folder


def test_a_friction_that_is_all_by_load_predicts(stribeck, tmp_path):
    """F_c comes out below 0, and so F_s = F_c = 1.5e-8 N in the fit: prediction ended with KeyError 'F_c'."""
    rng = np.random.default_rng(0)
    t = np.arange(0, 8, 2e-3)
    v = 0.1 * np.sin(2 * np.pi * 0.37 * t) + 0.05 * np.sin(2 * np.pi * 0.91 * t + 1)
    load = 40 + 30 * np.sin(2 * np.pi * 0.23 * t)
    force = 2 * np.gradient(v, 2e-3) + 0.2 * load * np.sign(v) - 0.5 * np.sign(v) + 0.1 * rng.standard_normal(len(t))
    rows = (",".join(map(repr, row)) for row in zip(*(x.tolist() for x in (t, v, force, load)), strict=True))
    (tmp_path / "log.csv").write_text("t,v,F,N\n" + "\n".join(rows))
    process = stribeck(
        "fit", tmp_path / "log.csv", "--law", "stribeck", *COLUMNS, "--load", "N", "--out", tmp_path / "out"
    )
    assert process.status == 0, process.err
    used = json.loads((tmp_path / "out" / "fit.json").read_text())["values"]
    assert 0 < used["F_c"] == used["F_s"] < 1e-7
    result = stribeck("predict", tmp_path / "log.csv", "--fit", tmp_path / "out", "--json")
    assert result.status == 0, result.err
    assert json.loads(result.out)["relative_force_error"] < 0.05


@pytest.mark.parametrize(
    ("content", "said"),
    [(None, "cannot be read"), ("{", "is not JSON"), ("[]", "is no model of a fit"), ('{"format": 1}', "is no model")],
)
def test_a_folder_without_a_fit_is_refused_in_a_line(stribeck, fitted, tmp_path, content, said):
    if content is not None:
        (tmp_path / "fit.json").write_text(content)
    process = stribeck("predict", fitted / "train.csv", "--fit", tmp_path, *COLUMNS)
    assert (process.status, process.out) == (2, "")
    assert said in process.err
    assert process.err.startswith("--fit: ")
    assert len(process.err.strip().splitlines()) == 1


def test_a_record_at_rest_is_refused_in_a_line(stribeck, fitted, tmp_path):
    (tmp_path / "log.csv").write_text("t,v,F\n" + "".join(f"{i / 100},0.0,{i % 7}\n" for i in range(400)))
    process = stribeck("predict", tmp_path / "log.csv", "--fit", fitted / "out", *COLUMNS)
    assert (process.status, process.out) == (2, "")
    assert process.err.endswith("a static law does not tell the force there\n")


def test_what_comes_after_a_recorded_drive_is_not_compared(stribeck, scenario, tmp_path):
    """The drive's last value went on to the end of the record, and the error was that of a motion that nobody drove."""
    t = np.arange(0, 4, 0.01)
    drive = "".join(f"{x:.2f},{2 * np.sin(5 * x)}\n" for x in t[:200])
    (tmp_path / "drive.csv").write_text("t,u\n" + drive)
    text = scenario.read_text().replace(
        'kind = "ramp"\nrate = 0.1', 'kind = "file"\npath = "drive.csv"\ntime = "t"\nvalue = "u"'
    )
    scenario.write_text(text.replace('kind = "spring"\nstiffness = 2.0', 'kind = "force"'))
    assert stribeck("run", scenario, "--set", "solve.t_end=1.99", "--out", tmp_path / "run").status == 0
    rows = (tmp_path / "run" / "trajectory.csv").read_text().splitlines()[1:]
    kept = "".join(",".join(row.split(",")[:2]) + "\n" for row in rows)
    (tmp_path / "log.csv").write_text("t,y\n" + kept + "".join(f"{x},9.0\n" for x in t[200:]))
    done = stribeck("predict", tmp_path / "log.csv", "--machine", scenario, "--time", "t", "--position", "y", "--json")
    assert done.status == 0, done.err
    assert "the recorded drive ends at 1.99 s: what comes after is not compared" in done.err
    document = json.loads(done.out)
    assert document["rows"] == 200
    assert document["errors"]["position"]["relative"] < 1e-6


def test_a_fit_s_file_that_was_changed_is_refused_in_a_line(stribeck, fitted, tmp_path):
    """One number less or another, wherever it stands, and the prediction would be another's."""
    text = (fitted / "out" / "fit.json").read_text()
    places = [path for path in every_place(json.loads(text)) if path[0] != "format"]
    changes = [lambda part, key: part.pop(key), lambda part, key: part.__setitem__(key, 10**400)]
    for *above, key in [*places[::9], ("predictor", "body", "sigma_2"), ("law",)]:
        for change in changes:
            data = json.loads(text)
            change(reduce(getitem, above, data), key)
            (tmp_path / "fit.json").write_text(json.dumps(data))
            with pytest.raises(InputError, match=r"fit\.json': was changed"):
                Fit.load(tmp_path)
    for more in ('"x": ' + "[" * 900 + "]" * 900, '"law": "dahl"'):  # of two of a name the last counts
        (tmp_path / "fit.json").write_text(f"{text.rstrip()[:-1]}, {more}}}")
        process = stribeck("predict", fitted / "none.csv", "--fit", tmp_path)
        assert (process.status, process.out, len(process.err.splitlines())) == (2, "", 1)
        assert "was changed" in process.err
    (tmp_path / "fit.json").write_text(json.dumps(dict(reversed(json.loads(text).items()))))
    assert Fit.load(tmp_path).law_name == Fit.load(fitted / "out").law_name


def test_a_strangers_fit_executes_no_law_from_elsewhere(stribeck, fitted, tmp_path, monkeypatch):
    """A fit.json is a file like any other: what it names outside its folder and the current one is not executed."""
    for name in ("away", "here", "fit"):
        (tmp_path / name).mkdir()
    mine = "from pathlib import Path\nfrom stribeck.laws.static import CoulombViscous as Mine\n"
    (tmp_path / "away" / "mine.py").write_text(f"{mine}Path(r'{tmp_path}', 'executed').touch()\n")
    document = json.loads((fitted / "out" / "fit.json").read_text())
    del document["digest"]
    monkeypatch.chdir(tmp_path / "here")
    for law in (f"{tmp_path}/away/mine.py:Mine", "../away/mine.py:Mine"):
        (tmp_path / "fit" / "fit.json").write_text(text_with_digest({**document, "law": law}))
        process = stribeck("predict", fitted / "train.csv", "--fit", tmp_path / "fit")
        assert (process.status, process.out) == (2, "")
        assert all(word in process.err for word in ("would be executed", "--trust"))
        with pytest.raises(InputError, match="would be executed"):
            predict(fitted / "train.csv", tmp_path / "fit")
        assert not (tmp_path / "executed").exists()
    stribeck("predict", fitted / "train.csv", "--fit", tmp_path / "fit", "--trust")
    assert (tmp_path / "executed").exists()

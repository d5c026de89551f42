"""stribeck run."""

import json
import signal
import subprocess
import sys
import time

import numpy as np
import pyarrow.csv
import pyarrow.parquet
import pytest

from stribeck import Scenario, simulate
from stribeck.simulation.tables import RUN


def test_files_hold_the_solution_in_full_precision(stribeck, scenario, tmp_path):
    out = tmp_path / "new" / "out"
    data = json.loads(stribeck("run", scenario, "--out", out, "--json").out)
    names = ["plot.svg", "report.html", "summary.json", "trajectory.csv", "trajectory.parquet"]
    assert sorted(p.name for p in out.iterdir()) == names
    assert sorted(data["files"]) == sorted(str(p) for p in out.iterdir())
    solution = simulate(Scenario.load(scenario))
    assert (out / "trajectory.csv").read_text().splitlines()[0] == "t,y,v,z,F,x,u"
    for table in (pyarrow.csv.read_csv(out / "trajectory.csv"), pyarrow.parquet.read_table(out / "trajectory.parquet")):
        assert table.column_names == ["t", "y", "v", "z", "F", "x", "u"]
        for name in table.column_names:
            np.testing.assert_array_equal(table.column(name).to_numpy(), solution[name])
    assert json.loads((out / "summary.json").read_text())["final"] == data["final"]
    assert "</svg>" in (out / "plot.svg").read_text()


@pytest.mark.pictures
def test_a_failed_computation_keeps_its_partial_result_marked(stribeck, scenario, tmp_path):
    unstable = ["--set", "drive={kind='pid', K_p=-1e6, K_i=0.0, K_d=-1e4, signal={kind='step', value=1.0, time=1.0}}"]
    out = tmp_path / "out"
    result = stribeck("run", scenario, *unstable, "--out", out, "--json")
    assert result.status == 1
    data = json.loads(result.out)
    assert data["status"] == "failed"
    assert data["reason"]
    assert data["reason"] in result.err
    rows = pyarrow.parquet.read_table(out / "trajectory.parquet")
    assert 100 <= len(rows) < 1001
    assert rows.schema.metadata[b"status"] == b"failed"
    assert "failed early" in (out / "plot.svg").read_text()


def test_without_room_for_the_page_the_numbers_are_kept(stribeck, scenario, tmp_path, monkeypatch):
    monkeypatch.setattr("stribeck.mouth.page.write_text", lambda path, text: _fails(path))
    result = stribeck("run", scenario, "--out", tmp_path / "out")
    assert (result.status, "without the plot and the page: No space left" in result.err) == (0, True)
    assert {path.name for path in (tmp_path / "out").iterdir()} == {
        "trajectory.csv",
        "trajectory.parquet",
        "summary.json",
    }
    monkeypatch.undo()
    assert stribeck("run", scenario, "--out", tmp_path / "out").status == 0
    assert {path.name for path in (tmp_path / "out").iterdir()} == set(RUN)


def _fails(path):
    raise OSError(28, "No space left on device", str(path))


@pytest.mark.parametrize("words", [("run",), ("run", "--law", "lugre", "--law", "lugre_sobczyk"), ("design",)])
def test_a_folder_in_a_file_s_place_is_refused_before_anything_runs(stribeck, scenario, tmp_path, words):
    (tmp_path / "out" / "summary.json").mkdir(parents=True)
    result = stribeck(words[0], scenario, *words[1:], "--out", tmp_path / "out")
    assert (result.status, result.out) == (2, "")
    assert "summary.json in it is a folder" in result.err


@pytest.mark.skipif(not hasattr(signal, "SIGINT") or sys.platform == "win32", reason="needs POSIX signals")
def test_ctrl_c_stops_a_long_run_and_writes_nothing(scenario, tmp_path):
    out = tmp_path / "out"
    words = ["--out", out, "--set", "solve.t_end=1e7", "--set", "output.step=1e4"]
    command = [sys.executable, "-m", "stribeck", "run", scenario, *words]
    process = subprocess.Popen(command, stderr=subprocess.PIPE)
    for _ in range(600):  # until it has begun
        if out.is_dir():
            break
        time.sleep(0.05)
    time.sleep(0.5)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=20)
    assert process.returncode == 130
    assert b"interrupted" in err
    assert not out.exists()

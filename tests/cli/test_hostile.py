"""Files, names and numbers that nobody means well with: one clear line, early, and nothing written."""

import json
import os
import stat
import subprocess
import sys
from pathlib import Path

import pytest

from stribeck.files import trouble, write_text
from stribeck.mouth.plots import plain
from stribeck.simulation import backend
from tests.shared import needs_links


def refused(outcome, *parts):
    assert outcome.status == 2, outcome.err
    assert outcome.out == ""
    lines = outcome.err.splitlines()
    assert all(line.isprintable() and len(line) <= 300 for line in lines)
    assert any(all(part in line for part in parts) for line in lines), outcome.err
    return lines


@pytest.mark.parametrize(("choice", "k_v"), [("sqrt", 1e155), ("compact", 1e103), ("sqrt", 1e300), ("compact", 1e300)])
def test_a_smooth_sign_as_steep_as_numbers_go(stribeck, scenario, choice, k_v):
    """m(v) is |v| then, and it was an OverflowError."""
    words = ("--set", "law.name=lugre_majorant", "--set", f"law.smooth_abs={choice}", "--set", f"law.k_v={k_v!r}")
    document = json.loads(stribeck("run", scenario, *words, "--set", "solve.t_end=2.0", "--json").out)
    other = json.loads(stribeck("run", scenario, "--set", "law.name=lugre", "--set", "solve.t_end=2.0", "--json").out)
    assert document["final"]["z"] == pytest.approx(other["final"]["z"], rel=1e-6)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs pipes with a name")
def test_pipes_by_name_are_not_waited_for(stribeck, scenario, tmp_path):
    for name in ("pipe.toml", "pipe.csv", "pipe.parquet", "pipe.py"):
        os.mkfifo(tmp_path / name)
    message = "must be a file, not a pipe or a device"
    refused(stribeck("run", tmp_path / "pipe.toml"), message)
    refused(stribeck("run", scenario, "--set", "law.parameters=pipe.toml"), message)
    refused(stribeck("run", scenario, "--set", "law.name=pipe.py:X"), message)
    for name in ("pipe.csv", "pipe.parquet"):
        signal = f'drive.signal={{kind="file",path="{name}",time="t",value="u"}}'
        refused(stribeck("run", scenario, "--set", signal), "drive.signal.path", message)
    refused(stribeck("run", "/dev/zero"), message)
    os.mkfifo(tmp_path / "fit.json")
    refused(stribeck("predict", "log.csv", "--fit", tmp_path), "--fit", "fit.json", message)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs pipes with a name")
def test_a_pipe_as_another_program_s_model_is_not_waited_for(stribeck, tmp_path):
    os.mkfifo(tmp_path / "arm.json")
    out = tmp_path / "arm.toml"
    refused(stribeck("import", "bam", tmp_path / "arm.json", "--out", out), "a pipe or a device")
    assert not out.exists()


@pytest.mark.thorough
@pytest.mark.skipif(sys.platform != "linux", reason="needs names that are not text")
def test_names_that_are_not_text(scenario, tmp_path):
    words = [sys.executable, "-m", "stribeck", "run"]
    strange, out = os.fsencode(tmp_path) + b"/b\xe9.toml", os.fsencode(tmp_path) + b"/o\xe9"
    scenario.rename(os.fsdecode(strange))
    done = subprocess.run([*words, strange, b"--out", out], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert r"o\udce9/summary.json" in done.stdout
    assert (Path(os.fsdecode(out)) / "summary.json").is_file()
    assert subprocess.run([*words, b"c\xe9.toml"], capture_output=True, check=False).returncode == 2


@pytest.mark.share(2)
@pytest.mark.pictures
@pytest.mark.parametrize("name", [r"$\foo$ [/red] <b>&", "_" + "x" * 3000])
def test_names_in_plots(stribeck, scenario, tmp_path, name):
    words = ("--set", f"name={json.dumps(name)}", "--set", "solve.t_end=0.1", "--out", tmp_path / "out")
    assert stribeck("run", scenario, *words).status == 0
    law = f"lugre_majorant:k_v=1{'0' * 250}e-245"
    assert stribeck("run", scenario, "--law", law, "--law", "lugre", *words).status == 0


def test_a_long_label_is_cut_and_nothing_in_it_is_a_formula():
    assert plain("$x$") == r"\$x\$"
    assert len(plain("x" * 3000)) == 60
    assert not plain("_x").startswith("_")


def places(tmp_path):
    (tmp_path / "file").write_text("x")
    return {
        "below a file": tmp_path / "file" / "x",
        "too long": tmp_path / ("x" * 300),
        "no folder at all": "/proc/nowhere/x",
    }


@pytest.mark.parametrize("which", ["below a file", "too long", "no folder at all"])
def test_places_that_cannot_be_written(stribeck, scenario, tmp_path, which):
    out = places(tmp_path)[which]
    before = sorted(tmp_path.rglob("*"))
    refused(stribeck("run", scenario, "--out", out), "--out: ")
    refused(stribeck("run", scenario, "--law", "lugre", "--out", out), "--out: ")
    refused(stribeck("sweep", scenario, "--vary", "plant.mass=1:2:2", "--out", out), "--out: ")
    for target in ("c", "fmu", "table"):
        words = ("lugre", "--parameters", "canudas1995", "--target", target)
        refused(stribeck("export", *words, "--out", out), "--out: ")
    refused(stribeck("new", "mine", "--out", out), "--out: ")
    assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="root may write anywhere")
def test_a_folder_that_is_closed(tmp_path):
    tmp_path.chmod(stat.S_IRUSR | stat.S_IXUSR)
    assert "Permission denied" in trouble(tmp_path / "x")
    assert "Permission denied" in trouble(tmp_path / "x" / "y", folder=True)


@needs_links
def test_devices_and_links_stay_what_they_are(tmp_path):
    real, link = tmp_path / "real", tmp_path / "link"
    link.symlink_to(real)
    write_text(link, "text")
    assert link.is_symlink()
    assert real.read_text() == "text"
    (tmp_path / "astray").symlink_to(tmp_path / "none" / "file")  # no folder is made for a link's target
    assert "there is no folder" in trouble(tmp_path / "astray")
    write_text(type(real)(os.devnull), "text")
    assert not type(real)(os.devnull).is_file()


def test_errors_name_the_users_file(tmp_path, stribeck, scenario):
    """And not the one that is written beside it."""
    (tmp_path / "out" / "0_lugre.csv").mkdir(parents=True)
    laws = ("--law", "lugre", "--law", "lugre_sobczyk")
    outcome = stribeck("run", scenario, "--set", "solve.t_end=0.1", *laws, "--out", tmp_path / "out")
    assert outcome.status == 1
    assert "0_lugre.csv" in outcome.err
    assert ".tmp" not in outcome.err


def test_no_memory_is_one_line(stribeck, scenario, monkeypatch):
    def full(*args):
        raise MemoryError("Unable to allocate 8. TiB")

    monkeypatch.setattr(backend, "solver", full)
    outcome = stribeck("run", scenario)
    assert (outcome.status, outcome.out) == (1, "")
    assert outcome.err.endswith("stribeck: not enough memory: Unable to allocate 8. TiB\n")


@pytest.mark.parametrize("word", ["\x1b[2J", "x" * 500])
def test_usage_is_one_line_too(stribeck, scenario, word):
    refused(stribeck("run", scenario, word), "unexpected extra argument")


@pytest.mark.parametrize(
    "words",
    [
        ("fit", "arm.toml", "--logs", "logs.toml"),
        ("fit", "log.csv", "--law", "lugre", "--time", "a", "--position", "b"),
        ("design", "arm.toml", "--vary", "bodies.arm.inertia"),
    ],
)
def test_what_is_refused_after_the_folder_was_tried_leaves_no_folder(stribeck, scenario, monkeypatch, words):
    """Each left an empty folder."""
    monkeypatch.chdir(scenario.parent)
    stribeck("new", "arm")
    Path("logs.toml").write_text("[unknown]\nx = 1\n")
    Path("log.csv").write_text("a,b\n1,2\n")
    before = sorted(Path().iterdir())
    refused(stribeck(*words, "--out", "new/folder"))
    assert sorted(Path().iterdir()) == before


@pytest.mark.pictures
@pytest.mark.filterwarnings("ignore")
def test_a_position_at_the_end_of_the_numbers_is_not_drawn(stribeck, scenario, tmp_path):
    """It ended in a traceback of the plots."""
    words = ("--set", "plant.initial.y=1e308", "--set", "solve.t_end=0.1", "--out", tmp_path / "out")
    assert stribeck("run", scenario, *words).status == 1  # its motion is none
    assert (tmp_path / "out" / "plot.svg").is_file()


@pytest.mark.skipif(os.name != "posix", reason="needs a shell that closes streams")
def test_streams_that_the_shell_has_closed(scenario):
    """Without standard error it was asked whether that is a terminal: nothing came out, with status 1."""
    words = f"'{sys.executable}' -m stribeck run '{scenario}' --set solve.t_end=0.1"
    done = subprocess.run(["sh", "-c", f"{words} 2>&-"], capture_output=True, text=True, check=False)
    assert done.returncode == 0
    assert "done" in done.stdout
    done = subprocess.run(["sh", "-c", f"{words} >&-"], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


def test_a_library_that_cannot_be_loaded(stribeck, scenario, monkeypatch):
    """Where no memory is left for one, or its file is damaged; it was a traceback."""

    def missing(*args, **named):
        raise ImportError("x.so: failed to map segment from shared object")

    monkeypatch.setattr("stribeck.cli.options.load_scenario", missing)
    process = stribeck("run", scenario)
    assert (process.status, process.out) == (1, "")
    assert process.err == "stribeck: a library cannot be loaded: x.so: failed to map segment from shared object\n"

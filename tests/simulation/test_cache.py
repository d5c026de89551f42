"""The cache of compiled systems: damaged, unwritable, full, and shared by processes."""

import errno
import json
import os
import subprocess
import sys
import threading
import warnings
from pathlib import Path

import pytest

from stribeck import Scenario, StribeckNote, simulate
from stribeck.simulation import cache, compiler
from tests.simulation import independent
from tests.simulation.rig import needs_compiler, rig

pytestmark = needs_compiler

DATA = rig("lugre", "force", {"kind": "ramp", "rate": 3.0}, 0.8)
Y = independent.solve(DATA)["y"][-1]
QUICK = ("-O0", "-fPIC", "-shared", "-fvisibility=hidden")  # these tests compile often


@pytest.fixture
def home(tmp_path, monkeypatch):
    """An empty cache, in this process too."""
    folder = tmp_path / "cache"
    monkeypatch.setenv("STRIBECK_CACHE", str(folder))
    monkeypatch.setattr(cache, "_loaded", {})
    monkeypatch.setattr(compiler, "_FLAGS", QUICK)
    return folder


def forget(monkeypatch):
    monkeypatch.setattr(cache, "_loaded", {})


def run(built, notes=()):
    """Simulate; the notes must be these, each a line, and the result right."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        solution = simulate(Scenario(DATA))
    said = [str(w.message) for w in caught]
    assert all(issubclass(w.category, StribeckNote) for w in caught)
    assert len(said) == len(notes), said
    assert all(part in text and "\n" not in text for part, text in zip(notes, said, strict=True)), said
    assert solution.status == "done"
    assert solution.stats["solver"] == "rodas5p"
    assert solution.stats["built"] is built
    assert solution["y"][-1] == pytest.approx(Y, rel=1e-6)


def test_a_system_is_built_once(home, monkeypatch):
    run(built=True)
    run(built=False)
    forget(monkeypatch)
    run(built=False)
    assert len(list(home.iterdir())) == 1


@pytest.mark.parametrize("place", ["/dev/null/x", "file/x", "file"])
def test_a_folder_that_cannot_be_made(place, home, tmp_path, monkeypatch):
    (tmp_path / "file").write_text("not a folder")
    monkeypatch.setenv("STRIBECK_CACHE", str(tmp_path / place))
    run(built=True, notes=["cannot be written"])
    run(built=False)


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_a_folder_that_is_read_only(home):
    home.mkdir(mode=0o500)
    run(built=True, notes=["cannot be written (Permission denied)"])


def full(*args, **kwargs):
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def test_a_full_disk_when_writing(home, monkeypatch):
    def file(*args, **kwargs):
        made = real(*args, **kwargs)
        made.write = full
        return made

    real = cache.tempfile.NamedTemporaryFile
    monkeypatch.setattr(cache.tempfile, "NamedTemporaryFile", file)
    run(built=True, notes=["cannot be written (No space left on device)"])
    assert list(home.iterdir()) == []


def test_a_full_disk_when_moving(home, monkeypatch):
    monkeypatch.setattr(Path, "replace", full)
    run(built=True, notes=["cannot be written (No space left on device)"])
    assert list(home.iterdir()) == []


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")
def test_a_disk_that_is_really_full(home, monkeypatch):
    def file(**options):
        return Path("/dev/full").open("wb")

    monkeypatch.setattr(cache.tempfile, "NamedTemporaryFile", file)
    monkeypatch.setattr(Path, "unlink", lambda self: None)
    run(built=True, notes=["cannot be written (No space left on device)"])


@pytest.mark.parametrize("content", [b"", b"\x7fELF", b"garbage" * 1000, 100, 4096, 20000, -1])
def test_a_damaged_file(content, home, monkeypatch):
    """Garbage, or the file cut after so many bytes."""
    run(built=True)
    (file,) = home.iterdir()
    whole = file.read_bytes()
    file.unlink()  # a new file: the old one is loaded in this process
    file.write_bytes(whole[:content] if isinstance(content, int) else content)
    forget(monkeypatch)
    run(built=True, notes=["damaged; the system is compiled anew"])
    forget(monkeypatch)
    run(built=False)


def test_a_file_that_is_whole_and_no_library(home, monkeypatch):
    run(built=True)
    (file,) = home.iterdir()
    file.unlink()
    (home / "other").write_text("text")
    (home / "other").rename(home / f"{file.stem.split('-')[0]}-{cache._digest(home / 'other')}.so")
    forget(monkeypatch)
    run(built=True, notes=["cannot be loaded"])
    forget(monkeypatch)
    run(built=False)


def test_a_damaged_file_that_cannot_be_removed(home, monkeypatch):
    run(built=True)
    (file,) = home.iterdir()
    name = home / f"{file.stem.split('-')[0]}-{'0' * 32}.so"
    file.unlink()
    name.mkdir()
    forget(monkeypatch)
    run(built=True, notes=["cannot be loaded (Is a directory)"])


def test_threads_that_build_at_once(home):
    found = []
    threads = [threading.Thread(target=lambda: found.append(simulate(Scenario(DATA)))) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert {solution["y"][-1] for solution in found} == {found[0]["y"][-1]}
    assert len(found) == 4


PROCESS = """
import json, os, sys, time, warnings
from pathlib import Path
warnings.simplefilter("error")
import stribeck
from stribeck.simulation import cache, compiler, simulate
scenario, home, me, turns = stribeck.Scenario(json.loads(sys.argv[1])), sys.argv[2], sys.argv[3], int(sys.argv[4])
compiler._FLAGS = tuple(sys.argv[5].split())
Path(home, "ready" + me).touch()
while not Path(home, "go").exists():
    time.sleep(0.001)
for turn in range(turns):
    time.sleep(max(0.0, Path(home, "go").stat().st_mtime + 0.1 + 0.5 * turn - time.time()))
    os.environ["STRIBECK_CACHE"] = str(Path(home, "cache" + str(turn)))
    cache._loaded.clear()
    solution = simulate(scenario)
    print(solution.stats["built"], repr(float(solution["y"][-1])))
"""


def test_processes_that_build_at_once(tmp_path):
    """Processes that find the same empty cache at the same instant, several times over."""
    turns = 4

    def start(me):
        command = [sys.executable, "-c", PROCESS, json.dumps(DATA), str(tmp_path), me, str(turns), " ".join(QUICK)]
        return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def values(process):
        out, error = process.communicate(timeout=60)
        assert error == ""
        return [line.split() for line in out.splitlines()]

    processes = [start(str(i)) for i in range(3)]
    while not all((tmp_path / f"ready{i}").exists() for i in range(3)):
        assert all(process.poll() is None for process in processes)
    (tmp_path / "go").touch()
    found = [values(process) for process in processes]
    assert {y for rows in found for _, y in rows} == {found[0][0][1]}
    assert sum(built == "True" for rows in found for built, _ in rows) >= turns
    for turn in range(turns):
        kept = list((tmp_path / f"cache{turn}").iterdir())
        assert kept
        assert all(file.stem.split("-")[1] == cache._digest(file) for file in kept)
    assert [built for built, _ in values(start("late"))] == ["False"] * turns

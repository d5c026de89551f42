"""The cache of compiled systems: damaged, unwritable, full, and shared by processes."""

import ctypes
import errno
import json
import os
import subprocess
import sys
import tempfile
import threading
import time
import warnings
from pathlib import Path

import pytest

from stribeck import Scenario, simulate
from stribeck.errors import BuildError, StribeckNote
from stribeck.simulation import cache, compiler
from stribeck.simulation.layout import declare
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
    monkeypatch.setenv("STRIBECK_BACKEND", "auto")  # C is the subject
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
    texts = [str(w.message) for w in caught]
    assert all(issubclass(w.category, StribeckNote) for w in caught)
    assert len(texts) == len(notes), texts
    assert all(part in text and "\n" not in text for part, text in zip(notes, texts, strict=True)), texts
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


@pytest.mark.skipif(not hasattr(os, "geteuid"), reason="needs users with numbers")
def test_a_user_without_a_home(home, tmp_path, monkeypatch):
    """A container's user may be a number alone: it was a traceback."""
    import platformdirs

    def nowhere(*args, **more):
        raise RuntimeError("could not determine the home directory")

    monkeypatch.delenv("STRIBECK_CACHE")
    monkeypatch.setattr(platformdirs, "user_cache_dir", nowhere)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    run(built=True)
    own = tmp_path / f"stribeck-{os.geteuid()}"
    assert own.stat().st_mode & 0o777 == 0o700
    assert len(list(own.iterdir())) == 1


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="root may write anywhere")
def test_a_folder_that_is_read_only(home):
    home.mkdir(mode=0o500)
    run(built=True, notes=["cannot be written (Permission denied)"])


def full(*args, **kwargs):
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


@pytest.mark.parametrize("place", [(tempfile._TemporaryFileWrapper, "close"), (Path, "replace")])
def test_a_full_disk(place, home, monkeypatch):
    """When it is written, and when it is moved."""
    monkeypatch.setattr(*place, full)
    run(built=True, notes=["cannot be written (No space left on device)"])
    assert list(home.iterdir()) == []


@pytest.mark.share(3)
@pytest.mark.parametrize("content", [b"", b"\x7fELF", b"garbage" * 1000, 100, 4096, 20000, -1])
def test_a_damaged_file(content, home, monkeypatch):
    """Garbage, or the file cut after so many bytes."""
    run(built=True)
    (file,) = home.iterdir()
    whole = file.read_bytes()
    file.unlink()  # a new file: the old one is loaded in this process
    file.touch(0o600)
    file.write_bytes(whole[:content] if isinstance(content, int) else content)
    forget(monkeypatch)
    run(built=True, notes=["damaged; the system is compiled anew"])
    forget(monkeypatch)
    run(built=False)


@pytest.mark.parametrize("text", ["text", None])
def test_what_is_no_library(text, home, monkeypatch):
    """A file that is whole, and a folder, which cannot be removed."""
    run(built=True)
    (file,) = home.iterdir()
    file.unlink()
    other = home / f"{file.stem.split('-')[0]}-{cache._digest(text.encode()) if text else '0' * 32}.so"
    if text:
        (home / "other").write_text(text)
        (home / "other").chmod(0o600)
        (home / "other").rename(other)
    else:
        other.mkdir(0o700)
    forget(monkeypatch)
    run(built=True, notes=["cannot be loaded" if text else "cannot be loaded (Is a directory)"])
    forget(monkeypatch)
    run(built=False, notes=[] if text else ["cannot be loaded (Is a directory)"])


def mode(path):
    return path.stat().st_mode & 0o777


@pytest.mark.skipif(not hasattr(os, "geteuid"), reason="users have no numbers here")
class TestOtherUsers:
    """A library is code that runs: what another user owns or could have written is not loaded."""

    def test_the_folder_is_closed_to_them(self, home):
        before = os.umask(0)
        try:
            run(built=True)
        finally:
            os.umask(before)
        (file,) = home.iterdir()
        assert (mode(home), mode(file)) == (0o700, 0o600)

    def test_an_open_folder_of_ours_is_closed(self, home):
        home.mkdir()
        home.chmod(0o777)
        run(built=True)
        assert mode(home) == 0o700

    @pytest.mark.parametrize(("open_to", "notes"), [
        (0o777, ["is open to other users and holds other files: it is not used"]), (0o755, []),
    ])  # fmt: skip
    def test_a_folder_of_other_things_stays_as_it_is(self, home, open_to, notes):
        """$STRIBECK_CACHE = /tmp, set by root, closed /tmp to every other user."""
        home.mkdir()
        (home / "letter.txt").touch()
        home.chmod(open_to)
        run(built=True, notes=notes)
        assert mode(home) == open_to
        assert len(list(home.glob("*.so"))) == (not notes)

    def test_the_folder_by_its_relative_name(self, home, monkeypatch):
        """Libraries of the current folder were never found again: their bare names were looked for on the system's path."""
        home.mkdir()
        monkeypatch.chdir(home)
        monkeypatch.setenv("STRIBECK_CACHE", ".")
        run(built=True)
        forget(monkeypatch)
        run(built=False)

    def test_a_folder_of_theirs_is_not_used(self, home, monkeypatch):
        run(built=True)
        forget(monkeypatch)
        monkeypatch.setattr(os, "geteuid", lambda: 12345)
        run(built=True, notes=["belongs to another user: it is not used"])
        assert len(list(home.iterdir())) == 1

    def test_a_file_that_they_can_write_is_built_anew(self, home, monkeypatch):
        run(built=True)
        (file,) = home.iterdir()
        file.chmod(0o666)
        forget(monkeypatch)
        run(built=True, notes=["may have been written by another user; the system is compiled anew"])
        assert mode(file) == 0o600
        forget(monkeypatch)
        run(built=False)

    @pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="only root gives files away")
    def test_a_file_of_theirs_is_built_anew(self, home, monkeypatch):
        run(built=True)
        (file,) = home.iterdir()
        os.chown(file, 12345, 12345)
        forget(monkeypatch)
        run(built=True, notes=["may have been written by another user"])
        assert file.stat().st_uid == 0

    def test_a_link_is_not_followed(self, home, monkeypatch, tmp_path):
        run(built=True)
        (file,) = home.iterdir()
        file.rename(tmp_path / "elsewhere.so")
        file.symlink_to(tmp_path / "elsewhere.so")
        forget(monkeypatch)
        run(built=True, notes=["may have been written by another user"])
        assert not file.is_symlink()


def test_a_library_that_is_another_one_is_built_anew(home, monkeypatch):
    """Not WebAssembly for ever."""
    run(built=True)
    (file,) = home.iterdir()
    key = file.stem.split("-")[0]
    file.unlink()
    (home / "other.c").write_text("int other(void) { return 1; }")
    result = compiler.find()
    result.build(home / "other.c", home / "other.so")
    (home / "other.so").chmod(0o600)
    (home / "other.so").rename(home / f"{key}-{cache._digest((home / 'other.so').read_bytes())}.so")
    forget(monkeypatch)
    run(built=True, notes=["the library built is not a compiled system; the system is compiled anew"])
    forget(monkeypatch)
    run(built=False)


def test_a_place_that_libraries_cannot_be_loaded_from(home, monkeypatch):
    """As where the folder is mounted noexec."""

    class Library(ctypes.CDLL):
        def __init__(self, path):
            if path.startswith(str(forbidden)):
                raise OSError(f"{path}: failed to map segment from shared object")
            super().__init__(path)

    monkeypatch.setattr(cache.ctypes, "CDLL", Library)
    forbidden = home
    run(built=True)
    forget(monkeypatch)
    run(built=True, notes=["cannot be loaded"])
    forget(monkeypatch)
    forbidden = Path(tempfile.gettempdir()) / "stribeck-"  # where it is built
    (kept,) = home.iterdir()
    kept.unlink()
    run(built=True)
    assert len(list(home.iterdir())) == 1


def test_threads_that_build_at_once(home):
    results = []
    threads = [threading.Thread(target=lambda: results.append(simulate(Scenario(DATA)))) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert {solution["y"][-1] for solution in results} == {results[0]["y"][-1]}
    assert len(results) == 4


PROCESS = """
import json, sys, warnings
warnings.simplefilter("error")
import stribeck
from stribeck.simulation import compiler
compiler._FLAGS = tuple(sys.argv[2].split())
sys.stdin.read()
solution = stribeck.simulate(json.loads(sys.argv[1]))
print(solution.stats["built"], repr(float(solution["y"][-1])))
"""


@pytest.mark.thorough
def test_processes_that_build_at_once(home, monkeypatch):
    """Processes that find the same empty cache at the same instant, and one that comes later."""
    monkeypatch.setenv("STRIBECK_BACKEND", "c")
    command, pipe = [sys.executable, "-c", PROCESS, json.dumps(DATA), " ".join(QUICK)], subprocess.PIPE
    processes = [subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=pipe, text=True) for _ in range(4)]
    time.sleep(3)  # they wait at the end of their input
    for process in processes[:3]:
        process.stdin.close()
        process.stdin = None
    printed = [process.communicate(timeout=60) for process in processes]
    assert [complaint for _, complaint in printed] == [""] * 4
    outputs = [text.split() for text, _ in printed]
    assert len({y for _, y in outputs}) == 1
    assert [built for built, _ in outputs].count("True") >= 1
    assert outputs[3][0] == "False"
    assert all(file.stem.split("-")[1] == cache._digest(file.read_bytes()) for file in home.iterdir())


def test_a_library_of_another_version_is_not_called():
    class Shared(ctypes.Structure):
        _fields_ = (("t", ctypes.c_double),)

    class Library:
        size = staticmethod(lambda: 16)

    with pytest.raises(BuildError, match="built for another version of Stribeck"):
        declare(Library(), "a system", Shared, "size", {})

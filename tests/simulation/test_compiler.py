"""Compilers that fail, hang, lie or are not there: a line says so, and WebAssembly solves the same equations."""

import importlib.util
import os
import shutil
import sys
import time
import warnings
from pathlib import Path

import numpy as np
import pytest

from stribeck import Scenario, simulate
from stribeck.errors import StribeckNote
from stribeck.simulation import cache, compiler
from tests.simulation import independent
from tests.simulation.rig import needs_compiler, rig

pytestmark = pytest.mark.skipif(os.name != "posix", reason="the compilers are shell scripts")
DATA = rig("lugre_sobczyk", "force", {"kind": "ramp", "rate": 3.0}, 0.7, rows=50)


@pytest.fixture(autouse=True)
def _fresh(tmp_path, monkeypatch):
    monkeypatch.setenv("STRIBECK_CACHE", str(tmp_path / "cache"))
    monkeypatch.setenv("STRIBECK_BACKEND", "auto")  # C is the subject
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setattr(cache, "_loaded", {})


@pytest.fixture
def use(tmp_path, monkeypatch):
    """Make a shell script the compiler."""

    def chosen(script, mode=0o755, name="mycc"):
        path = tmp_path / name
        path.write_text(script)
        path.chmod(mode)
        monkeypatch.setenv("STRIBECK_CC", str(path))

    return chosen


def message(backend):
    """Simulate with the backend expected; the notes, after a look at the result."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        solution = simulate(Scenario(DATA))
    assert solution.status == "done"
    assert solution.stats["backend"] == backend
    expected = independent.solve(DATA)
    for name in ("y", "v", "F"):
        np.testing.assert_allclose(solution[name], expected[name], rtol=0, atol=1e-6 * np.max(np.abs(expected[name])))
    assert all(issubclass(w.category, StribeckNote) for w in caught)
    notes = [str(w.message) for w in caught]
    assert all("\n" not in text for text in notes)
    return notes


def test_a_compiler_that_is_put_in_place_or_replaced_is_noticed(tmp_path, monkeypatch):
    monkeypatch.setenv("STRIBECK_CC", "mycc -g")
    monkeypatch.setenv("PATH", str(tmp_path))
    assert compiler.find().command == ("mycc", "-g")  # it is not there, which is said when it is run
    path = tmp_path / "mycc"
    path.write_text("#!/bin/sh\n")
    path.chmod(0o755)
    first = compiler.find()
    assert first.command == (str(path), "-g")
    assert compiler.find() is first
    path.write_text("#!/bin/sh\nexit 1\n")
    assert compiler.find().key != first.key
    path.unlink()
    assert compiler.find().command == ("mycc", "-g")
    monkeypatch.delenv("STRIBECK_CC")
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    assert compiler.find() is None


GARBAGE = '#!/bin/sh\nwhile [ "$1" != -o ]; do shift; done\necho garbage > "$2"\n'
PLAIN = """#!/bin/sh
for word; do [ "$word" = -mmove-max=128 ] && echo "error: unknown option" >&2 && exit 1; done
echo "error: no space left" >&2; exit 1
"""
FAULTS = {
    "complains": (
        "#!/bin/sh\necho 'note: thinking' >&2\necho 'system.c:1: fatal error: no\nmore' >&2\nexit 1\n",
        "compiling failed (mycc failed: system.c:1: fatal error: no): solving by WebAssembly",
    ),
    "fails without a word": ("#!/bin/sh\nexit 3\n", "exit status 3, no message"),
    "complains in no known letters": ("#!/bin/sh\nprintf 'error: \\377\\376 bad\\n' >&2\nexit 1\n", "error"),
    "complains of the plainest command": (PLAIN, "no space left"),
    "writes nothing": ("#!/bin/sh\nexit 0\n", "mycc failed: it wrote no library"),
    "writes garbage": (GARBAGE, "compiling failed ("),
    "may not be run": ("#!/bin/sh\n", "cannot be run: Permission denied"),
    "is no program": ("not a program", "cannot be run: Exec format"),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_compiler_that(fault, use):
    script, reported = FAULTS[fault]
    use(script, 0o644 if fault == "may not be run" else 0o755)
    (note,) = message("wasm")
    assert reported in note


@pytest.mark.skipif(sys.platform != "linux", reason="looks at /proc")
def test_what_a_compiler_started_ends_with_it(use, monkeypatch, tmp_path):
    monkeypatch.setattr(compiler, "_TIME_LIMIT", 0.5)
    use(f"#!/bin/sh\nsleep 60 &\necho $! > {tmp_path}/child\nwait\n")
    assert "did not finish within 0.5 s" in message("wasm")[0]
    state = Path("/proc", (tmp_path / "child").read_text().strip(), "stat")
    for _ in range(40):
        if (
            not state.exists() or state.read_text().rpartition(")")[2].split()[0] == "Z"
        ):  # ended; nobody asked for its status
            return
        time.sleep(0.05)
    pytest.fail("it goes on")


def test_a_compiler_that_is_not_there(monkeypatch):
    monkeypatch.setenv("STRIBECK_CC", "/nowhere/cc")
    assert "/nowhere/cc cannot be run: No such file or directory" in message("wasm")[0]


def test_no_compiler(monkeypatch):
    monkeypatch.setenv("STRIBECK_CC", "none")
    assert message("wasm") == []


@needs_compiler
@pytest.mark.parametrize("unknown", ["-march=native", "-mmove-max=128"])
def test_a_compiler_that_does_not_know_an_option(unknown, use):
    real = " ".join(compiler.find().command)
    use(f'#!/bin/sh\nfor word; do [ "$word" = {unknown} ] && echo "error: what?" >&2 && exit 1; done\n{real} "$@"\n')
    assert message("c") == []


def test_which_compiler_is_chosen(use, monkeypatch, tmp_path):
    use("#!/bin/sh\n", name="first")
    use("#!/bin/sh\n", name="second")
    monkeypatch.setenv("CC", str(tmp_path / "first"))
    assert compiler.find().command == (str(tmp_path / "second"),)
    monkeypatch.delenv("STRIBECK_CC")
    assert compiler.find().command == (str(tmp_path / "first"),)
    monkeypatch.setenv("CC", "/nowhere/cc")  # set by other tools, for other ends
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    assert compiler.find() is None
    shutil.copy(tmp_path / "first", tmp_path / "clang")
    assert compiler.find().command == (str(tmp_path / "clang"),)


def test_another_compiler_or_other_options_make_another_key(use, tmp_path, monkeypatch):
    use("#!/bin/sh\n")
    keys = [compiler.find().key]
    use("#!/bin/sh\n# a newer version\n")
    keys.append(compiler.find().key)
    monkeypatch.setenv("STRIBECK_CC", f"{tmp_path}/mycc -O1")
    keys.append(compiler.find().key)
    monkeypatch.setattr(compiler, "_FLAGS", ("-O0",))
    keys.append(compiler.find().key)
    monkeypatch.setattr(compiler, "processor", lambda: "another")
    keys.append(compiler.find().key)
    assert len(set(keys)) == 5


@pytest.mark.thorough
@pytest.mark.skipif(importlib.util.find_spec("ziglang") is None, reason="needs the package ziglang")
def test_zig(monkeypatch):
    monkeypatch.setenv("STRIBECK_CC", f"{sys.executable} -m ziglang cc")
    assert message("c") == []


def test_where_a_compiler_puts_its_temporary_files(use, tmp_path, monkeypatch):
    """$TMPDIR may be full: Python then takes another folder, and the compiler failed in the full one."""
    (tmp_path / "full").mkdir()
    monkeypatch.setenv("TMPDIR", str(tmp_path / "full"))
    use(f'#!/bin/sh\n[ "$TMPDIR" = {tmp_path / "full"} ] && exit 1\nexec {shutil.which("cc") or "cc"} "$@"\n')
    assert simulate(Scenario(DATA)).stats["solver"] == "rodas5p"


def test_the_complaint_is_the_error_and_no_warning_that_names_a_file_of_errors():
    text = (
        "warning(zcu): unable to write cached code for /lib/errors.zig\nfmu.c:3:1: error: unknown type\nerror: 1 of 2\n"
    )
    assert compiler.first_complaint(text) == "fmu.c:3:1: error: unknown type"
    assert compiler.first_complaint("Error 2\nx\n") == "Error 2"
    assert compiler.first_complaint("") == ""


@pytest.mark.thorough
@pytest.mark.skipif(importlib.util.find_spec("ziglang") is None, reason="no ziglang")
def test_zig_builds_lanes(tmp_path):
    """It ends at an option of GCC's that it does not know, where other compilers warn."""
    source = tmp_path / "lanes.c"
    source.write_text("double twice(double x) { return 2 * x; }\n")
    zig = compiler.Compiler((sys.executable, "-m", "ziglang", "cc"), "zig")
    for each in (zig, zig.for_lanes()):
        library = tmp_path / f"{len(each.options)}.so"
        each.build(source, library)
        assert library.is_file()

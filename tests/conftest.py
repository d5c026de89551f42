"""Fixtures for every test."""

import os
import shutil
import signal
from pathlib import Path

import pytest
from hypothesis import settings

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # as the command has it: more threads only spin on small matrices
settings.register_profile("any machine", deadline=None)  # a busy one is no fault of a test
settings.load_profile("any machine")


def pytest_runtest_setup():
    """Let Ctrl-C reach the programs that a test starts.

    A job in a shell's background ignores it, as does a process after `cli.main`, and so would their children.
    """
    signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_collection_modifyitems(items):
    """Of a family marked ``share(n)`` each n-th case is run by `make test`, from its first on; the rest is thorough."""
    seen = {}
    for item in items:
        if share := item.get_closest_marker("share"):
            family = item.nodeid.partition("[")[0]
            seen[family] = seen.get(family, -1) + 1
            if seen[family] % share.args[0]:
                item.add_marker("thorough")


# The rooms whose subject is what the compiler makes of a system: there it is called as a user's run calls it.
AS_USERS_COMPILE = {"codegen", "reference"}
# Elsewhere systems are compiled in a third of the time, and run slower; `make thorough` compiles all as a user's run.
QUICKLY = "-O0"
# Where one system is solved many times: in half the time, and a fifth slower.
SOLVE_MUCH = dict.fromkeys(
    ("identify", "loops", "kept"), "-O1 -fexpensive-optimizations -fno-inline-functions-called-once"
)


@pytest.fixture(scope="session", autouse=True)
def _cache_folder(tmp_path_factory):
    """Compiled systems go into a folder of the test run's own, shared by its workers."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("STRIBECK_CACHE", str(tmp_path_factory.getbasetemp().parent / "stribeck-cache"))
        yield


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item, nextitem):
    """Choose the compiler before the first fixture of a test compiles."""
    room = Path(item.fspath).relative_to(Path(__file__).parent).parts[0]
    with pytest.MonkeyPatch.context() as patch:
        if room not in AS_USERS_COMPILE and (quick := _quick_compiler(item.config, SOLVE_MUCH.get(room, QUICKLY))):
            patch.setenv("STRIBECK_CC", quick)
        return (yield)


def _quick_compiler(config, options):
    """A script that calls the C compiler with less optimization; None where there is none, or another was asked for."""
    path = shutil.which("cc") or shutil.which("gcc")
    chosen = os.environ.get("STRIBECK_CC") or os.environ.get("CC")
    if chosen or path is None or os.name != "posix" or config.option.markexpr == "thorough":
        return None
    script = config._tmp_path_factory.getbasetemp().parent / f"stribeck-cc{options.split()[0]}"
    if not script.exists():
        draft = script.with_name(f"{script.name}-{os.getpid()}")
        draft.write_text(f'#!/bin/sh\nexec {path} "$@" {options}\n')
        draft.chmod(0o755)
        os.utime(draft, (0, 0))  # the same file to every worker, and to the cache's key
        draft.replace(script)
    return str(script)


@pytest.fixture
def each_system_is_run_once(monkeypatch):
    """Many systems of their own, each run once: not worth optimizing."""
    monkeypatch.setattr("stribeck.simulation.compiler._FLAGS", ("-O0", "-fPIC", "-shared", "-fvisibility=hidden"))


BLANK = (
    '<?xml version="1.0"?>\n<svg xmlns="http://www.w3.org/2000/svg" width="9pt" height="9pt" viewBox="0 0 9 9"></svg>\n'
)


@pytest.fixture(autouse=True)
def _blank_pictures(request, monkeypatch):
    """Figures are made but drawn only in tests marked ``pictures``: half of a command's time goes into drawing."""
    if "pictures" not in request.keywords:
        monkeypatch.setattr("stribeck.mouth.plots.svg", lambda made: BLANK)

"""stribeck doctor: what it finds, and that it says so in any installation."""

import json
import os

import pytest

from stribeck.simulation import wasm
from tests.simulation.rig import needs_compiler

needs_scripts = pytest.mark.skipif(os.name != "posix", reason="needs scripts that run")


def reported(stribeck):
    process = stribeck("doctor", "--json")
    assert process.err == ""
    return process.status, json.loads(process.out)


@pytest.fixture
def compiler(tmp_path, monkeypatch):
    """A compiler that answers to --version with these bytes in octal, at a path with a blank."""

    def built(answer):
        path = tmp_path / "my compilers" / "cc"
        path.parent.mkdir()
        path.write_text(f'#!/bin/sh\nif [ "$1" = --version ]; then {answer}; exit; fi\nexec cc "$@"\n')
        path.chmod(0o755)
        monkeypatch.setenv("STRIBECK_CC", str(path))
        return str(path)

    return built


@needs_compiler
def test_a_healthy_installation_passes(stribeck, tmp_path, monkeypatch):
    monkeypatch.setattr("stribeck.simulation.cache._loaded", {})  # by other tests of this process
    monkeypatch.delenv("STRIBECK_BACKEND", raising=False)
    monkeypatch.setenv("STRIBECK_CACHE", str(tmp_path))
    assert "0 systems" in stribeck("doctor").out  # before the self-test's
    status, outcome = reported(stribeck)
    assert (status, outcome["backend"], outcome["self_test"]["passed"]) == (0, "c", True)
    assert outcome["self_test"]["deviation"] < 1e-6
    assert outcome["compiler"]["version"]
    text, cache, test = " ".join(stribeck("doctor").out.split()), outcome["cache"], outcome["self_test"]
    for words in (
        f"{outcome['compiler']['command']}: {outcome['compiler']['version']}", "backend C cache",
        f", writable, {cache['systems']} systems, {cache['bytes'] / 1e6:.1f} MB", "self-test passed: ",
        f"{test['deviation']:.1e} of the peaks from {test['against']}", f"numpy {outcome['packages']['numpy']}",
    ):  # fmt: skip
        assert words in text
    assert cache["writable"]
    assert cache["systems"]


def test_a_cache_that_cannot_be_written_is_said(stribeck, tmp_path, monkeypatch):
    (tmp_path / "file").touch()
    monkeypatch.setenv("STRIBECK_CACHE", str(tmp_path / "file"))
    monkeypatch.setenv("STRIBECK_BACKEND", "wasm")
    assert reported(stribeck)[1]["cache"]["writable"] is False
    assert "NOT writable: every process compiles anew, 0 systems, 0.0 MB" in " ".join(stribeck("doctor").out.split())


def test_without_a_compiler_it_says_what_solves(stribeck, monkeypatch):
    monkeypatch.setenv("STRIBECK_CC", "none")
    status, outcome = reported(stribeck)
    assert (status, outcome["backend"], outcome["compiler"]["command"]) == (0, "wasm", None)
    assert "none: WebAssembly solves" in stribeck("doctor").out


@needs_scripts
@needs_compiler
@pytest.mark.parametrize(
    ("answer", "version"),
    [("printf '\\377\\376 cc 1\\n'", "\ufffd\ufffd cc 1"), ("exit 1", "does not answer to --version")],
)
def test_a_compiler_with_a_blank_in_its_path_and_a_version_that_is_no_text(stribeck, compiler, answer, version):
    path = compiler(answer)
    status, outcome = reported(stribeck)
    assert (status, outcome["compiler"]["command"], outcome["compiler"]["version"]) == (0, path, version)


@needs_compiler
def test_a_solver_that_errs_fails(stribeck, monkeypatch):
    solve = wasm.solve

    def erring(*given):
        result = solve(*given)
        result.states[:, 1] *= 1.001  # the speed alone
        return result

    monkeypatch.delenv("STRIBECK_BACKEND", raising=False)
    monkeypatch.setattr(wasm, "solve", erring)
    status, outcome = reported(stribeck)
    assert (status, outcome["self_test"]["passed"], outcome["self_test"]["reason"]) == (1, False, None)
    assert outcome["self_test"]["deviation"] == pytest.approx(1e-3, rel=1e-2)


def test_what_cannot_be_found_out_is_a_line_and_not_the_end(stribeck, monkeypatch):
    monkeypatch.setenv("STRIBECK_BACKEND", "zig")
    status, outcome = reported(stribeck)
    assert (status, outcome["backend"]) == (1, None)
    assert outcome["self_test"]["reason"] == "InputError: STRIBECK_BACKEND: 'zig': must be auto, c or wasm"
    assert "self-test FAILED: InputError" in stribeck("doctor").out

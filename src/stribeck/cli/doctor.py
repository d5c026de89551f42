"""``stribeck doctor``, also as a function."""

from __future__ import annotations

import os
import platform
import sys
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

from stribeck.cli.options import Json, command
from stribeck.cli.output import tell
from stribeck.errors import BuildError, error_text, one_line
from stribeck.version import __version__

if TYPE_CHECKING:
    from stribeck.mouth.document import Document

_PACKAGES = (
    "numpy", "pydantic", "typer", "rich", "matplotlib", "jinja2", "pyarrow", "python-flint", "sympy", "scipy", "pandas",
    "ziglang", "wasmtime",
)  # fmt: skip
_ANSWERS_WITHIN = 5.0  # s, for a compiler to say its version: one that is asked over a network takes 1 s
_AGREES = 1e-6  # of the peaks: what is promised of y and v


T = TypeVar("T")
Found = dict[str, object]


@dataclass(frozen=True)
class Installation:
    """What :func:`doctor` finds.

    Attributes:
        passed: whether the self-test passed.
        lead: the self-test in one sentence.
        rows: every other part in words.
        found: the same as plain data.
    """

    passed: bool
    lead: str
    rows: dict[str, str]
    found: Found

    def to_dict(self) -> Found:
        """Plain data, as ``stribeck doctor --json`` prints it."""
        return self.found

    def document(self) -> Document:
        """The results, in rows."""
        from stribeck.mouth.document import Chapter, Document, Table

        table = Table(["part", "result"], [list(row) for row in self.rows.items()], prose=True)
        title = f"stribeck {self.found['stribeck']}"
        return Document(title, self.lead, (), [Chapter("installation", "Installation", tables=[table])])


@command("doctor", "stribeck doctor --json")
def _command(json: Json = False) -> int:
    """Show compiler, cache and versions, and run a self-test."""
    result = doctor()
    tell(result.document, result.to_dict() if json else None)
    return 0 if result.passed else 1


def doctor() -> Installation:
    """Look at the compiler, the cache and the versions of this installation, and run a self-test.

    Raises:
        None: what cannot be found out is reported with its reason.
    """
    backend, solver = _tried(_backend, lambda why: (None, f"none: {why}"))
    compiler, c = _tried(_compiler, lambda why: ({"command": None, "version": None}, why))
    cache, kept = _tried(
        _cache, lambda why: ({"folder": "", "writable": False, "systems": 0, "bytes": 0}, f"unknown: {why}")
    )
    untested: Found = dict.fromkeys(("passed", "solver", "deviation", "milliseconds", "against", "reason"))
    test, lead = _tried(
        _self_test, lambda why: ({**untested, "passed": False, "reason": why}, f"self-test FAILED: {why}")
    )
    packages = {name: _version(name) for name in _PACKAGES}
    python = f"{platform.python_version()} ({sys.executable})"
    machine = f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores"
    found = {
        "stribeck": __version__, "python": python, "machine": machine, "packages": packages, "compiler": compiler,
        "backend": backend, "cache": cache, "self_test": test,
    }  # fmt: skip
    rows = {
        "python": python, "machine": machine,
        "packages": ", ".join(f"{name} {version or 'not installed'}" for name, version in packages.items()),
        "compiler": c, "backend": solver, "cache": kept,
    }  # fmt: skip
    return Installation(bool(test["passed"]), lead, rows, found)


def _tried(what: Callable[[], tuple[T, str]], otherwise: Callable[[str], tuple[T, str]]) -> tuple[T, str]:
    """What is found, and its words; or the same of what went wrong: in the installations that need this command anything may."""
    try:
        return what()
    except Exception as error:
        return otherwise(one_line(error_text(error)))


def _version(name: str) -> str | None:
    from importlib.metadata import PackageNotFoundError, version  # slow to import, for every command

    try:
        return version(name)
    except PackageNotFoundError:
        return None


def _backend() -> tuple[str | None, str]:
    from stribeck.simulation import backend

    chosen = backend.chosen()
    return chosen, {"c": "C", "wasm": "WebAssembly"}[chosen]


def _compiler() -> tuple[Found, str]:
    from pathlib import Path
    from tempfile import gettempdir

    from stribeck.simulation import compiler

    cc = compiler.find()
    if cc is None:
        return {"command": None, "version": None}, "none: WebAssembly solves instead, about 1.5 times slower"
    command = " ".join(cc.command)
    try:
        asked = compiler.called([*cc.command, "--version"], cc.command[0], _ANSWERS_WITHIN, Path(gettempdir()))
        lines = (asked.stdout or asked.stderr).splitlines()
        version = one_line(lines[0] if lines else "does not answer to --version")
    except BuildError as error:
        version = one_line(str(error))
    return {"command": command, "version": version}, f"{command}: {version}"


def _cache() -> tuple[Found, str]:
    from stribeck.files import trouble
    from stribeck.simulation import cache

    folder = cache.folder()
    files = [*folder.glob("*.so"), *folder.glob("*.cwasm")] if folder.is_dir() else []
    writable = trouble(folder, folder=True) is None and cache.distrusted(folder) is None
    size = sum(file.stat().st_size for file in files)
    state = "writable" if writable else "NOT writable: every process compiles anew"
    found: Found = {"folder": str(folder), "writable": writable, "systems": len(files), "bytes": size}
    return found, f"{folder}, {state}, {len(files)} systems, {size / 1e6:.1f} MB"


def _self_test() -> tuple[Found, str]:
    """The shortest of the paper's scenarios must agree with WebAssembly's solution, within 1e-6 of the peaks.

    If WebAssembly is the backend, the reference is a solution at a far smaller tolerance."""
    import numpy as np

    from stribeck import examples
    from stribeck.scenario import Scenario
    from stribeck.simulation import Solution, backend, simulate, wasm

    scenario = Scenario.load(examples.path("break_away"))
    solution = simulate(scenario)
    if backend.chosen() == "c":
        system = wasm.system_module(scenario.system)
        other = Solution(scenario, wasm.solve(wasm.compiled(system.module)[0], system, scenario))
        against = "WebAssembly"
    else:
        other, against = simulate(scenario.with_changes({"solve.rtol": 1e-11})), "itself at rtol = 1e-11"
    worst = max(float(np.max(np.abs(solution[n] - other[n])) / other.peaks[n]) for n in ("y", "v"))
    passed, solver = solution.status == other.status == "done" and worst < _AGREES, solution.stats["solver"]
    ms = 1e3 * solution.stats["seconds"]
    found: Found = {
        "passed": passed, "solver": solver, "deviation": worst, "milliseconds": ms, "against": against, "reason": None,
    }  # fmt: skip
    verdict = "passed" if passed else "FAILED"
    return found, f"self-test {verdict}: {solver} {ms:.1f} ms, {worst:.1e} of the peaks from {against}"

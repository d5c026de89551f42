"""``stribeck doctor``."""

from __future__ import annotations

import os
import platform
import sys
from collections.abc import Callable
from typing import TYPE_CHECKING, TypedDict, TypeVar

from stribeck.cli.options import Json, command
from stribeck.cli.output import tell
from stribeck.errors import BuildError, error_text, one_line

if TYPE_CHECKING:
    from stribeck.mouth.document import Document

T = TypeVar("T")

_PACKAGES = (
    "numpy", "pydantic", "typer", "rich", "matplotlib", "jinja2", "pyarrow", "python-flint", "sympy", "scipy", "pandas",
    "ziglang", "wasmtime",
)  # fmt: skip
_ANSWERS_WITHIN = 5.0  # s, for a compiler to say its version: one that is asked over a network takes 1 s
_AGREES = 1e-6  # of the peaks: what is promised of y and v


class CompilerFound(TypedDict):
    """The C compiler, if there is one."""

    command: str | None
    version: str | None


class CacheFound(TypedDict):
    """Where compiled systems are kept."""

    folder: str
    writable: bool
    systems: int
    bytes: int


class SelfTest(TypedDict):
    """The agreement of two solutions, or the reason why they could not be compared."""

    passed: bool
    solver: str | None
    deviation: float | None
    milliseconds: float | None
    against: str | None
    reason: str | None


@command("doctor", "stribeck doctor --json")
def doctor(json: Json = False) -> int:
    """Show compiler, cache and versions, and run a self-test."""
    import stribeck

    backend, why_none = _tried(_backend, "")
    compiler, trouble = _tried(_compiler, CompilerFound(command=None, version=None))
    cache, unknown = _tried(_cache, CacheFound(folder="", writable=False, systems=0, bytes=0))
    untested = SelfTest(passed=False, solver=None, deviation=None, milliseconds=None, against=None, reason=None)
    test, reason = _tried(_self_test, untested)
    if reason:
        test["reason"] = reason
    packages = {name: _version(name) for name in _PACKAGES}
    python = f"{platform.python_version()} ({sys.executable})"
    machine = f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores"
    data = {
        "stribeck": stribeck.__version__, "python": python, "machine": machine, "packages": packages, "compiler": compiler,
        "backend": backend or None, "cache": cache, "self_test": test,
    }  # fmt: skip
    none = trouble or "none: WebAssembly solves instead, about 1.4 times slower"
    state = "writable" if cache["writable"] else "NOT writable: every process compiles anew"
    kept = f"{cache['folder']}, {state}, {cache['systems']} systems, {cache['bytes'] / 1e6:.1f} MB"
    rows = {
        "python": python, "machine": machine,
        "packages": ", ".join(f"{name} {version or 'not installed'}" for name, version in packages.items()),
        "compiler": none if compiler["command"] is None else f"{compiler['command']}: {compiler['version']}",
        "backend": {"c": "C", "wasm": "WebAssembly"}.get(backend, f"none: {why_none}"),
        "cache": f"unknown: {unknown}" if unknown else kept,
    }  # fmt: skip
    tell(
        lambda: _document(f"stribeck {stribeck.__version__}", _self_test_line(test), rows), data if json else None, None
    )
    return 0 if test["passed"] else 1


def _document(title: str, lead: str, rows: dict[str, str]) -> Document:
    """The results, in rows."""
    from stribeck.mouth.document import Chapter, Document, Table

    table = Table(["part", "result"], [list(row) for row in rows.items()], prose=True)
    return Document(title, lead, (), [Chapter("installation", "Installation", tables=[table])])


def _tried(what: Callable[[], T], otherwise: T) -> tuple[T, str]:
    """What is found; or the other thing, and what went wrong: this command is for installations in which anything may."""
    try:
        return what(), ""
    except Exception as error:
        return otherwise, one_line(error_text(error))


def _version(name: str) -> str | None:
    from importlib.metadata import PackageNotFoundError, version  # slow to import, for every command

    try:
        return version(name)
    except PackageNotFoundError:
        return None


def _backend() -> str:
    from stribeck.simulation import backend

    return backend.chosen()


def _compiler() -> CompilerFound:
    from pathlib import Path
    from tempfile import gettempdir

    from stribeck.simulation import compiler

    cc = compiler.find()
    if cc is None:
        return {"command": None, "version": None}
    try:
        asked = compiler.called([*cc.command, "--version"], cc.command[0], _ANSWERS_WITHIN, Path(gettempdir()))
        lines = (asked.stdout or asked.stderr).splitlines()
        first = lines[0] if lines else "does not answer to --version"
    except BuildError as error:
        first = str(error)
    return {"command": " ".join(cc.command), "version": one_line(first)}


def _cache() -> CacheFound:
    from stribeck.files import trouble
    from stribeck.simulation import cache

    folder = cache.folder()
    files = [*folder.glob("*.so"), *folder.glob("*.cwasm")] if folder.is_dir() else []
    return {
        "folder": str(folder),
        "writable": trouble(folder, folder=True) is None and cache.distrusted(folder) is None,
        "systems": len(files),
        "bytes": sum(file.stat().st_size for file in files),
    }


def _self_test() -> SelfTest:
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
    return {
        "passed": solution.status == other.status == "done" and worst < _AGREES, "solver": solution.stats["solver"],
        "deviation": worst, "milliseconds": 1e3 * solution.stats["seconds"], "against": against, "reason": None,
    }  # fmt: skip


def _self_test_line(t: SelfTest) -> str:
    verdict = "passed" if t["passed"] else "FAILED"
    if t["deviation"] is None:
        return f"self-test {verdict}: {t['reason']}"
    return f"self-test {verdict}: {t['solver']} {t['milliseconds']:.1f} ms, {t['deviation']:.1e} of the peaks from {t['against']}"

"""``stribeck doctor``."""

from __future__ import annotations

import os
import platform
import subprocess
import sys
from importlib.metadata import PackageNotFoundError, version
from typing import TypedDict

import numpy as np

import stribeck
from stribeck import examples
from stribeck.cli.show import print_json
from stribeck.cli.text import say
from stribeck.scenario import Scenario
from stribeck.simulation import Solution, backend, cache, compiler, simulate, wasm

_PACKAGES = (
    "numpy", "pydantic", "typer", "rich", "matplotlib", "jinja2", "pyarrow", "python-flint", "sympy", "scipy", "pandas",
    "ziglang", "wasmtime",
)  # fmt: skip


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
    """How a solution agrees with another's."""

    passed: bool
    solver: str
    deviation: float
    milliseconds: float
    against: str


class Installation(TypedDict):
    """All that the command tells."""

    stribeck: str
    python: str
    machine: str
    packages: dict[str, str | None]
    compiler: CompilerFound
    backend: str
    cache: CacheFound
    self_test: SelfTest


def doctor(json: bool) -> int:
    """Print compiler, cache, versions and a self-test; 1 where the self-test fails."""
    report: Installation = {
        "stribeck": stribeck.__version__,
        "python": f"{platform.python_version()} ({sys.executable})",
        "machine": f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores",
        "packages": {name: _version(name) for name in _PACKAGES},
        "compiler": _compiler(),
        "backend": backend.chosen(),
        "cache": _cache(),
        "self_test": _self_test(),
    }
    if json:
        print_json(report)
    else:
        _print(report)
    return 0 if report["self_test"]["passed"] else 1


def _version(name: str) -> str | None:
    try:
        return version(name)
    except PackageNotFoundError:
        return None


def _compiler() -> CompilerFound:
    found = compiler.find()
    if found is None:
        return {"command": None, "version": None}
    try:
        text = subprocess.run([*found.command, "--version"], capture_output=True, text=True, timeout=30, check=False)
        first = (text.stdout or text.stderr).splitlines()[0]
    except (OSError, subprocess.TimeoutExpired, IndexError):
        first = "does not answer to --version"
    return {"command": " ".join(found.command), "version": first}


def _cache() -> CacheFound:
    folder = cache.folder()
    files = list(folder.glob("*.so")) if folder.is_dir() else []
    existing = next(p for p in (folder, *folder.absolute().parents) if p.exists())
    writable = existing.is_dir() and os.access(existing, os.W_OK) and cache.distrusted(folder) is None
    return {
        "folder": str(folder),
        "writable": writable,
        "systems": len(files),
        "bytes": sum(f.stat().st_size for f in files),
    }


def _self_test() -> SelfTest:
    """The shortest of the paper's scenarios must agree within 1e-6 of the peaks with WebAssembly's solution; where that is
    the backend, with one at a far smaller tolerance."""
    scenario = Scenario.load(examples.path("break_away"))
    solution = simulate(scenario)
    if backend.chosen() == "c":
        system = wasm.system_module(scenario.system)
        other, against = (
            Solution(scenario, wasm.solve(wasm.compiled(system.module)[0], system, scenario)),
            "WebAssembly",
        )
    else:
        other, against = simulate(scenario.with_changes({"solve.rtol": 1e-11})), "itself at rtol = 1e-11"
    worst = max(float(np.max(np.abs(solution[n] - other[n])) / other.peaks[n]) for n in ("y", "v"))
    return {
        "passed": solution.status == other.status == "done" and worst < 1e-6, "solver": solution.stats["solver"],
        "deviation": worst, "milliseconds": 1e3 * solution.stats["seconds"], "against": against,
    }  # fmt: skip


def _print(report: Installation) -> None:
    for key, text in (("stribeck", report["stribeck"]), ("python", report["python"]), ("machine", report["machine"])):
        say(text, 11, f"{key:11}")
    packages = ", ".join(f"{name} {v or 'not installed'}" for name, v in report["packages"].items())
    say(packages, 11, "packages   ")
    command = report["compiler"]["command"]
    none = "none: WebAssembly solves (1.5 times slower)"
    words = f"{command}: {report['compiler']['version']}" if command else none
    say(words, 11, "compiler   ")
    say({"c": "C", "wasm": "WebAssembly"}[report["backend"]], 11, "backend    ")
    c = report["cache"]
    state = "writable" if c["writable"] else "NOT writable: every process compiles anew"
    say(f"{c['folder']}, {state}, {c['systems']} systems, {c['bytes'] / 1e6:.1f} MB", 11, "cache      ")
    t = report["self_test"]
    verdict = "passed" if t["passed"] else "FAILED"
    solved = f"{verdict}: {t['solver']} {t['milliseconds']:.1f} ms"
    say(f"{solved}, {t['deviation']:.1e} of the peaks from {t['against']}", 11, "self-test  ")

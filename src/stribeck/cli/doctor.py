"""``stribeck doctor``."""

from __future__ import annotations

import os
import platform
import subprocess
import sys
from importlib.metadata import PackageNotFoundError, version
from time import perf_counter
from typing import Any

import numpy as np

import stribeck
from stribeck import examples
from stribeck.cli.show import print_json
from stribeck.scenario import Scenario
from stribeck.simulation import Solution, cache, compiler, fallback, simulate

_PACKAGES = (
    "numpy", "scipy", "pydantic", "typer", "rich", "pyarrow", "matplotlib", "jinja2", "python-flint", "pandas", "ziglang",
)  # fmt: skip


def doctor(json: bool) -> int:
    """Print compiler, cache, versions and a self-test; 1 where the self-test fails."""
    report: dict[str, Any] = {
        "stribeck": stribeck.__version__,
        "python": f"{platform.python_version()} ({sys.executable})",
        "machine": f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores",
        "packages": {name: _version(name) for name in _PACKAGES},
        "compiler": _compiler(),
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


def _compiler() -> dict[str, Any]:
    found = compiler.find()
    if found is None:
        return {"command": None, "version": None}
    try:
        text = subprocess.run([*found.command, "--version"], capture_output=True, text=True, timeout=30, check=False)
        first = (text.stdout or text.stderr).splitlines()[0]
    except (OSError, subprocess.TimeoutExpired, IndexError):
        first = "does not answer to --version"
    return {"command": " ".join(found.command), "version": first}


def _cache() -> dict[str, Any]:
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


def _self_test() -> dict[str, Any]:
    """The shortest of the paper's scenarios, compiled and by SciPy: they must agree within 1e-6 of the peaks."""
    scenario = Scenario.load(examples.path("break_away"))
    fast = simulate(scenario)
    started = perf_counter()
    slow = Solution(scenario, fallback.solve(scenario))
    seconds = perf_counter() - started
    worst = max(float(np.max(np.abs(fast[n] - slow[n])) / slow.peaks[n]) for n in ("y", "v"))
    done = fast.status == slow.status == "done"
    return {
        "passed": done and worst < 1e-6, "solver": fast.stats["solver"], "deviation": worst,
        "milliseconds": 1e3 * fast.stats["seconds"], "milliseconds_scipy": 1e3 * seconds,
    }  # fmt: skip


def _print(report: dict[str, Any]) -> None:
    for key in ("stribeck", "python", "machine"):
        print(f"{key:10} {report[key]}")
    print("packages   " + ", ".join(f"{name} {v or 'not installed'}" for name, v in report["packages"].items()))
    command = report["compiler"]["command"]
    words = f"{command}: {report['compiler']['version']}" if command else "none: SciPy solves, slowly"
    print(f"compiler   {words}")
    c = report["cache"]
    state = "writable" if c["writable"] else "NOT writable: every process compiles anew"
    print(f"cache      {c['folder']}, {state}, {c['systems']} systems, {c['bytes'] / 1e6:.1f} MB")
    t = report["self_test"]
    verdict = "passed" if t["passed"] else "FAILED"
    print(
        f"self-test  {verdict}: {t['solver']} {t['milliseconds']:.1f} ms, SciPy {t['milliseconds_scipy']:.0f} ms, ",
        end="",
    )
    print(f"they differ by {t['deviation']:.1e} of the peaks")

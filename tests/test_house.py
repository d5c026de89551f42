"""CONTRIBUTING's rules on the shape of the code, with reasoned exceptions."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

SOURCE = Path(__file__).parent.parent / "src" / "stribeck"
FILES = sorted(SOURCE.rglob("*.py"))
LONGEST_FILE, LONGEST_FUNCTION = 400, 60

# What may be longer, and why.
LONG_FILES: dict[str, str] = {
    "cli/app.py": "one signature for each command",
}
LONG_FUNCTIONS: dict[str, str] = {
    "cli/measured.py:fit": "Typer reads a command's options from one signature",
    "control/proof.py:derive": "one derivation, read from top to bottom beside the theory",
    "identify/api.py:fit": "half of it is the meaning of its arguments",
    "identify/data/quality.py:clean": "half of it is the meaning of its arguments",
    "identify/methods/dynamic.py:fit_dynamic": "half of it is the meaning of its arguments",
    "simulation/ensemble.py:simulate_ensemble": "half of it is the meaning of its arguments",
    "simulation/native.py:solve": "fills one C struct and reads it back",
    "steepness/__init__.py:advise": "half of it is the meaning of its arguments",
}
PRIVATE_IMPORTS: dict[str, str] = {}


def relative(path: Path) -> str:
    return path.relative_to(SOURCE).as_posix()


def functions(path: Path) -> list[tuple[str, int]]:
    tree = ast.parse(path.read_text(encoding="utf-8"))
    return [
        (f"{relative(path)}:{node.name}", (node.end_lineno or 0) - node.lineno + 1)
        for node in ast.walk(tree)
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
    ]


@pytest.mark.parametrize("path", FILES, ids=relative)
def test_files_are_short(path):
    count = len(path.read_text(encoding="utf-8").splitlines())
    assert count <= LONGEST_FILE or relative(path) in LONG_FILES, f"{relative(path)} has {count} lines"


def test_functions_are_short():
    long = {name: count for path in FILES for name, count in functions(path) if count > LONGEST_FUNCTION}
    assert not (new := {n: c for n, c in long.items() if n not in LONG_FUNCTIONS}), f"longer than allowed: {new}"
    assert not (old := set(LONG_FUNCTIONS) - set(long)), f"no longer needed: {old}"


def test_private_names_stay_in_their_module():
    found = set()
    for path in FILES:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("stribeck"):
                found |= {
                    f"{relative(path)}: {node.module}.{name.name}"
                    for name in node.names
                    if name.name.startswith("_") and not name.name.startswith("__")
                }
    assert found == set(PRIVATE_IMPORTS)


def test_an_array_is_declared_once():
    found = [relative(path) for path in FILES if "NDArray[np.float64]" in path.read_text(encoding="utf-8")]
    assert found == ["arrays.py"]

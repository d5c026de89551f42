"""CONTRIBUTING's rules on the shape of the code, with reasoned exceptions."""

from __future__ import annotations

import ast
from functools import cache
from pathlib import Path

import pytest

SOURCE = Path(__file__).parent.parent / "src" / "stribeck"
FILES = sorted(SOURCE.rglob("*.py"))
LONGEST_FILE, LONGEST_FUNCTION = 700, 65

# What may be longer, and why.
LONG_FILES: dict[str, str] = {}
LONG_FUNCTIONS: dict[str, str] = {}
# Rooms that hold `Any`, how often at most, and what forces it there; there is none in the others.
ANY: dict[str, tuple[int, str]] = {
    "cli": (5, "summaries for JSON that are read again by their keys, to be printed; keywords for the library"),
    "exports": (9, "the files of other programs, as JSON and XML hold them"),
    "explorer": (8, "Bokeh's figures; numbers for the page"),
    "expressions": (
        8,
        "`Value`, declared once for all rooms: a number, array, node or tensor of any library, which no type covers",
    ),
    "identify": (16, "data frames and mappings of users; fit.json; MuJoCo has no types"),
    "laws": (4, "constants as users give them; a description that is told"),
    "parameter_sets": (2, "a file's tables, and values as tomllib gives them"),
    "properties": (
        6,
        "six names for what has no type of its own: flint's numbers, data for JSON, what NumPy broadcasts",
    ),
    "mouth": (4, "Matplotlib's options"),
    "sweeps": (2, "columns of any type"),
    "machine": (62, "`Held`, declared once; Pydantic's hooks, whose arguments are its own; a file's tables"),
    "scenario": (13, "its JSON Schema; a file's tables, as tomllib gives them"),
    "simulation": (9, "statistics read by their keys; a file's tables"),
    "recorded": (4, "data frames and mappings of users"),
    "": (4, "JSON files; `stribeck.NAME`"),
}
# Folders of tests that are no room of src/stribeck, and what they test; rooms that other folders test.
BESIDE_THE_ROOMS = {
    "fuzz": "tools/fuzz",
    "kept/inputs": "laws and machines that its commands read",
    "kept": "what every command and export writes, beside what is kept of it",
    "paper": "examples/paper, which 'make demo' runs",
    "proofs": "proofs/, the Coq developments",
    "properties/nasty": "laws written to mislead, which tests/properties reads",
    "reference": "reference trajectories and published numbers, by others",
    "stories": "what README promises to each kind of reader",
    "site": "docs/, the site: its references, links, examples",
    "theory": "docs/explanation/theory.md, step by step",
    "verify": "src/stribeck_verify, the independent checker",
}
TESTED_ELSEWHERE = {"examples": "tests/cli and tests/scenario run each"}
PRIVATE_IMPORTS: dict[str, str] = {}


def relative(path: Path) -> str:
    return path.relative_to(SOURCE).as_posix()


@cache
def tree(path: Path) -> ast.Module:
    """The file, parsed once for all tests."""
    return ast.parse(path.read_text(encoding="utf-8"))


@cache
def nodes(path: Path) -> list[ast.AST]:
    return list(ast.walk(tree(path)))


def functions(path: Path) -> list[tuple[str, int]]:
    return [
        (f"{relative(path)}:{node.name}", (node.end_lineno or 0) - node.lineno + 1)
        for node in nodes(path)
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
    result = set()
    for path in FILES:
        for node in nodes(path):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("stribeck"):
                result |= {
                    f"{relative(path)}: {node.module}.{name.name}"
                    for name in node.names
                    if name.name.startswith("_") and not name.name.startswith("__")
                }
    assert result == set(PRIVATE_IMPORTS)


def test_a_class_has_a_name_of_its_own():
    where: dict[str, list[str]] = {}
    for path in FILES:
        for node in tree(path).body:
            if isinstance(node, ast.ClassDef):
                where.setdefault(node.name, []).append(relative(path))
    result = {name: files for name, files in where.items() if len(files) > 1 and not name.startswith("_")}
    assert not result, f"two classes of one name: {result}"


def test_a_function_imported_by_its_bare_name_is_the_only_one_so_imported():
    """Modules may each have their ``files`` or ``chapter``, called as ``module.files``; a bare name means one thing."""
    defined: set[tuple[str, str]] = set()
    imported: set[tuple[str, str]] = set()
    for path in FILES:
        here = ".".join(("stribeck", *path.relative_to(SOURCE).with_suffix("").parts)).removesuffix(".__init__")
        defined |= {(here, n.name) for n in tree(path).body if isinstance(n, ast.FunctionDef)}
        froms = [n for n in nodes(path) if isinstance(n, ast.ImportFrom) and here != "stribeck"]
        imported |= {(n.module or "", name.name) for n in froms for name in n.names if not name.asname}
    homes: dict[str, list[str]] = {}
    for home, name in sorted(defined & imported):
        homes.setdefault(name, []).append(home)
    assert not (result := {name: where for name, where in homes.items() if len(where) > 1}), result


def test_an_array_is_declared_once():
    results = [relative(path) for path in FILES if "NDArray[np.float64]" in path.read_text(encoding="utf-8")]
    assert results == ["arrays.py"]


def test_any_stands_where_something_forces_it():
    count: dict[str, int] = {}
    for path in FILES:
        room = relative(path).partition("/")[0] if "/" in relative(path) else ""
        count[room] = count.get(room, 0) + sum(isinstance(n, ast.Name) and n.id == "Any" for n in nodes(path))
    result = {room: n for room, n in count.items() if n}
    assert not (new := {r: n for r, n in result.items() if n > ANY.get(r, (0, ""))[0]}), f"more than allowed: {new}"
    assert not (old := set(ANY) - set(result)), f"no longer needed: {old}"


def test_tests_mirror_the_rooms():
    tests = Path(__file__).parent
    folders = {p.parent.relative_to(tests).as_posix() for p in tests.rglob("*.py")} - {"."}
    rooms = {p.parent.relative_to(SOURCE).as_posix() for p in SOURCE.rglob("*.py")} - {"."}
    assert not (strange := {f for f in folders if f not in rooms} - set(BESIDE_THE_ROOMS)), strange
    untested = {r for r in rooms if "/" not in r} - folders - set(TESTED_ELSEWHERE)
    assert not untested, f"rooms without tests: {untested}"

"""docs/explanation/architecture.md against the tree: every room is there, in the order of the imports."""

import re
import tomllib
from graphlib import TopologicalSorter
from itertools import pairwise
from pathlib import Path

import grimp

ROOT = Path(__file__).parent.parent
SOURCE = ROOT / "src" / "stribeck"
PAGE = (ROOT / "docs" / "explanation" / "architecture.md").read_text(encoding="utf-8")
DRAWING = PAGE.split("```")[1]


def rooms():
    """The rooms of the table, row by row from the bottom."""
    table = PAGE.split("| package |")[1].split("\n\n")[0]
    return [re.findall(r"`([^`]+)`", row.split("|")[1]) for row in table.splitlines()[2:]]


def test_the_table_names_every_room_once():
    named = [room.rstrip("/") for row in rooms() for room in row]
    there = [p.name for p in SOURCE.iterdir() if (p.is_dir() and (p / "__init__.py").exists()) or p.suffix == ".py"]
    assert sorted(named) == sorted(set(there) - {"__init__.py", "__main__.py"})


def test_the_table_has_the_order_of_the_imports():
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["importlinter"]["contracts"]
    (contract,) = (each for each in contracts if each["type"] == "layers")
    layers = [re.split(r" [|:] ", layer) for layer in reversed(contract["layers"])]
    height = {name: i for i, layer in enumerate(layers) for name in layer}
    of_rows = [[height[room.rstrip("/").removesuffix(".py")] for room in row] for row in rooms()]
    assert all(max(lower) <= min(upper) for lower, upper in pairwise(of_rows))


def test_no_imports_form_a_circle():
    """Imports within functions count, those for type checkers do not; a module is imported with the packages around it."""
    graph = grimp.build_graph("stribeck", exclude_type_checking_imports=True, cache_dir=None)
    around = {m: {m[: dot.start()] for dot in re.finditer(r"\.", m)} for m in graph.modules}
    needs = {m: graph.find_modules_directly_imported_by(m) for m in graph.modules}
    needs = {m: {n for each in some for n in {each} | around[each] - around[m]} - {m} for m, some in needs.items()}
    TopologicalSorter(needs).prepare()  # raises CycleError, which names the circle


def test_what_the_page_and_its_drawing_name_exists():
    for path in re.findall(r"`([a-z_]+(?:/[a-z_]*)*(?:\.py)?)`", PAGE):
        if "/" in path and not path.startswith(("proofs/", "src/")):
            assert (SOURCE / path).exists() or (ROOT / path).exists(), path
    inside = {
        "exports": "targets c fmu machine controller python exchange",
        "identify": "data features models core methods actuator",
    }
    for room, parts in inside.items():
        line = next(line for line in DRAWING.splitlines() if f"{room}/" in line)
        drawn = re.findall(r"([a-z]+)/", line.split(f"{room}/", 1)[1])
        assert drawn == parts.split()
        folders = {p.name for p in (SOURCE / room).iterdir() if (p / "__init__.py").exists()}
        assert folders == set(drawn), room
    for name in re.findall(r"([a-z_]+)/", DRAWING.replace("→", "")):
        assert any((SOURCE / name).exists() or (SOURCE / room / name).exists() for room in (*inside, "codegen")), name

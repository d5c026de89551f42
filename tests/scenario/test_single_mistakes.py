"""A file with any single mistake in it is refused, and the message names the key, the value and what is allowed."""

from __future__ import annotations

import datetime
import math
import re

import pytest

from stribeck import InputError, Scenario
from tests.scenario.valid_scenarios import RECORD, allowed, edited, examples, keys, optional, write

EXAMPLES = examples()
JARGON = re.compile(
    r"\b(dict|float|int|str|bool|None|NoneType|True|False|pydantic|[Ii]nput should|Traceback|\w+Error)\b"
)
NUMBERS = ("any", "positive", "not negative")
NO_NUMBER = [
    "fast",
    True,
    [1.0],
    {"x": 1.0},
    math.nan,
    math.inf,
    -math.inf,
    10**400,
    10**4000,
    datetime.date(2024, 1, 1),
]
NO_TEXT = [1, 2.5, True, ["lugre"], {"x": "lugre"}, math.nan]
NO_LIST = [1.0, "0, 1", True, {"x": 1.0}, [], ["a"], [math.nan], [0.0, math.inf], [True], [1.0, [2.0]], [{}], [10**400]]
WRONG = {
    "any": NO_NUMBER,
    "positive": [*NO_NUMBER, 0, 0.0, -1, -1.5, -1e-300],
    "not negative": [*NO_NUMBER, -1, -1e-300],
    "whole": [*NO_NUMBER, 1.5, 0, -3],
    "text": NO_TEXT,
    "word": [*NO_TEXT, "", "x", "no such word"],
    "table or word": [1, 2.5, True, ["lugre"], math.nan, "", "x"],
    "path": [*NO_TEXT, "", "missing.csv", "."],
    "column": [*NO_TEXT, "", "no such column", "note"],
    "list": NO_LIST,
    "table": ["x", 1.0, True, [], [{}], [[1.0]]],
    "switch": ["on", "true", 0, 1, 1.0, [True], {"x": True}],
    "one": [0, 2, 1.0, "1", True, [1], {"x": 1}, math.nan],
}


def problems(data, folder) -> list[str]:
    """The problems that a scenario file with these data has; each must be one plain line."""
    path = write(data, folder)
    with pytest.raises(InputError) as refused:
        Scenario.load(path)
    lines = refused.value.problems
    assert str(refused.value) == "\n".join(lines)
    for line in lines:
        assert line.isprintable(), line
        assert len(line) <= 300, line
        assert not JARGON.search(line.replace(str(folder), "")), line
    return lines


@pytest.fixture(params=EXAMPLES)
def example(request):
    return EXAMPLES[request.param]


def test_the_examples_are_valid(example, tmp_path):
    Scenario.load(write(example, tmp_path))


def test_a_missing_key(example, tmp_path):
    for path in keys(example):
        data = edited(example, path)
        if optional(example, path):
            Scenario.load(write(data, tmp_path))
        else:
            assert any(line.startswith(f"{path}: missing: ") for line in problems(data, tmp_path)), path


def test_a_misspelt_key(example, tmp_path):
    for path in keys(example):
        parent, _, name = path.rpartition(".")
        wrong = f"{parent}.{name}{name[-1]}".lstrip(".")
        lines = problems(edited(example, path, name=f"{name}{name[-1]}"), tmp_path)
        named = [line for line in lines if line.startswith(f"{wrong}: ")]
        assert len(named) == 1, (path, lines)
        assert f"(did you mean '{name}'?)" in named[0]
        others = [line for line in lines if line not in named]
        assert all(line.startswith(f"{path}: missing: ") for line in others), (path, lines)


@pytest.mark.share(7)
def test_an_unknown_key(example, tmp_path):
    for path in keys(example):
        for name in ("zzz", "name of mine", "a\nb\x1b[31m", "k" * 500, path.split(".")[-1] + "_x"):
            lines = problems(edited(example, path, beside=name), tmp_path)
            parent = path.rpartition(".")[0]
            assert len(lines) == 1, (path, lines)
            assert lines[0].startswith(f"{parent}.{name.split()[0][:100]}".lstrip(".")), (path, lines)
            assert ": 1.0: " in lines[0]
            assert re.search(r"unknown key|no such constant|no such state", lines[0]), lines


@pytest.mark.share(7)
def test_a_wrong_value(example, tmp_path):
    for path in keys(example):
        kind = allowed(example, path)
        for value in WRONG[kind]:
            lines = problems(edited(example, path, value=value), tmp_path)
            named = [line for line in lines if re.match(rf"{re.escape(path)}(\[\d+\]|\.\w+)?: ", line)]
            assert named, (path, value, lines)
            assert shown(value) in named[0], (path, value, lines)
            if kind in NUMBERS:
                assert len(lines) == 1, (path, value, lines)
                assert "must be a" in lines[0]
                assert math.isinf(float(str(value)) if isinstance(value, float) else 0) or "number" in lines[0]
            if kind == "positive" and value in (0, -1.5):
                assert "> 0" in lines[0] or ">= 1e-13" in lines[0], lines


def shown(value) -> str:
    """What of a value must be seen in a message."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, int) and abs(value) > 10**20:
        return f"whole number of {len(str(value))} digits"
    if isinstance(value, list):
        return shown(value[-1]) if value else ""
    if isinstance(value, dict):
        return ", ".join(value) if value else "table"
    return str(value)


@pytest.mark.parametrize("name", ["drive.kind", "drive.signal.kind", "law.name", "law.parameters"])
def test_the_nearest_word_is_offered(name, tmp_path):
    for data in EXAMPLES.values():
        value = data
        for part in name.split("."):
            value = value.get(part, {})
        if isinstance(value, str):
            lines = problems(edited(data, name, value=value + value[-1]), tmp_path)
            assert lines[0].startswith(f"{name}: '{value}{value[-1]}': ")
            assert f"(did you mean '{value}'?)" in lines[0]


def test_the_nearest_column_is_offered(tmp_path):
    data = edited(EXAMPLES["velocity_file"], "drive.signal.value", value="v (m/ss)")
    assert any(f"did you mean '{RECORD['value']}'" in line for line in problems(data, tmp_path))

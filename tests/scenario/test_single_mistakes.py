"""Any single mistake in a file is refused at its place, and an editor underlines it by the schema; what each message says
is in tests/kept."""

from __future__ import annotations

import re

import pytest
from jsonschema import Draft202012Validator

from stribeck import InputError, Scenario
from stribeck.scenario import schema
from tests.scenario.valid_scenarios import RECORD, VALID, edited, keys, write

CHECK = Draft202012Validator(schema.json_schema())
WRONG = (True, -1.5, 0, "?", "", {"?": 1}, [], [[1.0]], ["a"])
IN_FILES = {f"drive.signal.{key}" for key in ("path", "time", "value")}  # the schema does not open the file


def problems(data, folder):
    """What is wrong with a scenario file that holds these data."""
    try:
        Scenario.load(write(data, folder))
    except InputError as refused:
        return refused.problems
    return []


@pytest.mark.parametrize("name", VALID)
def test_a_mistake_is_refused_at_its_place(name, tmp_path):
    data = VALID[name]
    assert problems(data, tmp_path) == []
    for path in keys(data):
        in_a_file = name == "velocity_file" and path in IN_FILES
        for change in ({}, *({"value": wrong} for wrong in WRONG)):
            mistaken = edited(data, path, **change)
            lines = problems(mistaken, tmp_path)
            assert CHECK.is_valid(mistaken) == (not lines) or in_a_file, (path, change, lines)
            at_its_place = (line for line in lines if re.match(rf"{re.escape(path)}(\[\d+\]|\.\w+|\.\?)?: ", line))
            assert not lines or any(at_its_place), (path, change, lines)


@pytest.mark.parametrize("name", VALID)
def test_a_key_that_is_misspelt_or_unknown_is_named(name, tmp_path):
    data = VALID[name]
    for path in keys(data):
        parent, _, last = path.rpartition(".")
        mistaken = edited(data, path, name=f"{last}{last[-1]}")
        lines = problems(mistaken, tmp_path)
        (named,) = (line for line in lines if line.startswith(f"{path}{last[-1]}: "))
        assert f"(did you mean '{last}'?)" in named
        assert all(line.startswith(f"{path}: missing: ") for line in lines if line != named), (path, lines)
        assert not CHECK.is_valid(mistaken), path
        for unknown in ("zzz", "name of mine", "a\nb\x1b[31m", "k" * 500):
            (line,) = problems(edited(data, path, beside=unknown), tmp_path)
            assert line.startswith(f"{parent}.{unknown.split()[0][:100]}".lstrip(".")), (path, line)
            assert re.search(r": 1.0: .*(unknown key|no such constant|no such state)", line), line


@pytest.mark.parametrize("name", ["drive.kind", "drive.signal.kind", "law.name", "law.parameters"])
def test_the_nearest_word_is_offered(name, tmp_path):
    for data in VALID.values():
        value = data
        for part in name.split("."):
            value = value.get(part, {})
        if isinstance(value, str):
            lines = problems(edited(data, name, value=value + value[-1]), tmp_path)
            assert lines[0].startswith(f"{name}: '{value}{value[-1]}': ")
            assert f"(did you mean '{value}'?)" in lines[0]


def test_the_nearest_column_is_offered(tmp_path):
    data = edited(VALID["velocity_file"], "drive.signal.value", value="v (m/ss)")
    assert any(f"did you mean '{RECORD['value']}'" in line for line in problems(data, tmp_path))

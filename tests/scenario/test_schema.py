"""The JSON Schema of a scenario file: accepts what is valid, refuses what editors should underline."""

from __future__ import annotations

import json
import tomllib

import pytest
from jsonschema import Draft202012Validator

from stribeck.cli import _status
from stribeck.examples import names, path
from stribeck.scenario import schema

CHECK = Draft202012Validator(schema.json_schema())


def test_it_is_written_when_asked_for(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert _status(["new", "--schema"]) == 0
    assert json.loads((tmp_path / "scenario.schema.json").read_text(encoding="utf-8")) == schema.json_schema()
    assert _status(["new", "--schema"]) == 2
    assert "scenario.schema.json': exists already; must be a new file" in capsys.readouterr().err


@pytest.mark.parametrize("name", names())
def test_valid_scenarios(name):
    CHECK.validate(tomllib.loads(path(name).read_text()))

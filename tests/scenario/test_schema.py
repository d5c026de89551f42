"""The JSON Schema of a scenario file: accepts what is valid, refuses what editors should underline."""

from __future__ import annotations

import json
import tomllib

import pytest
from jsonschema import Draft202012Validator

from stribeck import laws
from stribeck.examples import names, path
from stribeck.parameter_sets import parameters
from stribeck.scenario import schema
from tests.scenario.valid_scenarios import CANUDAS, MAKKAR, VALID, edited

CHECK = Draft202012Validator(schema.json_schema())


def with_law(**law):
    return edited(VALID["force_points"], "law", value=law)


def test_it_is_written_when_asked_for(tmp_path, monkeypatch, capsys):
    from stribeck.cli import _status

    monkeypatch.chdir(tmp_path)
    assert _status(["new", "--schema"]) == 0
    assert json.loads((tmp_path / "scenario.schema.json").read_text(encoding="utf-8")) == schema.json_schema()
    assert _status(["new", "--schema"]) == 2
    assert "scenario.schema.json': exists already; must be a new file" in capsys.readouterr().err


def test_it_is_a_schema():
    Draft202012Validator.check_schema(schema.json_schema())


@pytest.mark.parametrize("name", names())
def test_valid_scenarios(name):
    CHECK.validate(tomllib.loads(path(name).read_text()))


@pytest.mark.parametrize(
    "law",
    [
        {"name": "mylaw.py:MyLaw", "k": 1e6, "parameters": {**CANUDAS, "mu": 0.3}},
        {"name": "../my laws/mylaw.py:MyLaw"},
        *({"name": "lugre", "parameters": name} for name in (*parameters(), "x.toml", "../sets/x.toml")),
        {"name": "lugre_sobczyk", "parameters": {**CANUDAS, "k_v": 1e6}},
        {"name": "elastoplastic_majorant", "k_v": 1e6, "parameters": {**CANUDAS, "z_ba": 7e-6}},
        {"name": "elastoplastic_majorant", "parameters": "x.toml"},
        {"name": "makkar", "parameters": "x.toml"},
        {"name": "dahl", "parameters": {"sigma_0": 1e5, "F_c": 1}},
    ],
    ids=str,
)
def test_valid_laws(law):
    CHECK.validate(with_law(**law))


@pytest.mark.parametrize(
    "law",
    [
        {"name": "lugre", "k_v": 1e6, "parameters": CANUDAS},
        {"name": "lugre", "parameters": {**CANUDAS, "z_ba": 1e-6}},
        {"name": "lugre_sobczyk", "parameters": CANUDAS},
        {"name": "lugre_sobczyk", "parameters": "canudas1995"},
        {"name": "lugre_sobczyk", "k_v": 0, "parameters": CANUDAS},
        {"name": "lugre_sobczyk", "k_v": True, "parameters": CANUDAS},
        {"name": "lugre"},
        {"name": "lugre", "parameters": {"F_c": 1.0}},
        {"name": "lugre", "parameters": "canudas1996"},
        {"name": "lugre", "F_s": 1.5, "parameters": CANUDAS},
        {"name": "lugree", "parameters": CANUDAS},
        {"name": "makkar", **{n: x for n, x in MAKKAR.items() if n != "g3"}},
        {"name": "mylaw.py:MyLaw", "k": "steep"},
        {"parameters": CANUDAS},
    ],
    ids=str,
)
def test_mistaken_laws(law):
    assert not CHECK.is_valid(with_law(**law))


def test_every_constant_says_its_unit():
    by_name = {law["properties"]["name"].get("const"): law for law in schema.json_schema()["$defs"]["law"]["oneOf"]}
    for name, law in laws.builtin().items():
        for constant, declared in law.own_constants().items():
            assert by_name[name]["properties"][constant]["description"].endswith(declared.unit)


def test_a_moved_body():
    data = VALID["velocity_sine"]
    assert not CHECK.is_valid(edited(data, "plant.initial", value={"v": 1.0}))
    assert CHECK.is_valid(edited(data, "plant"))

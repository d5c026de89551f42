"""The library of machines: each is valid, says where it is from, and comes back from the command as a file that runs."""

import json
import tomllib

import pytest

import stribeck
from stribeck import Scenario
from stribeck.cli import main
from stribeck.errors import InputError
from stribeck.parameter_sets.library import machine_sets


@pytest.mark.parametrize("name", machine_sets())
def test_each_machine_is_valid_and_says_where_it_is_from(name):
    found = machine_sets()[name]
    Scenario(dict(found.machine))
    for word in ("title", "source", "licence", "date", "record", "holds", "command"):
        assert len(getattr(found, word)) > 3, word
        assert getattr(found, word) != word
    assert found.origin in ("published", "fitted")
    assert found.record.startswith("https://")
    assert all(isinstance(p["value"], float) for p in found.parameters.values())
    for path, p in found.parameters.items():
        if found.origin == "fitted":
            value = found.machine
            for word in path.split("."):
                value = value[int(word)] if isinstance(value, list) else value[word]
            assert value == pytest.approx(p["value"])
        assert ("low" in p) == ("high" in p)


def test_the_command_lists_shows_and_writes(tmp_path, capsys):
    with pytest.raises(SystemExit, match="0"):
        main(["library"])
    listed = capsys.readouterr().out
    assert all(name in listed for name in (*machine_sets(), "canudas1995"))
    with pytest.raises(SystemExit, match="0"):
        main(["library", "mx106", "--out", str(tmp_path / "servo.toml"), "--json"])
    assert json.loads(capsys.readouterr().out)["machines"]["mx106"]["licence"] == "Apache-2.0"
    text = (tmp_path / "servo.toml").read_text()
    assert "Apache-2.0" in text
    assert tomllib.loads(text) == machine_sets()["mx106"].machine
    Scenario.load(tmp_path / "servo.toml")


def test_mistakes(tmp_path, capsys):
    for words in (["olsson1998", "--out", str(tmp_path / "x.toml")], ["--out", str(tmp_path / "x.toml")]):
        with pytest.raises(SystemExit, match="2"):
            main(["library", *words])
        assert "--out" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_the_library_in_python():
    whole = stribeck.library()
    assert whole.sets["canudas1995"].values["F_s"] == 1.5
    assert "mx106" in whole.machines
    assert whole.laws["lugre"].name == "lugre"
    names = [*whole.laws, *whole.sets, *whole.machines]
    assert len(set(names)) == len(names), "one NAME finds one thing"
    some = stribeck.library("mx106", "lugre")
    assert (list(some.laws), list(some.sets), list(some.machines)) == (["lugre"], [], ["mx106"])
    with pytest.raises(InputError, match=r"'lugr': no such law, parameter set or machine \(did you mean 'lugre'\?\)"):
        stribeck.library("lugr")
    with pytest.raises(InputError, match="1: must be a name, not a number"):
        stribeck.library(1)

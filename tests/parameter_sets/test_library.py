"""The library of machines: each is valid and says where it is from."""

import pytest

import stribeck
from stribeck import Scenario
from stribeck.parameter_sets.library import machine_sets


@pytest.mark.parametrize("name", machine_sets())
def test_each_machine_is_valid_and_says_where_it_is_from(name):
    result = machine_sets()[name]
    Scenario(dict(result.machine))
    for word in ("title", "source", "license", "date", "record", "holds", "command"):
        assert len(getattr(result, word)) > 3, word
        assert getattr(result, word) != word
    assert result.origin in ("published", "fitted")
    assert result.record.startswith("https://")
    assert all(isinstance(p["value"], float) for p in result.parameters.values())
    for path, p in result.parameters.items():
        if result.origin == "fitted":
            value = result.machine
            for word in path.split("."):
                value = value[int(word)] if isinstance(value, list) else value[word]
            assert value == pytest.approx(p["value"])
        assert ("low" in p) == ("high" in p)


def test_one_name_finds_one_thing():
    whole = stribeck.library()
    names = [*whole.laws, *whole.sets, *whole.machines]
    assert len(set(names)) == len(names)
    some = stribeck.library("mx106", "lugre")
    assert (list(some.laws), list(some.sets), list(some.machines)) == (["lugre"], [], ["mx106"])

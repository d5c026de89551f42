"""The built-in parameter sets: their numbers, units and sources; and sets in files."""

from __future__ import annotations

import pytest

import stribeck
from stribeck import InputError, law, parameter_sets
from stribeck.errors import StribeckNote
from stribeck.parameter_sets import load, parameters


def test_changing_a_set_changes_no_other():
    parameters()["canudas1995"].values["F_s"] = 99.0
    load("canudas1995").values["F_s"] = 99.0
    assert stribeck.library().sets["canudas1995"].values["F_s"] == 1.5
    assert law("lugre", "canudas1995").p.F_s == 1.5


def test_a_file(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(
        "title = 'Mine'\nsource = 'measured'\nmotion = 'rotary'\n[parameters]\nF_c = 1\nF_s = {value = 2.0, low = 1.9}\n"
    )
    result = load("mine.toml", tmp_path)
    assert (result.name, result.title, result.source, result.motion) == ("mine", "Mine", "measured", "rotary")
    assert result.values == {"F_c": 1, "F_s": 2.0}
    assert load(str(path)).values == result.values
    path.write_text("F_c = 1.0\nF_s = 2.0\nname = 'mine'\nschema = 1\nleft_out = ['F_c_by_load']\n")
    with pytest.warns(StribeckNote, match="leave out: F_c_by_load"):
        result = load(str(path))
    assert (result.values, result.title, result.motion) == ({"F_c": 1.0, "F_s": 2.0}, "", "linear")


def test_sets_are_told_apart_by_their_hash():
    assert len({*parameters().values()}) == len(parameters())


def test_a_file_larger_than_the_memory(monkeypatch):
    def full(path):
        raise MemoryError

    monkeypatch.setattr(parameter_sets, "read_file", full)
    with pytest.raises(InputError, match=r"large\.toml: cannot be read: it does not fit into memory"):
        load("large.toml")

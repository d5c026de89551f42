"""What a scenario names by relative paths is found from another folder too."""

from pathlib import Path

from stribeck.scenario.moved import moved


def test_every_kind_of_path_is_seen_from_the_other_folder():
    data = {
        "contacts": {"a": {"law": {"name": "mine.py:Law", "parameters": "sets/a.toml", "k_v": None}}},
        "loads": [{"signal": {"kind": "file", "path": "log.csv"}}],
        "links": {"b": {"kind": "mine.py:Own"}, "c": {"kind": "spring"}},
        "drive": {"law": {"name": "lugre", "parameters": "canudas1995"}},
    }
    found = moved(data, Path("/rigs/one"), Path("/rigs/out/deep"))
    assert found == {
        "contacts": {"a": {"law": {"name": "../../one/mine.py:Law", "parameters": "../../one/sets/a.toml"}}},
        "loads": [{"signal": {"kind": "file", "path": "../../one/log.csv"}}],
        "links": {"b": {"kind": "../../one/mine.py:Own"}, "c": {"kind": "spring"}},
        "drive": {"law": {"name": "lugre", "parameters": "canudas1995"}},
    }


def test_absolute_paths_stay():
    data = {"law": {"parameters": Path("/sets/a.toml").absolute().as_posix()}}
    assert moved(data, Path("/rigs"), Path("/out")) == data

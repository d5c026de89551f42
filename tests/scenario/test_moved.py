"""What a scenario names by relative paths is found from another folder too."""

from pathlib import Path

from stribeck import Body, Machine, Scenario, signals
from stribeck.scenario.moved import moved
from tests.scenario.valid_scenarios import RECORD, VALID, write


def test_every_kind_of_path_is_seen_from_the_other_folder():
    data = {
        "contacts": {"a": {"law": {"name": "mine.py:Law", "parameters": "sets/a.toml", "k_v": None}}},
        "loads": [{"signal": {"kind": "file", "path": "log.csv"}}],
        "links": {"b": {"kind": "mine.py:Own"}, "c": {"kind": "spring"}},
        "drive": {"law": {"name": "lugre", "parameters": "canudas1995"}},
    }
    result = moved(data, Path("/rigs/one"), Path("/rigs/out/deep"))
    assert result == {
        "contacts": {"a": {"law": {"name": "../../one/mine.py:Law", "parameters": "../../one/sets/a.toml"}}},
        "loads": [{"signal": {"kind": "file", "path": "../../one/log.csv"}}],
        "links": {"b": {"kind": "../../one/mine.py:Own"}, "c": {"kind": "spring"}},
        "drive": {"law": {"name": "lugre", "parameters": "canudas1995"}},
    }


def test_absolute_paths_stay():
    data = {"law": {"parameters": Path("/sets/a.toml").absolute().as_posix()}}
    assert moved(data, Path("/rigs"), Path("/out")) == data


def test_the_path_of_a_signal_is_relative_to_the_scenario(tmp_path, monkeypatch):
    (tmp_path / "inner").mkdir()
    monkeypatch.chdir(tmp_path)
    path = write(VALID["velocity_file"], Path("inner"))
    (tmp_path / RECORD["path"]).write_text("t,v\n0,5\n")
    machine = Machine(Body("a", velocity=signals.File(*list(RECORD.values())[1:])), folder="inner").scenario(1.0)
    assert Scenario.load(path).signal.at(0.5) == machine.elements.bodies["a"].velocity.signal.built.at(0.5) == 1e-3

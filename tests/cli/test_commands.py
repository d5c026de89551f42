"""new, and what a command reads before it begins."""

import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from stribeck import Ensemble, Scenario, check, simulation
from stribeck.cli.app import app, with_command


def test_a_new_scenario_begins_with_a_law_that_is_proved_passive(stribeck, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    stribeck("new", "mine")
    law = Scenario.load("mine.toml").law
    assert law.name == "lugre_majorant"
    assert check(law)["passive"].holds is True


def test_the_step_after_new_names_files_that_are_there(stribeck, tmp_path):
    """In another folder the recordings were named without it."""
    words = shlex.split(stribeck("new", "joint-from-log", "--out", tmp_path / "a.toml").out.partition("next: ")[2])
    assert Path(words[words.index("--logs") + 1]).is_file()


def test_the_command_that_was_given_is_made_alone():
    names = [c.name or c.callback.__name__ for c in app.registered_commands]
    assert len(names) == 12
    for name in names:
        (only,) = with_command(name).registered_commands
        assert (only.name or only.callback.__name__) == name
    assert with_command("runn") is app  # which says what was meant
    assert with_command("") is app
    assert len(app.registered_commands) == len(names)


def test_one_run_reads_nothing_of_ensembles(scenario):
    """Most of the time of a run from the cache is imports."""
    code = "import sys\nfrom stribeck.cli import _status\n_status(['run', sys.argv[1]])\n"
    code += "print([n for n in sys.modules if n.startswith('stribeck.simulation.')])"
    read = subprocess.run([sys.executable, "-c", code, scenario], capture_output=True, text=True, check=True).stdout
    assert "'stribeck.simulation.single'" in read
    assert "ensemble" not in read
    assert "lanes" not in read
    assert simulation.Ensemble is Ensemble
    with pytest.raises(AttributeError, match="has no attribute 'nothing'"):
        simulation.nothing  # noqa: B018


def test_without_arguments_there_is_the_help(stribeck):
    shown = stribeck()
    assert (shown.status, shown.err) == (0, "")
    assert shown.out == stribeck("--help").out

"""run under several laws, library, new, doctor."""

import json
import re
import subprocess
import sys

import pytest

from stribeck import Ensemble, Scenario, check, examples, simulation
from stribeck.cli.app import app, with_command


def test_compare_names_deviations_from_the_first(stribeck, scenario, tmp_path):
    laws = ["--law", "lugre", "--law", "lugre_sobczyk:k_v=1e6", "--law", "lugre_majorant:k_v=1e6,F_s=1.5"]
    out = tmp_path / "out"
    data = json.loads(stribeck("run", scenario, *laws, "--json", "--out", out).out)
    assert data["reference"] == "lugre"
    assert list(data["laws"]) == laws[1::2]
    sobczyk, majorant = (data["laws"][name]["deviations"]["y"] for name in laws[3::2])
    assert sobczyk["max"] > 1e3 * majorant["max"] > 0
    assert sobczyk["max_relative"] == pytest.approx(sobczyk["max"] / data["laws"]["lugre"]["peaks"]["y"])
    assert sobczyk["rms"] < sobczyk["max"]
    assert (out / "compare.svg").exists()
    assert json.loads((out / "summary.json").read_text())["laws"].keys() == data["laws"].keys()


def test_one_law_takes_the_place_of_the_files(stribeck, scenario):
    found = json.loads(stribeck("run", scenario, "--law", "dahl", "--json").out)
    assert found["law"]["name"] == "dahl"
    same = json.loads(stribeck("run", scenario, "--set", "law.name=dahl", "--json").out)
    assert found["peaks"] == same["peaks"]


def test_options_that_do_not_go_together(stribeck, scenario, tmp_path):
    several = ("--law", "lugre", "--law", "dahl")
    for words, line in (
        ((*several, "--keep-c", tmp_path / "x.c"), "--keep-c: must be left out where several laws are compared"),
        (("--contact", "a"), "--contact: goes with --law, which is not given"),
        ((*several, "--show"), "--law: must be left out with --show, which simulates nothing"),
    ):
        result = stribeck("run", scenario, *words)
        assert (result.status, result.out) == (2, "")
        assert line in result.err


@pytest.mark.parametrize(
    ("law", "line"),
    [
        ("lugr", "law.name: 'lugr': no such law (did you mean 'lugre'?)"),
        ("lugre:k_v=1e6", "law.k_v: 1000000.0: law 'lugre' has no such constant (it has v_d, delta)"),
        ("lugre:k_v", "--law: 'lugre:k_v': must be NAME or NAME:KEY=VALUE,..."),
        ("lugre_majorant:k_v=-1", "law.k_v: -1: must be"),
    ],
)
def test_compare_refuses_a_bad_law(stribeck, scenario, law, line):
    result = stribeck("run", scenario, "--law", "lugre_sobczyk", "--law", law, "--json")
    assert result.status == 2
    assert result.out == ""
    assert line in result.err


def test_a_law_of_the_users_own(stribeck, scenario):
    example = re.search(
        r"```python\n(.*?)```", (examples.path("x").parents[3] / "docs" / "howto" / "own-law.md").read_text(), re.S
    )
    (scenario.parent / "mylaw.py").write_text(example[1])
    result = stribeck("run", scenario, "--json", "--set", "law.name=mylaw.py:RootLuGre")
    assert json.loads(result.out)["law"]["name"] == "root_lugre"
    listing = stribeck("library", f"{scenario.parent}/mylaw.py:RootLuGre")
    assert "dz/dt = v - (sqrt(v² + 1/k_v²)/g(v)) z" in listing.out


@pytest.mark.share(3)
@pytest.mark.parametrize("name", [*examples.names(), "my rig-1"])
def test_new_writes_a_scenario_that_runs(stribeck, tmp_path, name, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert stribeck("new", name).status == 0
    assert Scenario.load(tmp_path / f"{name}.toml").name == name
    assert stribeck("run", f"{name}.toml", "--set", "solve.t_end=0.2").status == 0
    for given in (name, f"{name}.toml"):
        again = stribeck("new", given)
        assert again.status == 2
        assert "exists already" in again.err
    assert not (tmp_path / f"{name}.toml.toml").exists()


def test_a_new_scenario_begins_with_a_law_that_is_proved_passive(stribeck, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    stribeck("new", "mine")
    law = Scenario.load("mine.toml").law
    assert law.name == "lugre_majorant"
    assert check(law)["passive"].holds is True


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
    """It was one line of an error, cut in its middle."""
    shown = stribeck()
    assert (shown.status, shown.err) == (0, "")
    assert shown.out == stribeck("--help").out

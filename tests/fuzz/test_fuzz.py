"""A short part of ``make fuzz``, always the same: what it found once it must not find again."""

import sys
import types
from pathlib import Path

import pytest

from stribeck.cli import _status
from tests.machine.machines import solved

FOLDER = Path(__file__).parent.parent.parent / "tools" / "fuzz"
pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="a hanging command is ended by a signal")


@pytest.fixture
def attack(monkeypatch):
    monkeypatch.syspath_prepend(str(FOLDER))
    import kills
    import machines
    import mutations
    import parameters

    return {"kills": kills, "mutations": mutations, "parameters": parameters, "machines": machines}


@pytest.mark.parametrize(("name", "count"), [("mutations", 24), ("parameters", 6), ("machines", 1)])
def test_nothing_is_found(attack, name, count):
    ended, faults = attack[name].campaign(2026, count)
    assert faults == []
    assert sum(ended.values()) == count


def test_the_attack_sees_a_fault(attack, monkeypatch):
    """A command that breaks, speaks to the terminal or leaves something is named."""
    mutations = attack["mutations"]

    def broken(words):
        raise ZeroDivisionError("x")

    monkeypatch.setattr(mutations, "_status", broken)
    assert "traceback: ZeroDivisionError" in mutations.campaign(1, 1)[1][0]
    monkeypatch.setattr(mutations, "_status", lambda words: print("\x1b[2J", file=sys.stderr) or 2)
    assert "a line that no terminal should get" in mutations.campaign(1, 1)[1][0]
    monkeypatch.setattr(mutations, "_status", lambda words: print("x") or 2)
    assert "words on standard output" in mutations.campaign(1, 1)[1][0]


def test_a_signal_while_the_commands_are_read(monkeypatch, capsys):
    """It ended in a traceback: the first half second of a command reads its libraries."""

    class Halfway(types.ModuleType):
        def __getattr__(self, name):
            raise KeyboardInterrupt

    monkeypatch.setitem(sys.modules, "stribeck.cli.app", Halfway("stribeck.cli.app"))
    assert _status(["doctor"]) == 130
    assert "interrupted" in capsys.readouterr().err


@pytest.mark.thorough
def test_every_command_that_is_killed_works(attack, monkeypatch, tmp_path, capsys):
    """Both results, which the kills of ``make fuzz`` tell apart, can be written."""
    kills = attack["kills"]
    monkeypatch.chdir(tmp_path)
    kills.prepare(tmp_path)
    for what, (older, added, last) in kills.COMMANDS.items():
        out = tmp_path / f"{what} out"
        out.mkdir()
        target = out / kills.FILES[what] if what in kills.FILES else out
        for more in ((), added):
            if what in kills.FIRST_ONLY:
                target.unlink(missing_ok=True)
            assert _status([what.split()[0], *older, "--out", str(target), *more]) == 0, (what, capsys.readouterr().err)
        assert last is None or (out / last).exists(), what


def test_the_attack_sees_a_machine_that_is_off(attack, monkeypatch):
    """Equations that differ in one number are told apart."""
    machines = attack["machines"]
    data = machines.random_machine(5)
    assert machines.one(data) == ("agree", None)
    bodies = {n: b | {k: 1.01 * b[k] for k in ("mass", "inertia") if k in b} for n, b in data["bodies"].items()}
    other = {**data, "bodies": bodies}
    solve = machines.apart.solve
    monkeypatch.setattr(machines.apart, "solve", lambda _, **more: solve(other, **more))
    what, fault = machines.one(data)
    assert what == "differ"
    assert "off by" in fault


@pytest.mark.share(3)
@pytest.mark.parametrize("seed", [0, *range(2, 9)])  # nothing drives machine 1
def test_the_energy_of_random_machines_balances(attack, seed):
    assert solved(attack["machines"].random_machine(seed)).peaks["E_in"] > 0


def test_ctrl_c_tells_how_far_it_came(attack, monkeypatch, capsys):
    """A campaign of hours told nothing before its end, and took Ctrl-C for a fault of the command."""
    import run

    statuses = iter((2, 0, 2, 3, 130))
    monkeypatch.setattr(attack["mutations"], "_status", lambda words: next(statuses))
    wrong = []
    with pytest.raises(KeyboardInterrupt):
        run.part("mutations", attack["mutations"], 1, 9, wrong)
    captured = capsys.readouterr().out
    assert captured.startswith("mutations: 4 of 9, ")
    assert captured.endswith(" s of processor time: 1 exit status 0, 2 exit status 2, 1 exit status 3\n")
    assert len(wrong) == 1
    assert "exit status 3" in wrong[0]

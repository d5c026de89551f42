"""Machines that combine every feature of machine.md, through the command line, against equations written apart.

Those that take little time run always, and all of them with `make thorough`.
"""

import json
import tomllib
from pathlib import Path

import numpy as np
import pytest

from stribeck.cli import _status
from stribeck.simulation import compiler
from tests.machine.machines import assert_balanced
from tests.reference import apart

FILES = Path(__file__).parent / "unseen"
QUICK = ("crank_play", "loads_and_factors", "sampled_tied_encoder", "serial_contacts", "tied_rails")
# of the others: points in a row, between which the times of events lie; s; of the energy, over longer and harder motions
SLOW = {"fine": 100, "late": 1e-3, "share": 1e-6}
MOTION = (".y", ".v", ".w", ".r")


def disagreements(file, found, happened, fine=20, late=1e-4, share=1e-7):
    """The columns and events of a run that differ from those of the equations written apart, in words."""
    expected, events = apart.solve_with_events(tomllib.loads(file.read_text()), fine)
    assert list(found) == list(expected)
    wrong = []
    for name, x in expected.items():
        error = np.max(np.abs(found[name] - x)) / max(np.max(np.abs(x)), 1e-12)
        if error > (1e-5 if name.endswith(MOTION) else 2e-4):
            wrong.append(f"{name}: {error:.1e}")
    for element, kinds in events.items():
        for kind, times in kinds.items():
            there = happened[element][kind]
            if len(there) != len(times):
                wrong.append(f"{element}: {len(there)} times {kind}, not {len(times)}")
            elif len(times) and np.max(np.abs(np.subtract(there, times))) > late:
                wrong.append(f"{element}: {kind} at {there}, not {times}")
    assert_balanced(found, share)
    return wrong


def run(file, out, capsys):
    """The columns and the events of a file's run."""
    assert _status(["run", str(file), "--out", str(out), "--json"]) == 0
    happened = json.loads(capsys.readouterr().out)["events"]
    head, *rows = (out / "trajectory.csv").read_text().splitlines()
    return dict(zip(head.split(","), np.loadtxt(rows, delimiter=",").T, strict=True)), happened


@pytest.mark.filterwarnings("ignore::numpy.exceptions.RankWarning")  # of the reference's own polynomials
@pytest.mark.parametrize(
    "file",
    [
        pytest.param(f, id=f.stem, marks=[pytest.mark.thorough] * (f.stem not in QUICK))
        for f in sorted(FILES.glob("*.toml"))
    ],
)
def test_agrees(file, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(compiler, "_FLAGS", ("-O0", "-fPIC", "-shared", "-fvisibility=hidden"))  # each is run once
    more = {} if file.stem in QUICK else SLOW
    assert disagreements(file, *run(file, tmp_path / "out", capsys), **more) == []

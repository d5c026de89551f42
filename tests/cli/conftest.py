"""Running the command within the test's process."""

import warnings
from dataclasses import dataclass

import pytest

from stribeck.cli import _status


@dataclass
class Outcome:
    status: int
    out: str
    err: str


@pytest.fixture
def stribeck(capsys, monkeypatch):
    """Call the command with some words: its exit status, standard output and standard error.

    It tells no progress, which depends on the speed of the machine.
    """
    monkeypatch.setattr("stribeck.cli.progress._EVERY", 1e6)

    def call(*words):
        with warnings.catch_warnings():
            status = _status([str(word) for word in words])
        captured = capsys.readouterr()
        return Outcome(status, captured.out, captured.err)

    return call


@pytest.fixture
def scenario(tmp_path):
    """A short scenario file."""
    path = tmp_path / "rig.toml"
    path.write_text(
        """
schema = 1
name = "rig"
[law]
name = "lugre_sobczyk"
k_v = 1e7
parameters = "canudas1995"
[plant]
mass = 1.0
[drive]
kind = "spring"
stiffness = 2.0
[drive.signal]
kind = "ramp"
rate = 0.1
[solve]
t_end = 10.0
[output]
step = 0.01
"""
    )
    return path

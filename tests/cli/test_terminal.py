"""What a terminal of 80 columns shows: lines that end between words, an example for each command, completion."""

import io
import os
import re
import subprocess
import sys
import time
from contextlib import contextmanager

import pytest

from stribeck import examples
from stribeck.cli import _status
from stribeck.cli import progress as show
from stribeck.mouth.terminal import _said


def test_lines_end_between_words(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "40")
    text = "a self-test of drift-free words that a terminal would have cut somewhere in their middles"
    print("\n".join(_said(text, 6, "  one ")))
    out = capsys.readouterr().out
    assert out.split() == ["one", *text.split()]
    assert all(len(line) <= 40 for line in out.splitlines())
    assert out.splitlines()[1].startswith("      ")


@pytest.mark.skipif(os.name != "posix", reason="of other shells")
@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_completion_is_installed(shell, tmp_path):
    # the variable names the shell in the place of looking at the process that started this one
    environment = {**os.environ, "HOME": str(tmp_path), "_TYPER_COMPLETE_TEST_DISABLE_SHELL_DETECTION": "1"}
    command = [sys.executable, "-m", "stribeck", "--install-completion", shell]
    process = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert process.returncode == 0
    scripts = [path.read_text() for path in tmp_path.rglob("*") if path.is_file() and "stribeck" in path.name]
    assert len(scripts) == 1
    assert f"complete_{shell}" in scripts[0]


def test_completion_knows_the_commands(tmp_path):
    environment = {**os.environ, "_STRIBECK_COMPLETE": "complete_bash", "COMP_WORDS": "stribeck sw", "COMP_CWORD": "1"}
    process = subprocess.run(
        [sys.executable, "-m", "stribeck"], env=environment, capture_output=True, text=True, check=False
    )
    assert process.stdout.split() == ["sweep"]


def test_progress_moves_though_nothing_is_told(monkeypatch):
    terminal = io.StringIO()
    terminal.isatty = lambda: True
    monkeypatch.setattr(sys, "stderr", terminal)
    with show.progress("fit") as tell:
        tell(None, "lugre")
        shown, tries = set(), 300  # half a minute, should the machine be busy
        while len(shown) < 3 and (tries := tries - 1):
            time.sleep(0.1)
            shown = set(re.findall(r"0:00:0\d|[⠀-⣿]", terminal.getvalue()))
    assert "fit: lugre" in terminal.getvalue()
    assert len(shown) > 2  # the spinner turns


def test_a_log_file_gets_lines_of_progress(monkeypatch):
    log = io.StringIO()
    monkeypatch.setattr(sys, "stderr", log)
    monkeypatch.setattr(show, "_EVERY", 0.05)
    with show.progress("axis") as tell:
        tell(0.25, "the verdict")
        tries = 600
        while not log.getvalue() and (tries := tries - 1):
            time.sleep(0.05)
    assert re.match(r"stribeck: axis: the verdict, 25 % after \d+ s\n", log.getvalue())


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("words", "what"),
    [
        (["check", "dahl", "--parameters", "canudas1995"], "check dahl"),
        (["export", "dahl", "--parameters", "canudas1995", "--target", "c", "--out", "OUT"], "export to c"),
        (["run", "FILE", "--out", "OUT"], "stick_slip"),
        (["sweep", "FILE", "--vary", "plant.mass=1:2:2", "--out", "OUT"], "stick_slip: 2 lanes"),
        (["explore", "FILE", "--out", "OUT.html"], "writing the page"),
    ],
)
def test_long_commands_show_progress(words, what, tmp_path, monkeypatch):
    """Whatever may take more than two seconds; a fit, a prediction and a design have tests of their own."""
    asked = []

    @contextmanager
    def shown(what):
        asked.append(what)
        yield lambda *_: None

    monkeypatch.setattr(show, "_lines", shown)
    out, file = str(tmp_path / "out"), str(examples.path("stick_slip"))
    assert _status([word.replace("OUT", out).replace("FILE", file) for word in words]) == 0
    assert asked == [what]


def test_a_terminal_of_ascii_alone():
    result = subprocess.run(
        [sys.executable, "-m", "stribeck", "library", "lugre"], capture_output=True, check=True,
        env=os.environ | {"PYTHONIOENCODING": "ascii"},
    ).stdout.decode("ascii")  # fmt: skip
    assert r"F = \u03c3\u2080 z" in result

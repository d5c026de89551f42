"""Messages: one plain line each, values shown shortly, and errors that travel between processes."""

from __future__ import annotations

import pickle

import pytest

from stribeck import InputError, StribeckError
from stribeck.cli import _status
from stribeck.errors import MissingExtra, arg, error_text, needed


def test_every_problem_is_one_line_that_a_terminal_can_show():
    error = InputError(["a: two\nlines", "b: \x1b[31mred\x07\t", "c: " + "x" * 1000])
    assert error.problems[:2] == ["a: two lines", r"b: \x1b[31mred\x07"]
    assert len(error.problems[2]) == 300
    assert str(error) == "\n".join(error.problems)
    assert InputError("only one").problems == ["only one"]
    assert isinstance(error, StribeckError)
    assert isinstance(error, ValueError)


def test_an_error_without_words_has_its_kind():
    class Mute(Exception):
        def __str__(self):
            raise RuntimeError

    assert error_text(Mute()) == "Mute"
    assert error_text(ValueError("x")) == "ValueError: x"


def test_no_message_holds_the_marks_of_arguments():
    """Python showed control characters, and the command the argument's bare name."""
    assert str(StribeckError(f"{arg('out')} gone")) == "out gone"
    assert str(MissingExtra(f"{arg('out')} x", "pyarrow", "plot")).startswith("out x needs pyarrow")


def test_a_module_that_no_extra_brings_is_no_missing_extra():
    with pytest.raises(ModuleNotFoundError, match="unknown"), needed("x"):
        raise ModuleNotFoundError("unknown", name="unknown")


def test_a_computation_that_failed_names_the_option(monkeypatch, capsys):
    def fails(*args, **options):
        raise StribeckError(f"{arg('out')} gone")

    monkeypatch.setattr("stribeck.cli.app.with_command", fails)
    assert _status(["sweep"]) == 1
    assert capsys.readouterr().err == "stribeck: --out gone\n"


def test_problems_survive_another_process():
    error = pickle.loads(pickle.dumps(InputError(["a: one", "b: two"])))
    assert error.problems == ["a: one", "b: two"]

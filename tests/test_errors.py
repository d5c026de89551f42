"""Messages: one plain line each, values shown shortly, and errors that travel between processes."""

from __future__ import annotations

import datetime
import math
import pickle

import pytest

from stribeck import InputError, StribeckError
from stribeck.cli import _status
from stribeck.constants import Constant, show
from stribeck.errors import MissingExtra, arg, error_text, nearest, needed


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


@pytest.mark.parametrize(("value", "text"), [(12345, "12345"), (10**20, "a whole number of 21 digits")])
def test_a_long_whole_number_is_counted(value, text):
    assert show(value) == text


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


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (1.5, "1.5"), (10**25, "a whole number of 26 digits"), (-(10**5000), "a whole number of 5001 digits"),
        (True, "true"), ("a\n'b'", '"a\\n\'b\'"'), ("x" * 200, "'" + "x" * 76 + "..."), (math.nan, "nan"),
        ([1, "a", False], "[1, 'a', false]"), ([], "[]"), ([0.5] * 100, "a list of 100"), (["x" * 50], "a list of 1"),
        ({}, "an empty table"), ({"a": 1, "b": [2]}, "a table with a, b"), (datetime.date(2024, 5, 1), "2024-05-01"),
    ],
    ids=range(14),
)  # fmt: skip
def test_values_are_shown_shortly(value, shown):
    assert show(value) == shown


@pytest.mark.parametrize(
    ("constant", "good", "bad", "allowed"),
    [
        (
            Constant("N", "force", above=0),
            (1, 1e-300, 2.5),
            (0, -1.0, math.nan, math.inf, 10**400),
            "a finite number > 0",
        ),
        (Constant("N", "force", at_least=0), (0, 0.0, 1), (-1e-300, -math.inf), "a finite number >= 0"),
        (Constant("N", "force"), (-1, 0), (math.nan, "1", True, [1.0], None, {}), "a finite number"),
    ],
    ids=["positive", "not negative", "any"],
)
def test_constants(constant, good, bad, allowed):
    assert constant.allowed == allowed
    assert [constant.problem(x) for x in good] == [None] * len(good)
    assert all(constant.problem(x).startswith(f"must be {allowed}") for x in bad)


def test_the_nearest_name():
    assert nearest("F_S", ["F_c", "F_s"]) == " (did you mean 'F_s'?)"
    assert nearest("zzz", ["F_c", "F_s"]) == ""

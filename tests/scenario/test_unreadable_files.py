"""Files that are no scenario at all, or too much of one."""

from __future__ import annotations

import sys

import numpy as np
import pytest

from stribeck import InputError, Scenario, platforms
from tests.scenario.valid_scenarios import VALID, edited, toml

GOOD = toml(VALID["pid_step"])


def refused(path) -> str:
    with pytest.raises(InputError) as error:
        Scenario.load(path)
    assert len(error.value.problems) == 1, error.value.problems
    line = error.value.problems[0]
    assert line.startswith(f"{path}: ")
    assert line.isprintable()
    assert len(line) <= 300
    return line


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"", "is empty; 'stribeck new' writes"),
        (b"# only a comment\n\n", "is empty"),
        (b"schema = \n", "is not TOML: Invalid value (at line 1"),
        (b"[law\nname = 1", "is not TOML"),
        (b"F_s: 1.5\n", "is not TOML"),
        (b'{"schema": 1}', "is not TOML"),
        (GOOD.encode() + b"schema = 1\n", "is not TOML: Cannot overwrite a value"),
        (b"schema = 1\n[law]\nname = 'lugre'\n[law]\nk_v = 1\n", "is not TOML: Cannot declare ('law',) twice"),
        (b"[solve]\nt_end = 1.0\nt_end = 2.0\n", "is not TOML: Cannot overwrite a value"),
        ("name = 'größe'".encode("latin-1"), "is not text in UTF-8"),
        (GOOD.encode("utf-16"), "is not text in UTF-8"),
        (bytes(range(256)), "is not text in UTF-8"),
        (b"a\x00 = 1", "is not TOML"),
        (b"x = " + b"[" * 100_000, "nested too deeply"),
        (b"x = " + b"{a = " * 100_000, "nested too deeply"),
        (b"x = " + b"9" * 10_000, "cannot be read: the path or a number in it is impossible"),
    ],
    ids=range(16),
)
def test_a_file_that_is_not_toml(content, said, tmp_path):
    path = tmp_path / "scenario.toml"
    path.write_bytes(content)
    assert said in refused(path)


def test_a_file_that_cannot_be_read(tmp_path):
    assert refused(tmp_path / "missing.toml").endswith("cannot be read: No such file or directory")
    assert "cannot be read" in refused(tmp_path)
    assert "cannot be read" in refused(tmp_path / "missing" / "scenario.toml")


def test_a_mark_at_the_beginning_is_no_mistake(tmp_path):
    path = tmp_path / "scenario.toml"
    path.write_bytes(b"\xef\xbb\xbf" + GOOD.replace("\n", "\r\n").encode())
    assert Scenario.load(path).name == "scenario"


@pytest.mark.parametrize(
    "text",
    [
        "law = {x = " + "[" * 100 + "]" * 100 + "}",
        ".".join("a" * 5_000) + " = 1",
        "[" + ".".join("a" * 20_000) + "]",
        "[law." + ".".join("a" * 5_000) + "]\nx = 1",
    ],
    ids=range(4),
)
def test_deep_nesting(text, tmp_path):
    path = tmp_path / "scenario.toml"
    path.write_text(text)
    ours, toml = (
        r"^(a|law): nested too deeply: must be at most 8 tables or lists deep$",
        r"lists are nested too deeply$",
    )
    with pytest.raises(InputError, match=f"{ours}|{toml}"):  # Python 3.14's tomllib refuses the three last itself
        Scenario.load(path)


def test_numbers_with_more_digits_than_python_prints(tmp_path):
    path = tmp_path / "scenario.toml"
    path.write_text(GOOD.replace("t_end = 1.0", f"t_end = 0x{'f' * 5000}"))
    with pytest.raises(InputError, match=r"^solve.t_end: a whole number of 6021 digits: must be a finite number > 0$"):
        Scenario.load(path)
    assert sys.get_int_max_str_digits() == 4300  # or this test shows nothing


@pytest.mark.parametrize(
    ("t_end", "step", "said"),
    [
        (1e6, 1e-6, r"1e\+12 rows would take \d+ TB of memory, and .* are free; must be larger"),
        (1.0, 1e-320, r"more than 1e\+15 rows would take more than \d+ PB of memory, and .*; must be larger"),
        (1e308, 1e-308, r"more than 1e\+15 rows would take more than \d+ PB of memory, and .*; must be larger"),
    ],
)
def test_more_rows_than_memory_holds(t_end, step, said):
    data = edited(edited(VALID["force_points"], "solve.t_end", value=t_end), "output.step", value=step)
    with pytest.raises(InputError, match=f"^output.step: .*: {said}$") as error:
        Scenario(data)
    assert f"{step}: " in str(error.value)
    assert len(error.value.problems) == 1


def test_rows_are_kept_twice_in_the_memory_that_is_free(monkeypatch):
    data = edited(VALID["force_points"], "output.step", value=1e-4)
    columns = 1 + len(Scenario(data).system.columns)  # and the time
    needed = 2 * np.zeros((10_001, columns)).nbytes
    monkeypatch.setattr(platforms, "free_memory", lambda: float(needed))
    Scenario(data)
    monkeypatch.setattr(platforms, "free_memory", lambda: needed - 1.0)
    with pytest.raises(InputError, match="rows would take"):
        Scenario(data)

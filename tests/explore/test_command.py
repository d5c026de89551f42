"""``stribeck explore`` as a user calls it."""

import base64
import html
import json

import pytest

from stribeck import examples
from tests.cli.conftest import stribeck  # noqa: F401


def test_the_page_stands_alone_and_is_small(made, data):
    text = made.read_text()
    assert "http://" not in text.replace("http://www.w3.org", "")
    assert "src=" not in text.split("<script type")[0]
    modules = [len(base64.b64decode(law["wasm"])) for law in data["laws"].values()]
    from stribeck.laws import builtin

    rest = (len(builtin()) - len(modules)) * (4 / 3 * max(modules) + 6000)
    assert made.stat().st_size + rest < 1.5e6
    paths = {n["path"] for n in (*data["numbers"], *data["laws"]["lugre_majorant"]["numbers"])}
    assert {"law.k_v", "law.parameters.F_s", "plant.mass", "plant.initial.z", "drive.stiffness", "drive.signal.rate",
            "solve.t_end", "solve.rtol", "output.step"} <= paths  # fmt: skip


def test_the_command_writes_a_page(stribeck, tmp_path):  # noqa: F811
    out = tmp_path / "mine.html"
    name = "{{ script }} {{ version }} </script>"  # what fills the page is data, and not a part of its text
    found = stribeck(
        "explore", examples.path("stick_slip"), "--set", "law.name=lugre_majorant", "--law", "lugre", "--out", out,
        "--set", f"name={name}",
    )  # fmt: skip
    assert (found.status, found.err) == (0, "")
    assert "open" in found.out
    text = out.read_text()
    assert f"<h1>{html.escape(name)}</h1>" in text
    data = json.loads(text.partition('<script type="application/json" id="data">')[2].partition("</script>")[0])
    assert data["name"] == name


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (("nothing.toml",), "nothing.toml"),
        (("lugr",), "'lugr': no such law (did you mean 'lugre'?)"),
        (("lugre", "--law", "x"), "'x': no such law"),
        (("lugre", "--out", "."), "--out: '.': is a folder"),
        (("lugre", "--set", "plant.mass=-1"), "plant.mass: -1: must be a finite number > 0"),
        ((str(examples.path("belt")), "--law", "lugre"), "--law: lugre: a machine keeps the laws of its file"),
        (
            (str(examples.path("servo")), "--law", "lugre"),
            "--law: lugre: a servo, or a drive that follows a curve, keeps the laws",
        ),
        (("--report", "."), "--report: '.': must be a folder"),
    ],
)
def test_bad_input_is_one_line(stribeck, words, line, tmp_path, monkeypatch):  # noqa: F811
    monkeypatch.chdir(tmp_path)
    found = stribeck("explore", *words)
    assert found.status == 2
    assert found.out == ""
    assert line in found.err
    assert found.err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_a_missing_extra_is_one_line(tmp_path):
    from tests.cli.test_extras import command

    found = command(tmp_path, "explore", "lugre", blocked=("bokeh",))
    assert found.returncode == 2
    assert found.stderr == "stribeck: an explorer needs bokeh: pip install 'stribeck[plot]'\n"


def test_a_page_is_added_to_what_run_left(stribeck, tmp_path):  # noqa: F811
    from stribeck import Scenario

    words = ("--set", "law.name=lugre_majorant", "--set", "solve.t_end=2.0")
    assert stribeck("run", examples.path("stick_slip"), *words, "--out", tmp_path / "first").status == 0
    assert "Moves up to" in (tmp_path / "first" / "report.html").read_text()
    found = stribeck("explore", "--report", tmp_path / "first", "--law", "lugre")
    assert (found.status, found.err) == (0, "")
    text = (tmp_path / "first" / "explore.html").read_text()
    number = text[text.index('"solve.t_end"') :]
    assert '"value": 2.0' in number[:200]
    assert Scenario.load(examples.path("stick_slip")).solve.t_end == 40.0


def test_a_run_of_a_stranger_executes_no_law_elsewhere(stribeck, tmp_path, monkeypatch):  # noqa: F811
    """Its summary.json says which folder its laws are seen from: / held every file of the disk."""
    (tmp_path / "evil.py").write_text(f"open({str(tmp_path / 'executed')!r}, 'w').close()\n")
    for name in ("theirs", "mine"):
        (tmp_path / name).mkdir()
    tables = {"schema": 1, "law": {"name": f"{str(tmp_path)[1:]}/evil.py:X"},
              "plant": {"mass": 1.0}, "solve": {"t_end": 1.0}, "output": {"step": 0.1},
              "drive": {"kind": "force", "signal": {"kind": "ramp", "rate": 1.0}}}  # fmt: skip
    (tmp_path / "theirs" / "summary.json").write_text(json.dumps({"tables": tables, "folder": "/"}))
    monkeypatch.chdir(tmp_path / "mine")
    found = stribeck("explore", "--report", tmp_path / "theirs")
    assert found.status == 2
    assert "must be in the current folder, in the result's or below them, or allowed with" in found.err
    assert not (tmp_path / "executed").exists()
    (tmp_path / "theirs" / "summary.json").write_text(json.dumps({"tables": 3, "folder": "/"}))
    assert "must be a folder that" in stribeck("explore", "--report", tmp_path / "theirs").err

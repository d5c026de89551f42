"""What an export takes, and what no target can hold; refusals in a few words are in tests/kept."""

from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

import stribeck
from stribeck import examples
from stribeck.exports.c.sampling import radius
from stribeck.exports.fmu.archive import described
from stribeck.exports.fmu.description import model_description
from stribeck.exports.request import Request
from tests.exports.harness import law


def test_the_words_of_a_constant_end_no_comment_and_no_string(tmp_path):
    """They went into the C and the FMU's XML as they stood: the one did not compile, the other was no XML."""
    (tmp_path / "mine.py").write_text(
        "from stribeck.constants import Constant\n"
        "from stribeck.laws import StaticLaw\n"
        "class Mine(StaticLaw):\n"
        "    'Viscous. Ends a comment: */ and (* begins one *).'\n"
        "    source = 'me \\u00b5 ??/ */'\n"
        "    c = Constant('N \"*) */', 'ends */ *) \\x07 \\u00b5 ??/', at_least=0, example=1.0)\n"
        "    @staticmethod\n"
        "    def friction(p, v, z, dz_dt):\n"
        "        return p.c * v\n"
    )
    mine = stribeck.law(f"{tmp_path / 'mine.py'}:Mine", {}, c=1.0)
    stribeck.export(mine, "c", tmp_path / "c")
    for file in (tmp_path / "c").iterdir():
        text = file.read_text()
        assert text.isascii()
        assert text.count("/*") == text.count("*/")
        assert "??" not in text
    of, _ = described(Request(mine))
    assert "ends" in ElementTree.fromstring(model_description(of)).find(".//*[@name='c']").get("description")


def test_constants_that_no_target_can_have(tmp_path):
    (tmp_path / "mine.py").write_text(
        "from stribeck.laws.base import StaticLaw\n"
        "from stribeck.constants import Constant\n"
        "class Odd(StaticLaw):\n"
        "    'Viscous.'\n"
        "    dt = Constant('N s/m', 'viscous friction', at_least=0)\n"
        "    double = Constant('N s/m', 'viscous friction', at_least=0)\n"
        "    @staticmethod\n"
        "    def friction(p, v, z, dz_dt):\n"
        "        return (p.dt + p.double) * v\n"
    )
    with pytest.raises(stribeck.InputError, match=r"\Adouble: .*\Z"):
        stribeck.export(stribeck.law(f"{tmp_path}/mine.py:Odd", {}, dt=1.0, double=1.0), "c", tmp_path / "out")
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("name", ["lugre", "elastoplastic_majorant"])
def test_the_limit_is_where_the_loop_grows(name):
    """The linearization against the loop itself: a body at rest, kicked by almost nothing."""
    chosen = law(name)
    for step in (2e-3, 3.2e-3, 4.2e-3, 6e-3):
        v, z = 1e-9, 0.0
        for _ in range(400):
            x = step * float(chosen.jacobian(v, z)[1])
            z += step * (np.expm1(x) / x if x else 1.0) * float(chosen.rate(v, z))
            v -= step * float(chosen.force(v, z))
        assert (abs(v) > 1e-9) == (radius(chosen, 1.0, step) > 1), step


def test_a_crash_leaves_nothing(tmp_path, monkeypatch):
    def full(self, data):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(OSError, match="No space"):
        stribeck.export(law("lugre"), "c", tmp_path / "out")
    with pytest.raises(OSError, match="No space"):
        stribeck.export(law("lugre"), "table", tmp_path / "law.csv")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("given", [str, Path, lambda path: dict(stribeck.load(path).data)])
@pytest.mark.parametrize("keyword", [True, False])
def test_a_machine_is_exported_from_its_file_or_its_tables_too(tmp_path, given, keyword):
    """As `simulate`, `check` and `design` take it."""
    path = examples.path("axis_hunts")
    stribeck.export(stribeck.load(path), "c", tmp_path / "loaded")
    law, scenario = (None, given(path)) if keyword else (given(path), None)
    files = stribeck.export(law, "c", tmp_path / "given", scenario=scenario)
    assert [p.name for p in files] == ["axis_hunts.h", "axis_hunts.c", "axis_hunts_run.c"]
    assert all(p.read_bytes() == (tmp_path / "loaded" / p.name).read_bytes() for p in files)

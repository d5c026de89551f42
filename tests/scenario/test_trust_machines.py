"""A machine may come from a stranger too: laws and elements in files are executed last, and only from its folder."""

from __future__ import annotations

import pytest

import stribeck
from stribeck.scenario import Scenario

MACHINE = """
schema = 2
[bodies.table]
mass = 1.0
[bodies.motor]
mass = 0.1
[links.screw]
kind = "{element}"
from = "motor"
to = "table"
stiffness = 1e4
[contacts.guide]
from = "table"
law = {{ name = "{law}", parameters = "canudas1995" }}
[solve]
t_end = {t_end}
[output]
step = 0.001
"""
PLUGIN = """
from pathlib import Path
Path({mark!r}).write_text("executed")
from stribeck.laws.lugre import LuGre
from stribeck.machine.elements.links import Link
class OwnLaw(LuGre): pass
class OwnLink(Link): pass
"""


@pytest.mark.parametrize(("law", "element"), [("own.py:OwnLaw", "link"), ("lugre", "own.py:OwnLink")])
@pytest.mark.parametrize("outside", [False, True])
@pytest.mark.parametrize("valid", [True, False])
def test_files_are_executed_last_and_from_the_own_folder(tmp_path, law, element, outside, valid):
    mark, home = tmp_path / "mark", tmp_path / "home"
    home.mkdir()
    (tmp_path / "own.py" if outside else home / "own.py").write_text(PLUGIN.format(mark=str(mark)))
    up = "../" if outside else ""
    names = {"law": law.replace("own.py", f"{up}own.py"), "element": element.replace("own.py", f"{up}own.py")}
    file = home / "machine.toml"
    file.write_text(MACHINE.format(t_end=0.01 if valid else -1.0, **names))
    if valid and not outside:
        assert Scenario.load(file).elements is not None
    else:
        with pytest.raises(stribeck.InputError, match="folder" if valid else "t_end"):
            Scenario.load(file)
    assert mark.exists() is (valid and not outside)
    if valid:
        assert Scenario.load(file, trust=True).elements is not None

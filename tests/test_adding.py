"""Adding a drive, a plant, an export target or a chapter is one file, as adding a law is."""

from __future__ import annotations

import sys

import pytest

from stribeck import drives, export, plants
from stribeck.export import text

DRIVE = '''
from stribeck.drives.base import Column, Drive


class Doubled(Drive):
    """Twice the signal."""

    kind, meaning = "doubled", "the signal is half of the force, N"
    signal = Column("half", "N", "half of the force")

    @staticmethod
    def force(p, r, y, v, x):
        return 2 * r
'''
PLANT = '''
from stribeck.constants import Constant
from stribeck.plants.base import Plant


class Heavy(Plant):
    """Twice the mass."""

    kind, meaning = "heavy", "a body of twice the mass"
    constants = {"half": Constant("kg", "half of the mass", above=0)}

    @staticmethod
    def acceleration(p, u, F, x=()):
        return (u - F) / (2 * p.half)
'''
TARGET = """
from stribeck.export.request import Target

TARGET = Target("names", "text.zz_names", "the names of the constants", folder=False)


def files(request):
    return {"names.txt": " ".join(request.constants)}
"""
CHAPTER = "def chapter(done):\n    return None\n"


@pytest.fixture
def beside(tmp_path, monkeypatch):
    """Put a file into a package for the time of a test."""
    before = set(sys.modules)

    def put(package, name, content):
        (tmp_path / f"{name}.py").write_text(content, encoding="utf-8")
        monkeypatch.setattr(package, "__path__", [*package.__path__, str(tmp_path)])

    yield put
    for name in set(sys.modules) - before:
        del sys.modules[name]


def test_a_drive_is_one_file(beside):
    beside(drives, "zz_doubled", DRIVE)
    found = drives.kinds()
    assert list(found) == [*drives.KINDS, "doubled"]
    assert found["doubled"].force(None, 1.5, 0.0, 0.0, ()) == 3.0


def test_a_plant_is_one_file(beside, monkeypatch):
    from stribeck import Scenario, simulate
    from stribeck.scenario import schema

    beside(plants, "zz_heavy", PLANT)
    found = plants.kinds()
    assert list(found) == [*plants.KINDS, "heavy"]
    monkeypatch.setattr(plants, "KINDS", found)
    assert "a body of twice the mass" in schema.text()

    def moved(plant):
        return Scenario(
            law={"name": "lugre", "parameters": "canudas1995"}, plant=plant,
            drive={"kind": "force", "signal": {"kind": "ramp", "rate": 3.0}}, solve={"t_end": 1.0}, output={"step": 0.1},
        )  # fmt: skip

    heavy, mass = simulate(moved({"kind": "heavy", "half": 0.5})), simulate(moved({"mass": 1.0}))
    assert abs(heavy["y"] - mass["y"]).max() <= 1e-6 * abs(mass["y"]).max()


def test_an_export_target_is_one_file(beside, monkeypatch, tmp_path):
    import stribeck

    beside(text, "zz_names", TARGET)
    found = export.targets()
    assert set(found) - set(export.TARGETS) == {"names"}
    monkeypatch.setattr(export, "TARGETS", found)
    law = stribeck.law("coulomb_viscous", {"F_c": 1.0, "sigma_2": 0.1})
    (file,) = export.export(law, "names", tmp_path / "names.txt")
    assert file.read_text().split()[:2] == ["F_c", "sigma_2"]

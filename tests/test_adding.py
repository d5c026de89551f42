"""Adding an export target is one file, as adding a law or a kind of element is."""

from __future__ import annotations

import sys

import pytest

import stribeck
from stribeck import exports
from stribeck.exports import targets

TARGET = """
from stribeck.exports.request import Target, Part


def files(request):
    return {"names.txt": " ".join(request.constants)}


TARGET = Target("names", "the names of the constants", {"law": Part(files)}, folder=False)
"""


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


def test_an_export_target_is_one_file(beside, monkeypatch, tmp_path):
    beside(targets, "zz_names", TARGET)
    result = exports.find_targets()
    assert set(result) - set(exports.TARGETS) == {"names"}
    monkeypatch.setattr(exports, "TARGETS", result)
    law = stribeck.law("coulomb_viscous", {"F_c": 1.0, "sigma_2": 0.1})
    (file,) = exports.export(law, "names", tmp_path / "names.txt")
    assert file.read_text().split()[:2] == ["F_c", "sigma_2"]

"""--backend: what solves, said on the command line."""

import json
import os

import pytest


def test_the_backend_asked_for_solves(stribeck, scenario):
    before = os.environ.get("STRIBECK_BACKEND", "")
    summary = json.loads(stribeck("run", scenario, "--backend", "wasm", "--json").out)
    assert summary["status"] == "done"
    assert summary["steps"]["backend"] == "wasm"
    assert os.environ.get("STRIBECK_BACKEND", "") == before


def test_a_sweep_by_webassembly_needs_no_compiler(stribeck, scenario, tmp_path, monkeypatch):
    """To the bit what it gives where there is none."""
    pyarrow = pytest.importorskip("pyarrow.parquet")
    words = ("sweep", scenario, "--vary", "plant.mass=1:2:2", "--out")
    assert stribeck(*words, tmp_path / "asked", "--backend", "wasm").status == 0
    monkeypatch.setenv("STRIBECK_CC", "none")
    assert stribeck(*words, tmp_path / "without").status == 0
    asked, without = (pyarrow.read_table(tmp_path / name) for name in ("asked", "without"))
    assert asked.num_rows
    assert asked.equals(without)

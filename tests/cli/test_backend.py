"""STRIBECK_BACKEND: what solves."""

import pytest


def test_a_sweep_by_webassembly_needs_no_compiler(stribeck, scenario, tmp_path, monkeypatch):
    """To the bit what it gives where there is none."""
    pyarrow = pytest.importorskip("pyarrow.parquet")
    words = ("sweep", scenario, "--vary", "plant.mass=1:2:2", "--out")
    monkeypatch.setenv("STRIBECK_BACKEND", "wasm")
    assert stribeck(*words, tmp_path / "asked").status == 0
    monkeypatch.setenv("STRIBECK_BACKEND", "auto")
    monkeypatch.setenv("STRIBECK_CC", "none")
    assert stribeck(*words, tmp_path / "without").status == 0
    asked, without = (pyarrow.read_table(tmp_path / name) for name in ("asked", "without"))
    assert asked.num_rows
    assert asked.equals(without)

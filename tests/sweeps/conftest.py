"""Sweeps of several parts."""

import pytest

from stribeck.sweeps import job


@pytest.fixture(autouse=True)
def small_parts(monkeypatch):
    """Two lanes a part."""
    monkeypatch.setattr(job, "_PART_BYTES", 2 * 8.0 * 7 * 201)

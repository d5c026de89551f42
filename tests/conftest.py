"""Fixtures for every test."""

import pytest


@pytest.fixture(scope="session", autouse=True)
def _cache_folder(tmp_path_factory):
    """Compiled systems go into a folder of the test run's own, shared by its workers."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("STRIBECK_CACHE", str(tmp_path_factory.getbasetemp().parent / "stribeck-cache"))
        yield

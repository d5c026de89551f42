"""Fixtures for every test."""

from pathlib import Path

import pytest


@pytest.fixture(scope="session", autouse=True)
def _cache_folder(tmp_path_factory):
    """Compiled systems go into a folder of the test run's own, shared by its workers."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("STRIBECK_CACHE", str(tmp_path_factory.getbasetemp().parent / "stribeck-cache"))
        yield


# Seen to fail, or not seen to pass, where the last branches met: to be mended and taken off this list, one by one.
UNVERIFIED = tuple(Path(__file__).with_name("unverified.txt").read_text().split())


def pytest_collection_modifyitems(items):
    for item in items:
        if item.nodeid.startswith(UNVERIFIED):
            item.add_marker(pytest.mark.xfail(reason="not seen to pass since the last merge", strict=False))

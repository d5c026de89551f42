"""Fixtures for every test."""

import pytest


@pytest.fixture(scope="session", autouse=True)
def _cache_folder(tmp_path_factory):
    """Compiled systems go into a folder of the test run's own, shared by its workers."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("STRIBECK_CACHE", str(tmp_path_factory.getbasetemp().parent / "stribeck-cache"))
        yield


BLANK = (
    '<?xml version="1.0"?>\n<svg xmlns="http://www.w3.org/2000/svg" width="9pt" height="9pt" viewBox="0 0 9 9"></svg>\n'
)


@pytest.fixture(autouse=True)
def _blank_pictures(request, monkeypatch):
    """Figures are made but drawn only in tests marked ``pictures``: half of a command's time goes into drawing."""
    if "pictures" not in request.keywords:
        monkeypatch.setattr("stribeck.report.plots.svg", lambda made: BLANK)
        monkeypatch.setattr("stribeck.report.plots.prints", lambda made, pdf: (b"png", b"pdf" if pdf else b""))

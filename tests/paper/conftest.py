"""The report, made once for all tests and workers; and single chapters of it, for tests that need no more."""

import importlib
import json
import os
import subprocess
import sys
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

import pytest

from stribeck.errors import EXTRAS
from stribeck.mouth.page import html
from tests.absent import site_without
from tests.pages import Page

# what the extra [demo] installs
ROOT = Path(__file__).parents[2]
BROUGHT = {"matplotlib", "jinja2", "markupsafe", "pyarrow", "flint"}


@dataclass
class Report:
    folder: Path
    data: dict

    def numbers(self, chapter):
        return self.data["chapters"][chapter]

    def tables(self, chapter):
        """Its tables as rows of text; the first row is the head."""
        return Page(self.folder / "report.html", section=chapter).tables


@contextmanager
def alone(path):
    """One worker at a time, where the system can say so."""
    with path.open("w") as handle:
        with suppress(ImportError):
            import fcntl

            fcntl.flock(handle, fcntl.LOCK_EX)
        yield


@pytest.fixture(scope="session")
def report(tmp_path_factory, worker_id):
    own = tmp_path_factory.getbasetemp()
    folder = (own if worker_id == "master" else own.parent) / "paper-report"
    with alone(folder.with_suffix(".lock")):
        if not folder.exists():
            words = [sys.executable, "-m", "examples.paper", "--out", str(folder)]
            # with what 'make demo' installs and no more
            site = site_without(set(EXTRAS) - BROUGHT, folder.with_name("paper-site"))
            paths = [str(site), *filter(None, [os.environ.get("PYTHONPATH")])]
            env = {**os.environ, "PYTHONPATH": os.pathsep.join(paths)}
            done = subprocess.run(words, capture_output=True, text=True, env=env, cwd=ROOT)
            assert done.returncode == 0, done.stderr
            assert done.stdout == f"open {folder / 'report.html'}\n"
    return Report(folder, json.loads((folder / "summary.json").read_text()))


@pytest.fixture
def chapter(tmp_path, monkeypatch):
    """Makes one chapter that needs no other: its numbers, and its tables as a page shows them."""

    monkeypatch.setattr("examples.paper.common.png", lambda made: b"png")

    def built(name):
        done = importlib.import_module(f"examples.paper.{name}").chapter({})
        (tmp_path / "report.html").write_text(html("", "", (), [done]), encoding="utf-8")
        return Report(tmp_path, {"chapters": {done.key: done.numbers}})

    return built

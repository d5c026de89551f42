"""Coq for the tests, where it is installed."""

from __future__ import annotations

import importlib
import shutil
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

FOLDER = Path(__file__).parent.parent.parent / "proofs"
needs_coq = pytest.mark.skipif(shutil.which("coqc") is None, reason="coqc is not installed")


def script(name: str) -> ModuleType:
    """A program of the folder of proofs, as a module."""
    if str(FOLDER) not in sys.path:
        sys.path.append(str(FOLDER))
    return importlib.import_module(name)


def compiles(text: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """Coq's answer to a file."""
    (folder / "Goal.v").write_text(text)
    command = ["coqc", "-q", "-w", "-ambiguous-paths", "Goal.v"]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False, timeout=900)

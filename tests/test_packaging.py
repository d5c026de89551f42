"""What is installed and shipped: the floors of the dependencies, and the tests that the sdist holds."""

import re
import shutil
import subprocess
import sys
import tarfile
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
DEVELOPERS = {"demo", "docs", "dev"}  # extras whose versions are not a user's


def test_floors_are_the_releases_that_were_tried():
    """'make floors' installs tools/floors.txt, in exactly these versions, and runs the tests."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = {name: lines for name, lines in project["optional-dependencies"].items() if name not in DEVELOPERS}
    wanted = {line for lines in (project["dependencies"], *extras.values()) for line in lines}
    floors = {line.replace(">=", "==") for line in wanted if not line.startswith("stribeck[")}
    assert all(re.fullmatch(r"[\w.-]+==[\d.]+", line) for line in floors), (
        "each dependency has one floor and no other limit"
    )
    tried = (ROOT / "tools" / "floors.txt").read_text(encoding="utf-8").splitlines()
    assert sorted(line for line in tried if not line.startswith("#")) == sorted(floors)


def test_every_extra_that_a_page_names_exists():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    for page in (ROOT / "README.md", *(ROOT / "docs").rglob("*.md")):
        text = page.read_text(encoding="utf-8")
        named = re.findall(r"stribeck\[(\w+)\]|extra `(\w+)`", text)
        assert {a or b for a, b in named} <= project["optional-dependencies"].keys(), page


@pytest.mark.thorough
def test_the_sdist_holds_no_tests(tmp_path):
    """By default setuptools takes tests/test*.py alone, which do not run without the files beside them."""
    pytest.importorskip("setuptools", minversion="77", reason="pyproject.toml needs setuptools 77 to build")
    for name in ("pyproject.toml", "MANIFEST.in", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, tmp_path)
    for folder in ("src", "tests"):
        shutil.copytree(ROOT / folder, tmp_path / folder, ignore=shutil.ignore_patterns("__pycache__", "*.egg-info"))
    build = "import sys; from setuptools.build_meta import build_sdist; build_sdist(sys.argv[1])"
    subprocess.run([sys.executable, "-c", build, "."], cwd=tmp_path, check=True, capture_output=True)
    (built,) = tmp_path.glob("*.tar.gz")
    with tarfile.open(built) as archive:
        names = archive.getnames()
    assert f"{built.name.removesuffix('.tar.gz')}/src/stribeck/py.typed" in names
    assert not [name for name in names if "tests" in name.split("/")]

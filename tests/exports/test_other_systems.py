"""The generated C is built for Windows and macOS, without a warning."""

import subprocess
import sys

import pytest

import stribeck
from stribeck import examples

EXPORTS = {
    "a machine": ("gear", {"part": "machine"}),
    "a law": ("gear", {"part": "law", "contact": "bearing", "self_test": True}),
    "a controller": ("arm", {"part": "controller", "self_test": True}),
}


@pytest.mark.thorough
@pytest.mark.parametrize("target", ["x86_64-windows-gnu", "aarch64-macos", "x86_64-macos"])
@pytest.mark.parametrize("what", EXPORTS)
def test_it_compiles_there(what, target, tmp_path):
    """tools/windows/README.md tells how to run it under wine."""
    pytest.importorskip("ziglang", reason="ziglang, of the extra 'fmu', is not installed")
    example, options = EXPORTS[what]
    written = stribeck.export(stribeck.Scenario.load(examples.path(example)), "c", tmp_path / "c", **options)
    files = [path for path in written if path.suffix == ".c"]
    assert len(files) == 2
    built = tmp_path / "made.exe"
    words = [sys.executable, "-m", "ziglang", "cc", "-std=c99", "-O2", "-Wall", "-Wextra", "-Werror", "-target", target]
    subprocess.run([*words, *files, "-o", built], check=True)
    assert built.read_bytes()[:2] == (b"MZ" if "windows" in target else b"\xcf\xfa")

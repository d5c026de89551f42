"""stribeck import: another program's file as a machine."""

import json
import os
import tomllib

import pytest

PLAIN = {"kt": 1.5, "R": 2.0, "armature": 0.02, "friction_base": 0.05, "friction_viscous": 0.06}


@pytest.mark.skipif(os.name != "posix", reason="Windows has no such names")
def test_the_name_of_a_file_writes_no_line(stribeck, tmp_path):
    """It went as it is into the machine's first line, a comment."""
    path = tmp_path / "a\nrotary = 5.json"
    path.write_text(json.dumps(PLAIN))
    done = stribeck("import", "bam", path, "--out", tmp_path / "m.toml")
    assert done.status == 0, done.err
    assert "rotary" not in tomllib.loads((tmp_path / "m.toml").read_text())

"""stribeck import: what is turned into another program's file and back."""

import json
import os
import tomllib

import pytest
import tomli_w

PLAIN = {"kt": 1.5, "R": 2.0, "armature": 0.02, "friction_base": 0.05, "friction_viscous": 0.06}
CYCLE = {"a": {"tied_to": "b", "mass": 1.0}, "b": {"tied_to": "a", "mass": 1.0}}


@pytest.mark.parametrize("kind", ["bam", "mujoco"])
@pytest.mark.parametrize(
    ("change", "said"),
    [({"bodies": CYCLE}, "bodies.a"), ({"bodies": {'a"/><x': {"mass": 1.0}}}, "a name must be"), ({"bodies": 1}, "bodies: 1"),
     ({"bodies": {"a": {"mass": "x"}}}, "bodies.a.mass: 'x'")],
)  # fmt: skip
def test_what_is_turned_back_is_a_valid_machine(stribeck, tmp_path, kind, change, said):
    """Bodies tied in a circle were followed for ever, tables that are none ended in a traceback, and a name in elements."""
    pytest.importorskip("mujoco")
    law = {"name": "coulomb_viscous", "k_v": 100.0, "parameters": {"F_c": 1.0, "sigma_2": 1.0}}
    machine = {
        "schema": 2, "bodies": {"a": {"mass": 1.0}}, "contacts": {"f": {"from": "a", "law": law}}, "solve": {"t_end": 1.0},
        "output": {"step": 0.1},
    }  # fmt: skip
    (tmp_path / "m.toml").write_text(tomli_w.dumps(machine | change))
    done = stribeck("import", kind, tmp_path / "m.toml", "--out", tmp_path / "out")
    assert done.status == 2
    assert said in done.err
    assert not (tmp_path / "out").exists()


def test_a_set_of_parameters_is_written_out(stribeck, tmp_path):
    """Its name stood where numbers were looked for."""
    mujoco = pytest.importorskip("mujoco")
    data = {
        "schema": 2, "bodies": {"a": {"mass": 1.0}}, "solve": {"t_end": 1.0}, "output": {"step": 0.1},
        "contacts": {"f": {"from": "a", "law": {"name": "lugre", "parameters": "canudas1995"}}},
    }  # fmt: skip
    (tmp_path / "m.toml").write_text(tomli_w.dumps(data))
    assert stribeck("import", "mujoco", tmp_path / "m.toml", "--out", tmp_path / "m.xml").status == 0
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "m.xml"))
    assert model.actuator_dynprm[0][5] == 1e5  # sigma_0 of the set


@pytest.mark.skipif(os.name != "posix", reason="Windows has no such names")
def test_the_name_of_a_file_writes_no_line(stribeck, tmp_path):
    """It went as it is into the machine's first line, a comment."""
    path = tmp_path / "a\nrotary = 5.json"
    path.write_text(json.dumps(PLAIN))
    done = stribeck("import", "bam", path, "--out", tmp_path / "m.toml")
    assert done.status == 0, done.err
    assert "rotary" not in tomllib.loads((tmp_path / "m.toml").read_text())

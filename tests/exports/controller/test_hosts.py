"""What hosts an exported controller: MuJoCo, which loads the plugin and runs it."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import stribeck
from stribeck import Scenario
from tests.exports.controller.stages import RUB, stage
from tests.exports.harness import need


def test_the_mujoco_plugin_moves_as_the_simulation(tmp_path):
    """Built against MuJoCo's own headers, loaded, run: the body goes where the simulated one does, the nearer the smaller
    MuJoCo's steps are. In a process of its own, since a plugin stays loaded."""
    need("gcc")
    mujoco = pytest.importorskip("mujoco", reason="mujoco is not installed")
    place = Path(mujoco.__file__).parent
    library = next(iter(place.glob("libmujoco.so.*")), None)
    if library is None or not (place / "include" / "mujoco" / "mjplugin.h").exists():
        pytest.skip("this package of MuJoCo has no headers or library")
    data = stage().data  # without its contact: friction is not in MuJoCo's model
    data = {**data, "contacts": {}, "controllers": {"axis": {**data["controllers"]["axis"]}}}
    data["controllers"]["axis"]["compensation"] = {"law": RUB, "speed": "measured", "share": 0.3}
    free = Scenario(data)
    stribeck.export(free, "mujoco_plugin", tmp_path, part="controller")
    sources = [str(tmp_path / name) for name in ("stage_axis.c", "stage_axis_mujoco.c")]
    words = ["gcc", "-std=c99", "-O2", "-shared", "-fPIC", f"-I{place / 'include'}", *sources, str(library), "-lm"]
    subprocess.run([*words, "-o", str(tmp_path / "plugin.so")], check=True)
    script = f"""
import mujoco
mujoco.mj_loadPluginLibrary({str(tmp_path / "plugin.so")!r})
model = mujoco.MjModel.from_xml_path({str(tmp_path / "stage_axis.xml")!r})
other = open({str(tmp_path / "stage_axis.xml")!r}).read().replace('value="own"', 'value="other"')
try:
    mujoco.MjData(mujoco.MjModel.from_xml_string(other))
except Exception:
    pass
else:
    raise SystemExit("a signal that there is not was taken")
for parts in (10, 40):
    model.opt.timestep = 1e-3 / parts
    data = mujoco.MjData(model)
    for k in range(400 * parts):
        if k % parts == 0:
            print(data.qpos[0])
        mujoco.mj_step(model, data)
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True, cwd=tmp_path)
    coarse, fine = np.array([float(x) for x in done.stdout.split()]).reshape(2, -1)
    exact = np.asarray(stribeck.simulate(free)["a.y"])[:-1]
    size = np.abs(exact).max()
    assert size > 0.01
    assert np.abs(coarse - exact).max() < 6e-3 * size
    assert np.abs(fine - exact).max() < 2e-3 * size

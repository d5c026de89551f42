"""Every command and every Python line of docs/reference/tools.md works as it stands, and says what it says."""

import ctypes
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import stribeck
from stribeck.cli import _status
from stribeck.errors import MissingExtra
from stribeck.exports import export
from stribeck.exports.python import to_jax, to_torch

ROOT = Path(__file__).parent.parent.parent
TEXT = (ROOT / "docs" / "reference" / "tools.md").read_text(encoding="utf-8")
SECTIONS = dict(re.findall(r"^## (\S[^\n]*)\n(.*?)(?=^## |\Z)", TEXT, re.S | re.M))


def blocks(section, language):
    return re.findall(rf"```{language}\n(.*?)```", SECTIONS[section], re.S)


def run_python(section):
    scopes = []
    for code in blocks(section, "python"):
        scopes.append({})
        exec(compile(code, "tools.md", "exec"), scopes[-1])
    return scopes


def test_commands_and_mujoco(tmp_path, monkeypatch, capsys):
    pytest.importorskip("mujoco")
    monkeypatch.chdir(tmp_path)
    for line in "".join(blocks("MuJoCo", "sh")).splitlines():
        words = shlex.split(line)
        assert words[0] == "stribeck"
        assert _status(words[1:]) == 0, line
    assert (tmp_path / "friction" / "lugre_dcmotor.xml").exists()
    monkeypatch.setattr("sys.path", [str(tmp_path), *sys.path])
    (scope,) = run_python("MuJoCo")
    assert 1e-6 < scope["data"].qpos[0] < 3e-5  # it sticks still
    assert "wrote" in capsys.readouterr().out


def test_callback_in_c(tmp_path, monkeypatch):
    """Compiled and run in MuJoCo, it agrees with the callback in Python; lines of C that users copy give no warning."""
    mujoco = pytest.importorskip("mujoco")
    compiler = shutil.which("gcc") or shutil.which("clang")
    if compiler is None or not sys.platform.startswith("linux"):
        pytest.skip("no gcc or clang, or not Linux")
    monkeypatch.chdir(tmp_path)
    law = stribeck.law("lugre_majorant", "canudas1995", k_v=1e6)
    for target in ("c", "mujoco"):
        export(law, target, tmp_path, step=4e-3)
    (code,) = blocks("MuJoCo", "c")
    (tmp_path / "callback.c").write_text(code)
    home = Path(mujoco.__file__).parent
    (library,) = home.glob("libmujoco.so.*")
    flags = [
        "-std=c99", "-Wall", "-Wextra", "-Werror", "-O2", "-shared", "-fPIC", f"-I{home / 'include'}", "-o",
        "callback.so",
    ]  # fmt: skip
    command = [compiler, *flags, "callback.c", "lugre_majorant.c", str(library), f"-Wl,-rpath,{home}", "-lm"]
    subprocess.run(command, check=True, cwd=tmp_path)
    in_c = ctypes.CDLL(str(tmp_path / "callback.so"))
    in_python = {}
    exec(compile((tmp_path / "lugre_majorant_mujoco.py").read_text(), "callback", "exec"), in_python)
    travels = []
    try:
        for install in (lambda model: in_c.install(), in_python["install"]):
            in_python["remove"]()
            model = mujoco.MjModel.from_xml_path("lugre_majorant.xml")
            data = mujoco.MjData(model)
            install(model)
            for _ in range(2500):
                data.qfrc_applied[0] = 2 * (0.1 * data.time - data.qpos[0])
                mujoco.mj_step(model, data)
            travels.append(data.qpos[0])
    finally:
        in_python["remove"]()
    assert travels[1] > 0.2
    assert travels[0] == pytest.approx(travels[1], rel=1e-2)
    assert travels[0] != travels[1]  # two ways to look ahead, both of the first order


def test_jax(capsys):
    jax = pytest.importorskip("jax", reason="JAX is not installed (600 MB): pip install jax")
    before = jax.config.jax_enable_x64
    try:
        run_python("JAX")
    finally:
        jax.config.update("jax_enable_x64", before)
    assert "Array" in capsys.readouterr().out


def test_a_missing_package_is_named_with_the_way_to_get_it(monkeypatch):
    law = stribeck.law("lugre_majorant", "canudas1995", k_v=1e6)
    converted = {"jax": to_jax, "torch": to_torch}
    for module, convert in converted.items():
        monkeypatch.setitem(sys.modules, module, None)
        with pytest.raises(MissingExtra, match=rf"needs [a-z]+: pip install {module}"):
            convert(law)

"""Names that a language or a template has already: every export compiles."""

import subprocess

import pytest

import stribeck
from stribeck import Scenario
from stribeck.exports.request import identifier
from tests.exports.harness import need
from tests.machine.machines import law, machine, push

HOSTILE = [
    "row", "m", "t_end", "step", "count", "words", "int", "class", "net", "main", "features", "alloca", "x" * 80, "2nd",
    "double_t", "y0", "fmu", "fmi3", "\u00e9t\u00e9",
]  # fmt: skip


def test_a_machine_compiles(tmp_path):
    need("gcc")
    contacts, files = {"rub": {"from": "a", "law": law()}}, []
    data = machine({"a": {"mass": 1.0}}, 0.1, energy=False, contacts=contacts, loads={"push": push()})
    for i, name in enumerate(HOSTILE):
        files += stribeck.export(Scenario({**data, "name": name}), "c", tmp_path / str(i))
    sources = [file for file in files if file.suffix == ".c"]
    for language in ("c99", "gnu17"):  # the second: all that the C library knows
        subprocess.run(["gcc", f"-std={language}", "-fsyntax-only", "-Werror", *sources], check=True)


def test_names_of_columns_are_names_in_c_and_no_other_ones(tmp_path):
    need("gcc")
    bodies = {name: {"mass": 1.0} for name in ("a", "X_a", "P_a", "2nd")}
    file = stribeck.export(Scenario(machine(bodies, 0.1, energy=False, loads={"push": push()})), "c", tmp_path)[0]
    subprocess.run(["gcc", "-std=c99", "-fsyntax-only", "-Werror", str(file)], check=True)


def written(name, folder):
    """A law of the user's own of this name."""
    text = f"from stribeck.laws.lugre import LuGre\n\n\nclass Own(LuGre):\n    'Own.'\n\n    name = {name!r}\n"
    (folder / "own.py").write_text(text)
    return stribeck.law(f"{folder / 'own.py'}:Own", "canudas1995")


@pytest.mark.parametrize("name", ["net", "step", "force_law", "Given", "y" * 80])
def test_a_law_compiles(name, tmp_path):
    need("gcc", "g++")
    for file in stribeck.export(written(name, tmp_path), "c", tmp_path / "c", self_test=True):
        compiler = ["gcc", "-std=c99"] if file.suffix == ".c" else ["g++", "-x", "c++"]
        subprocess.run([*compiler, "-fsyntax-only", "-Werror", str(file)], check=True)


def test_names_stay_apart_and_are_the_usual_ones():
    assert identifier("lugre_majorant", "law") == "lugre_majorant"
    assert identifier("x_axis2") == "x_axis2"
    long = [identifier("n" * 80 + end) for end in "ab"]
    assert len({*long}) == 2
    assert max(map(len, long)) <= 48


@pytest.mark.share(7)
@pytest.mark.parametrize("name", [*filter(str.isascii, HOSTILE), "model", "fmi3_instance", "F", "v"])
@pytest.mark.parametrize("fmi", [2, 3])
def test_an_fmu_is_built_and_runs(name, fmi, tmp_path):
    """The machine and its body have the name, and its contact nearly."""
    need("gcc")
    fmpy = pytest.importorskip("fmpy", reason="fmpy is not installed")
    loads = {"push": push(on=name)}
    contacts = {f"{name}_": {"from": name, "law": law()}}
    data = machine({name: {"mass": 1.0}}, 0.1, energy=False, contacts=contacts, loads=loads)
    (path,) = stribeck.export(Scenario({**data, "name": name}), "fmu", tmp_path / "made.fmu", fmi=fmi)
    assert fmpy.simulate_fmu(str(path), stop_time=0.01)["time"][-1] == pytest.approx(0.01)


@pytest.mark.share(5)
@pytest.mark.parametrize("target", ["isaaclab", "mjwarp", "mujoco", "newton"])
@pytest.mark.parametrize("name", ["net", "step", "class", "F", "self", "np", "torch", "JointFriction", "y" * 80])
def test_a_law_is_python(name, target, tmp_path):
    out = tmp_path / ("made" if target == "mujoco" else "made.py")
    files = [file for file in stribeck.export(written(name, tmp_path), target, out) if file.suffix == ".py"]
    assert files
    for file in files:
        compile(file.read_text(encoding="utf-8"), str(file), "exec")

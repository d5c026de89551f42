"""What is given twice, of which only the last was taken; bad texts of which only the first was told; and paths that are empty,
which were the current folder."""

import pytest

MACHINE = """
schema = 2
[bodies.a]
mass = 1.0
[contacts.guide]
from = "a"
law = {name = "lugre", parameters = "canudas1995"}
[loads.push]
on = "a"
kind = "signal"
signal = {kind = "sine", amplitude = 1.0, frequency = 1.0}
[controllers.axis]
kind = "pid"
on = "a"
K_p = 10.0
K_i = 0.0
K_d = 5.0
signal = {kind = "sine", amplitude = 0.1, frequency = 1.0}
[solve]
t_end = 0.01
[output]
step = 0.01
"""


@pytest.fixture
def place(tmp_path, monkeypatch, scenario):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "machine.toml").write_text(MACHINE)
    (tmp_path / "logs.toml").write_text("")
    (tmp_path / "log.csv").write_text("t,y,F\n0,0,1\n0.1,0.1,1\n")
    return tmp_path


@pytest.mark.parametrize(
    ("words", "text"),
    [
        ("run rig.toml --set plant.mass=2 --set plant.mass=3", "--set plant.mass"),
        ("check rig.toml --set plant.mass=2 --set plant.mass=2", "--set plant.mass"),
        ("check lugre --parameters canudas1995 --set F_s=2 --set F_s=3", "--set F_s"),
        ("export lugre --parameters canudas1995 --target table --set F_s=2 --set F_s=3 --out o.csv", "--set F_s"),
        ("export machine.toml --target c --set bodies.a.mass=2 --set bodies.a.mass=3 --out o", "--set bodies.a.mass"),
        ("explore rig.toml --set plant.mass=2 --set plant.mass=3", "--set plant.mass"),
        ("sweep rig.toml --vary plant.mass=1:2:2 --vary plant.mass=1:3:2 --out o", "--vary plant.mass"),
        ("design machine.toml --vary bodies.a.mass=1:2 --vary bodies.a.mass=2:3", "--vary bodies.a.mass"),
        ("run rig.toml --law lugre --law dahl:sigma_0=1,sigma_0=2", "--law: 'dahl:sigma_0=1,sigma_0=2': sigma_0"),
        ("fit --plan stroke=1,speed=1,force=9 --simulate --set F_s=2 --set F_s=3 --out o", "--set F_s"),
        ("fit log.csv --law coulomb_viscous --set F_c=1 --set law.parameters.F_c=2", "--set F_c"),
        ("fit log.csv --unit y=mm --unit y=m", "--unit y"),
        ("check machine.toml --force push=1 --force push=2", "--force push"),
        ("run rig.toml --law lugre --law lugre", "--law lugre"),
        ("fit machine.toml --logs logs.toml --law guide=lugre --law guide=dahl", "--law guide"),
    ],
)
def test_one_name_twice_is_refused(stribeck, place, words, text):
    before = sorted(path.name for path in place.iterdir())
    done = stribeck(*words.split())
    assert (done.status, done.out) == (2, "")
    assert done.err == f"{text}: given 2 times; must be given once\n"
    assert sorted(path.name for path in place.iterdir()) == before


@pytest.mark.parametrize(
    ("words", "texts"),
    [
        (["run", "rig.toml", "--set", "a", "--set", "b", "--set", "c.d=1", "--set", "c.d=2"],
         ["--set 'a'", "--set 'b'", "--set c.d: given 2 times"]),
        (["check", "lugre", "--set", "a", "--set", "b"], ["--set 'a'", "--set 'b'"]),
        (["run", "rig.toml", "--law", "lugre:", "--law", "", "--law", "dahl:=1"],
         ["--law: 'lugre:': must be NAME or", "--law: '': must be NAME or", "--law: 'dahl:=1': must be NAME or"]),
        (["run", "rig.toml", "--law", "lugr", "--law", "dah"], ["law.name: 'lugr': no such", "law.name: 'dah': no such"]),
        (["check", "machine.toml", "--force", "a", "--force", "b=-1"], ["--force: 'a'", "--force: 'b=-1'"]),
        (["design", "machine.toml", "--vary", "a", "--vary", "b"], ["--vary: 'a'", "--vary: 'b'"]),
        (["fit", "log.csv", "--unit", "y", "--unit", "=m"], ["--unit: 'y'", "--unit: '=m'"]),
        (["fit", "log.csv", "--law", "coulomb_viscous", "--set", "F_c=true", "--set", "b"], ["--set F_c", "--set 'b'"]),
        (["fit", "--plan", "=5,speed=x"], ["--plan: '=5'", "--plan speed: 'x'"]),
        (["fit", "machine.toml", "--logs", "logs.toml", "--law", "a", "--law", "b"], ["--law: 'a'", "--law: 'b'"]),
        (["fit", "machine.toml", "--logs", "logs.toml", "--unknown", "={low=1}", "--unknown", "b"],
         ["--unknown: '={low=1}'", "--unknown: 'b'"]),
        (["run", "rig.toml", "--set", "a", "--law", ""], ["--set 'a'", "--law: ''"]),
        (["sweep", "rig.toml", "--out", "o", "--vary", "a", "--seed", "3", "--set", "b"],
         ["--set 'b'", "--vary 'a'", "--seed 3"]),
        (["design", "machine.toml", "--vary", "a", "--set", "b"], ["--set 'b'", "--vary: 'a'"]),
        (["check", "lugre", "--v-max", "-1", "--set", "a", "--level", "3", "--force", "q"],
         ["--v-max: -1.0", "--set 'a'", "--level: '3'", "--force: 'q'"]),
        (["fit", "log.csv", "--unknown", "a", "--require", "b", "--unit", "y", "--set", "F_c=true"],
         ["--unknown: 'a'", "--require: 'b'", "--unit: 'y'", "--set F_c"]),
        (["fit", "machine.toml", "--logs", "logs.toml", "--unit", "y", "--set", "a", "--law", "b"],
         ["--unit: 'y'", "--set 'a'", "--law: 'b'"]),
        (["predict", "log.csv", "--machine", "machine.toml", "--unit", "y", "--set", "a"], ["--unit: 'y'", "--set 'a'"]),
    ],
)  # fmt: skip
def test_each_bad_text_of_an_option_has_its_line(stribeck, place, words, texts):
    done = stribeck(*words)
    assert (done.status, done.out) == (2, "")
    assert [line[: len(text)] for line, text in zip(done.err.splitlines(), texts, strict=True)] == texts


@pytest.mark.parametrize(
    "words",
    [
        "run rig.toml --out", "run rig.toml --keep-c", "run rig.toml --law lugre --out", "new rig --out",
        "sweep rig.toml --vary plant.mass=1:2:2 --out", "explore rig.toml --out", "run rig.toml --show --out",
        "export lugre --parameters canudas1995 --target c --out", "design machine.toml --out",
        "check lugre --parameters canudas1995 --certificate", "check lugre --parameters canudas1995 --out",
        "import mujoco machine.toml --out", "fit log.csv --out",
        "library mx106 --out", "fit --plan stroke=1,speed=1,force=1 --out",
    ],
)  # fmt: skip
def test_an_empty_path_is_refused(stribeck, place, words):
    before = sorted(path.name for path in place.iterdir())
    done = stribeck(*words.split(), "")
    assert (done.status, done.out) == (2, "")
    assert done.err == f"stribeck: Invalid value for '{words.split()[-1]}': '': must be a path (stribeck --help)\n"
    assert sorted(path.name for path in place.iterdir()) == before

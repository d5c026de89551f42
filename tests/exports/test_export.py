"""The registry, the command, and what is said before anything is written."""

import json
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

import stribeck
from stribeck import examples
from stribeck.cli import _status
from stribeck.errors import StribeckNote
from stribeck.exports import PARTS, TARGETS
from stribeck.exports.c.sampling import radius, resolution
from stribeck.exports.fmu.archive import described
from stribeck.exports.fmu.description import model_description
from stribeck.exports.request import Request
from tests.exports.harness import law


def command(*words):
    return _status(["export", *words])


BASE = ("lugre_majorant", "--parameters", "canudas1995", "--set", "k_v=1e7")


def test_c_from_the_command(tmp_path, capsys):
    out = tmp_path / "firmware"
    assert command(*BASE, "--target", "c", "--self-test", "--out", str(out), "--json") == 0
    said = json.loads(capsys.readouterr().out)
    assert [Path(file).name for file in said["files"]] == [
        "lugre_majorant.h", "lugre_majorant.c", "lugre_majorant_test.c",
    ]  # fmt: skip
    assert sorted(p.name for p in out.iterdir()) == ["lugre_majorant.c", "lugre_majorant.h", "lugre_majorant_test.c"]
    header = (out / "lugre_majorant.h").read_text()
    for piece in ("sigma_1 = 316.22776601683796 N s/m", "canudas1995", stribeck.__version__, "Source: Stribeck"):
        assert piece in header
    assert all((out / p).read_text().isascii() for p in ("lugre_majorant.h", "lugre_majorant.c"))


def test_parts_of_c(tmp_path):
    stribeck.export(law("lugre"), "c", tmp_path / "body", part="body")
    stribeck.export(law("lugre"), "c", tmp_path / "observer", part="observer")
    body, observer = ((tmp_path / p / "lugre.h").read_text() for p in ("body", "observer"))
    assert ("body_step" in body, "observer_step" in body) == (True, False)
    assert ("body_step(" in observer, "observer_step" in observer) == (False, True)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ((*BASE, "--target", "see"), "'see': no such target"),
        ((*BASE, "--target", "c", "--part", "all"), "must be one of law, body"),
        ((*BASE, "--target", "table", "--part", "body"), "target 'table'"),
        ((*BASE, "--target", "table", "--self-test"), "--self-test"),
        ((*BASE, "--target", "c", "--step", "0"), "--step: 0.0: must be"),
        ((*BASE, "--target", "c", "--step", "nan"), "--step: nan: must be"),
        ((*BASE, "--target", "fmu", "--fmi", "1"), "--fmi: 1: must be 2 or 3"),
        ((*BASE, "--target", "fmu", "--part", "body"), "plant.mass"),
        ((*BASE[:-1], "k_v=-1", "--target", "c"), "k_v: -1: must be"),
        (("lugre_majorant", "--parameters", "canudas1995", "--target", "c"), "k_v: missing"),
        (("stribeck", "--parameters", "canudas1995", "--target", "c", "--part", "observer"), "no internal state"),
        (("lugger", "--target", "c"), "did you mean 'lugre'"),
        ((*BASE, "--target", "c", "--set", "k_w=1"), "no such constant"),
    ],
)
def test_nothing_is_written_on_an_error(words, said, tmp_path, capsys):
    assert command(*words, "--out", str(tmp_path / "x")) == 2
    captured = capsys.readouterr()
    assert said in captured.err
    assert captured.out == ""
    assert not list(tmp_path.iterdir())


def test_out_of_the_wrong_kind(tmp_path, capsys):
    (tmp_path / "file").write_text("kept")
    (tmp_path / "folder").mkdir()
    assert command(*BASE, "--target", "c", "--out", str(tmp_path / "file")) == 2
    assert command(*BASE, "--target", "table", "--out", str(tmp_path / "folder")) == 2
    assert command(*BASE, "--target", "c", "--out", str(tmp_path / "file" / "below")) == 2
    assert (tmp_path / "file").read_text() == "kept"
    assert not list((tmp_path / "folder").iterdir())
    assert len(capsys.readouterr().err.splitlines()) == 3


def test_parameters_of_a_scenario(tmp_path):
    text = (
        'schema = 1\n[law]\nname = "lugre_sobczyk"\nk_v = 1e6\n[law.parameters]\nsigma_0 = 2e5\nsigma_1 = 100.0\n'
        "sigma_2 = 0.4\nF_c = 1.0\nF_s = 1.5\nv_s = 0.001\n[plant]\nmass = 2.0\n"
        '[drive]\nkind = "force"\n[drive.signal]\nkind = "ramp"\nrate = 1.0\n[solve]\nt_end = 1.0\n[output]\nstep = 0.1\n'
    )
    (tmp_path / "rig.toml").write_text(text)
    out = tmp_path / "out"
    words = ("lugre_majorant", "--scenario", str(tmp_path / "rig.toml"), "--target", "c", "--out", str(out))
    assert command(*words) == 0
    header = (out / "lugre_majorant.h").read_text()
    assert "sigma_0 = 200000.0 N/m" in header
    assert "k_v = 1000000.0" in header
    assert "Parameters: scenario rig" in header


def test_a_law_of_the_users_own(tmp_path):
    (tmp_path / "mine.py").write_text(
        "from stribeck.laws.base import BristleLaw\n"
        "from stribeck.laws.terms import g\n"
        "class My_Law(BristleLaw):\n"
        "    '''Ends a comment: */ and (* begins one *).'''\n"
        "    source = 'me \\u00b5 */'\n"
        "    @staticmethod\n"
        "    def dz_dt(p, v, z):\n"
        "        return v - abs(v) / g(p, v) * z\n"
    )
    words = (f"{tmp_path}/mine.py:My_Law", "--parameters", "canudas1995")
    assert command(*words, "--target", "c", "--out", str(tmp_path / "c")) == 0
    text = (tmp_path / "c" / "My_Law.h").read_text()
    assert text.isascii()
    assert text.split("#ifndef")[0].count("*/") == 1
    assert command(*words, "--target", "table", "--out", str(tmp_path / "law.csv")) == 0


def test_the_words_of_a_constant_end_no_comment_and_no_string(tmp_path):
    """They went into the C and the FMU's XML as they stood: the one did not compile, the other was no XML."""
    (tmp_path / "mine.py").write_text(
        "from stribeck.constants import Constant\n"
        "from stribeck.laws import StaticLaw\n"
        "class Mine(StaticLaw):\n"
        "    'Viscous.'\n"
        "    source = 'me ??/'\n"
        "    c = Constant('N \"*) */', 'ends */ *) \\x07 \\u00b5 ??/', at_least=0, example=1.0)\n"
        "    @staticmethod\n"
        "    def friction(p, v, z, dz_dt):\n"
        "        return p.c * v\n"
    )
    mine = stribeck.law(f"{tmp_path / 'mine.py'}:Mine", {}, c=1.0)
    stribeck.export(mine, "c", tmp_path / "c")
    for file in (tmp_path / "c").iterdir():
        text = file.read_text()
        assert text.isascii()
        assert text.count("/*") == text.count("*/")
        assert "??" not in text
    of, _ = described(Request(mine))
    assert "ends" in ElementTree.fromstring(model_description(of)).find(".//*[@name='c']").get("description")


def test_constants_that_no_target_can_have(tmp_path, capsys):
    (tmp_path / "mine.py").write_text(
        "from stribeck.laws.base import StaticLaw\n"
        "from stribeck.constants import Constant\n"
        "class Odd(StaticLaw):\n"
        "    'Viscous.'\n"
        "    dt = Constant('N s/m', 'viscous friction', at_least=0)\n"
        "    double = Constant('N s/m', 'viscous friction', at_least=0)\n"
        "    @staticmethod\n"
        "    def friction(p, v, z, dz_dt):\n"
        "        return (p.dt + p.double) * v\n"
    )
    words = (f"{tmp_path}/mine.py:Odd", "--set", "dt=1.0", "--set", "double=1.0", "--out", str(tmp_path / "out"))
    assert command(*words, "--target", "c") == 2
    said = capsys.readouterr().err.splitlines()
    assert [line.split(":")[0] for line in said] == ["double"]
    assert not (tmp_path / "out").exists()


def test_step_in_time_or_not(tmp_path):
    """With a mass, the note names the step at which sampled friction and body stop being stable together."""
    rig = stribeck.Scenario.load(stribeck_example())
    with pytest.warns(StribeckNote, match="unstable together"):
        stribeck.export(law("lugre"), "c", tmp_path / "slow", scenario=rig, step=4e-3)
    import warnings

    with warnings.catch_warnings():
        warnings.simplefilter("error")
        stribeck.export(law("lugre"), "c", tmp_path / "fast", scenario=rig, step=1e-3)
    with pytest.warns(StribeckNote, match="longer than the bristles' time constant"):
        stribeck.export(law("lugre"), "c", tmp_path / "slow", step=0.1)


@pytest.mark.parametrize(("name", "k_v", "told"), [
    ("elastoplastic_majorant", 1e-30, True), ("elastoplastic_majorant", 1.0, True), ("elastoplastic_majorant", 10.0, False),
    ("elastoplastic_sobczyk", 1e-30, False), ("lugre_majorant", 1e-30, False), ("elastoplastic", None, False),
])  # fmt: skip
def test_bristles_that_creep_at_rest_are_told_of(name, k_v, told):
    """The step of an elasto-plastic law whose |v| is smoothed as far failed its own test, without a word before."""
    chosen = law(name) if k_v is None else law(name, k_v=k_v)
    assert ["take a larger k_v" in text for text in resolution(Request(chosen))] == [True] * told


def stribeck_example():
    from importlib.resources import files

    return files("stribeck.examples").joinpath("stick_slip.toml")


@pytest.mark.parametrize("name", ["lugre", "elastoplastic_majorant"])
def test_the_limit_is_where_the_loop_grows(name):
    """The linearisation against the loop itself: a body at rest, kicked by almost nothing."""
    chosen = law(name)
    for step in (2e-3, 3.2e-3, 4.2e-3, 6e-3):
        v, z = 1e-9, 0.0
        for _ in range(400):
            x = step * float(chosen.jacobian(v, z)[1])
            z += step * (np.expm1(x) / x if x else 1.0) * float(chosen.rate(v, z))
            v -= step * float(chosen.force(v, z))
        assert (abs(v) > 1e-9) == (radius(chosen, 1.0, step) > 1), step


def test_a_crash_leaves_nothing(tmp_path, monkeypatch):
    from pathlib import Path

    def full(self, data):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(OSError, match="No space"):
        stribeck.export(law("lugre"), "c", tmp_path / "out")
    with pytest.raises(OSError, match="No space"):
        stribeck.export(law("lugre"), "table", tmp_path / "law.csv")
    assert not list(tmp_path.iterdir())


def test_the_names_of_the_contract():
    assert list(TARGETS) == ["c", "fmu", "isaaclab", "mjwarp", "mujoco", "mujoco_plugin", "newton", "table"]
    assert list(PARTS) == ["law", "body", "observer", "controller", "compensator", "machine"]
    assert callable(stribeck.export)


def test_the_header_says_plainly_what_is_not_guaranteed(tmp_path):
    files = stribeck.export(stribeck.law("lugre_majorant", "canudas1995", k_v=1e6), "c", tmp_path)
    said = " ".join(line.strip(" *") for line in next(f for f in files if f.suffix == ".h").read_text().splitlines())
    assert "The law is unique, bounded and smooth; it is not passive and not drift-free." in said


@pytest.mark.parametrize("sigma_0", [5e-324, 1e-300, 1e-30, 1e300, 1.7e308])
def test_a_self_test_whose_numbers_c_cannot_hold(tmp_path, sigma_0):
    """It was written with nan in it, or could not pass, or was computed for ever."""
    strange = stribeck.law("lugre", parameters="canudas1995", sigma_0=sigma_0)
    with pytest.raises(stribeck.InputError, match=r"single precision does not hold|not finite"):
        stribeck.export(strange, "c", tmp_path / "c", self_test=True)
    assert not (tmp_path / "c").exists()


@pytest.mark.parametrize("v_s", [5e-324, 1e-300, 1.7e308])
@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_a_table_of_speeds_that_numbers_cannot_hold(tmp_path, v_s):
    """It was written with inf in it, or with an error as large as the force."""
    strange = stribeck.law("lugre", parameters="canudas1995", v_s=v_s)
    with pytest.raises(stribeck.InputError, match="'table'"):
        stribeck.export(strange, "table", tmp_path / "t.csv")
    assert not (tmp_path / "t.csv").exists()


@pytest.mark.parametrize("given", [str, Path, lambda path: dict(stribeck.load(path).data)])
@pytest.mark.parametrize("keyword", [True, False])
def test_a_machine_is_exported_from_its_file_or_its_tables_too(tmp_path, given, keyword):
    """As `simulate`, `check` and `design` take it."""
    path = examples.path("axis_hunts")
    stribeck.export(stribeck.load(path), "c", tmp_path / "loaded")
    law, scenario = (None, given(path)) if keyword else (given(path), None)
    files = stribeck.export(law, "c", tmp_path / "given", scenario=scenario)
    assert [p.name for p in files] == ["axis_hunts.h", "axis_hunts.c", "axis_hunts_run.c"]
    assert all(p.read_bytes() == (tmp_path / "loaded" / p.name).read_bytes() for p in files)


def test_two_scenarios_are_refused_and_so_is_what_is_none(tmp_path):
    path = examples.path("axis_hunts")
    with pytest.raises(stribeck.InputError, match="law: must be left out, or a law: scenario gives a scenario already"):
        stribeck.export(stribeck.load(path), "c", tmp_path / "out", scenario=path)
    with pytest.raises(stribeck.InputError, match="must be a Scenario, the path of its file or its tables, not"):
        stribeck.export(7, "c", tmp_path / "out")
    assert not list(tmp_path.iterdir())

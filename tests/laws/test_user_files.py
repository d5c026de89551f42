"""Files with laws of the user's own: what is executed is what lies there, and names that would be taken for others."""

import os
import pickle
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from stribeck import InputError, export, fit, law
from stribeck.cli import _status
from stribeck.constants import Constant
from stribeck.laws import Relation, StaticLaw, find
from stribeck.scenario import Scenario
from tests.scenario.valid_scenarios import VALID

LAW = """
from stribeck.constants import Constant
from stribeck.laws import StaticLaw

class Mine(StaticLaw):
    "Viscous."
    {name} = Constant("N s/m", "viscous friction", at_least=0)

    @staticmethod
    def friction(p, v, z, dz_dt):
        return 3.0 * p.{name} * v
"""


def written(folder, name="c"):
    path = folder / "mine.py"
    path.write_text(LAW.format(name=name))
    return path


def test_an_edit_that_keeps_size_and_time_is_seen(tmp_path):
    """Python's own byte code is keyed on both: the old law would run."""
    path = written(tmp_path)
    program = "import sys, stribeck; print(float(stribeck.law(sys.argv[1], c=1.0).force(1.0)))"

    def force():
        words = [sys.executable, "-c", program, f"{path}:Mine"]
        return float(subprocess.run(words, capture_output=True, text=True, check=True).stdout)

    before = path.stat()
    assert force() == 3.0
    path.write_text(path.read_text().replace("3.0 *", "5.0 *"))
    os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns))
    assert path.stat().st_size == before.st_size
    assert force() == 5.0
    assert sorted(p.name for p in tmp_path.iterdir()) == ["mine.py"]  # and no __pycache__


def test_an_edit_is_seen_within_a_process(tmp_path):
    path = written(tmp_path)
    assert law(f"{path}:Mine", c=1.0).force(1.0) == 3.0
    path.write_text(path.read_text().replace("3.0 *", "15.0 *"))
    assert law(f"{path}:Mine", c=1.0).force(1.0) == 15.0


def test_threads_load_a_law_once(tmp_path):
    path = written(tmp_path)
    path.write_text("import time\ntime.sleep(0.2)\n" + path.read_text())
    with ThreadPoolExecutor(4) as pool:
        assert len(set(pool.map(lambda _: find(f"{path}:Mine"), range(4)))) == 1


def test_byte_code_that_lies_there_is_not_taken(tmp_path):
    import importlib.util
    import py_compile

    path = written(tmp_path)
    path.write_text(path.read_text().replace("3.0", "7.0"))
    before = path.stat()
    py_compile.compile(str(path), cfile=importlib.util.cache_from_source(str(path)))
    written(tmp_path)
    os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns))
    assert law(f"{path}:Mine", c=1.0).force(1.0) == 3.0


@pytest.mark.parametrize("name", ["K", "error"])
def test_arguments_of_the_exports(name, tmp_path):
    result = law(f"{written(tmp_path, name)}:Mine", **{name: 1.0})
    with pytest.raises(InputError, match=f"^{name}: a constant of this name cannot be exported"):
        export(result, "c", tmp_path / "out")


@pytest.mark.parametrize("name", ["mass", "time"])
def test_variables_of_an_fmu(name, tmp_path):
    result = law(f"{written(tmp_path, name)}:Mine", **{name: 1.0})
    scenario = Scenario(VALID["force_points"])
    with pytest.raises(InputError, match=f"^{name}: the FMU has a variable of this name"):
        export(result, "fmu", tmp_path / "out.fmu", part="body", scenario=scenario)


class Related(StaticLaw):
    """A law whose constants are related, one of them with a default, one optional."""

    low = Constant("", "lower end", default=0.0)
    high = Constant("", "upper end")
    most = Constant("", "largest", optional=True)
    relations = (
        Relation("high", "above low", lambda p: p.high > p.low, ("high", "low")),
        Relation("most", "below 9", lambda p: p.most < 9, ("most",)),
    )

    @staticmethod
    def friction(p, v, z, dz_dt):
        return (p.high - p.low) * v


@pytest.mark.parametrize(
    ("values", "line"),
    [
        ({"high": -1.0}, "high: -1.0: must be above low (low = 0.0)"),
        ({"high": 1.0, "low": 2.0}, "high: 1.0: must be above low (low = 2.0)"),
        ({"high": 1.0, "most": 9.0}, "most: 9.0: must be below 9"),
        ({"high": 1.0, "most": None}, None),
    ],
)
def test_relations_of_constants_that_are_off_or_have_a_default(values, line):
    results = [f"{name}: {text}" for name, text in Related.problems(values)]
    assert results == ([] if line is None else [line])


def test_the_file_of_a_set_as_a_path(tmp_path):
    file = tmp_path / "set.toml"
    file.write_text("[parameters]\nF_c = 1.0\nsigma_2 = 0.5\n")
    assert law("coulomb_viscous", file).values["F_c"] == 1.0


def test_nor_does_it_end_the_process_as_if_all_were_done(tmp_path):
    path = written(tmp_path)
    path.write_text(path.read_text().replace("return 3.0", "raise SystemExit(0)\n        return 3.0"))
    command = [sys.executable, "-m", "stribeck", "check", f"{path}:Mine", "--set", "c=1"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)


def test_a_signal_while_a_file_is_read_is_not_its_fault(tmp_path):
    (tmp_path / "mine.py").write_text("raise KeyboardInterrupt\n")
    with pytest.raises(KeyboardInterrupt):
        find(f"{tmp_path}/mine.py:Mine")


def one_sided(folder, force):
    path = folder / "side.py"
    path.write_text(LAW.format(name="c").replace("3.0 * p.c * v", force).replace(
        "from stribeck.laws", "from stribeck.expressions.ops import exp, log, sqrt, where\nfrom stribeck.laws"))  # fmt: skip
    return f"{path}:Mine"


def record(folder, speeds, force):
    """100 rows a second of a motion at these speeds under a force."""
    y = np.concatenate([[0.0], np.cumsum(0.01 * speeds)])
    rows = (f"{0.01 * i},{x},{F}" for i, (x, F) in enumerate(zip(y, force, strict=False)))
    path = folder / "log.csv"
    path.write_text("t,y,F\n" + "\n".join(rows))
    return path


WAYS = ("--time", "t", "--position", "y", "--force", "F")


@pytest.mark.parametrize(
    "force", ["p.c * sqrt(v)", "p.c * exp(1e5 * v)", "p.c * 1e308 * 10 * v", "where(v > 0.05, float('nan'), p.c * v)"]
)
@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_a_fit_with_a_law_that_has_no_force_at_the_records_speeds(tmp_path, capsys, force):
    v = 0.1 * np.sin(0.05 * np.arange(400))
    path = record(tmp_path, v, np.sign(v))
    assert _status(["fit", str(path), "--law", one_sided(tmp_path, force), *WAYS]) == 2
    out, error = capsys.readouterr()
    assert out == ""
    assert "law 'Mine': gives no force within 1e+30 N in size at the speeds of this record (-0.1 to 0.1)" in error
    assert len(error.splitlines()) == 1


def test_a_fit_with_a_law_for_one_direction_of_a_record_in_that_direction(tmp_path):
    v = 0.02 + 0.015 * np.sin(0.03 * np.arange(600))
    path = record(tmp_path, v, 2.0 * np.sqrt(v))
    fitted = fit(path, one_sided(tmp_path, "p.c * sqrt(v)"), time="t", position="y", force="F")
    assert fitted.estimates["c"].value == pytest.approx(2.0, rel=2e-3)


def test_a_speed_at_which_a_law_has_no_force_is_told(tmp_path, capsys):
    law_ = one_sided(tmp_path, "p.c * log(v)")
    message = "Mine: values: F is not finite at v = -"
    assert _status(["library", law_]) == 0
    assert message in capsys.readouterr().err
    assert _status(["export", law_, "--set", "c=1", "--target", "c", "--out", str(tmp_path / "c")]) == 0
    assert message in capsys.readouterr().err


def test_a_law_of_a_file_in_another_process(tmp_path):
    """joblib, Dask and spawned processes unpickle it by loading the file, which must be the same."""
    path = written(tmp_path)
    pickled = pickle.dumps([law(f"{path}:Mine", c=2.0), find(f"{path}:Mine")])
    program = "import pickle, sys; x = pickle.load(sys.stdin.buffer); print(float(x[0].force(1.0)), type(x[0]) is x[1])"
    words = [sys.executable, "-c", program]
    run = subprocess.run(words, input=pickled, capture_output=True, cwd=tmp_path.parent, check=False)
    assert run.stdout.split() == [b"6.0", b"True"], run.stderr
    path.write_text(path.read_text() + "\nprint('executed')\n")
    run = subprocess.run(words, input=pickled, capture_output=True, check=False)
    assert b"has changed since 'Mine' was pickled" in run.stderr
    assert run.stdout == b""  # seen before anything of it is executed
    assert law("lugre", "canudas1995").same_as(pickle.loads(pickle.dumps(law("lugre", "canudas1995"))))

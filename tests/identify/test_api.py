"""``stribeck.fit`` as Python calls it: what it takes, what it refuses, and the law that comes out."""

import re

import numpy as np
import pandas as pd
import pytest

import stribeck
from stribeck import InputError
from stribeck.identify.log import Log
from stribeck.identify.options import FitOptions

STEP = 1e-3
T = np.arange(4000) * STEP
V = 0.05 * np.sin(2 * np.pi * T) + 0.02 * np.sin(14 * T)
A = np.gradient(V, STEP)
F = 2.0 * A + 5.0 * np.sign(V) + 20.0 * V
COLUMNS = {"time": "t", "velocity": "v", "force": "F"}


def table():
    return {"t": T, "v": 1e3 * V, "F": F}


def log():
    y = np.cumsum(V) * STEP
    return Log(time=T, position=y, velocity=V, acceleration=A, force=F, run=np.zeros(len(T), np.int32), step=STEP)


def test_a_table_in_memory_is_fitted_as_a_file_is(tmp_path):
    pd.DataFrame(table()).to_csv(tmp_path / "log.csv", index=False)
    tables = table(), pd.DataFrame(table()), pd.DataFrame(table()).convert_dtypes()
    of_file, *of_tables = (
        stribeck.fit(data, "coulomb_viscous", units={"v": "mm/s"}, **COLUMNS)["F_c"].value
        for data in (tmp_path / "log.csv", *tables)
    )
    assert of_tables == pytest.approx([of_file] * 3, rel=1e-12)
    assert of_file == pytest.approx(5.0, rel=1e-2)


@pytest.mark.parametrize("law", [None, "coulomb_viscous"])
def test_the_share_that_is_done_rises_while_a_static_fit_runs(law):
    shares = []
    stribeck.fit(table(), law, units={"v": "mm/s"}, progress=shares.append, **COLUMNS)
    assert len(shares) >= 3
    assert shares == sorted(set(shares))
    assert 0.0 < shares[0] < 0.3 < shares[-1] < 1.0


def test_a_column_that_a_table_has_not_is_named_with_its_argument():
    with pytest.raises(InputError, match=r"^velocity: 'w': the table has no such column \(it has t, v, F\)$"):
        stribeck.fit(pd.DataFrame(table()), "coulomb_viscous", **{**COLUMNS, "velocity": "w"})


def test_arguments_of_a_wrong_kind_are_named():
    with pytest.raises(InputError, match="force: 3: must be the name of a column, not a number"):
        stribeck.fit(table(), time="t", velocity="v", force=3)
    rows = np.stack([T, V, F], 1)
    for data in (rows, np.rec.fromarrays([T, V, F], names="t,v,F"), b"log.csv"):
        with pytest.raises(InputError, match=r"^data: .*: must be a file, a table or several of these, not a"):
            stribeck.fit(data, **COLUMNS)
    with pytest.raises(InputError, match=r"^data\[1\]: .*: must be a file, a table or several of these, not a ndarray"):
        stribeck.fit([table(), rows], **COLUMNS)


def test_a_column_that_is_none_is_not_given():
    assert stribeck.fit(table(), law="coulomb_viscous", position=None, **COLUMNS).values["F_c"] > 0


def test_a_keyword_that_is_no_role_is_refused_with_a_log_too():
    with pytest.raises(InputError, match=r"^tiem: 't': unknown argument \(did you mean 'time'\?\)$"):
        stribeck.fit(log(), "coulomb_viscous", tiem="t")
    with pytest.raises(InputError, match=r"^cutoff: 20.0: is for columns of a file; a Log is taken as it is$"):
        stribeck.fit(log(), "coulomb_viscous", cutoff=20.0)


@pytest.mark.parametrize(
    ("law", "options", "said"),
    [
        ("lugre", {"method": "static"}, "'static': law 'lugre' has bristles, which a static fit cannot estimate"),
        ("lugre", {"forms": False}, "forms: belongs to .*method static, not dynamic"),
        ("lugre", {"weight": False, "speeds": (0.1,)}, "weight: belongs to .*speed: belongs to"),
        ("stribeck", {"terms": ("delay",)}, "'delay': belongs to .*method dynamic: a static fit chooses it itself"),
        ("stribeck", {"constants": {"F_q": 1.0}}, r"F_q: law 'stribeck' has no such constant \(did you mean"),
        ("stribeck", {"constants": {"F_c": -1.0}}, "F_c: -1.0: must be"),
        ("stribeck", {"mass": 1.0, "constants": {"mass": 1.0}}, "mass: 1.0: is given with .*constants as well"),
        ("stribeck", {"mass": -1.0}, "mass: -1.0: must be a number from 0"),
        ("lugre_sobczyk", {"free": ("k_v",), "constants": {"k_v": 1e5}}, "k_v: is given with .*constants as well"),
        ("lugre_majorant", {"free": ("smooth_abs",)}, "smooth_abs: is a word, not a number"),
        ("lugre_majorant", {"free": ("k_w",)}, "free: k_w: law 'lugre_majorant' has no such constant"),
        (None, {"method": "dynamic"}, "method: needs .*law: without one, static laws are compared"),
        (None, {"free": ("k_v",)}, "free: needs .*law"),
        (None, {"constants": {"F_q": 1.0}}, "F_q: no law has such a constant"),
    ],
)  # fmt: skip
def test_what_a_law_cannot_be_asked_for(law, options, said):
    asked = FitOptions(**options)
    with pytest.raises(InputError) as caught:
        asked.check(law) if law else asked.check_without_law()
    assert re.search(said, " ".join(caught.value.problems)), caught.value.problems


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"method": "x"}, "method: 'x': must be static, dynamic"),
        ({"output": "speed"}, "output: 'speed': must be force"),
        ({"law": "stribeck", "output": "velocity", "method": "static"}, "output: 'velocity': belongs to method dynamic"),
        ({"output": "velocity"}, "output: .*must be given with one law"),
        ({"law": ["lugre", "lugre_majorant"], "output": "velocity"}, "output: .*must be given with one law"),
        ({"filter": "none"}, "filter: 'none': must be"),
        ({"speeds": (0.1, 0.0)}, r"speed: 0\.0: must be above 0"),
        ({"require": {"F_c": 0.0}}, r"require: F_c: 0\.0: must be a half width above 0"),
        ({"law": ["stribeck", "stribeck"]}, "law: 'stribeck': given twice"),
        ({"law": 3}, "law: 3: must be a law's name or several, not a"),
        ({"law": {"guide": ["stribeck"]}}, "law: .*: laws by contact need logs"),
        ({"law": "stribeck", "logs": "logs.toml"}, "law: 'stribeck': must be laws by contact with logs"),
        ({"law": "stribeck", "unknown": {"F_c": {"low": 1.0, "high": 2.0}}}, "unknown: F_c: is estimated by linear least"),
    ],
)  # fmt: skip
def test_what_a_fit_cannot_be_asked_for(options, said):
    options = {"law": None} | options
    columns = {} if "logs" in options else COLUMNS
    with pytest.raises(InputError) as caught:
        stribeck.fit(table(), **options, **columns)
    assert re.search(f"^{said}", caught.value.problems[0]), caught.value.problems


def test_the_law_of_a_fit_is_the_law_of_its_curve():
    fit = stribeck.fit(log(), "coulomb_viscous", mass=2.0, forms=False)
    law = fit.law()
    assert fit.values["k_v"] == law.values["k_v"] == 1e9  # steeper than the law's own default, as the curve is
    p = fit.friction
    np.testing.assert_allclose(law.steady_force(p.velocity), p.fitted, rtol=1e-4)


def test_given_constants_that_contradict_are_named():
    """By simulation it said that 'no values near the data's are allowed'."""
    t = np.arange(500) * 2e-3
    log = {"t": t, "y": np.sin(t), "F": np.cos(t)}
    with pytest.raises(InputError, match=r"constants.F_s\]?: 3.0: must be at least F_c \(F_c = 6.0\)"):
        stribeck.fit(log, "lugre", time="t", position="y", force="F", constants={"F_c": 6.0, "F_s": 3.0})


def test_files_may_come_one_by_one(tmp_path):
    for i in range(2):
        np.savez(tmp_path / f"{i}.npz", **table())
    several, one_by_one = (
        stribeck.fit(files, "coulomb_viscous", **COLUMNS)
        for files in (sorted(tmp_path.glob("*.npz")), (tmp_path / f"{i}.npz" for i in range(2)))
    )
    assert one_by_one.values == several.values

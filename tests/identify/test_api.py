"""``stribeck.fit`` as Python calls it: what it takes, what it refuses, and the law that comes out."""

import numpy as np
import pandas as pd
import pytest

import stribeck
from stribeck import InputError
from stribeck.identify.log import Log
from stribeck.identify.validate import _changes
from tests.simulation.rig import rig

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
    tables[0]["v"].setflags(write=False)  # as where another program holds the memory
    of_file, *of_tables = (
        stribeck.fit(data, "coulomb_viscous", unit={"v": "mm/s"}, **COLUMNS)["F_c"].value
        for data in (tmp_path / "log.csv", *tables)
    )
    assert of_tables == pytest.approx([of_file] * 3, rel=1e-12)
    assert of_file == pytest.approx(5.0, rel=1e-2)


@pytest.mark.parametrize("law", [None, "coulomb_viscous"])
def test_the_share_that_is_done_rises_while_a_static_fit_runs(law):
    shares = []
    stribeck.fit(table(), law, unit={"v": "mm/s"}, progress=shares.append, **COLUMNS)
    assert len(shares) >= 3
    assert shares == sorted(set(shares))
    assert 0.0 < shares[0] < 0.3 < shares[-1] < 1.0


def test_a_machine_begins_as_the_record_does():
    scenario = stribeck.Scenario(rig("lugre", "force", {"kind": "ramp", "rate": 1.0}, 1.0))
    changes = _changes(scenario, {"command": T, "position": 2 + T, "velocity": 3 + T}, T)
    assert (changes["plant.initial.y"], changes["plant.initial.v"]) == (2.0, 3.0)


def test_a_column_that_is_none_is_not_given():
    assert stribeck.fit(table(), law="coulomb_viscous", position=None, **COLUMNS).values["F_c"] > 0


def test_a_keyword_that_is_no_role_is_refused_with_a_log_too():
    with pytest.raises(InputError, match=r"^tiem: 't': unknown argument \(did you mean 'time'\?\)$"):
        stribeck.fit(log(), "coulomb_viscous", tiem="t")
    with pytest.raises(InputError, match=r"^cutoff: 20.0: is for columns of a file; a Log is taken as it is$"):
        stribeck.fit(log(), "coulomb_viscous", cutoff=20.0)


def test_the_law_of_a_fit_is_the_law_of_its_curve():
    fit = stribeck.fit(log(), "coulomb_viscous", mass=2.0, forms=False)
    law = fit.law()
    assert fit.values["k_v"] == law.values["k_v"] == 1e9  # steeper than the law's own default, as the curve is
    p = fit.friction
    np.testing.assert_allclose(law.steady_force(p.velocity), p.fitted, rtol=1e-4)


def test_files_may_come_one_by_one(tmp_path):
    for i in range(2):
        np.savez(tmp_path / f"{i}.npz", **table())
    several, one_by_one = (
        stribeck.fit(files, "coulomb_viscous", **COLUMNS)
        for files in (sorted(tmp_path.glob("*.npz")), (tmp_path / f"{i}.npz" for i in range(2)))
    )
    assert one_by_one.values == several.values

"""The table of the steady friction."""

import csv

import numpy as np
import pytest

import stribeck
from stribeck.errors import StribeckNote
from tests.exports.harness import law


def test_no_table_of_what_has_no_limit(tmp_path):
    with pytest.raises(stribeck.InputError, match="grows without limit"):
        stribeck.export(law("lugre_arctan"), "table", tmp_path / "law.csv")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["lugre", "lugre_majorant", "elastoplastic", "dahl", "makkar"])
def test_table(name, tmp_path):
    chosen = law(name)
    (file,) = stribeck.export(chosen, "table", tmp_path / "law.csv")
    lines = file.read_text().splitlines()
    head = [line for line in lines if line.startswith("#")]
    rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    v, F = (np.array([float(row[key]) for row in rows]) for key in ("v", "F"))
    assert 2 <= len(v) <= 20
    assert v[0] == 0
    assert (np.diff(v) > 0).all()
    (said,) = [line for line in head if "Greatest error" in line]
    error = float(said.split(": ")[1].split(" N")[0])
    at = (
        np.concatenate(
            [10 ** np.random.default_rng(1).uniform(-12, 0, 20000), np.random.default_rng(2).uniform(0, 1, 20000)]
        )
        * v[-1]
    )
    assert np.max(abs(np.interp(at, v, F) - chosen.steady_force(at))) <= 1.01 * error
    assert error <= 0.02 * np.max(F)
    assert any(f"{key} = {value!r}" in line for line in head for key, value in chosen.values.items() if value)


def test_a_table_says_what_it_loses(tmp_path):
    with pytest.warns(StribeckNote, match="none of the law's dynamics"):
        stribeck.export(law("lugre"), "table", tmp_path / "law.csv", step=1e-3)

"""The table of the steady friction."""

import csv

import numpy as np
import pytest

import stribeck
from stribeck.exports.targets import table
from stribeck.expressions.ops import sign
from stribeck.laws import BristleLaw
from tests.exports.harness import law


class Uphill(BristleLaw):
    """Friction that is a thousandth higher in one direction."""

    symmetric = False

    @staticmethod
    def dz_dt(p, v, z):
        return v - abs(v) * p.sigma_0 / (p.F_c * (1 + 5e-4 * sign(v))) * z


@pytest.mark.parametrize("unit", [1e-6, 1.0, 1e6])
def test_a_law_that_is_not_odd_has_no_table_whatever_the_unit_of_force(unit, tmp_path):
    values = {"sigma_0": 1e5 * unit, "sigma_1": 0.0, "sigma_2": 0.1 * unit, "F_c": unit, "F_s": unit, "v_s": 0.01}
    with pytest.raises(stribeck.InputError, match="must be finite and odd in v"):
        stribeck.export(Uphill(values), "table", tmp_path / "law.csv")


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
    (text,) = [line for line in head if "Greatest error" in line]
    error = float(text.split(": ")[1].split(" N")[0])
    at = (
        np.concatenate(
            [10 ** np.random.default_rng(1).uniform(-12, 0, 20000), np.random.default_rng(2).uniform(0, 1, 20000)]
        )
        * v[-1]
    )
    assert np.max(abs(np.interp(at, v, F) - chosen.steady_force(at))) <= 1.01 * error
    assert error <= 0.02 * np.max(F)
    grid = table._grid(chosen)  # no other table has a smaller one
    assert error < 1e-9 * np.max(F) or len(table._polygon(grid, chosen.steady_force(grid), 0.99 * error)[0]) > 20
    assert any(f"{key} = {value!r}" in line for line in head for key, value in chosen.values.items() if value)

"""Exports for controllers that take no C: Structured Text, parsed and run, and the table."""

import csv

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import stribeck
from tests.export.harness import ELASTOPLASTIC, LINEAR, STATIC, law


@pytest.fixture(scope="module")
def structured_text():
    pytest.importorskip("blark", reason="blark, which parses Structured Text, is not installed")
    from tests.export import structured_text

    return structured_text


@pytest.mark.parametrize("name", ["lugre", "lugre_sobczyk", "lugre_majorant", "elastoplastic", "makkar", "stribeck"])
def test_structured_text_runs(name, structured_text, tmp_path):
    chosen = law(name)
    (file,) = stribeck.export(chosen, "st", tmp_path / "law.st")
    text = file.read_text()
    assert text.isascii()
    blocks = structured_text.parse(text)
    x = structured_text.declared(blocks[name])
    assert {n: x[n] for n in chosen.values if n in x} == {n: v for n, v in chosen.values.items() if v is not None}
    names = [n.lower() for n in x]
    assert len(set(names)) == len(names)  # the language knows no case
    z, rng = 0.0, np.random.default_rng(8)
    for v, dt in zip(
        10 ** rng.uniform(-6, -1, 20) * rng.choice([-1, 1], 20), 10 ** rng.uniform(-5, -2.5, 20), strict=True
    ):
        x["v"], x["dt"] = v, dt
        structured_text.run(name, blocks, x)
        assert x["ok"]
        if name not in STATIC:
            exact = solve_ivp(
                lambda t, z, u=v: [chosen.rate(u, z[0])], (0, dt), [z], method="LSODA", rtol=1e-11, atol=1e-18
            )
            assert x["z"] == pytest.approx(exact.y[0, -1], rel=1e-6, abs=(1e-8 if name in LINEAR else 3e-2) * 1.5e-5)
        assert x["F"] == pytest.approx(chosen.force(v, x["z"]), rel=1e-12, abs=1e-12)
        z = x["z"]
    for v, dt in ((float("nan"), 1e-3), (float("inf"), 1e-3), (1.0, 0.0), (1.0, float("nan"))):
        x["v"], x["dt"] = v, dt
        structured_text.run(name, blocks, x)
        assert (x["ok"], x["z"]) == (False, z)


@pytest.mark.parametrize("name", ELASTOPLASTIC[:2])
def test_structured_text_keeps_z_within_its_bound(name, structured_text, tmp_path):
    blocks = structured_text.parse(stribeck.export(law(name), "st", tmp_path / "law.st")[0].read_text())
    x, rng = structured_text.declared(blocks[name]), np.random.default_rng(9)
    for _ in range(60):
        x["v"], x["dt"] = 10 ** rng.uniform(-5, 2) * rng.choice([-1, 1]), 10 ** rng.uniform(-5, 0)
        structured_text.run(name, blocks, x)
        assert abs(x["z"]) <= 1.5e-5


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
    with pytest.warns(stribeck.StribeckNote, match="none of the law's dynamics"):
        stribeck.export(law("lugre"), "table", tmp_path / "law.csv", step=1e-3)


@pytest.mark.parametrize("name", ["int", "Real", "exp", "While", "a__b", "a_"])
def test_words_of_the_language_are_refused_as_names(tmp_path, name):
    """They were written, and no controller would have read the block."""
    text = (
        "from stribeck.constants import Constant\nfrom stribeck.laws import StaticLaw\n\n\nclass Mine(StaticLaw):\n"
        f'    "Viscous."\n    {name} = Constant("N s/m", "x")\n\n    @staticmethod\n'
        f"    def friction(p, v, z, dz_dt):\n        return p.{name} * v\n"
    )
    (tmp_path / "mine.py").write_text(text)
    with pytest.raises(
        stribeck.InputError, match=f"{name}: a constant of this name cannot be exported to Structured Text"
    ):
        stribeck.export(stribeck.law(f"{tmp_path / 'mine.py'}:Mine", **{name: 2.0}), "st", tmp_path / "mine.st")
    assert not (tmp_path / "mine.st").exists()

"""Parameters that a fit could not determine: written with their best values, marked, and used only where that is allowed."""

import tomllib
from contextlib import contextmanager

import numpy as np
import pytest

import stribeck as package
from stribeck.identify.onebody import simulated
from stribeck.identify.options import FitOptions
from stribeck.parameter_sets import allow_undetermined, load
from tests.identify import rig


@pytest.fixture(scope="module")
def fitted(tmp_path_factory):
    """The folder of a fit to a log without presliding."""
    log = rig.held_at(0.05, 1.0)
    fit = simulated(log, "lugre", FitOptions(mass=0.0, set={"offset": 0.0}, starts=1)).judged()
    folder = tmp_path_factory.mktemp("fit")
    (folder / "parameters.toml").write_text(fit.files(folder, "stribeck fit")["parameters.toml"])
    assert not fit.estimates["sigma_0"].identifiable
    return folder, fit


def test_every_parameter_is_written_and_what_is_open_is_marked(fitted):
    folder, fit = fitted
    table = tomllib.loads((folder / "parameters.toml").read_text())
    assert set(table["parameters"]) >= set(rig.TRUTH)
    for name, estimate in fit.estimates.items():
        row = table["parameters"][name]
        assert row["value"] == pytest.approx(fit.values[name])
        assert row.get("determined", True) is estimate.usable
        assert bool(row.get("experiment")) is (not estimate.usable or estimate.state == "at least")


def test_python_allows_it_too(fitted):
    file = str(fitted[0] / "parameters.toml")
    with pytest.raises(package.InputError, match="allow_undetermined"):
        load(file)
    allow_undetermined()
    try:
        assert load(file).undetermined[:2] == ("sigma_0", "sigma_1")
        assert package.law("lugre", file).p.F_c > 0
    finally:
        allow_undetermined(False)


def test_a_fit_that_ctrl_c_stops_is_written_and_marked(stribeck, fitted, tmp_path, monkeypatch):
    texts = []

    def tell(share):
        texts.append(share)
        if len(texts) == 12:
            raise KeyboardInterrupt

    @contextmanager
    def progress(what):
        yield tell

    monkeypatch.setattr("stribeck.cli.fit.progress", progress)
    log = rig.held_at(0.05, 1.0)
    np.savez(tmp_path / "log.npz", t=log.time, y=log.position, F=log.force)
    columns = ("--time", "t", "--position", "y", "--force", "F", "--mass", 0)
    outcome = stribeck("fit", tmp_path / "log.npz", "--law", "lugre", *columns, "--out", tmp_path / "out")
    assert outcome.status == 130
    table = tomllib.loads((tmp_path / "out" / "parameters.toml").read_text())
    assert table["status"] == "stopped"
    assert all(row["determined"] is False for row in table["parameters"].values())
    assert "Ctrl-C" in outcome.out

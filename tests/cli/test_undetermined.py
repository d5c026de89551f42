"""Parameters that a fit could not determine: written with their best values, marked, and used only where that is allowed."""

import tomllib

import numpy as np
import pytest

import stribeck as package
from stribeck.parameter_sets import allow_undetermined, load
from tests.identify import rig


@pytest.fixture(scope="module")
def fitted(tmp_path_factory):
    """The folder of a fit to a log without presliding."""
    from stribeck.identify.onebody import simulated
    from stribeck.identify.options import FitOptions
    from stribeck.identify.written import toml

    log = rig.held_at(0.05, 1.0)
    fit = simulated(log, "lugre", FitOptions(mass=0.0, constants={"offset": 0.0}, starts=1)).judged()
    folder = tmp_path_factory.mktemp("fit")
    (folder / "parameters.toml").write_text(toml(fit, "stribeck fit"))
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


def commands(folder):
    file = str(folder / "parameters.toml")
    scenario = folder / "rig.toml"
    scenario.write_text(
        'schema = 1\n[law]\nname = "lugre"\nparameters = "parameters.toml"\n[plant]\nmass = 1.0\n'
        '[drive]\nkind = "force"\nsignal = { kind = "ramp", rate = 1.0 }\n[solve]\nt_end = 0.01\n[output]\nstep = 0.001\n'
    )
    return (
        ("run", scenario), ("run", scenario, "--law", "lugre", "--law", "dahl"),
        ("check", "lugre", "--parameters", file),
        ("export", "lugre", "--parameters", file, "--target", "c", "--out", folder / "c"),
    )  # fmt: skip


@pytest.mark.parametrize("which", range(4))
def test_such_a_file_is_refused_unless_allowed(stribeck, fitted, which):
    command = commands(fitted[0])[which]
    refused = stribeck(*command)
    assert refused.status == 2
    assert "do not determine sigma_0" in refused.err
    assert "--allow-undetermined" in refused.err
    assert stribeck(*command, "--allow-undetermined").status == 0
    assert stribeck(*command).status == 2  # it holds for one command


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
    from contextlib import contextmanager

    told = []

    def tell(share):
        told.append(share)
        if len(told) == 12:
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


def test_predict_takes_it_too(stribeck, fitted, tmp_path):
    scenario = commands(fitted[0])[0][1]
    log = tmp_path / "log.csv"
    log.write_text("t,y\n" + "".join(f"{k * 1e-4:.6g},{k * k * 1e-12:.6g}\n" for k in range(101)))
    command = ("predict", log, "--machine", scenario, "--time", "t", "--position", "y")
    assert stribeck(*command).status == 2
    assert stribeck(*command, "--allow-undetermined").status == 0


def test_a_law_that_needs_only_what_is_determined_is_exported(stribeck, fitted, tmp_path):
    """coulomb_viscous takes F_c and sigma_2 from a fit that leaves the bristles open."""
    file = str(fitted[0] / "parameters.toml")
    done = stribeck("export", "coulomb_viscous", "--parameters", file, "--target", "c", "--out", tmp_path / "c")
    assert done.status == 0, done.err
    told = tomllib.loads((fitted[0] / "parameters.toml").read_text())["parameters"]
    assert package.law("coulomb_viscous", parameters=file).values["F_c"] == told["F_c"]["value"]


def test_values_of_your_own_take_the_place_of_what_is_not_determined(stribeck, fitted, tmp_path):
    file = str(fitted[0] / "parameters.toml")
    names = names_of_open_values(fitted[0])
    own = [word for name in names for word in ("--set", f"{name}=100.0")]
    export = ("export", "lugre", "--parameters", file, "--target", "c", "--out", tmp_path / "c")
    assert f"do not determine {names[0]}: give values of your own with --set" in stribeck(*export, *own[2:]).err
    done = stribeck(*export, *own)
    assert done.status == 0, done.err
    assert package.law("lugre", parameters=file, **dict.fromkeys(names, 100.0)).values["sigma_0"] == 100.0
    scenario = commands(fitted[0])[0][1]
    paths = [word for name in names for word in ("--set", f"law.parameters.{name}=100.0")]
    assert stribeck("run", scenario, *paths[2:]).status == 2
    assert stribeck("run", scenario, *paths).status == 0


def names_of_open_values(folder):
    told = tomllib.loads((folder / "parameters.toml").read_text())["parameters"]
    return [name for name, row in told.items() if row.get("determined") is False]

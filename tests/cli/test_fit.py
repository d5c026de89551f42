"""stribeck fit as a user runs it."""

import json
import re
import tomllib

import numpy as np
import pytest

import stribeck as package


def test_what_the_data_do_not_tell_is_marked(stribeck, tmp_path, monkeypatch):
    """Speeds that hardly differ leave the viscous friction open."""
    monkeypatch.setenv("COLUMNS", "120")
    draw, t = np.random.default_rng(0), np.arange(8000) * 1e-3
    v = np.sign(np.sin(3 * t)) * (0.1 + 0.002 * np.sin(11 * t))
    force = 5 * np.sign(v) + 20 * v + 1.5 * draw.standard_normal(len(t))
    path, out = tmp_path / "log.csv", tmp_path / "out"
    np.savetxt(path, np.column_stack([t, v, force]), delimiter=",", header="t,v,F", comments="")
    words = ("--time", "t", "--velocity", "v", "--force", "F", "--law", "coulomb_viscous", "--cutoff", "0")
    found = stribeck("fit", path, *words, "--out", out)
    assert found.status == 0, found.err
    (row,) = (line for line in found.out.splitlines() if line.startswith("  sigma_2 "))
    assert "~" in row
    assert "not identifiable" in row
    written = tomllib.loads((out / "parameters.toml").read_text())
    assert written["parameters"]["sigma_2"]["determined"] is False
    assert "constant speeds" in written["parameters"]["sigma_2"]["experiment"]


def test_counts_of_an_encoder_are_an_angle_everywhere(stribeck, tmp_path):
    """Screen, page and files are in N m, rad/s and kg m^2, and so is a prediction that goes beyond what was seen."""
    draw, t = np.random.default_rng(0), np.arange(8000) * 1e-3
    files = []
    for size, name in ((1.0, "log.csv"), (2.0, "faster.csv")):
        v = size * (20 * np.sin(2 * np.pi * 0.37 * t) + 10 * np.sin(2 * np.pi * 0.91 * t + 1))
        y = np.cumsum(v) * 1e-3
        torque = 1e-3 * np.gradient(v, 1e-3) + 0.05 * np.sign(v) + 1e-3 * v + 0.02 * np.sin(3 * y)
        torque += 1e-3 * draw.standard_normal(len(t))
        files.append(tmp_path / name)
        rows = np.column_stack([t, np.round(y * 2000 / (2 * np.pi)), torque / 0.05])
        np.savetxt(files[-1], rows, delimiter=",", header="t,q,i", comments="")
    columns = ("--time", "t", "--position", "q", "--force", "i", "--force-gain", "0.05", "--unit", "q=counts")
    found = stribeck(
        "fit", files[0], *columns, "--counts", "2000", "--law", "stribeck", "--set", "v_s=1", "--out", tmp_path / "fit"
    )
    assert found.status == 0, found.err
    assert "Further terms of the force" in found.out
    predicted = stribeck("predict", files[1], "--fit", tmp_path / "fit", "--out", tmp_path / "predicted")
    assert "lie beyond the fitted range" in " ".join(predicted.out.split())
    pages = [tmp_path / "fit" / "report.html", tmp_path / "predicted" / "prediction.html"]
    linear = r"(?<![\w^/])(N|kg|m/s|N s/m|N/m)(?![\w/ ]|\^)|[0-9] (N|m|kg|m/s) "
    for text in (
        found.out,
        predicted.out,
        *(re.sub("<script.*?</script>", "", x.read_text(), flags=re.S) for x in pages),
    ):
        shown = " ".join(text.split()).replace("N m", "torque").replace("kg m^2", "inertia")
        assert not re.search(linear, shown)
    assert 'motion = "rotary"' in (tmp_path / "fit" / "parameters.toml").read_text()
    mass = json.loads((tmp_path / "fit" / "fit.json").read_text())["estimates"]["mass"]
    assert mass["range"][0] < 1e-3 < mass["range"][1]


def test_a_fitted_law_is_checked_from_its_file(stribeck, tmp_path):
    from tests.identify import rig

    log = rig.measured([*rig.LOOPS, *rig.STROKES])
    np.savez(tmp_path / "log.npz", t=log.time, y=log.position, F=log.force)
    options = ("--time", "t", "--position", "y", "--force", "F", "--mass", "0", "--starts", "1", "--cutoff", "0")
    words = ("--set", "k_v=1e5", "--set", "smooth_abs=sqrt")
    found = stribeck("fit", tmp_path / "log.npz", "--law", "lugre_majorant", *options, *words, "--out", tmp_path)
    assert found.status == 0, found.err
    law = package.law("lugre_majorant", parameters=str(tmp_path / "parameters.toml"))
    assert law.choices["smooth_abs"] == "sqrt"
    fit = package.Fit.load(tmp_path)
    assert fit.predict(tmp_path / "log.npz").force_error == pytest.approx(fit.relative_force_error, rel=1e-3)
    assert package.check(law)["passive"].holds is False  # sigma_1 (F_s - F_c)/F_c is far above sigma_2

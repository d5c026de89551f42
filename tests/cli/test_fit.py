"""stribeck fit as a user runs it."""

import json
import re
import tomllib

import numpy as np
import pytest

import stribeck as package
from stribeck.identify.said import HEAD
from stribeck.parameter_sets import load
from tests.pages import Page


@pytest.fixture
def log(tmp_path):
    rng = np.random.default_rng(0)
    t = np.arange(6000) * 1e-3
    v = 0.1 * np.sin(2 * np.pi * 0.37 * t) + 0.05 * np.sin(2 * np.pi * 0.91 * t + 1)
    a = np.gradient(v, 1e-3)
    force = 2 * a + 5 * np.tanh(1e4 * v) + 20 * v + 1 + 0.1 * rng.standard_normal(len(t))
    path = tmp_path / "log.csv"
    rows = (f"{x!r},{y!r},{z!r}" for x, y, z in zip(t.tolist(), (1e3 * v).tolist(), force.tolist(), strict=True))
    path.write_text("time,speed,force\n" + "\n".join(rows))
    return path


OPTIONS = ("--time", "time", "--velocity", "speed", "--force", "force", "--unit", "speed=mm/s")


def test_json_is_as_the_contract_has_it(stribeck, log):
    found = stribeck("fit", log, "--law", "coulomb_viscous", *OPTIONS, "--json")
    assert found.status == 0
    data = json.loads(found.out)
    assert data["law"] == "coulomb_viscous"
    for name, truth, unit in (("F_c", 5, "N"), ("sigma_2", 20, "N s/m")):
        e = data["parameters"][name]
        assert e["low"] < e["value"] < e["high"]
        assert e["value"] == pytest.approx(truth, rel=0.02)
        assert (e["unit"], e["identifiable"]) == (unit, True)
    assert 0 < data["relative_force_error"] < 0.05
    assert data["files"] == []


def test_files_are_read_back_and_the_page_stands_alone(stribeck, log, tmp_path, monkeypatch):
    out = tmp_path / "out"
    monkeypatch.setattr(
        "sys.argv", ["stribeck", "fit", "a\x1b[2Jb.csv"]
    )  # the page says the command, and can be copied from
    found = stribeck("fit", log, "--law", "coulomb_viscous", *OPTIONS, "--out", out)
    assert found.status == 0, found.err
    assert "95 % interval" in found.out
    assert "N s/m" in found.out
    written = tomllib.loads((out / "parameters.toml").read_text())
    assert written["law"] == "coulomb_viscous"
    assert len(written["data_sha256"]) == 64
    assert written["parameters"]["F_c"]["state"] == "identified"
    assert written["levels"]["level fast"]["speed"] > written["levels"]["level slow"]["speed"]
    kept = json.loads((out / "fit.json").read_text())["estimates"]["F_c"]
    assert kept.keys() >= {"estimate", "interval", "range", "state"}
    law = package.law("coulomb_viscous", parameters=str(out / "parameters.toml"))
    assert law.values["F_c"] == pytest.approx(5, rel=0.02)
    assert load(str(out / "parameters.toml")).values["F_c"] == law.values["F_c"]
    assert "\x1b" not in (out / "report.html").read_text()
    page = Page(out / "report.html")
    assert page.headings[1] == "2. Model"
    assert page.headings[-2:] == ["5. Measured and fitted", "6. Friction against velocity"]
    shown = page.rows(HEAD)
    assert float(shown["F_c"][0]) == pytest.approx(law.values["F_c"], rel=1e-3)
    units = {"F_c": "N", "sigma_2": "N s/m", "mass": "kg", "offset": "N"}
    assert {name: shown[name][-2] for name in units} == units


def test_the_screen_is_a_headline_a_table_and_at_most_five_notes(stribeck, log, monkeypatch):
    monkeypatch.setenv("COLUMNS", "150")  # on a narrow terminal the names stand above their rows
    found = stribeck("fit", log, *OPTIONS)
    assert found.status == 0, found.err
    lines = found.out.splitlines()
    assert lines[0].startswith("log.csv: ")
    assert "relative residual" in lines[0]
    assert lines[2].split() == ["parameter", "estimate", "95", "%", "interval", "model", "range", "unit", "state"]
    rows = lines[3 : lines.index("", 3)]
    assert [row.split()[0] for row in rows][:2] == ["F_c", "sigma_2"]
    assert all("identif" in row or "model-dependent" in row or "at " in row or row.endswith("given") for row in rows)


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


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ((), "--counts: must be given"),
        (("--counts", "0"), "--counts: 0: must be a whole number above 0"),
        (("--counts", "2000", "--unit", "speed=mm/s"), "no column is in counts"),
    ],
)
def test_counts_a_turn_that_are_missing_or_wrong_are_one_line(stribeck, log, words, said):
    unit = () if "--unit" in words else ("--unit", "speed=counts/s")
    found = stribeck("fit", log, *OPTIONS[:6], *unit, *words)
    assert (found.status, said in found.err) == (2, True), found.err


def test_several_laws_are_compared_and_one_picked(stribeck, log):
    laws = ("--law", "stribeck", "--law", "coulomb_viscous")
    data = json.loads(stribeck("fit", log, *laws, *OPTIONS, "--json").out)
    assert {row["law"] for row in data["candidates"]} == {"stribeck", "coulomb_viscous"}
    assert [row["law"] for row in data["candidates"] if row["chosen"]] == [data["law"]]


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--law", "nothing"), "no such law"),
        (("--law", "coulomb_viscous", "--method", "guess"), "--method: 'guess': must be static"),
        (("--law", "coulomb_viscous", "--set", "sigma_9=1"), "--set: sigma_9"),
        (("--law", "coulomb_viscous", "--mass", "-1"), "--mass: -1"),
        (("--law", "coulomb_viscous", "--unit", "speed"), "--unit: 'speed': must be COL=UNIT"),
        (("--law", "coulomb_viscous", "--term", "magic"), "--term: 'magic': no such term"),
        (("--law", "coulomb_viscous", "--cutoff", "900"), "--cutoff: 900"),
        (("--law", "coulomb_viscous", "--cutoff", "1e-300"), "--cutoff: 1e-300: must be at least"),
        (("--law", "coulomb_viscous", "--mass", "2", "--set", "mass=1"), "--mass: 2.0: is given with --set as well"),
        (("--law", "coulomb_viscous", "--free", "F_c", "--set", "F_c=1"), "--free: F_c: is given with --set as well"),
        (("--law", "lugre", "--method", "static"), "--method: 'static': law 'lugre' has bristles"),
        (("--filter", "other"), "--filter: 'other': must be published"),
    ],
)
def test_bad_usage_is_one_line_and_writes_nothing(stribeck, log, tmp_path, options, said):
    out = tmp_path / "out"
    found = stribeck("fit", log, *OPTIONS, *options, "--json")
    assert found.status == 2
    assert found.out == ""
    assert said in found.err
    assert len(found.err.strip().splitlines()) == 1
    assert not out.exists()


def test_a_log_at_constant_velocity_is_refused(stribeck, tmp_path):
    rng = np.random.default_rng(0)
    t = np.arange(4000) * 1e-3
    path = tmp_path / "log.csv"
    rows = (f"{x!r},{0.1 * x!r},{5 + f!r}" for x, f in zip(t.tolist(), rng.normal(0, 0.05, 4000).tolist(), strict=True))
    path.write_text("t,x,F\n" + "\n".join(rows))
    found = stribeck("fit", path, "--law", "coulomb_viscous", "--time", "t", "--position", "x", "--force", "F")
    assert (found.status, found.out) == (2, "")
    assert found.err.startswith("--velocity: constant (0.1 m/s")


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


def test_a_constant_goes_to_those_laws_that_have_it(stribeck, log):
    laws = ("--law", "stribeck", "--law", "coulomb_viscous", "--method", "static")
    found = stribeck("fit", log, *laws, *OPTIONS, "--set", "v_s=0.01", "--json")
    assert found.status == 0, found.err
    assert json.loads(found.out)["fixed"].get("v_s", 0.01) == 0.01

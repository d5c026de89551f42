"""``stribeck fit --plan``."""

import csv
import io
import json
import re
import tomllib
from pathlib import Path

import numpy as np
import pytest

LIMITS = "stroke=0.05,speed=0.1,force=50"


def rows(text):
    return list(csv.DictReader(io.StringIO(text)))


def test_the_programme_stays_within_the_limits(stribeck):
    for more in ("", ",deflection=1e-5"):
        outcome = stribeck("fit", "--plan", LIMITS + more)
        assert outcome.status == 0
        tests = rows(outcome.out)
        assert {t["kind"] for t in tests} == {"presliding loop", "constant speed", "force ramp", "acceleration"}
        for test in tests:
            if test["control"] == "motion":
                assert float(test["amplitude_m"]) <= 0.05
                assert float(test["speed_m_per_s"]) <= 0.1
            else:
                assert float(test["force_rate_N_per_s"]) * float(test["duration_s"]) <= 50
    loops = [float(t["amplitude_m"]) for t in tests if t["kind"] == "presliding loop"]
    assert min(loops) < 1e-5 < max(loops)


def test_it_leaves_table_motion_and_plot(stribeck, tmp_path):
    outcome = stribeck("fit", "--plan", f"{LIMITS},deflection=1e-5", "--out", tmp_path / "rig", "--json")
    report = json.loads(outcome.out)
    assert {Path(p).name for p in report["files"]} == {"programme.csv", "motion.csv"}
    assert report["synthetic"] is None
    t, y, v = np.loadtxt(tmp_path / "rig" / "motion.csv", delimiter=",", skiprows=1).T
    assert np.ptp(y) <= 0.05
    assert abs(v).max() <= 0.1 * (1 + 1e-9)
    assert np.diff(y) / np.diff(t) == pytest.approx((v[1:] + v[:-1]) / 2, abs=1e-6)
    assert abs(np.diff(v)).max() < 0.1 * 0.04  # no jolts
    assert len(rows((tmp_path / "rig" / "programme.csv").read_text())) == len(report["tests"])


@pytest.mark.thorough  # minutes of simulation: each number is sought from three starts
def test_the_synthetic_log_says_so_and_is_fitted(stribeck, tmp_path):
    out = tmp_path / "rig"
    words = ("--simulate", "--law", "dahl", "--seed", 3, "--out", out)
    made = stribeck("fit", "--plan", f"{LIMITS},deflection=1e-5", *words)
    assert made.status == 0
    truth = tomllib.loads((out / "synthetic_truth.toml").read_text())
    assert "SYNTHETIC" in truth["title"]
    columns = ("--time", "time", "--position", "position", "--force", "force", "--mass", 0)
    fit = stribeck("fit", out / "synthetic_log.csv", "--law", "dahl", *columns, "--starts", 3, "--json")
    assert fit.status == 0, fit.err
    for name, each in json.loads(fit.out)["parameters"].items():
        assert each["value"] == pytest.approx(truth["parameters"][name], rel=0.02), name


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (("stroke=-1,speed=0.1,force=1",), "--plan stroke: -1.0: must be a finite number > 0"),
        (("stroke=1,speed=nan,force=1",), "--plan speed: nan: must be a finite number > 0"),
        (("stroke=1,speed=x,force=1",), "--plan speed: 'x': must be a number"),
        (("stroke=1,speed=1,speed=2,force=1",), "--plan speed: given 2 times; must be given once"),
        (("stroke=1,speed=1",), "--plan force: missing"),
        (("stroke=1,way=1",), "--plan: 'way=1': must be one of stroke, speed, force, deflection"),
        ((f"{LIMITS},deflection=5.02e-3",), "--plan deflection: 0.00502: must be at most a tenth of the stroke (0.05)"),
        ((LIMITS, "--simulate"), "--simulate: needs --out DIR, where the synthetic log goes"),
        ((LIMITS, "--set", "F_c=1"), "--set: goes with --simulate, which is not given"),
        ((LIMITS, "--mass", "1"), "--mass: must be left out with --plan"),
        ((LIMITS, "--simulate", "--law", "dahl", "--law", "lugre", "--out", "NEW"), "--law: given twice"),
        ((LIMITS, "--simulate", "--set", "F_c=x", "--out", "NEW"), "--set F_c: 'x': must be a number"),
        ((LIMITS, "--simulate", "--set", "F_c=99", "--out", "NEW"), "must be at least F_c"),
        ((LIMITS, "--simulate", "--law", "nope", "--out", "NEW"), "'nope': no such law"),
    ],
)
def test_bad_input_is_one_line_and_writes_nothing(stribeck, tmp_path, words, line):
    new = tmp_path / "new"
    outcome = stribeck("fit", "--plan", *(new if word == "NEW" else word for word in words))
    assert outcome.status == 2
    assert outcome.out == ""
    assert line in outcome.err
    assert outcome.err.count("\n") == 1
    assert not new.exists()


@pytest.mark.parametrize("key", ["stroke", "speed", "force"])
@pytest.mark.parametrize("number", ["5e-324", "1e308", "0", "nan"])
def test_limits_that_no_rig_has(stribeck, tmp_path, key, number):
    limits = re.sub(rf"{key}=[^,]*", f"{key}={number}", LIMITS)
    outcome = stribeck("fit", "--plan", limits, "--simulate", "--out", tmp_path / "rig")
    assert (outcome.status, outcome.out) == (2, "")
    assert outcome.err.startswith(f"--plan {key}: ")
    assert not (tmp_path / "rig").exists()


def test_a_law_that_the_synthetic_rig_cannot_show(stribeck, tmp_path):
    words = ("fit", "--plan", LIMITS, "--simulate", "--out", tmp_path / "rig", "--set")
    outcome = stribeck(*words, "sigma_0=1e-3")
    assert outcome.status == 2
    assert "--plan stroke: 0.05: the law's friction breaks away at 1.4e+04 m" in outcome.err
    outcome = stribeck(*words, "v_s=1e-300")
    assert outcome.status == 1
    assert "the synthetic rig failed: after t = " in outcome.err
    assert not (tmp_path / "rig").exists()

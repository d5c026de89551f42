"""``stribeck fit --plan``."""

import csv
import io
import json
import tomllib

import pytest

LIMITS = "stroke=0.05,speed=0.1,force=50"


def rows(text):
    return list(csv.DictReader(io.StringIO(text)))


def test_the_program_stays_within_the_limits(stribeck):
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


@pytest.mark.thorough  # minutes of simulation: each number is sought from three starts
def test_the_synthetic_log_says_so_and_is_fitted(stribeck, tmp_path):
    out = tmp_path / "rig"
    words = ("--simulate", "--law", "dahl", "--seed", 3, "--out", out)
    process = stribeck("fit", "--plan", f"{LIMITS},deflection=1e-5", *words)
    assert process.status == 0
    truth = tomllib.loads((out / "synthetic_truth.toml").read_text())
    assert "SYNTHETIC" in truth["title"]
    fit = stribeck("fit", out / "synthetic_log.csv", "--law", "dahl", "--mass", 0, "--starts", 3, "--json")
    assert fit.status == 0, fit.err
    for name, each in json.loads(fit.out)["parameters"].items():
        assert each["value"] == pytest.approx(truth["parameters"][name], rel=0.02), name

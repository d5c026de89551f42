"""``stribeck fit --plan``."""

import json
import tomllib

import pytest

LIMITS = "stroke=0.05,speed=0.1,force=50"


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

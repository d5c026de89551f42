"""Noise with memory, covariance, intervals."""

import importlib.util
import json
from pathlib import Path

import numpy as np
import pytest
from scipy.signal import lfilter
from scipy.stats import chi2

from stribeck.identify.methods.blockwise import solve_blocks
from stribeck.identify.methods.dynamic import fit_dynamic
from stribeck.identify.models.dynamic_problem import velocity_problem
from stribeck.identify.statistics import correlated, uncertainty
from stribeck.identify.synthetic import LABEL
from tests.identify import rig

BENCHMARKS = Path(__file__).parent.parent.parent.parent / "benchmarks"
N = 2000


def remembering(keep, count, draw):
    """Noise of standard deviation 1 that forgets exponentially."""
    return lfilter([np.sqrt(1 - keep**2)], [1, -keep], draw.standard_normal(count + 500))[500:]


def test_white_noise_has_no_memory():
    draw = np.random.default_rng(0)
    assert sum(len(correlated.noise_memory(draw.standard_normal(N))) for _ in range(20)) <= 1


@pytest.mark.parametrize("keep", [0.5, 0.95])
def test_the_memory_of_noise_is_found(keep):
    memory = correlated.noise_memory(remembering(keep, 20 * N, np.random.default_rng(0)))
    assert len(memory) == 1
    assert memory[0] == pytest.approx(keep, abs=0.02)


@pytest.mark.parametrize("keep", [0.0, 0.95])
def test_the_covariance_is_that_of_repeated_fits(keep):
    draw, x = np.random.default_rng(0), np.linspace(0, 1, N)
    slopes = np.column_stack([np.ones(N), x, np.sin(60 * x)])
    solve = np.linalg.pinv(slopes)
    fits = np.array([solve @ remembering(keep, N, draw) for _ in range(2000)])
    memory = np.array([keep]) if keep else np.zeros(0)
    found = correlated.covariance(slopes, 1.0, memory)
    assert np.sqrt(np.diag(found)) == pytest.approx(np.std(fits, axis=0), rel=0.07)
    assert found[0, 1] == pytest.approx(np.cov(fits.T)[0, 1], rel=0.15)


def test_an_estimate_on_few_samples_is_told_from_one_on_many():
    few, many = np.zeros(N), np.ones(N)
    few[:3] = 1.0
    support = correlated.supporting_samples(np.column_stack([few, many]))
    assert support[0] == pytest.approx(3, rel=0.01)
    assert support[1] == pytest.approx(N, rel=0.01)


def test_a_profile_ends_where_the_likelihood_has_fallen():
    log = rig.measured([*rig.LOOPS, *rig.STROKES[:3]])
    problem, _, _, _ = velocity_problem(log, "lugre", mass=0.0)
    u = solve_blocks(problem, problem.point({**rig.TRUTH, "offset": 0.0, "z_0": 0.0}), 1e-10, 50).point
    misfit = problem.misfit(u)
    fit = fit_dynamic(log, "lugre", mass=0.0, starts=2)
    k = [c.name for c in problem.coordinates].index("sigma_1")
    variance = misfit @ misfit / (len(misfit) - len(u))
    # independent of the search for the end: hold the value found there and fit the others anew
    held, _, _, _ = velocity_problem(log, "lugre", mass=0.0, fixed={"sigma_1": fit.estimates["sigma_1"].high})
    there = solve_blocks(held, held.point({**problem.values(u)}), 1e-12, 100).point
    fall = (np.sum(held.misfit(there) ** 2) - misfit @ misfit) / variance
    assert fall == pytest.approx(chi2.ppf(0.95, 1), rel=0.05)
    assert problem.coordinates[k].outer(u[k]) == pytest.approx(fit.estimates["sigma_1"].value, rel=1e-4)


def test_an_interval_that_is_wide_with_what_no_residual_shows_is_not_known(monkeypatch):
    """It came out as 47000 to 200000, and known: the verdict was that of the narrower one."""
    log = rig.measured([*rig.LOOPS, *rig.STROKES[:3]])
    problem, _, _, _ = velocity_problem(log, "lugre", mass=0.0)
    u = solve_blocks(problem, problem.point({**rig.TRUTH, "offset": 0.0, "z_0": 0.0}), 1e-10, 50).point
    monkeypatch.setattr(uncertainty, "systematic", lambda problem, u, slopes: np.full(len(u), 0.75))
    monkeypatch.setattr(uncertainty, "hangs", lambda c, bias: "")
    found = uncertainty.judge(problem, u, log, profiles=False).estimates["sigma_0"]
    assert found.high / found.low > 4
    assert not found.identifiable
    assert "spans a factor of" in found.why


def test_noise_with_memory_widens_the_intervals():
    white, slow = (
        fit_dynamic(rig.measured([*rig.LOOPS, *rig.STROKES], memory=m), "lugre", mass=0.0, starts=2)
        for m in (0.0, 5e-3)
    )
    wider = [
        (slow.estimates[n].high - slow.estimates[n].low) / (white.estimates[n].high - white.estimates[n].low)
        for n in ("sigma_2", "F_c")
    ]
    assert min(wider) > 2  # samples 1 ms apart that remember 5 ms: some 3.3 times
    assert slow.details["noise"]["memory"] >= 1


def study():
    spec = importlib.util.spec_from_file_location("coverage_study", BENCHMARKS / "interval_coverage.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.thorough
def test_intervals_cover_the_truth_in_twenty_experiments():
    coverage = study()
    cases = [coverage.covered(name, seed) for name in coverage.LAWS for seed in range(7)][:20]
    told = [each for case in cases for each in case.values() if each["identifiable"]]
    assert len(told) > 100
    assert 0.9 <= sum(each["covers"] for each in told) / len(told) <= 0.99


def test_the_committed_study_covers_as_it_should():
    result = json.loads((BENCHMARKS / "results" / "coverage.json").read_text())
    assert result["experiments"] >= 200
    assert set(result["laws"]) == {"lugre", "lugre_sobczyk", "elastoplastic_majorant"}
    for law in result["laws"].values():
        for name, each in law["parameters"].items():
            assert 0.90 <= each["covers"] <= 0.99, name


def test_synthetic_data_say_that_they_are():
    log = rig.held_at(0.05, 0.5)
    assert all(LABEL in source for source in log.sources.values())
    assert LABEL in log.quality[0]


@pytest.mark.parametrize(
    ("cell", "seed"),
    [("force, 0.1 um, 2 kHz", 28), pytest.param("position, 100 Hz", 11, marks=pytest.mark.thorough)],
)
def test_a_curve_that_no_speed_shows_has_no_f_s(monkeypatch, cell, seed):
    """The search ended without a Stribeck curve, and told F_s as F_c: 0.790 [0.789, 0.791] N where 1.25 is true."""
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    import coverage_cells

    found = coverage_cells.one(cell, seed)["parameters"]
    assert not found["F_s"]["known"]
    assert found["F_s"]["covers"]  # no end is told
    assert [name for name, e in found.items() if e["known"] and not e["covers"]] == []
    assert all(found[name]["known"] for name in ("F_c", "sigma_2", "offset"))

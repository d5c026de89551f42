"""Cross-validation and the choice of a law."""

import numpy as np
import pytest

from stribeck.identify.methods.blockwise import solve_blocks
from stribeck.identify.methods.dynamic import cross_validated, fit_dynamic
from stribeck.identify.models.dynamic_problem import velocity_problem
from stribeck.identify.statistics.crossvalidate import groups
from tests.identify import rig


@pytest.fixture(scope="module")
def log():
    return rig.measured([*rig.LOOPS, *rig.STROKES, *rig.STROKES])


def two_runs(log):
    half = len(log) // 2
    return log.with_columns(run=np.repeat(np.array([0, 1], np.int32), [half, len(log) - half]))


def test_parts_are_blocks_runs_or_files(log):
    part, how = groups(log, 10)
    assert np.bincount(part).min() == pytest.approx(len(log) / 10, abs=5)
    assert np.sum(np.diff(part) != 0) == 49
    assert how == "over 50 blocks in time, dealt to 10 parts"
    runs = log.with_columns(run=(np.arange(len(log)) * 12 // len(log)).astype(np.int32))
    part, how = groups(runs, 4)
    assert all(len(set(part[runs.run == r])) == 1 for r in range(12))
    assert how == "over 12 runs in 4 parts"
    files = runs.with_columns(files=tuple("abc"[i % 3] for i in range(12)))
    part, how = groups(files, 4)
    assert how == "over 3 files, one left out at a time"
    assert {files.files[r] for r in runs.run[part == 0]} == {"a"}


def test_an_error_over_parts_left_out_is_the_noise_for_the_true_law(log):
    fit = fit_dynamic(log, "lugre", mass=0.0, starts=2, profiles=False, folds=5)
    assert fit.cross_validated_error == pytest.approx(0.1 / np.sqrt(np.mean(log.force**2)), rel=0.03)
    assert fit.cross_validated_error >= fit.relative_force_error


def test_the_part_left_out_is_not_seen(log):
    """Spoiling the force of a part changes only what the other parts' fits say, never its own prediction."""
    problem, u, _, _ = velocity_problem(two_runs(log), "lugre", mass=0.0)
    u = solve_blocks(problem, problem.point({**rig.TRUTH, "offset": 0.0, "z_0": 0.0, "z_1": 0.0}), 1e-8, 50).point
    part, _ = groups(two_runs(log), 2)
    spoilt = two_runs(log).with_columns(force=np.where(part == 0, log.force + 100.0, log.force))
    other, _, _, _ = velocity_problem(spoilt, "lugre", mass=0.0)
    clean, wrong = (cross_validated(p, u, p.log, 2) for p in (problem, other))
    # fitted to the clean part, the model misses the spoilt one by the 100 N added
    assert np.sqrt(wrong.squares[0] / np.sum(part == 0)) == pytest.approx(100, rel=0.02)
    assert np.sqrt(clean.squares[0] / np.sum(part == 0)) == pytest.approx(0.1, rel=0.1)

"""What the filter of a coarse position does to the bristles' damping is counted in the interval."""

from pathlib import Path

import numpy as np
import pytest

import stribeck
from stribeck.identify.data.prepare import Preparation, load_log
from stribeck.identify.data.read import ColumnNames
from stribeck.identify.features.filtering import filter_bias
from stribeck.identify.models.dynamic_problem import velocity_problem
from stribeck.identify.models.problem import Coordinate
from stribeck.identify.statistics.verdicts import farther
from tests.identify import rig

SLOW = [rig.loop(size, rate, 3) for size in (8e-6, 2e-5, 3e-5) for rate in (0.5, 3.0)]


def written(path, resolution):
    log = rig.measured([*SLOW, *map(rig.stroke, (2e-3, 1e-2, 0.1))], noise=0.02)
    y = resolution * np.round(log.position / resolution)
    np.savez(path, t=log.time, y=y, F=log.force)
    return path


def fitted(path):
    given = {"sigma_2": 30.0}
    return stribeck.fit(path, "lugre", time="t", position="y", force="F", mass=0.0, constants=given, starts=1)


def test_damping_that_hangs_on_the_filter_is_not_printed_as_known(tmp_path):
    fit = fitted(written(tmp_path / "log.npz", 1.6e-8))
    damping = fit.estimates["sigma_1"]
    assert not damping.identifiable
    assert "hangs on the filter" in damping.why
    assert damping.low < 1e3 < damping.high
    optimum = np.sqrt(damping.low * damping.high)
    assert abs(optimum - 1e3) > 5 * np.sqrt(fit.covariance[1, 1])  # the residuals' noise alone would rule the truth out
    assert fit.estimates["sigma_0"].value == pytest.approx(1e6, rel=0.01)


def test_the_ends_reach_farther_than_a_shift_that_one_step_tells_badly():
    """Of 20 s of LuGre with 1 um of noise sigma_1's ends, moved by the shift of 40 % alone, left the truth out."""
    of_bristles, of_offset = Coordinate("sigma_1", "N s/m", 1.0, 1e4), Coordinate("offset", "N", -1.0, 1.0, log=False)
    assert farther(of_bristles, 0.1) == 0.1
    assert farther(of_bristles, 0.4) == 0.8
    assert farther(of_offset, 0.4) == 0.4


def test_motion_taken_as_it_is_has_no_filter_to_doubt():
    problem, u, _, _ = velocity_problem(rig.measured(rig.LOOPS), "lugre", mass=0.0)
    assert not filter_bias(problem, u, problem.sensitivities(u)).any()


def test_a_simulation_follows_what_moves_at_a_tenth_of_the_sampling_rate():
    t, rate = np.arange(400) * 2e-3, 2 * np.pi * 50
    table = {"t": t, "x": np.sin(rate * t), "F": np.cos(rate * t)}
    log = load_log([table], ColumnNames({"time": "t", "position": "x", "force": "F"}), Preparation(0.0, None, True))
    inside = slice(50, -50)
    assert log.velocity[inside] == pytest.approx(rate * np.cos(rate * t[inside]), abs=2e-3 * rate)
    assert log.acceleration[inside] == pytest.approx(-(rate**2) * np.sin(rate * t[inside]), abs=4e-3 * rate**2)


@pytest.mark.thorough
def test_break_aways_of_a_few_samples_bias_no_interval(monkeypatch):
    """At 500 Hz a body breaks away within some ten samples: the Stribeck curve came out too steep and F_c too low."""
    monkeypatch.syspath_prepend(str(Path(__file__).parent.parent.parent.parent / "benchmarks"))
    import coverage_cells

    found = coverage_cells.one("force, 5 nm", 3)["parameters"]
    assert all(found[name]["known"] for name in ("sigma_0", "sigma_2", "F_c", "F_s"))
    assert [name for name, e in found.items() if e["known"] and not e["covers"]] == []


def test_what_the_filter_and_the_samples_round_off_adds_up(monkeypatch):
    """Both take the bristles' damping away: of 30 intervals of sigma_1 like this one 7 ended below the truth."""
    monkeypatch.syspath_prepend(str(Path(__file__).parent.parent.parent.parent / "benchmarks"))
    import coverage_cells

    sigma_1 = coverage_cells.one("force, 5 nm", 20)["parameters"]["sigma_1"]
    assert sigma_1["known"]
    assert sigma_1["low"] < sigma_1["truth"] < sigma_1["high"]

"""A force sine on a body that slips and sticks, positions with an ordinary encoder's noise: fits by simulation."""

import re
from itertools import pairwise

import numpy as np
import pytest

import stribeck
from stribeck.identify.methods.horizons import first_values
from stribeck.identify.models.dynamic_problem import velocity_problem
from stribeck.identify.work import Work

TRUTH = stribeck.library().sets["canudas1995"].values
MASS = 1.1


def recorded(path, noise=1e-6, seconds=6.0, seed=0, drift=0.0):
    """Positions and force at 500 Hz."""
    t = np.arange(0, seconds + 1e-4, 1e-3)
    force = (2.0 + 0.84 * np.sin(2 * np.pi * 0.13 * t)) * np.sin(2 * np.pi * 0.5 * t)
    scenario = stribeck.Scenario(
        law={"name": "lugre", "parameters": TRUTH},
        plant={"mass": MASS},
        drive={"kind": "force", "signal": {"kind": "points", "t": t.tolist(), "value": force.tolist()}},
        solve={"t_end": seconds},
        output={"step": 2e-3},
    )
    found = stribeck.simulate(scenario)
    y = found["y"] + noise * np.random.default_rng(seed).standard_normal(len(found.t))
    y += drift * np.sin(np.pi * found.t / seconds)
    np.savez(path, t=found.t, y=y, F=force[::2])
    return path


@pytest.fixture(scope="module")
def record(tmp_path_factory):
    return recorded(tmp_path_factory.mktemp("log") / "log.npz")


def fitted(path, **options):
    options = {"method": "dynamic", "output": "position", "mass": MASS, **options}
    return stribeck.fit(path, "lugre", time="t", position="y", force="F", **options)


@pytest.mark.share(2)
@pytest.mark.parametrize("starts", [1, 20])
def test_the_truth_is_found_from_any_number_of_starts(record, starts):
    fit = fitted(record, starts=starts)
    for name, truth in TRUTH.items():
        estimate = fit.estimates[name]
        assert estimate.identifiable, (name, estimate.why)
        assert estimate.low < truth < estimate.high, name
        assert estimate.value == pytest.approx(truth, rel=0.03), name
    assert not any("misses" in note for note in fit.notes)
    assert re.search(r"the position is missed by \S+ m rms, its noise is (9\.\d+e-07|1(\.\d+)?e-06) m", fit.notes[0])


def test_a_parameter_that_is_known_closely_is_known(record):
    fit = fitted(record, starts=1)
    coulomb = fit.estimates["F_c"]
    assert coulomb.identifiable
    assert (coulomb.high - coulomb.low) / coulomb.value < 1e-4


def test_a_sensor_that_drifts_is_noticed_and_the_intervals_hold(tmp_path):
    """Half a wave of 3 um over the record: a tenth of the noise in the residual, many times what the intervals are."""
    fit = fitted(recorded(tmp_path / "log.npz", drift=3e-6), starts=1)
    assert "1 windows" not in fit.notes[0]
    for name, truth in {**TRUTH, "offset": 0.0}.items():
        estimate = {**fit.estimates, **fit.body}[name]
        assert estimate.identifiable, (name, estimate.why)
        assert estimate.low < truth < estimate.high, name


def test_a_fit_that_misses_has_no_intervals(tmp_path):
    """A mass three times too large fits nothing."""
    fit = fitted(recorded(tmp_path / "log.npz", seconds=2.0), mass=3 * MASS, starts=1)
    for name, estimate in {**fit.estimates, **fit.body}.items():
        assert not estimate.identifiable, name
        assert (estimate.low, estimate.high) == (None, None), name
        assert "times what noise explains" in estimate.why
        assert np.isfinite(estimate.value)


def test_a_start_is_the_same_however_many_there_are(record):
    from stribeck.identify.api import log_of
    from stribeck.identify.data.prepare import Preparation
    from stribeck.identify.data.read import ColumnNames

    columns = ColumnNames({"time": "t", "position": "y", "force": "F"})
    log = log_of(record, columns, Preparation(simulated=True))
    problem, *_ = velocity_problem(log, "lugre", mass=MASS)
    many = first_values(problem, 20, 3)
    for count in (1, 2, 4, 8, 13):
        assert first_values(problem, count, 3) == many[:count]


@pytest.mark.thorough
def test_more_starts_are_never_worse(record):
    """The hard way: the force for the noisy motion, in which no start reaches the noise."""
    errors = [fitted(record, output="force", starts=n).relative_force_error for n in (1, 3)]
    assert all(later <= earlier * (1 + 1e-6) for earlier, later in pairwise(errors))


@pytest.mark.thorough
def test_progress_rises_to_the_end(record):
    shares = []
    fitted(record, starts=2, progress=shares.append)
    assert len(shares) > 20
    assert all(b >= a for a, b in pairwise(shares))
    assert shares[-1] == pytest.approx(1.0)


@pytest.mark.parametrize("output", ["position", "force"])
def test_ctrl_c_leaves_what_was_found(record, output):
    told = []

    def tell(share):
        told.append(share)
        if len(told) == 15:
            raise KeyboardInterrupt

    fit = fitted(record, output=output, starts=4, progress=tell)
    assert fit.status == "stopped"
    assert any("Ctrl-C" in note for note in fit.notes)
    for estimate in fit.estimates.values():
        assert not estimate.identifiable
        assert np.isfinite(estimate.value)


def test_ctrl_c_before_anything_is_found_is_ctrl_c(record):
    def tell(share):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        fitted(record, progress=tell)


def test_parts_of_the_work_follow_each_other():
    shares = []
    work = Work(shares.append)
    for number in range(2):
        part = work.part(number, 2)
        part.section(0.5)
        part.done(1.0)
        part.section(1.0)
        part.done(1.0)
    assert shares == sorted(shares)
    assert shares[-1] == 1.0

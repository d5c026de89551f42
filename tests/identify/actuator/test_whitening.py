"""Residuals that repeat themselves from sample to sample are fitted by what their past does not predict."""

import numpy as np
import pytest
from scipy.signal import lfilter

from stribeck.identify.actuator import residuals
from stribeck.identify.actuator.coordinates import MachineCoordinate
from stribeck.identify.actuator.guided import GuidedSearch, steps_apart
from stribeck.identify.actuator.recordings import Channel, Recording
from stribeck.identify.actuator.starts import problem_of
from stribeck.identify.actuator.whitening import prediction_filter
from stribeck.identify.log import Log
from stribeck.identify.onebody import simulated
from stribeck.identify.options import FitOptions
from stribeck.scenario import Scenario
from tests.identify.actuator.recorded import body
from tests.reference.apart import solve

F_C = "contacts.guide.law.parameters.F_c"
STEP = 2e-3
KNOWN = {"k_v": 1e4, "sigma_0": 2e4, "sigma_1": 60.0, "v_s": 0.02, "F_s": 1.3, "sigma_2": 4.0}


def correlation_of_neighbors(x):
    return float(x[1:] @ x[:-1] / (x @ x))


def test_the_filter_takes_out_what_the_past_predicts():
    noise = 3.0 * np.random.default_rng(0).standard_normal(20_000)
    drift = lfilter([1.0], [1.0, -1.97, 0.9702], noise)
    coefficients = prediction_filter([drift[:9000], drift[9000:]])
    white = lfilter(coefficients, [1.0], drift)[100:]
    assert coefficients * 3.0 == pytest.approx([1.0, -1.97, 0.9702], abs=0.02)
    assert abs(correlation_of_neighbors(white)) < 0.03 < 0.9 < correlation_of_neighbors(drift)
    assert np.std(white) == pytest.approx(1.0, rel=0.02)


@pytest.mark.parametrize(
    "parts", [[np.random.default_rng(1).normal(size=5000)], [np.zeros(500)], [np.arange(40.0)], []]
)
def test_what_is_white_nothing_or_short_is_left_as_it_is(parts):
    assert prediction_filter(parts).tolist() == [1.0]


@pytest.fixture(scope="module")
def pushed():
    """A body of 1 kg whose position is measured, and whose driving force is recorded with noise."""
    data = body(amplitude=5.0, t_end=8.0, step=STEP)
    t, push = 8.0 * np.arange(4001) / 4000, np.array(data["loads"]["push"]["signal"]["value"])
    noise = np.random.default_rng(5).standard_normal((2, len(t)))
    solution = solve(data, rtol=1e-9)
    return Log(
        time=t, position=solution["a.y"] + 1e-6 * noise[0], velocity=solution["a.v"],
        acceleration=np.gradient(solution["a.v"], STEP), force=push + 0.15 * noise[1], run=np.zeros(len(t), np.int32),
        step=STEP,
    )  # fmt: skip


def test_a_noisy_drive_costs_little_accuracy(pushed, monkeypatch):
    """The position integrates the noise of the force. Its prediction errors are as small as this noise."""
    asked = FitOptions(method="dynamic", output="position", starts=1, set=KNOWN)
    fit = simulated(pushed, "lugre_majorant", asked).judged()
    monkeypatch.setattr(residuals, "prediction_filter", lambda _: np.ones(1))
    plain = simulated(pushed, "lugre_majorant", asked).judged()
    for name, truth in {"F_c": 1.0, "mass": 1.0}.items():
        low, high = fit.estimates[name].interval
        assert low <= truth <= high
        assert high - low < 0.05 * truth
        assert high - low < 0.5 * np.ptp(plain.estimates[name].interval)


@pytest.mark.thorough
def test_a_second_estimate_enters_the_interval_where_the_residual_is_colored(pushed, monkeypatch):
    asked = FitOptions(method="dynamic", output="position", starts=1, set=KNOWN)
    second = simulated(pushed, "lugre_majorant", asked).best.under_guide
    assert second.keys() == {"F_c", "mass", "offset"}
    assert np.exp(second["F_c"][0]) == pytest.approx(1.0, rel=0.03)
    assert 0 < second["F_c"][1] < 0.03
    monkeypatch.setattr(GuidedSearch, "under_guide", lambda *_: {"F_c": (np.log(1.5), 0.01)})
    assert simulated(pushed, "lugre_majorant", asked).judged().estimates["F_c"].interval[1] > 1.4


def at(F_c):
    """The problem of a recording whose F_c is 1 N, at another value."""
    data = body(amplitude=5.0, t_end=4.0, F_s=4.5)
    t, x = 0.01 * np.arange(401), solve(data, rtol=1e-9)["a.y"]
    level = MachineCoordinate(F_C, 0.5, 4.5, F_c, targets={F_C: 1.0})
    recording = Recording("run", t, {"a.y": Channel("y", t, x)})
    problem = problem_of(Scenario(data), [(0, recording)], [level], {"a.y": 1e-3})
    return problem, problem.point({F_C: F_c})


def test_a_large_residual_is_no_noise():
    for F_c, colored in ((1.02, True), (4.0, False)):
        problem, u = at(F_c)
        residuals.weigh(problem, u)
        assert problem.colored is colored
    assert problem.residuals(u[None]) == pytest.approx(problem.plain(u[None]))


def test_the_first_samples_which_have_no_past_stay_as_they_are():
    problem, u = at(1.02)
    residuals.weigh(problem, u)
    plain, white = problem.plain(u[None])[0], problem.residuals(u[None])[0]
    past = len(problem.whitening["a.y"]) - 1
    assert white[:past] == pytest.approx(plain[:past])
    assert np.std(white[past:]) == pytest.approx(1.0, rel=0.1)
    assert abs(correlation_of_neighbors(white[past:])) < 0.2 < correlation_of_neighbors(plain)
    assert problem.without_whitening().residuals(u[None])[0] == pytest.approx(plain)
    assert problem.deviations()["a.y"] < 0.2 * problem.noise["a.y"]


@pytest.mark.parametrize(("there", "beyond"), [(0.02, 0.0), (0.5, 0.5 - 1.96 * 0.05), (-0.5, -0.5 + 1.96 * 0.05)])
def test_another_estimate_counts_by_what_its_own_deviation_leaves(there, beyond):
    problem, u = at(1.0)
    assert steps_apart(problem, u, {F_C: (u[0] + there, 0.05)})[0] == pytest.approx(beyond, rel=1e-4)
    assert not steps_apart(problem, u, {}).any()

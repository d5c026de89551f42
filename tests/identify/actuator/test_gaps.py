"""Inputs with missing samples: crossed as the samples around tell, and no interval where they do not."""

import numpy as np
import pytest

from stribeck.errors import InputError
from stribeck.identify.actuator import fit_machine
from stribeck.identify.actuator.bridges import bridged
from tests.identify.actuator.recorded import body, logs, record

F_C, MASS = "contacts.guide.law.parameters.F_c", "bodies.a.mass"
WANTED = {F_C: {"low": 0.1, "high": 10.0}, MASS: {"low": 0.2, "high": 5.0}}


def without(begin, end):
    return lambda table: {name: np.delete(x, slice(begin, end)) for name, x in table.items()}


def off(found):
    """The rms of the possible error in the gaps, of a signal of about 1."""
    there = found.others[0] != found.x
    return np.sqrt(np.mean((found.others - found.x)[:, there] ** 2))


def test_a_gap_is_crossed_as_the_samples_around_tell():
    t = np.linspace(0.0, 2.0, 401)
    x = np.sin(20 * t)
    some = np.r_[0:100, 108:401]
    result = bridged(t[some], x[some])
    straight = abs(np.interp(t, t[some], x[some]) - x).max()
    assert abs(np.interp(t, result.t, result.x) - x).max() < 0.05 * straight
    assert 0 < off(result) < 0.1  # and it is known how well
    rng = np.random.default_rng(0)
    noise = 3 * rng.standard_normal(401)
    assert off(bridged(t[some], noise[some])) == pytest.approx(3, rel=0.3)
    few = np.r_[0, 1, 18, 19]
    assert off(bridged(t[few], noise[few])) == pytest.approx(np.std(noise[few]))  # nothing around tells more
    assert len(bridged(np.delete(t, 150), np.delete(x, 150)).t) == 401
    whole = bridged(t, x)
    assert (len(whole.t), len(whole.others)) == (401, 0)


@pytest.mark.share(3)
@pytest.mark.parametrize(("end", "sure"), [(122, True), (180, False)])
def test_missing_samples_cost_no_truth(tmp_path, end, sure):
    """One of two recordings is 2 or 60 samples short; across 60 nobody knows what drove it."""
    record(tmp_path / "a.csv", body(amplitude=5.0, step=0.0025))
    record(tmp_path / "b.csv", body(amplitude=4.0, step=0.0025), seed=1, change=without(120, end))
    fitted = fit_machine(body(), logs(tmp_path, ["a.csv", "b.csv"], WANTED), starts=1, baselines=False)
    for name in (F_C, MASS):
        e = fitted.estimates[name]
        low, high = e.interval if sure else e.range
        assert low < 1.0 < high
        assert sure == (high < 1.05 * low)


@pytest.mark.parametrize("between", [1, 2, 4])
def test_gaps_near_each_other_are_known_to_be_crossed_worse(between):
    """Few samples stand between them, and these tell the slope: the error is that of such a place, not of one gap alone."""
    t = np.linspace(0.0, 2.0, 401)
    for phase in np.linspace(0.0, 3.0, 5):
        x = np.sin(9 * t + phase) + 0.5 * np.sin(5 * t)
        some = np.r_[0:200, 209 : 209 + between, 216 + between : 401]
        result = bridged(t[some], x[some])
        gap = (result.t > t[199] + 1e-9) & (result.t < t[209] - 1e-9)
        wrong = np.sqrt(np.mean((result.x - np.interp(result.t, t, x))[gap] ** 2))
        reported = np.sqrt(np.mean((result.others[0] - result.x)[gap] ** 2))
        assert wrong < 3 * reported
        assert reported < 0.03  # of a signal of 1


def test_samples_at_random_times_lack_none():
    """Many of their intervals are long, but no even grid holds them."""
    t = np.sort(np.random.default_rng(0).uniform(0.0, 2.0, 400))
    x = np.sin(20 * t)
    result = bridged(t, x)
    np.testing.assert_array_equal(result.t, t)
    np.testing.assert_array_equal(result.x, x)
    assert not len(result.others)


def jumped(table):
    return table | {"t": np.where(table["t"] > 0.5, table["t"] + 1e9, table["t"])}


def still(table):
    return table | {"y": 0 * table["y"]}


@pytest.mark.parametrize(
    ("change", "text"),
    [
        (jumped, "log.0.time: 't': jumps from 0.5 s to 1e+09 s, longer than all the rest: must be two recordings"),
        (still, "log.0.outputs.a.y: 'y': never changes: some measured column must"),
    ],
)
def test_a_recording_that_shows_no_motion_is_refused(tmp_path, change, text):
    record(tmp_path / "a.csv", body(amplitude=5.0, step=0.0025), change=change)
    with pytest.raises(InputError) as caught:
        fit_machine(body(), logs(tmp_path, ["a.csv"], WANTED), starts=1)
    assert caught.value.problems[0].endswith(text)


def test_four_samples_of_a_sensor_are_used(tmp_path):
    """A cubic passes through them; a smoothing spline needs more."""
    record(tmp_path / "a.csv", body(amplitude=5.0, step=0.0025))
    few = {"y": lambda x: np.where(np.arange(len(x)) % (len(x) // 4) == 9, x, np.nan)}
    record(
        tmp_path / "b.csv", body(amplitude=4.0, step=0.0025), change=lambda t: t | {n: f(t[n]) for n, f in few.items()}
    )
    fitted = fit_machine(body(), logs(tmp_path, ["a.csv", "b.csv"], WANTED), starts=1, baselines=False)
    for name in (F_C, MASS):
        low, high = fitted.estimates[name].range
        assert low < 1.0 < high < 1.05 * low

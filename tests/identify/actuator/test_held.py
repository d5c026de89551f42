"""Inputs that a sampled controller holds from sample to sample, and those that run straight."""

import numpy as np
import pytest

from stribeck.identify.actuator import fit_machine
from tests.identify.actuator.recorded import NOISE, body, logs, record

F_C, MASS = "contacts.guide.law.parameters.F_c", "bodies.a.mass"
WANTED = {F_C: {"low": 0.1, "high": 10.0}, MASS: {"low": 0.2, "high": 5.0}}
HELD = {"loads.push.signal": {"column": "u", "held": True}}


def recorded(path, noise):
    """A body whose push is held for 10 ms."""
    data = body(amplitude=5.0)
    push = data["loads"]["push"]["signal"]
    push |= {"t": np.repeat(push["t"], 2)[1:].tolist(), "value": np.repeat(push["value"], 2)[:-1].tolist()}
    record(path, data, noise=noise, change=lambda x: {**x, "u": x["u"][::2]})


@pytest.mark.share(2)
@pytest.mark.parametrize("noise", [2e-5, 3e-4])
def test_a_held_input_is_followed_as_held_and_told_where_it_is_not_said(tmp_path, noise):
    recorded(tmp_path / "run.csv", noise)
    path = logs(tmp_path, [{"file": "run.csv", "inputs": HELD}], WANTED)
    result = fit_machine(body(mass=1.2), path, starts=1, baselines=False)
    for name in (F_C, MASS):
        assert result.estimates[name].low < 1.0 < result.estimates[name].high
    assert not any("between samples (held" in n for n in result.notes), result.notes
    fitted = fit_machine(body(mass=1.2), logs(tmp_path, ["run.csv"], WANTED), starts=1, baselines=False)
    assert any("inputs held between samples (held = true)" in n for n in fitted.notes), fitted.notes
    for name in (F_C, MASS):
        low, high = fitted.estimates[name].range
        assert low < 1.0 < high


@pytest.mark.thorough
def test_the_last_samples_of_an_uneven_recording_are_compared_at_their_own_times(tmp_path):
    """The simulation ended up to half a sample before them: recordings whose times jitter left more than noise."""
    rows = np.cumsum(np.random.default_rng(5).choice([6, 7, 7, 9], 140))
    rows = rows[rows <= 990]
    uneven = lambda x: {n: column[rows] for n, column in x.items()}  # noqa: E731
    record(tmp_path / "run.csv", body(amplitude=5.0, step=0.001), change=uneven)
    fitted = fit_machine(body(), logs(tmp_path, ["run.csv"], WANTED), starts=1, baselines=False)
    (trace,) = fitted.logs[0].traces
    assert trace.rms < 1.2 * NOISE
    p = fitted.estimates[MASS]
    assert p.low < 1.0 < p.high

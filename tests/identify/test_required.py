"""What a user requires decides what is identified, and the notes say what is missing."""

from dataclasses import replace

import numpy as np
import pytest

import stribeck
from stribeck.identify.core.states import EstimateState
from stribeck.identify.required import half_width, with_requirements
from tests.identify.actuator.recorded import body, logs, record

LAW = stribeck.law("stribeck_tanh", k_v=1e4, F_c=1.0, F_s=1.4, v_s=0.01, sigma_2=2.0)


@pytest.fixture(scope="module")
def columns():
    t = 0.008 * np.arange(2500)
    y = 0.05 * np.sin(0.7 * t) + 0.01 * np.sin(2.3 * t)
    v, a = np.gradient(y, t), np.gradient(np.gradient(y, t), t)
    noise = 0.05 * np.random.default_rng(5).standard_normal(len(t))
    return {"t": t, "y": y, "F": 1.5 * a + np.asarray(LAW.steady_force(v)) + noise}


@pytest.fixture(scope="module")
def usual(columns):
    return fitted(columns)


def fitted(columns, **more):
    return stribeck.fit(columns, "stribeck_tanh", time="t", position="y", force="F", **more)


def test_a_number_is_identified_as_far_as_it_is_required(usual):
    assert usual["F_c"].state == "identified"
    own, wide = (half_width(x, usual["F_c"].value) for x in (usual["F_c"].interval, usual["F_c"].range))
    assert own < wide
    between = with_requirements(usual, {"F_c": (own + wide) / 2})
    assert between["F_c"].state == "model-dependent"
    assert between.notes[0].startswith("F_c is known within")
    assert with_requirements(usual, {"F_c": 1.01 * wide})["F_c"].state == "identified"
    assert 1.01 * wide < 0.5


def test_a_bound_stays_a_bound(usual):
    bound = replace(usual["F_s"], interval=(1.3, np.inf), state=EstimateState.AT_LEAST)
    asked = replace(usual, estimates={**usual.estimates, "F_s": bound})
    assert with_requirements(asked, {"F_s": 0.1})["F_s"].state == "at least"


def test_what_to_measure_stands_with_what_is_missing(columns, usual):
    result = fitted(columns, require={"F_c": 1e-4})
    e = result["F_c"]
    assert e.state == "not identifiable"
    assert "constant speeds" in e.experiment
    assert e.experiment in result.notes[0]
    page = next(chapter for chapter in result.document().chapters if chapter.key == "result")
    for name, each in result.parameters.items():  # in the table of a page alone
        assert not each.advice(name) or each.advice(name) not in page.text
        assert not each.advice(name) or [name, each.why, each.experiment] in page.tables[-1].rows
    assert any(each.advice(name) for name, each in result.parameters.items())
    assert (e.value, e.interval, e.range) == tuple(getattr(usual["F_c"], n) for n in ("value", "interval", "range"))


def test_a_machine_is_judged_by_the_end_of_a_path(tmp_path):
    record(tmp_path / "run.csv", body(amplitude=5.0))
    path = logs(tmp_path, ["run.csv"], {"bodies.a.mass": {"low": 0.2, "high": 5.0}})
    result = stribeck.fit(body(), logs=path, require={"mass": 1e-9})
    assert result["mass"].state == "not identifiable"
    assert result.notes[0].startswith("bodies.a.mass is known within")

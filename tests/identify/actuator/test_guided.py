"""A guide keeps the simulation at the measured motion, however wrong the friction is."""

import numpy as np
import pytest

from stribeck import Scenario
from stribeck.identify.actuator import Logs, fit_machine
from stribeck.identify.actuator.coordinates import MachineCoordinate
from stribeck.identify.actuator.guided import GuidedSearch, Reached
from stribeck.identify.actuator.guides import Guides
from stribeck.identify.actuator.recordings import Channel, Recording, Sought
from stribeck.identify.actuator.residuals import leftovers
from stribeck.identify.actuator.solve import Found, half_squares
from stribeck.identify.actuator.starts import problem_of
from stribeck.identify.work import Work
from tests.identify.actuator.recorded import NOISE, body
from tests.reference.apart import solve

WAVE = {"kind": "sine", "amplitude": 0.1, "frequency": 1.0}
F_C, F_S, MASS = "contacts.guide.law.parameters.F_c", "contacts.guide.law.parameters.F_s", "bodies.a.mass"


@pytest.fixture(scope="module")
def recording():
    data = body(amplitude=5.0, t_end=4.0)
    t, x = 0.01 * np.arange(401), solve(data, rtol=1e-9)["a.y"]
    noisy = x + NOISE * np.random.default_rng(0).standard_normal(len(x))
    return Recording("run", t, {"a.y": Channel("y", t, noisy)})


def left(scenario, recordings):
    """The residual of the measured position, of its changes."""
    problem = problem_of(scenario, recordings, [], {"a.y": NOISE})
    rms, size = leftovers(problem, problem.start())["a.y"]
    return rms / size


def test_a_stiffer_guide_follows_closer(recording):
    wrong = Scenario(body(amplitude=5.0, t_end=4.0, F_c=3.0, F_s=3.5))
    guides = Guides(wrong, [(0, recording)])
    assert left(wrong, [(0, recording)]) > 0.3
    guided = [guides.at(bandwidth) for bandwidth in guides.bandwidths[1:]]
    errors = [left(each.scenario, each.recordings) for each in guided]
    assert errors == sorted(errors, reverse=True)
    assert errors[-1] < 0.02


@pytest.mark.parametrize("taken", ["guide_", "guide_spring_a", "guide_pull_a"])
def test_guides_replace_no_element_of_the_machine(recording, taken):
    data = body(t_end=4.0)
    spring = data["links"] = {taken: {"from": "a", "to": "ground", "stiffness": 3.0}}
    data["loads"] |= {f"{taken}2": {"on": "a", "kind": "signal", "signal": WAVE}}
    guided = Guides(Scenario(data), [(0, recording)]).at(1.0)
    tables = guided.scenario.data
    assert tables["links"][taken] == spring[taken]
    assert tables["loads"][f"{taken}2"]["signal"] == WAVE
    assert (len(tables["links"]), len(tables["loads"])) == (2, 3)
    assert len(guided.recordings[0][1].inputs) == 1


def test_the_bandwidths_reach_from_the_motion_to_the_sampling(recording):
    guides = Guides(Scenario(body(t_end=4.0)), [(0, recording)])
    assert guides.bandwidths[0] == 0.0
    assert guides.bandwidths == sorted(guides.bandwidths)
    assert 100.0 / 3 < guides.bandwidths[-1] <= 100.0
    reached = Reached({}, {bandwidth: {F_C: bandwidth} for bandwidth in (1.0, 4.0, 2.0)})
    assert [reached.at(bandwidth)[F_C] for bandwidth in (1.0, 1.5, 3.0, 5.0)] == [1.0, 2.0, 4.0, 4.0]


@pytest.mark.parametrize(("F_c", "followed"), [(1.0, 1), (1.2, 2)])
def test_another_start_is_followed_where_more_than_noise_is_left(recording, monkeypatch, F_c, followed):
    level = MachineCoordinate(F_C, 0.5, 5.0, F_c, targets={F_C: 1.0})
    search = GuidedSearch(Scenario(body(amplitude=5.0, t_end=4.0)), [(0, recording)], [level], {"a.y": NOISE}, Work())
    whole, ends = search._problem(0), []

    def end(guide, u):
        ends.append(Reached(whole.values(u), {}, float(half_squares(whole.residuals(u[None]))[0])))
        return ends[-1]

    compared = 1, Found(whole.start(), 0.0, others=(whole.point({F_C: 1.25}),))
    monkeypatch.setattr(search, "_best_starts", lambda *_: compared)
    monkeypatch.setattr(search, "_freed", end)
    assert search.followed(search.reached(2, 0, {})).values[F_C] == pytest.approx(F_c, rel=1e-5)
    assert len(ends) == followed


def test_one_start_far_away_suffices(recording):
    truth = {F_C: 1.0, F_S: 1.3, MASS: 1.0}
    sought = tuple(Sought(name, 0.05, 50.0) for name in truth)
    fitted = fit_machine(
        body(t_end=4.0, amplitude=5.0, mass=8.0, F_c=5.0, F_s=6.0),
        Logs((recording,), sought),
        starts=1,
        baselines=False,
    )
    for name, x in truth.items():
        e = fitted.estimates[name]
        assert e.state == "identified", fitted.notes
        assert e.low < x < e.high

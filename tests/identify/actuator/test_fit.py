"""Machines whose numbers are known by construction: found, with intervals that hold them; or said not to be told."""

from dataclasses import replace

import numpy as np
import pytest

from stribeck.errors import InputError, StribeckError
from stribeck.identify.actuator import estimate as estimation
from stribeck.identify.actuator import fit_machine, read_logs
from stribeck.identify.actuator.coordinates import coordinates
from stribeck.identify.actuator.problem import MachineProblem
from stribeck.identify.actuator.runs import RecordedRun
from stribeck.identify.actuator.starts import problem_of
from stribeck.scenario import Scenario
from tests.identify.actuator.recorded import body, logs, record
from tests.machine.test_servo import MACHINE
from tests.reference.apart import solve

F_C, F_S, MASS = "contacts.guide.law.parameters.F_c", "contacts.guide.law.parameters.F_s", "bodies.a.mass"
WANTED = {F_C: {"low": 0.1, "high": 10.0}, MASS: {"low": 0.2, "high": 5.0}}


@pytest.fixture(scope="module")
def recordings(tmp_path_factory):
    folder = tmp_path_factory.mktemp("recordings")
    for i, amplitude in enumerate((3.0, 5.0)):
        record(folder / f"run{i}.csv", body(amplitude=amplitude), seed=i)
    return folder


def machine(**more):
    return body(**{"mass": 2.0, "F_c": 0.5, "F_s": 1.3, **more})


def test_the_truth_lies_in_the_intervals(recordings):
    path = logs(recordings, ["run0.csv", {"file": "run1.csv", "hold_out": True}], WANTED)
    fitted = fit_machine(machine(), path, starts=2)
    assert fitted.status == "done", fitted.reason
    for name, truth in ((F_C, 1.0), (MASS, 1.0)):
        p = fitted.estimates[name]
        assert p.state == "identified"
        assert p.low < truth < p.high, (name, p)
        assert p.high - p.low < 0.1 * truth
    assert fitted.error(held_out=True) < 0.02
    assert fitted.baselines["no friction"]["held_out"] > 5 * fitted.error(held_out=True)
    assert fitted.data["bodies"]["a"]["mass"] == fitted.estimates[MASS].value
    with pytest.raises(InputError, match="it holds no recording; there is nothing to plot"):
        replace(fitted, logs=[]).plot()


def test_a_number_short_of_its_optimum_is_not_identified(recordings, monkeypatch):
    """By position a search crept along a valley for as long as it was let, and sigma_0 was identified 29 % off."""
    monkeypatch.setattr(estimation, "settled", lambda problem, u: u + 0.01)
    fitted = fit_machine(machine(), logs(recordings, ["run0.csv"], WANTED), starts=2, baselines=False)
    assert fitted.levels
    assert {e.state for e in fitted.parameters.values()} == {"not identifiable"}
    assert all("did not come to its end" in e.why for e in fitted.parameters.values())


def test_no_point_of_a_recording_is_simulated_twice(recordings, monkeypatch):
    given = read_logs(logs(recordings, ["run0.csv", "run1.csv"], WANTED))
    scenario = Scenario(machine())
    sought, noise = coordinates(scenario, given), {"a.y": 1e-5}
    asked = []
    monkeypatch.setattr(RecordedRun, "predict", counted(asked, RecordedRun.predict))
    problem = problem_of(scenario, list(enumerate(given.recordings)), sought, noise)
    start = problem.start()
    points = np.stack([start, start, start + 0.01, start])
    first = problem.residuals(points)
    assert sorted(asked) == [2, 2]  # of each recording two points that differ
    of_one = np.flatnonzero([c.log == 0 for c in problem.sought])  # where the first recording begins
    points[2, of_one] += 0.01
    again = problem.residuals(points)
    assert sorted(asked) == [1, 2, 2]
    assert again[[0, 1, 3]].tobytes() == first[[0, 1, 3]].tobytes()
    assert again.tobytes() == MachineProblem(problem.runs, problem.sought, noise).residuals(points).tobytes()


def counted(lanes, predict):
    def predicted(run, values, *more):
        lanes.append(len(next(iter(values.values()))))
        return predict(run, values, *more)

    return predicted


@pytest.mark.thorough
def test_a_column_in_degrees_or_of_the_wrong_sign_is_noticed(recordings, tmp_path):
    for factor in (180 / np.pi, -1.0):
        record(tmp_path / "wrong.csv", body(amplitude=5.0), change=lambda x, f=factor: {**x, "y": f * x["y"]})
        fitted = fit_machine(machine(), logs(tmp_path, ["wrong.csv"], WANTED), starts=2)
        assert fitted.status == "missed"
        assert not any(p.state == "identified" for p in fitted.estimates.values())


@pytest.mark.thorough
def test_one_load_cannot_tell_how_the_level_depends_on_it(tmp_path):
    gain = "contacts.guide.loads.0.F_c"
    truth = {"gain": 0.2, "pull": 2.0, "amplitude": 6.0}
    record(tmp_path / "run.csv", body(**truth))
    path = logs(tmp_path, ["run.csv"], {F_C: {"low": 0.1, "high": 10.0}, gain: {"low": 0.0, "high": 0.6}})
    fitted = fit_machine(body(**truth, F_s=3.0), path, starts=1, baselines=False)
    assert "identified" not in {fitted.estimates[n].state for n in (F_C, gain)}
    assert fitted.correlated
    assert set(fitted.correlated[0]["names"]) == {F_C, gain}


@pytest.mark.thorough
def test_friction_alone_may_be_sought(recordings):
    """The machine without friction, which is compared, then has no number left."""
    data = body(F_c=0.8, F_s=1.3)
    data["bodies"]["a"]["initial"] = {"y": 0.0, "v": 0.0}
    fitted = fit_machine(data, logs(recordings, ["run0.csv"], {F_C: WANTED[F_C]}), starts=1)
    assert fitted.estimates[F_C].low < 1.0 < fitted.estimates[F_C].high
    assert fitted.baselines["no friction"]["fitted"] > 5 * fitted.error(held_out=False)


@pytest.mark.thorough
def test_a_machine_without_the_recorded_force_is_no_comparison(tmp_path):
    """Without friction there is no guide.F: that was a row of the results, as a mistake in the user's file."""
    data, force = body(), solve(body())["guide.F"]
    record(tmp_path / "run.csv", data, change=lambda table: {**table, "F": force})
    entry = {"file": "run.csv", "outputs": {"a.y": "y", "guide.F": "F"}}
    fitted = fit_machine(data, logs(tmp_path, [entry], {F_C: WANTED[F_C]}), starts=1)
    assert fitted.status == "done", fitted.reason
    assert "no friction" not in fitted.baselines
    assert not any("why" in each for each in fitted.baselines.values())


def test_gaps_are_told(recordings, tmp_path):
    record(tmp_path / "whole.csv", body())
    rows = (tmp_path / "whole.csv").read_text().splitlines()
    (tmp_path / "gaps.csv").write_text("\n".join(rows[:30] + rows[35:]) + "\n")
    path = logs(tmp_path, ["whole.csv", "gaps.csv"], WANTED)
    fitted = fit_machine(machine(), path, starts=1, baselines=False)
    assert any("gaps.csv: 5 samples are missing" in note for note in fitted.notes)


def pressed_at(share):
    """Progress that presses Ctrl-C once, when this share of the work is done."""
    pressed = []

    def progress(now):
        if now > share and not pressed:
            pressed.append(now)
            raise KeyboardInterrupt

    return progress


def test_a_fit_that_was_stopped_keeps_what_it_found(recordings):
    fitted = fit_machine(machine(), logs(recordings, ["run0.csv"], WANTED), starts=4, progress=pressed_at(0.02))
    assert fitted.status == "stopped"
    assert all(np.isfinite(e.value) and not e.identifiable for e in fitted.estimates.values())


def test_a_comparison_that_was_stopped_shows_no_residual(recordings):
    """The residuals of searches that Ctrl-C had ended stood as those of simpler friction."""
    fitted = fit_machine(machine(), logs(recordings, ["run0.csv"], WANTED), starts=1, progress=pressed_at(0.801))
    assert (fitted.status, fitted.baselines) == ("stopped", {})
    assert all(e.identifiable for e in fitted.estimates.values())


@pytest.mark.thorough
def test_intervals_are_those_of_the_noise_that_is_left(tmp_path):
    """From a poor start the noise settles over several rounds; it was taken as twice as much."""
    record(tmp_path / "run.csv", body(amplitude=5.0))
    law = {"F_c": 1.0, "F_s": 1.3, "v_s": 0.02, "sigma_0": 2e4, "sigma_1": 60.0, "sigma_2": 4.0}
    truth = {f"contacts.guide.law.parameters.{n}": x for n, x in law.items()} | {"bodies.a.mass": 1.0}
    wanted = {n: {"low": x / 5, "high": 5 * x, "start": 2.5 * x} for n, x in truth.items()}
    fitted = fit_machine(body(), logs(tmp_path, ["run.csv"], wanted), starts=1, baselines=False)
    assert abs(fitted.noise["a.y"] / 2e-5 - 1) < 0.2


def test_a_controller_whose_model_changes_with_the_machine_is_refused(tmp_path):
    (tmp_path / "run.csv").write_text("t,y\n" + "".join(f"{0.01 * i},{1e-4 * i * i}\n" for i in range(21)))
    entry = {"file": "run.csv", "inputs": {}, "outputs": {"piston.y": "y"}}
    wanted = {"contacts.seal.law.parameters.F_c": {"low": 10.0, "high": 100.0}}
    with pytest.raises(StribeckError, match="changes the form of the equations"):
        fit_machine(MACHINE, logs(tmp_path, [entry], wanted), starts=1, baselines=False)

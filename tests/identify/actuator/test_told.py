"""What is told beside the numbers: clocks that drift, another unit, the files."""

import re
from types import SimpleNamespace

import numpy as np
import pytest

from stribeck import Scenario
from stribeck.identify.actuator import advise, fit_machine, read_logs
from stribeck.identify.actuator.coordinates import MachineCoordinate, coordinates
from stribeck.identify.actuator.drawn import above_noise
from stribeck.identify.actuator.estimate import BestPoint
from stribeck.identify.actuator.guides import Guides
from stribeck.identify.actuator.problem import MachineProblem
from stribeck.identify.actuator.starts import prepared, problem_of
from tests.identify.actuator.recorded import NOISE, body, logs, record

F_C, MASS = "contacts.guide.law.parameters.F_c", "bodies.a.mass"
WANTED = {F_C: {"low": 0.1, "high": 10.0}, MASS: {"low": 0.2, "high": 5.0}}


def drifting(table):
    """The encoder was read every 9.9 ms, and says every 10 ms: its clock gains 1 % on that of the drive."""
    return {"t": 0.01 * np.arange(101), "y": table["y"][:101], "u": table["u"]}


def test_a_clock_that_drifts_is_told_and_can_be_sought(tmp_path):
    data = body(amplitude=5.0)
    data["output"]["step"] = 0.0099
    record(tmp_path / "run.csv", data, change=drifting)
    fitted = fit_machine(body(), logs(tmp_path, ["run.csv"], WANTED), starts=1, baselines=False)
    assert any("outputs.a.y.clock = 0.0" in note for note in fitted.notes), fitted.notes
    clock = {"outputs.a.y.clock": {"low": -0.03, "high": 0.03}}
    result = fit_machine(body(), logs(tmp_path, ["run.csv"], WANTED | clock), starts=1, baselines=False)
    p = result.estimates["outputs.a.y.clock"]
    assert p.low < 0.01 < p.high
    assert result.estimates[MASS].low < 1.0 < result.estimates[MASS].high


@pytest.mark.share(2)
@pytest.mark.parametrize("off", [1e-3, 5e-2])
def test_the_sensor_of_one_recording_that_errs_is_named(tmp_path, off):
    record(tmp_path / "good.csv", body(amplitude=3.0))
    record(tmp_path / "bad.csv", body(amplitude=5.0), change=lambda x: {**x, "y": x["y"] + off})
    start = {"bodies.a.initial.y": 0.0, "bodies.a.initial.v": 0.0}
    path = logs(tmp_path, [{"file": f"{name}.csv", "known": start} for name in ("good", "bad")], WANTED)
    fitted = fit_machine(body(), path, starts=1, baselines=False)
    assert any("log.1.outputs.a.y.offset (bad.csv)" in n for n in fitted.notes), fitted.notes
    entries = [{"file": f"{name}.csv", "known": start} for name in ("good", "bad")]
    offset = {"log.1.outputs.a.y.offset": {"low": -0.1, "high": 0.1}}
    result = fit_machine(body(), logs(tmp_path, entries, WANTED | offset), starts=1, baselines=False)
    p = result.estimates["log.1.outputs.a.y.offset"]
    assert p.low < off < p.high
    assert result.estimates[MASS].low < 1.0 < result.estimates[MASS].high


@pytest.mark.thorough
def test_noise_of_an_input_is_counted_in_the_intervals(tmp_path):
    rng = np.random.default_rng(3)
    noisy = lambda x: {**x, "u": x["u"] + 0.1 * rng.standard_normal(len(x["u"]))}  # noqa: E731
    record(tmp_path / "noisy.csv", body(amplitude=5.0), change=noisy)
    record(tmp_path / "clean.csv", body(amplitude=5.0))
    wanted = {"bodies.a.mass": {"low": 0.2, "high": 5.0}, F_C: {"low": 0.1, "high": 10.0}}
    result, clean = (
        fit_machine(body(mass=1.1), logs(tmp_path, [name], wanted), starts=1, baselines=False)
        for name in ("noisy.csv", "clean.csv")
    )
    for name in wanted:
        p, exact = result.estimates[name], clean.estimates[name]
        assert p.low < 1.0 < p.high
        assert exact.low < 1.0 < exact.high
        assert p.high - p.low > 5 * (exact.high - exact.low)


@pytest.mark.share(3)
@pytest.mark.parametrize("noise", [1e-4, 6e-4])
def test_a_fixed_number_that_is_wrong_is_named_and_in_the_ranges(tmp_path, noise):
    record(tmp_path / "a.csv", body(amplitude=5.0), noise=noise)
    record(tmp_path / "b.csv", body(amplitude=3.0), noise=noise, seed=1)
    fitted = fit_machine(body(sigma_2=4.4), logs(tmp_path, ["a.csv", "b.csv"], WANTED), starts=4, baselines=False)
    for name in (F_C, MASS):
        assert fitted.estimates[name].range[0] < 1.0 < fitted.estimates[name].range[1]
    if noise < 5e-4:  # else it is not seen
        assert any(re.search(r"sigma_2 = \S+ in place of 4\.4\b", n) for n in fitted.notes), fitted.notes


@pytest.mark.thorough
def test_a_wrong_constant_that_spoils_another_is_the_one_that_is_named(tmp_path):
    """sigma_0 30000 for 20000 moved v_s out of its interval, and another constant was blamed."""
    record(tmp_path / "a.csv", body(amplitude=5.0))
    record(tmp_path / "b.csv", body(amplitude=3.0), seed=1)
    law = "contacts.guide.law.parameters."
    truth = {f"{law}v_s": 0.02, f"{law}F_s": 1.3, F_C: 1.0, MASS: 1.0}
    wanted = {n: {"low": x / 5, "high": 5 * x} for n, x in truth.items()}
    fitted = fit_machine(body(sigma_0=3e4), logs(tmp_path, ["a.csv", "b.csv"], wanted), starts=3, baselines=False)
    ranges = {n: fitted.estimates[n].range for n in truth}
    assert all(low < truth[n] < high for n, (low, high) in ranges.items()), ranges
    assert any(re.search(rf"{re.escape(law)}sigma_0 = \S+ in place of 3e\+04", n) for n in fitted.notes), fitted.notes


@pytest.mark.parametrize(("amplitude", "t_end"), [(1.5, 1.0), (5.0, 0.3)])
def test_the_same_recording_once_more_narrows_an_interval_by_the_root_of_two(tmp_path, amplitude, t_end):
    """It was to make one 98 times narrower, and another recording 507 times: each start was taken as known."""
    law, machine = "contacts.guide.law.parameters.", body(amplitude=amplitude, t_end=t_end)
    truth = {F_C: 1.0, f"{law}F_s": 1.3, f"{law}v_s": 0.02, f"{law}sigma_2": 4.0, MASS: 1.0}
    record(tmp_path / "a.csv", machine)
    read = read_logs(logs(tmp_path, ["a.csv"], {n: {"low": x / 5, "high": 5 * x} for n, x in truth.items()}))
    sought = coordinates(Scenario(machine), read)
    problem = problem_of(Scenario(machine), [(0, read.recordings[0])], sought, {"a.y": NOISE})
    u = np.array([*(c.inner(truth[c.name]) for c in sought), *problem.start()[len(sought) :]])
    J = problem.slopes(u[None], np.full(len(u), 2e-3))[1][0]
    advised = advise.experiments(problem, u, J, list(range(len(sought))))
    for text in advised.values():
        *gains, repeated = (float(x) for x in re.findall(r"(\S+) times(?:\)|$)", text))
        assert repeated == 1.4, text
        assert all(1.4 < x <= 10 for x in gains), text
    assert any("(its deviation would fall more than 10 times)" in text for text in advised.values())


def test_no_recording_is_advised_for_parameters_of_which_only_ratios_matter(tmp_path):
    """Twice the drive was to narrow their intervals more than 10 times."""
    machine, law = body(amplitude=5.0), "contacts.guide.law.parameters."
    truth = {f"{law}{n}": x for n, x in machine["contacts"]["guide"]["law"]["parameters"].items() if n != "v_s"}
    truth |= {MASS: 1.0, "loads.push.gain": 1.0}
    record(tmp_path / "a.csv", machine)
    wanted = {n: {"low": x / 5, "high": 5 * x} for n, x in truth.items()}
    fitted = fit_machine(machine, logs(tmp_path, ["a.csv"], wanted), starts=1, baselines=False)
    for name, e in fitted.estimates.items():
        assert "confounded with" in e.why, name
        assert e.experiment.startswith("no simulated recording"), name


def test_numbers_with_which_nothing_can_be_simulated_are_no_fit(tmp_path):
    """F_c above the F_s that is fixed: nothing is left that could be compared, which is not little."""
    record(tmp_path / "a.csv", body())
    reported = read_logs(logs(tmp_path, ["a.csv"], {F_C: {"low": 0.1, "high": 10.0}}))
    scenario = Scenario(body())
    sought = coordinates(scenario, reported)
    runs, _ = prepared(scenario, [(0, reported.recordings[0])], sought)
    problem = MachineProblem(runs, sought, {"a.y": NOISE})
    good, bad = (np.array([problem.sought[0].inner(x)]) for x in (1.0, 5.0))
    assert not above_noise(problem, good)
    guides = Guides(scenario, [(0, reported.recordings[0])])
    assert not BestPoint(problem, good, False, [], guides).missed()
    assert above_noise(problem, bad)
    assert BestPoint(problem, bad, False, [], guides).missed() == ["a.y: cannot be simulated with the best values"]


def test_known_masses_and_drives_but_no_guides_may_differ_in_a_recording_that_is_advised():
    scenario = Scenario(body(mass=3.0))
    reported = dict(advise._loads(SimpleNamespace(sought=[]), SimpleNamespace(scenario=scenario)))
    assert reported["with bodies.a.mass = 6 (it is 3)"] == {"bodies.a.mass": 6.0}
    sought = MachineCoordinate("bodies.a.mass", 1.0, 9.0, targets={"bodies.a.mass": 1.0})
    assert not list(advise._loads(SimpleNamespace(sought=[sought]), SimpleNamespace(scenario=scenario)))
    run = SimpleNamespace(scenario=scenario)
    others = [advise._drives(SimpleNamespace(of_guide=lambda _, x=x: x), run) for x in (False, True)]
    assert [any("loads.push" in words for words, _ in drives) for drives in others] == [True, False]

"""The verdict on a loop, against linear theory, against another solver, and what the command prints and writes."""

import json

import numpy as np
import pytest
import tomli_w

import stribeck
from stribeck import InputError, Scenario, design
from stribeck.cli import _status
from stribeck.loops import uncertainty
from stribeck.loops.boundary import Turned, line
from stribeck.loops.compensation import kinds_of, lag_of, with_compensation
from stribeck.loops.excess import excess
from stribeck.loops.judge import judge
from stribeck.loops.loop import loop_of
from stribeck.loops.moves import moves_of
from tests.loops.axis import axis
from tests.machine.machines import law
from tests.reference.apart import solve


def only(data, **options):
    return design(Scenario(data), **options)


@pytest.mark.thorough
def test_without_an_integral_it_is_quiet():
    assert only(axis()).verdict == "quiet"


@pytest.mark.thorough
def test_a_majorant_creeps_where_lugre_rests():
    """m(0) > 0: under a held load the contact creeps on at about m(0) F/F_s."""
    result = only(axis(contact=law(sigma_1=30.0, sigma_2=15.0, k_v=1e5)))
    assert result.verdict == "creeping"


@pytest.mark.thorough
def test_an_integral_hunts_against_stiction():
    """The paper's limit cycle, as a machine: known from its figure and from ../shared/reference."""
    canudas = {"name": "lugre", "parameters": "canudas1995"}
    step = {"kind": "step", "time": 0.0, "value": 1.0}
    result = only(axis(contact=canudas, signal=step, K_p=3.0, K_i=4.0, K_d=6.0))
    assert result.verdict == "hunting"
    cycle = result.to_dict()["limit_cycle"]
    assert cycle["body"] == "a"
    assert cycle["amplitude"] == pytest.approx(0.064, abs=1e-3)
    assert cycle["period"] == pytest.approx(24.4, abs=0.1)


def test_the_slowest_time_constant_is_that_of_the_linear_loop():
    """m s^2 + (K_d + sigma_2) s + K_p."""
    result = loop_of(Scenario(axis()))
    roots = np.roots([1.0, 20.0 + 15.0, 200.0])
    assert result.slowest == pytest.approx(1 / -roots.real.max(), rel=1e-3)


@pytest.mark.thorough
def test_beyond_the_stability_of_the_linear_loop_it_is_unstable():
    """Routh: m K_i > K_p (K_d + sigma_2) grows, whatever friction takes once it moves far."""
    limit = 200.0 * 35.0
    assert only(axis(K_i=1.3 * limit, limit=1e4)).verdict == "unstable"


@pytest.mark.thorough
def test_another_solver_agrees_on_both_sides_of_a_boundary():
    """Where a delay destabilizes: 5 % away on either side the second solver's mass rests, or does not."""
    data = axis(K_p=500.0, K_d=30.0, limit=100.0, sampling={"period": 2e-3, "delay": 2e-3})
    loop = loop_of(Scenario(data))
    result = line(loop, Turned.parse("controllers.hold.sampling.delay=6e-3:6e-2"))
    (boundary,) = result.boundaries
    assert (boundary.below, boundary.above) == ("quiet", "unstable")
    assert boundary.sure
    for share, quiet in ((0.95, True), (1.05, False)):
        data["controllers"]["hold"]["sampling"]["delay"] = share * boundary.value
        data["solve"]["t_end"] = 1.0 + 50 * loop.slowest
        data["output"]["step"] = data["solve"]["t_end"] / 400
        y = np.asarray(solve(data)["a.y"])
        assert bool(np.ptp(y[200:]) < 1e-4 * np.ptp(y)) is quiet


def test_what_an_encoder_does_not_see_counts_as_rest():
    data = axis(K_i=800.0, sampling={"period": 1e-3, "resolution": 1e-2})
    assert judge(loop_of(Scenario(data)))[0].amplitude <= 0.5e-2


def test_signals_that_never_rest_are_held():
    data = axis(signal={"kind": "sine", "amplitude": 0.05, "frequency": 1.0})
    loop = loop_of(Scenario(data))
    assert loop.held == ("controllers.hold.signal",)
    assert (loop.rest, loop.scenario.elements.controllers["hold"].signal.t[12]) == (2.0, 0.25)  # crests are points
    assert judge(loop)[0].verdict == "quiet"


@pytest.mark.thorough
def test_compensation_lowers_the_error_after_reversals_by_what_is_said():
    """Each as a machine of its own, simulated anew, leaves the error that was stated."""
    result = design(
        Scenario(axis(signal={"kind": "point_to_point", "t": [0.1, 0.6], "value": [0.0, 0.05]})), compensate=True
    )
    rows = {c.kind: c for c in result.compensations}
    assert set(rows) == {"none", "reference", "measured", "dither"}
    assert rows["none"].largest_quiet_share == 0.0
    assert rows["reference"].reversal_error < 0.7 * rows["none"].reversal_error
    own = rows["reference"]
    data = json.loads(json.dumps(own.loop.scenario.data))
    table = data["controllers"]["hold"]
    assert table["compensation"]["speed"] == "reference"
    table["compensation"]["share"] = own.share
    speed = 0.05 / 0.5 * 35 / 16  # the fastest of a move of order seven
    period = 2 * np.pi * 0.025 / speed
    reported = result.to_dict()
    assert reported["moves"] == pytest.approx({"amplitude": 0.025, "speed": speed, "period": period}, rel=2e-3)
    assert [row.get("table") for row in reported["compensations"]][:2] == [None, table["compensation"]]
    table["signal"] = {"kind": "sine", "amplitude": 0.025, "frequency": 1 / period}
    t = stribeck.simulate(Scenario(data), t_end=4 * period, step=period / 1000)
    after = (t.t >= period) & ((t.t / period - 0.25) % 0.5 <= 0.125)
    assert np.abs(t["hold.r"] - t["a.y"])[after].max() == pytest.approx(own.reversal_error, rel=0.01)


def test_a_set_in_a_file_is_found_from_the_folder_of_the_machine_that_is_written(tmp_path):
    """The command left a machine that looked for it beside itself."""
    data = axis()
    numbers = data["contacts"]["guide"]["law"]["parameters"]
    (tmp_path / "guide.toml").write_text(tomli_w.dumps({"parameters": numbers}))
    data["contacts"]["guide"]["law"]["parameters"] = "guide.toml"
    (tmp_path / "axis.toml").write_text(tomli_w.dumps(data))
    assert _status(["design", str(tmp_path / "axis.toml"), "--out", str(tmp_path / "deep" / "out")]) == 0
    assert _status(["run", str(tmp_path / "deep" / "out" / "machine.toml")]) == 0


INTERVALS = """
[parameters]
F_c = {low = 0.5, high = 2.2}
"contacts.guide.law.parameters.F_s" = {value = 2.0, low = 1.8, high = 2.4}
sigma_0 = {value = 1e5}
sigma_2 = {low = 3.0}
"""


def test_the_intervals_of_a_file_hold_for_each_contact_that_has_the_constant(tmp_path):
    (tmp_path / "fit.toml").write_text(INTERVALS)
    result = uncertainty.friction_intervals(Scenario(axis()), tmp_path / "fit.toml")
    assert result == {"contacts.guide.law.parameters.F_c": (0.5, 2.2), "contacts.guide.law.parameters.F_s": (1.8, 2.4)}
    samples = uncertainty.friction_samples(result)
    F_c, F_s = (samples[path] for path in result)
    assert (F_s >= F_c).all()
    assert (F_c.min(), F_c.max(), F_s.min(), F_s.max()) == (0.5, 2.2, 1.8, 2.4)
    np.testing.assert_allclose(F_c[:7], [1.35, 0.5, 2.2, 0.5, 2.2, 1.35, 1.35])  # middle, low, high, each alone
    np.testing.assert_allclose(F_s[:7], [2.1, 1.8, 2.4, 2.1, 2.2, 1.8, 2.4])


def test_over_compensation_pushes_from_the_share_that_is_named(tmp_path):
    """The run at 5 % more speeds up by itself; at 5 % less than the share the same body comes to rest."""
    pull = {"on": "a", "kind": "signal", "signal": {"kind": "step", "value": 0.1, "time": 0.0}}  # not in the run
    loop = loop_of(Scenario({**axis(contact=law("lugre", sigma_1=30.0, sigma_2=2.0)), "loads": {"pull": pull}}))
    samples = uncertainty.friction_samples(uncertainty.friction_intervals(loop.scenario, None))
    result = excess(loop.scenario, "hold", samples)
    assert result.share == pytest.approx(1.0, rel=1e-9)  # the same law on both sides
    v = result.speed
    taken, added = (
        p["F_c"] + (p["F_s"] - p["F_c"]) * np.exp(-((v / p["v_s"]) ** 2)) + p["sigma_2"] * v
        for p in (
            {name.rpartition(".")[2]: x for name, x in result.sample.items()},
            loop.scenario.data["contacts"]["guide"]["law"]["parameters"],
        )
    )
    assert result.worst_share == pytest.approx(taken / added, rel=1e-9)
    assert result.worst_share < 0.9
    assert not result.counterexample.elements.loads
    run = stribeck.simulate(result.counterexample)
    assert run["a.v"][-1] > 2 * v
    assert run["E_in"][-1] > 0  # what the compensation supplied
    path = "controllers.hold.compensation.share"
    less = result.counterexample.with_changes({path: 0.95 * result.worst_share})
    assert stribeck.simulate(less)["a.v"][-1] < 0.5 * v


def test_the_standard_sine_of_a_sine_is_that_sine():
    """Its speed was that of the spline which begins at rest, in other cases that of an aliased wave."""
    data = axis(t_end=4.0, signal={"kind": "sine", "amplitude": 0.05, "frequency": 0.5})
    moves = moves_of(loop_of(Scenario(data)), "hold")
    assert moves.amplitude == pytest.approx(0.05, rel=1e-4)
    assert moves.period == pytest.approx(2.0, rel=1e-3)


def test_what_grows_until_it_cannot_be_followed_is_unstable():
    """It was called failed: without a limit the step fell below what floating point resolves."""
    assert only(axis(K_i=30 * 200.0 * 35.0)).verdict == "unstable"


def test_an_inner_loop_that_leads_makes_up_for_the_lag_of_the_drive():
    """The force that acts lags by the delay; with lead dF/dt it is nearer to the law's at the moving body's speed."""
    sampling = {"period": 1e-3, "delay": 5e-3}
    wave = {"kind": "sine", "amplitude": 0.02, "frequency": 1.0}
    rub = law(sigma_0=5e4, sigma_1=100.0, sigma_2=5.0, k_v=1e3)
    loop = loop_of(Scenario(axis(contact=rub, signal=wave, K_p=3e3, K_d=60.0, sampling=sampling)))
    assert lag_of(loop.scenario, "hold") == pytest.approx(5.5e-3)
    assert kinds_of(loop, "hold", "guide") == ["none", "reference", "measured", "inner_loop", "dither"]
    errors = []
    for kind in ("none", "measured", "inner_loop"):
        built = with_compensation(loop.scenario, "hold", "guide", kind, 0.8)
        run = stribeck.simulate(built.with_changes({"solve.t_end": 2.0, "output.step": 1e-3}))
        assert run.status == "done"
        errors.append(np.abs(run["hold.r"] - run["a.y"])[1000:].max())
    assert errors[2] < errors[1] < errors[0]
    rough = loop_of(Scenario(axis(contact=law("lugre"), signal=wave, sampling=sampling)))
    assert "inner_loop" not in kinds_of(rough, "hold", "guide")
    with pytest.raises(InputError, match="has no dF/dt"):
        Scenario(
            axis(
                contact=law("lugre"), signal=wave, compensation={"contact": "guide", "speed": "measured", "lead": 1e-3}
            )
        )

"""What the loop does from many starts, and with a dither."""

from dataclasses import replace

import numpy as np
import pytest

from stribeck import Scenario
from stribeck.loops.compensation import CompensationResult, _dithered, with_compensation
from stribeck.loops.figures import motions, unbeaten
from stribeck.loops.judge import Judgment, judge, rest_bands
from stribeck.loops.loop import loop_of
from stribeck.loops.moves import Tracked, on_a_sine, reversal_errors
from stribeck.loops.said import starts_sentence
from stribeck.loops.shaken import SHARE, frequency_for, swings
from stribeck.loops.starts import Start, _travel_ratios, distinct_judgments, from_starts
from tests.loops.axis import axis
from tests.machine.machines import law


def hunter(**controller):
    """Quiet from where its file begins, though its integral hunts when it begins nearer to its target."""
    step = {"kind": "step", "time": 0.0, "value": 0.05}
    guide = law("lugre", sigma_0=1e5, sigma_1=300.0, sigma_2=20.0, F_c=6.0, F_s=9.0, v_s=5e-3)
    data = axis(contact=guide, signal=step, **{"K_p": 2000.0, "K_d": 100.0, "K_i": 20000.0, **controller})
    data["bodies"]["a"]["mass"] = 2.0
    return loop_of(Scenario(data))


def test_what_it_does_depends_on_the_start():
    """Another solver on equations written apart (30 s, rtol 1e-9) has a cycle of
    0.816 mm from 0.75 mm off, and rest to 1.6e-11 m from 2.5 mm off."""
    loop = hunter()
    own = judge(loop)[0]
    fitted = from_starts(loop, "hold")
    assert own.verdict == "quiet"
    cycles = [s for s in fitted if s.judgment.verdict == "hunting"]
    assert [abs(s.off) for s in cycles] == pytest.approx([0.03 * 0.025] * 2)
    assert all(s.judgment.amplitude == pytest.approx(0.816e-3, rel=0.01) for s in cycles)
    assert {j.verdict for j in distinct_judgments(fitted, own)} == {"quiet", "hunting"}
    assert f"from 2 of {len(fitted)} other starts it hunts, ±" in starts_sentence(fitted, own, "m")
    assert len(distinct_judgments([s for s in fitted if s.judgment.quiet], own)) == 1


@pytest.mark.parametrize(("amplitude", "different"), [(1.105e-6, 1), (1.12e-6, 2)])
def test_cycles_within_a_tenth_of_the_larger_one_are_one(amplitude, different):
    one, other = (Judgment("hunting", "a", x, 0.1) for x in (1e-6, amplitude))
    for start, own in ((one, other), (other, one)):
        assert len(distinct_judgments([Start("a", 1e-3, 0.0, start)], own)) == different


def test_a_cycle_without_a_period_is_told_without_one():
    rest, uneven = Judgment("quiet", "a", 0.0, np.nan), Judgment("hunting", "a", 2e-6, np.nan)
    results = [Start("a", 1e-3, 0.0, rest), Start("a", 2e-3, 0.0, uneven)]
    reported = starts_sentence(results, rest, "m")
    assert reported == "from 1 of 2 other starts it hunts, ±2 µm"
    assert "nan" not in reported


def test_rest_is_measured_by_the_move_of_the_file():
    """A start near its target hardly travels, and what its last slip left was more than a millionth of that: called creeping."""
    loop = loop_of(Scenario(axis(K_i=100.0)))
    held = replace(loop, travel={"a": 0.1})
    assert rest_bands(loop, {"a": 1e-4}) == {"a": pytest.approx(1e-10)}
    assert rest_bands(held, {"a": 1e-4}) == {"a": pytest.approx(1e-7)}
    assert all(s.judgment.quiet for s in from_starts(loop, "hold"))


def test_starts_move_what_is_linked_along():
    data = axis()
    data["bodies"] |= {"wheel": {"inertia": 0.01}, "rim": {"inertia": 0.01, "tied_to": "wheel", "ratio": -2.0}}
    data["links"] = {"k": {"from": "a", "to": "rim", "ratio": 50.0, "stiffness": 9.0, "damping": 0.1}}
    assert _travel_ratios(Scenario(data), "a") == {"a": 1.0, "wheel": pytest.approx(-25.0)}
    assert _travel_ratios(Scenario(data), "rim") == {"wheel": pytest.approx(-0.5), "a": pytest.approx(1 / 50)}


def test_a_dither_stops_what_hunts():
    """0.712 mm of hunting; with more than friction at 100 Hz the mass stays within what the dither alone moves it."""
    assert judge(hunter(K_i=60000.0))[0].verdict == "hunting"
    loop = hunter(K_i=60000.0, dither={"amplitude": 12.0, "frequency": 100.0})
    path = "controllers.hold.dither.amplitude"
    none, shaken = judge(loop, {path: np.array([0.0, 12.0])})
    assert none.verdict == "hunting"
    assert shaken.quiet
    free = 12.0 / (2.0 * (2 * np.pi * 100) ** 2)  # of the mass alone
    assert 0.3 * free < shaken.amplitude < 1.2 * free
    assert swings(loop, {}, 1)[0]["a"] == pytest.approx(2 * SHARE * free, rel=0.02)


def test_a_dither_swings_the_mass_by_a_hundredth_of_the_most_that_it_could():
    loop = hunter(K_i=60000.0)
    s = 2j * np.pi * np.append(np.geomspace(0.1, 100, 4001), frequency_for(loop.scenario, "hold", loop.slowest))
    swing = abs(s / (2.0 * s**3 + (100.0 + 20.0) * s**2 + 2000.0 * s + 60000.0))
    assert 0.009 < swing[-1] / swing.max() < 0.0101


def test_errors_after_reversals_are_those_of_each_lane_that_is_simulated():
    loop = hunter(K_i=0.0, K_d=300.0)
    own, stiff, wild = reversal_errors(loop, "hold", {"controllers.hold.K_p": np.array([2000.0, 8000.0, -1e9])})
    assert own == pytest.approx(on_a_sine(loop, "hold").errors["reversal"], rel=1e-6)
    assert 0 < stiff < own / 2
    assert np.isnan(wild)


@pytest.mark.thorough
def test_the_amplitude_of_a_dither_that_leaves_least():
    loop = hunter(K_i=0.0, K_d=300.0)
    named = "contacts.guide.law.parameters.F_s"
    built = replace(loop, scenario=with_compensation(loop.scenario, "hold", "guide", "dither", 1.0))
    result = _dithered(built, "hold", {named: np.array([10.0])}, np.array([True]))
    assert result.largest_quiet_share == 3.0
    assert result.dither["least_quiet_share"] == 0.0
    assert result.dither["amplitude"] == pytest.approx(result.share * 9.0, rel=0.02)
    plain = reversal_errors(loop, "hold", {named: np.array([10.0])})
    assert result.share > 0
    assert result.worst_error < 0.8 * plain.max()
    path = "controllers.hold.dither.amplitude"
    assert result.reversal_error == pytest.approx(
        reversal_errors(built, "hold", {path: [result.dither["amplitude"]]})[0], rel=1e-6
    )


def test_the_front_of_error_against_margin():
    """Those that none beats in both; what is not quiet, and a dither, whose shares are of another kind, aside."""
    rows = [("none", 0.0, 3.0), ("reference", 1.5, 1.0), ("measured", 0.8, 0.7), ("inner_loop", 0.7, 0.9),
            ("dither", 3.0, 0.1), ("other", None, 0.0)]  # fmt: skip
    sine = Tracked(np.zeros(0), np.zeros(0), np.zeros(0), {})
    results = [CompensationResult(kind, 1.0, margin, 0.0, worst, hunter(), sine) for kind, margin, worst in rows]
    assert unbeaten(results) == [(0.8, 0.7), (1.5, 1.0)]


def test_errors_are_drawn_over_the_last_wave_and_after_its_reversal():
    """Of 2 mm and of 3 um at a period of 2 s, in the unit of the larger one."""
    pytest.importorskip("matplotlib")
    t = np.linspace(0.0, 8.0, 801)
    tracked = [Tracked(t, np.sin(np.pi * t), np.sin(np.pi * t) - e, {}) for e in (2e-3, 3e-6)]
    remedies = zip(("none", "measured"), tracked, strict=True)
    results = [CompensationResult(kind, 1.0, 0.0, 0.0, 0.0, hunter(), sine) for kind, sine in remedies]
    wave, after = motions(results, 2.0, "m").draw().axes
    assert wave.get_ylabel() == "error (mm)"
    assert [float(line.get_ydata().max()) for line in wave.lines] == pytest.approx([2.0, 3e-3])
    assert wave.lines[1].get_xdata()[[0, -1]] == pytest.approx([6.0, 8.0])
    assert after.lines[1].get_xdata()[[0, -1]] == pytest.approx([-0.04, 0.25], abs=0.011)  # a sample

"""A run keeps its promise: y and v right to 1e-6 of their peaks, F to 1e-4, however small or stiff the motion is."""

import warnings
from pathlib import Path

import numpy as np
import pytest
from scipy.special import ellipj

import stribeck
from stribeck.errors import StribeckNote
from stribeck.simulation import counts
from stribeck.simulation.ensemble import simulate_ensemble

NEARLY = {"sigma_0": 1e5, "sigma_1": 30.0, "sigma_2": 0.4, "F_c": 1.0, "F_s": 1.5, "v_s": 1e-3}


def scenario(law, drive, mass=1.0, t_end=0.5, **solve):
    """A law on a body."""
    return {
        "schema": 1, "law": law, "plant": {"mass": mass}, "drive": drive,
        "solve": {"t_end": t_end, **solve}, "output": {"step": t_end / 100},
    }  # fmt: skip


def stepped(size, **solve):
    """A body on its bristles and a spring, whose far end makes a step: a linear oscillator while the step is small."""
    drive = {"kind": "spring", "stiffness": 1e4, "signal": {"kind": "step", "value": size, "time": 0.0}}
    return scenario({"name": "lugre", "parameters": NEARLY}, drive, t_end=0.05, **solve)


@pytest.mark.parametrize("size", [1e-11, 1e-13, 1e-18, 1e-30])
@pytest.mark.parametrize("lanes", [False, True])
def test_a_motion_far_below_the_laws_scales(size, lanes):
    """Elastic: m y'' + (sigma_1 + sigma_2) y' + (sigma_0 + k) y = k s, solved in closed form."""
    data = stepped(size)
    if lanes:
        many = stribeck.simulate(data, {"plant.mass": [1.0, 1.0, 2.0]})
        assert many.status == ["done"] * 3
        result = {name: many[name][1] for name in ("y", "v")} | {"t": many.t}
    else:
        result = stribeck.simulate(data)
        assert result.status == "done"
    damping, k, n = 30.4, 1.1e5, 1e4
    a, w = damping / 2, np.sqrt(k - damping**2 / 4)
    decay, t = np.exp(-a * result["t"]), result["t"]
    y = n * size / k * (1 - decay * (np.cos(w * t) + a / w * np.sin(w * t)))
    v = n * size / w * decay * np.sin(w * t)
    slip = 10 * size * n / 1.5  # by which |v| z/g bends the elastic motion, on the way there and back
    assert np.max(abs(result["y"] - y)) <= (1e-6 + slip) * np.max(abs(y))
    assert np.max(abs(result["v"] - v)) <= (1e-6 + slip) * np.max(abs(v))


def test_a_force_that_is_a_small_difference_of_large_terms():
    """sigma_1 m(0)/F_s = 4e9: errors of z are multiplied by it. The body follows the force slowly, so F is known: with
    z = v g/m the bristles' rate is (g/m)' v' z/v, and F = sigma_0 g v/m + sigma_2 v + 2nd order."""
    p = {"sigma_0": 2e5, "sigma_1": 7.7e4, "sigma_2": 1.2e-3, "F_c": 3.9e-6, "F_s": 7.2e-6, "v_s": 3.4e-6}
    drive = {"kind": "force", "signal": {"kind": "step", "value": 7.7e-6, "time": 2.8}}
    solution = stribeck.simulate(scenario({"name": "lugre_majorant", "k_v": 1.7, "parameters": p}, drive, 35.0, 7.4))
    v, t = solution["v"], solution.t
    later = t > 3.0
    g = (p["F_c"] + (p["F_s"] - p["F_c"]) * np.exp(-((v / p["v_s"]) ** 2))) / p["sigma_0"]
    m = v * 2 / np.pi * np.arctan(1.7 * v) + 2 / (np.pi * 1.7)
    acceleration = (7.7e-6 - solution["F"]) / 35.0
    expected = p["sigma_0"] * v * g / m + p["sigma_2"] * v + p["sigma_1"] * np.gradient(v * g / m, t, edge_order=2)
    assert solution.status == "done"
    assert np.max(abs(acceleration)) <= 1.01 * 7.7e-6 / 35.0
    assert np.max(abs(solution["F"] - expected)[later][2:-2]) <= 1e-3 * np.max(abs(expected[later]))


REFERENCES = sorted((Path(__file__).parent / "accuracy").glob("*.toml"))


@pytest.mark.parametrize("path", REFERENCES, ids=lambda path: path.stem)
def test_a_motion_that_was_wrong_agrees_with_extended_precision(path):
    """Equations written apart, a 64-bit mantissa, Radau IIA of five stages, 1e-12; F was off by up to 440 peaks."""
    expected = np.genfromtxt(path.with_suffix(".csv"), delimiter=",", names=True)
    solution = stribeck.simulate(path)
    assert solution.status == "done"
    rows = np.rint(expected["t"] / solution.scenario.output.step).astype(int)
    for name, most in (("y", 1e-6), ("v", 1e-6), ("F", 1e-4)):
        assert np.max(abs(solution[name][rows] - expected[name])) <= 0.2 * most * np.max(abs(expected[name])), name


def test_what_rounding_forbids_is_said():
    """F is 1e-15 of the terms that it is the difference of: no double holds it."""
    p = {"sigma_0": 1e5, "sigma_1": 1e16, "sigma_2": 0.0, "F_c": 1e-6, "F_s": 1.5e-6, "v_s": 1e-3}
    drive = {"kind": "force", "signal": {"kind": "step", "value": 1e-6, "time": 0.01}}
    data = scenario({"name": "lugre_majorant", "k_v": 0.1, "parameters": p}, drive, 1.0, 0.1)
    with warnings.catch_warnings(record=True) as notes:
        warnings.simplefilter("always", StribeckNote)
        solution = stribeck.simulate(data)
    assert solution.status == "done"
    assert any("F to 0.0001 of the peak" in str(note.message) for note in notes)


def pushed_to_the_top(lacking):
    """A pendulum pushed just over its top, where errors grow by 1/lacking: its tables, and its angle by elliptic functions."""
    speed = float(2 / np.sqrt(1 - lacking))
    data = {
        "schema": 2, "bodies": {"arm": {"inertia": 1.0, "initial": {"y": 0.0, "v": speed}}},
        "loads": {"gravity": {"on": "arm", "kind": "pendulum", "amplitude": 1.0}},
        "solve": {"t_end": 20.0}, "output": {"step": 0.1},
    }  # fmt: skip
    return data, lambda t: 2 * ellipj(speed * t / 2, 4 / speed**2)[3]


@pytest.mark.parametrize("backend", ["auto", "wasm", "lanes"])
def test_errors_that_grow_along_the_motion_get_smaller_tolerances(backend, monkeypatch):
    """In one pass y was off by up to 7e-5 of its peak: small errors decide when it leaves the top."""
    monkeypatch.setenv("STRIBECK_BACKEND", "auto" if backend == "lanes" else backend)
    data, angle = pushed_to_the_top(1e-6)
    if backend == "lanes":
        many = stribeck.simulate(data, {"bodies.arm.inertia": [1.0, 1.1]})
        t, y = many.t, many["arm.y"][0]
    else:
        solution = stribeck.simulate(data)
        assert solution.message.startswith("done")
        assert "accuracy" not in solution.message
        t, y = solution.t, solution["arm.y"]
    assert np.max(abs(y - angle(t))) <= 1e-7 * np.max(y)


def test_lanes_whose_end_alone_counts_are_not_mended():
    """How a loop ends is judged without, in a third of the steps."""
    data, _ = pushed_to_the_top(1e-6)
    mended, once = (simulate_ensemble(data, {"bodies.arm.inertia": [1.0]}, growth=growth) for growth in (True, False))
    assert 2 * once.accepted[0] < mended.accepted[0]
    assert np.max(abs(once["arm.y"] - mended["arm.y"])) < 1e-3


@pytest.mark.parametrize("lacking", [0.0, 1e-13])
def test_errors_that_grow_beyond_any_tolerance_are_said(lacking):
    """Which way the pendulum falls, or when, rounding decides."""
    with pytest.warns(StribeckNote, match=r"arm.y, arm.v to 1e-06 of the peak; small errors grow too much"):
        stribeck.simulate(pushed_to_the_top(lacking)[0])


@pytest.mark.parametrize("backend", ["auto", "wasm"])
def test_lanes_beyond_the_promise_are_counted_as_single_runs_are(backend, monkeypatch):
    """A lane of a batch missed it without a word."""
    monkeypatch.setenv("STRIBECK_BACKEND", backend)
    data = pushed_to_the_top(1e-6)[0]
    speeds = [data["bodies"]["arm"]["initial"]["v"], pushed_to_the_top(1e-13)[0]["bodies"]["arm"]["initial"]["v"]]
    vary = {"bodies.arm.initial.v": speeds}
    with pytest.warns(StribeckNote, match="^1 of 2 lanes do not reach the promised accuracy$"):
        many = stribeck.simulate(data, vary)
    assert many.inaccurate.tolist() == [False, True]
    assert many.message == "2 of 2 lanes done; 1 of 2 lanes do not reach the promised accuracy"
    with pytest.warns(StribeckNote, match="accuracy not reached"):
        singles = [stribeck.simulate(stribeck.Scenario(data).with_changes({"bodies.arm.initial.v": v})) for v in speeds]
    assert [single.inaccurate for single in singles] == [False, True]


def test_a_body_within_the_play_of_a_link_stays_where_it_is():
    """The damper of the play acts in contact only, and so do its derivatives: at rest on both sides they did not."""
    law = {"name": "lugre_majorant", "k_v": 1e4, "parameters": NEARLY}
    data = {
        "schema": 2, "bodies": {"pushed": {"mass": 1.0}, "free": {"mass": 1.0}},
        "links": {"coupling": {"from": "pushed", "to": "free", "stiffness": 1e3, "damping": 10.0, "gap": 1.0}},
        "contacts": {"guide": {"from": "free", "law": law}},
        "loads": {"push": {"on": "pushed", "kind": "signal", "signal": {"kind": "ramp", "rate": 1.0}}},
        "solve": {"t_end": 1.0}, "output": {"step": 0.1},
    }  # fmt: skip
    solution = stribeck.simulate(data)
    assert solution.peaks["pushed.y"] > 0.1
    assert not np.any(solution["free.y"])
    assert not np.any(solution["guide.F"])
    assert "accuracy" not in solution.message


@pytest.mark.parametrize("share", [1e-5, 1e-10, 1e-16])
def test_a_body_that_moves_far_less_than_another(share):
    """It has the promised accuracy of its own peak down to 1e-12 of the largest motion, and then that of this size."""
    law = {"name": "lugre", "parameters": NEARLY}
    data = {
        "schema": 2, "bodies": {"large": {"mass": 1.0}, "small": {"mass": 1e-3}},
        "contacts": {"one": {"from": "large", "law": law}, "two": {"from": "small", "law": law}},
        "loads": {
            f"on_{name}": {"on": name, "kind": "signal", "signal": {"kind": "step", "value": value, "time": 0.0}}
            for name, value in (("large", 1.0), ("small", share))
        },
        "solve": {"t_end": 0.05}, "output": {"step": 5e-4},
    }  # fmt: skip
    solution = stribeck.simulate(data)
    assert (solution.stats["accepted"] < 250) == (share < 1e-12)  # no second run for what is rounding
    a, w = 30.4 / 2e-3, np.emath.sqrt(1e5 / 1e-3 - (30.4 / 2e-3) ** 2)
    y = share / 1e5 * (1 - np.exp(-a * solution.t) * (np.cos(w * solution.t) + a / w * np.sin(w * solution.t))).real
    slip = 10 * share  # by which |v| z/g bends the elastic motion
    assert np.max(abs(solution["small.y"] - y)) <= (1e-6 + slip) * max(np.max(y), 1e-12 * solution.peaks["large.y"])
    assert "accuracy" not in solution.message


def test_a_tolerance_of_the_file_stays():
    """solve.atol is the user's: it is neither tightened nor complained about."""
    given = {"y": 1e-9, "v": 1e-9, "z": 1e-9}
    loose, tight = (stribeck.simulate(stepped(1e-13, **more)) for more in ({"atol": given}, {}))
    assert loose.stats["accepted"] < 0.5 * tight.stats["accepted"]


EDGE = Path(__file__).parent / "near_an_edge.toml"  # at rtol 1e-8 a reading falls off the edge of a count


def test_a_reading_near_the_edge_of_a_count():
    """Two tolerances differ, and finer runs follow until two agree."""
    result, fine = (stribeck.simulate(stribeck.load(EDGE), **more) for more in ({}, {"rtol": 1e-11}))
    assert result.message.startswith("done")
    for name, share in (("rotor.y", 1e-6), ("rotor.v", 1e-6), ("arm.y", 1e-6), ("bearing.F", 1e-4), ("seal.F", 1e-4)):
        assert np.max(abs(result[name] - fine[name])) <= 0.1 * share * np.max(abs(fine[name]))


def test_readings_that_no_tolerance_settles_are_said(monkeypatch):
    """Where the finest run still differs from the one before."""
    monkeypatch.setattr(counts, "_FINEST", 1e-9)
    with pytest.warns(StribeckNote, match="less differ by more than 1e-06 of the peak; counts of an encoder"):
        solution = stribeck.simulate(stribeck.load(EDGE))
    assert "counts of an encoder" in solution.message
    finest = stribeck.simulate(stribeck.load(EDGE), rtol=1e-9)  # none is finer, and a looser one says nothing of it
    assert "counts of an encoder" not in finest.message


def test_lanes_go_over_no_narrow_peak():
    """As a single run: a step that takes the speed past v_s on both sides ends at rest instead."""
    path = Path(__file__).parent / "accuracy" / "narrow_peak.toml"
    data = stribeck.load(path)
    many, one = stribeck.simulate(data, {"plant.mass": [5890.0, 5890.0]}), stribeck.simulate(data)
    assert np.max(abs(many["y"][1] - one["y"])) <= 1e-8 * np.max(abs(one["y"]))

"""Trajectories in the lanes of vectors: the functions written for them, and every width of the vectors."""

import ctypes
import time
from dataclasses import replace

import numpy as np
import pytest

from stribeck import Scenario, simulate
from stribeck.codegen import source
from stribeck.errors import BuildError
from stribeck.simulation import cache, compiler, lanes
from stribeck.simulation.promise import Tolerances
from stribeck.simulation.variations import Variations
from tests.simulation.rig import needs_compiler, rig, spring

pytestmark = needs_compiler

DATA = rig("lugre_sobczyk", spring("canudas1995"), {"kind": "ramp", "rate": 0.3}, 6.0)
OPERATION = """
EXPORT void stribeck_{0}(double *x)
{{
    real values;
    for (int lane = 0; lane < LANES; lane++) values[lane] = x[lane];
    values = {0}_of(values);
    for (int lane = 0; lane < LANES; lane++) x[lane] = values[lane];
}}
"""
OPERATIONS = "".join(map(OPERATION.format, ("exp", "atan", "sign")))
VALUES = {"law.k_v": np.geomspace(1e6, 1e8, 11), "law.parameters.F_s": np.linspace(1.1, 1.9, 11)}


def library(*options):
    chosen = compiler.find().for_lanes()
    result, _ = cache.library(
        source(Scenario(DATA).system, lanes=True) + OPERATIONS, replace(chosen, options=(*chosen.options, *options))
    )
    lanes.check(result)
    return result


def evaluated(name, x):
    """The values of a function of runtime/vector.c, a vector after the other."""
    loaded = library()
    width = loaded.stribeck_lanes()
    padded = np.concatenate([x, np.zeros(-len(x) % width)])
    for part in padded.reshape(-1, width):
        getattr(loaded, name)(part.ctypes.data_as(ctypes.POINTER(ctypes.c_double)))
    return padded[: len(x)]


def ulps(found, exact):
    """How many units in the last place the values are off."""
    return np.abs((found - exact) / np.spacing(np.abs(exact.astype(float))))


@pytest.mark.skipif(np.finfo(np.longdouble).eps > 1e-18, reason="needs a longer number to compare with")
@pytest.mark.parametrize(("name", "exact"), [("stribeck_exp", np.exp), ("stribeck_atan", np.arctan)])
def test_functions_are_within_two_units_in_the_last_place(name, exact):
    random = np.random.default_rng(2)
    signs = random.choice([-1.0, 1.0], 20000)
    small = signs * 10 ** random.uniform(-300, 2.8, 20000)
    x = np.concatenate([random.uniform(-700, 700, 20000), random.uniform(-3, 3, 20000), small])
    if name == "stribeck_atan":
        seams = [signs * random.uniform(c, 1.005 * c, 20000) for c in (np.tan(np.pi / 8), np.tan(3 * np.pi / 8))]
        x = np.concatenate([x, signs * 10 ** random.uniform(2, 300, 20000), *seams])  # the first: 2.3 were missed there
    assert ulps(evaluated(name, x), exact(x.astype(np.longdouble))).max() <= 2.0


def test_functions_at_the_ends():
    ends = np.array([0.0, -0.0, -701.0, -1e300, -np.inf, 0.66, 2.4142135623730951])
    assert np.array_equal(evaluated("stribeck_exp", ends)[:5], [1, 1, 0, 0, 0])
    np.testing.assert_allclose(evaluated("stribeck_atan", ends), np.arctan(ends), rtol=4e-16)
    assert np.array_equal(evaluated("stribeck_sign", ends), np.sign(ends))
    assert np.all(np.isnan(evaluated("stribeck_atan", np.array([np.nan]))))


def test_a_lane_without_a_trajectory_costs_no_more_than_one_with():
    scenario, loaded = Scenario({**DATA, "output": {"step": 2e-4}}), library()

    def seconds(count):
        variations = Variations(scenario, {"law.k_v": np.full(count, 1e7)})
        tolerances, taken = Tolerances(variations.atol(), np.ones(count), rows_are_steps=True), []
        for _ in range(3):
            start = time.process_time()
            lanes.lane_solver(loaded, 1)(variations, None, tolerances)
            taken.append(time.process_time() - start)
        return min(taken)

    assert seconds(1) < 2 * seconds(loaded.stribeck_lanes())  # 90 times, if each row is looked for from the first on


def test_each_row_ends_a_step_where_that_is_asked_for():
    scenario = Scenario({**DATA, "output": {"step": DATA["solve"]["t_end"] / 3000}})
    variations = Variations(scenario, {"law.k_v": np.array([1e6, 1e7])})
    tolerances = Tolerances(variations.atol(), np.ones(2), rows_are_steps=True)
    result = lanes.lane_solver(library(), 1)(variations, None, tolerances)
    assert np.all(result.counts["accepted"] >= scenario.rows - 1)


@pytest.mark.share(2)
@pytest.mark.parametrize("width", [2, 4, 8])
def test_every_width_agrees_with_single_runs(width):
    """Eleven lanes: the queue is refilled, and ends with lanes that have nothing to do."""
    variations = Variations(Scenario(DATA), VALUES)
    loaded = library(f"-DLANES={width}")
    assert loaded.stribeck_lanes() == width
    solution = lanes.solve(lanes.lane_solver(loaded, 1), variations)
    for lane in range(len(variations)):
        alone = simulate(Scenario(DATA).with_changes(variations.changes(lane)))
        peaks = np.abs(alone.states).max(axis=0)
        assert np.all(np.abs(solution.states[lane] - alone.states) <= 1e-7 * peaks)
        assert solution.counts["happened"][lane, 0, 0] == len(alone.events["slip"])
        steps = alone.stats["accepted"] + alone.stats["rejected"]
        assert abs(solution.counts["accepted"][lane] + solution.counts["rejected"][lane] - steps) < 0.05 * steps


def test_a_trajectory_that_follows_another_in_its_lane_is_looked_at_from_its_own_start():
    """Looked at from where the other ended, it would be said to get on no more."""
    text = source(Scenario(DATA).system, lanes=True)
    often = text.replace("LOOK = 1000000", "LOOK = 100")
    assert often != text
    chosen = compiler.find().for_lanes()
    loaded, _ = cache.library(often, replace(chosen, options=(*chosen.options, "-DLANES=2")))
    solution = lanes.solve(lanes.lane_solver(loaded, 1), Variations(Scenario(DATA), VALUES)).counts
    assert not solution["status"].any()
    assert (solution["accepted"] > 200).all()


def test_one_vector_and_several_by_turns_make_the_same_bits():
    loaded, result = library(), []
    many = {path: np.resize(x, 32) for path, x in VALUES.items()}
    for groups in (1, 2, 3, 1000):
        built = lanes.lane_arrays(Variations(Scenario(DATA), many))
        built.batch.groups = groups
        loaded.stribeck_solve_batch(ctypes.byref(built.batch))
        result.append(lanes.outcome(built))
    assert np.all(np.isfinite(result[0].states))
    for other in result[1:]:
        np.testing.assert_array_equal(other.states, result[0].states)
        np.testing.assert_array_equal(other.counts["accepted"], result[0].counts["accepted"])


def test_a_library_of_another_kind_is_refused():
    other, _ = cache.library(source(Scenario(DATA).system), compiler.find())
    with pytest.raises(BuildError, match="not a compiled system for lanes"):
        lanes.check(other)


def test_nothing_is_written_outside_the_rows():
    """Lanes for which no trajectory was left wrote before the first row where times passed 1e300."""
    data = rig("lugre_sobczyk", spring("canudas1995"), {"kind": "ramp", "rate": 0.0}, 99e300)
    few = Variations(Scenario(data | {"output": {"step": 1e300}}), {"law.k_v": np.array([1e6, 1e7])})
    built = lanes.lane_arrays(few)
    out = built.by_name["out"]
    guarded = np.full(3 * out.size, 1.25)
    inside = guarded[out.size : 2 * out.size]
    inside[:] = np.nan
    built.batch.out = inside.ctypes.data
    lanes._run(library(), built, 1, None)
    assert lanes.outcome(built).counts["status"].tolist() == [0, 0]
    assert (guarded[: out.size] == 1.25).all()
    assert (guarded[2 * out.size :] == 1.25).all()
    assert np.isfinite(inside).all()


def test_a_lane_is_the_same_beside_any_others():
    """Also what decides whether a lane is solved again: a neighbor that wrote a row counted once for all."""
    slips = {**rig("lugre_majorant", spring("canudas1995"), {"kind": "ramp", "rate": 0.1}, 20.0, rows=200)}
    stiffness = np.linspace(1.0, 3.0, 16)
    together = simulate(slips, {"drive.stiffness": stiffness}, threads=1)
    order = np.random.default_rng(0).permutation(len(stiffness))
    permuted = simulate(slips, {"drive.stiffness": stiffness[order]}, threads=1)
    np.testing.assert_array_equal(permuted["y"], together["y"][order])
    for lane in range(0, len(stiffness), 3):
        alone = simulate(slips, {"drive.stiffness": stiffness[lane : lane + 1]}, threads=1)
        np.testing.assert_array_equal(alone["y"][0], together["y"][lane])

"""The estimator on records whose truth is known."""

import numpy as np
import pytest

from stribeck.identify.core.judging import judged
from stribeck.identify.core.states import Estimate, EstimateState
from stribeck.identify.log import Log
from stribeck.identify.models.curves import SteadyCurve
from stribeck.identify.models.forms import in_words, sliding
from stribeck.identify.models.over_position import ripple_waves
from stribeck.identify.models.predictor import of_json, predictor
from stribeck.identify.models.record import record_of, rows_of, shortened
from stribeck.identify.models.steady import chosen, library, optimum, refine
from stribeck.laws import find
from tests.identify.core.records import TRUTH, joined, record


def choice_of(log, laws=("stribeck",), terms=("offset",), given=None, **asked):
    given = given or {}
    curves = [SteadyCurve(law, given, ()) for law in laws]
    record = record_of(rows_of(log), terms, given)
    return chosen(record, curves, **asked)


def inside(e, truth, how="interval"):
    low, high = getattr(e, how)
    return low <= truth <= high


@pytest.fixture(scope="module")
def plain():
    """The choice on a record that lacks nothing."""
    return choice_of(record())


def test_a_complete_law_is_identified_and_its_intervals_hold_the_truth(plain):
    fitted = judged(plain)
    for name, truth in TRUTH.items():
        assert inside(fitted[name], truth, "range"), name
    assert all(fitted[n].state is EstimateState.IDENTIFIED for n in ("mass", "F_c", "F_s", "sigma_2", "offset"))
    assert sum(inside(fitted[n], x) for n, x in TRUTH.items()) >= len(TRUTH) - 1


def test_an_open_end_is_none_in_json():
    bound = Estimate(1.5, (0.5, np.inf), (0.25, np.inf), EstimateState.AT_LEAST, unit="N", why="no slow rows")
    reported = bound.to_dict()
    assert (reported["low"], reported["high"], reported["range"]) == (0.5, None, [0.25, None])
    assert (reported["state"], reported["why"], "experiment" in reported) == ("at least", "no slow rows", False)


def test_levels_at_seen_speeds_are_estimates(plain):
    result, speeds = judged(plain), plain.library.at.speeds
    for name, v in zip(("level slow", "level middle", "level half", "level fast"), speeds, strict=True):
        truth = TRUTH["F_c"] + (TRUTH["F_s"] - TRUTH["F_c"]) * np.exp(-((v / TRUTH["v_s"]) ** 2)) + TRUTH["sigma_2"] * v
        assert inside(result[name], truth, "range")
        assert result[name].state is EstimateState.IDENTIFIED


def test_what_the_law_lacks_is_chosen_from_the_table_of_forms():
    log = record(3, extra=lambda t, y, v, a: 25.0 * y)
    choice = choice_of(log)
    assert "spring" in choice.model[1]
    fitted = judged(choice)
    assert inside(fitted["F_c"], TRUTH["F_c"], "range")
    assert inside(fitted["mass"], TRUTH["mass"], "range")


def test_without_slow_rows_the_static_friction_is_a_lower_bound_that_is_never_below_the_coulomb_level():
    log = record(4)
    log = log.rows(abs(log.velocity) > 0.06)
    log = log.with_columns(run=np.cumsum(np.diff(log.time, prepend=log.time[0]) > 1.5 * log.step).astype(np.int32))
    fitted = judged(choice_of(log))
    f_s, v_s = fitted["F_s"], fitted["v_s"]
    assert f_s.state is EstimateState.AT_LEAST
    assert v_s.state is EstimateState.AT_MOST
    assert f_s.value >= fitted["F_c"].value
    assert f_s.interval[0] >= fitted["F_c"].interval[0]
    assert f_s.interval[1] == np.inf


def test_a_fit_that_leaves_a_quarter_of_the_force_identifies_nothing():
    log = record(5, noise=4.0)
    fitted = judged(choice_of(log))
    assert not any(e.state is EstimateState.IDENTIFIED for e in fitted.values())


def test_a_number_that_one_file_alone_shows_is_as_certain_as_there():
    """Of two files, one moves too slowly for the mass."""
    mass = judged(choice_of(joined(record(6, slow=0.05), record(7))))["mass"]
    assert inside(mass, 2.0)
    assert np.diff(mass.interval) < 0.05


def test_the_spread_between_files_is_in_the_interval():
    levels = (4.6, 5.0, 5.4)
    choice = choice_of(joined(*(record(6 + i, F_c=x, F_s=x + 3) for i, x in enumerate(levels))))
    assert set(choice.library.files) == {0, 1, 2}  # of its blocks, none over two files
    apart = judged(choice)["F_c"]
    alike = judged(choice_of(joined(*(record(6 + i) for i in range(3)))))["F_c"]
    assert np.diff(apart.interval) > 5 * np.diff(alike.interval)
    assert inside(apart, 5.0)


LEVELS = {"F_c": 1.0, "F_s": 1.5, "v_s": 1e-2, "sigma_2": 0.0}


@pytest.mark.parametrize("size", [0.3, 3.0])
@pytest.mark.parametrize(
    ("name", "own"),
    [
        ("coulomb_viscous", {"k_v": 300.0}), ("stribeck", {}), ("stribeck", {"k_v": 300.0, "delta": 1.3}),
        ("stribeck_tanh", {"k_v": 300.0}),
    ],
)  # fmt: skip
def test_a_curve_is_the_steady_force_of_its_law(name, own, size):
    values = {n: size * x if n in ("F_c", "F_s") else x for n, x in LEVELS.items() if n in find(name).constants()} | own
    curve = SteadyCurve(name, own, ())
    v, shape = np.array([-0.05, -1e-3, 1e-4, 2e-3, 0.03]), {n: values[n] for n in curve.shapes}
    of = values | {"rise": 0.5 * size}
    result = curve.force(v, shape, of)
    steep = {} if "k_v" in own else {"k_v": 1e15}  # an exact sign
    assert result == pytest.approx(find(name)(values | steep).steady_force(v), rel=1e-5)


def test_given_constants_are_taken_off_the_force():
    given = {"mass": 2.0, "sigma_2": 12.0, "offset": 0.7}
    fitted = judged(choice_of(record(9), given=given))
    assert not given.keys() & fitted.keys()
    assert inside(fitted["F_c"], 5.0, "range")
    assert inside(fitted["v_s"], 0.05, "range")


def test_the_law_is_chosen_first():
    choice = choice_of(record(10), laws=("coulomb_viscous", "stribeck"))
    assert choice.library.curve.law == "stribeck"
    plain = choice_of(record(11, F_s=5.0), laws=("coulomb_viscous", "stribeck"))
    assert plain.library.curve.law == "coulomb_viscous"


def test_nodes_at_the_optima_leave_little_of_the_grid_s_error():
    log = record(3, noise=0.0, end=8.0, extra=lambda t, y, v, a: 25.0 * y)
    lib = library(record_of(rows_of(log), ("offset",), {}), SteadyCurve("stribeck", {}, ()))
    before = lib.solve(lib.gram.sum(0))[1].min()
    refine(lib, len(log))
    assert lib.solve(lib.gram.sum(0))[1].min() < 0.5 * before
    lib = library(record_of(rows_of(log := record(1, end=8.0)), ("offset",), {}), SteadyCurve("stribeck", {}, ()))
    grid = len(lib.nodes)
    refine(lib, len(log))
    assert lib.models[int(np.argmin(lib.scores(lib.solve(lib.gram.sum(0))[1], len(log))))][0] >= grid


@pytest.mark.parametrize(("F_s", "possible"), [(8.0, True), (4.0, False)])
def test_forms_are_those_about_the_optimum_of_the_law_alone_if_that_is_possible(F_s, possible):
    """Where the level rises with speed, the optimum has F_s below F_c: the best node of the grid takes its place."""
    log = record(3, noise=0.0, end=4.0, F_s=F_s)
    lib = library(record_of(rows_of(log), ("offset",), {}), SteadyCurve("stribeck", {}, ()))
    *grid, v_s = (node["v_s"] for node in lib.nodes)
    assert (v_s in grid) is not possible
    assert v_s == pytest.approx(TRUTH["v_s"], rel=1e-6) or not possible


def test_the_largest_ripples_within_the_range_are_found_largest_first():
    y = np.linspace(-0.1, 0.3, 4000)
    left = sum(size * np.sin(wave * y) for size, wave in ((9.0, 40.0), (1.0, 500.0), (2.0, 350.0), (3.0, 200.0)))
    for most in (1, 2, 3):
        assert ripple_waves(y, left, 90.0, 800.0, most) == pytest.approx([200.0, 350.0, 500.0][:most], rel=0.02)


def test_slopes_are_taken_about_coefficients_that_are_not_0():
    assert SteadyCurve("stribeck", {}, ()).anchored([5.0, 0.0]) == {"F_c": 5.0, "rise": 0.5}


def test_rows_about_reversals_do_not_count_unless_hardly_another_is_left():
    for log, ringing in ((record(3), 4), (record(3, slow=10, end=4.0), 0)):
        rows = rows_of(log)
        assert len(record_of(rows, (), {}).at) == np.count_nonzero(rows.moving) - ringing
        assert len(record_of(rows, (), {}, all_rows=True).at) == np.count_nonzero(rows.moving)


def test_a_column_that_is_given_twice_shares_its_coefficient():
    rows = record_of(rows_of(record(3)), ("offset",), {})
    lib, body = library(rows, SteadyCurve("stribeck", {}, ())), np.column_stack([*rows.body.values()])
    once, twice = (optimum(lib.law, lib.nodes[0], body[:, at], rows.force)[1] for at in ([0, 1, 2], [0, 1, 2, 2]))
    assert twice == pytest.approx([*once[:-1], *once[-1:] / 2, *once[-1:] / 2], rel=1e-6)


def test_a_very_long_record_is_predicted_from_stretches_of_it(plain):
    log, other = record(), record(14, noise=0.0)
    stretches = shortened(log, len(log) // 3)
    whole, part = predictor(plain, log, 0.0), predictor(choice_of(stretches), stretches, 0.0)
    assert part.error == pytest.approx(whole.error, rel=0.1)
    assert 0 < np.linalg.norm(part.force(other) - whole.force(other)) < 0.01 * np.linalg.norm(other.force)


def test_a_level_that_one_direction_does_not_tell_from_the_offset_is_not_blown_up():
    """Their columns are equal but for rounding, and another motion has both directions."""
    t, other = 0.01 * np.arange(1500), record(12)
    v, a = 0.2 + 0.1 * np.sin(2 * t), 0.2 * np.cos(2 * t)
    force = 5.7 + 2.0 * a + 12.0 * v + 0.05 * np.random.default_rng(3).standard_normal(len(t))
    log = Log(t, 0.2 * t - 0.05 * np.cos(2 * t), v, a, force, np.zeros(len(t), np.int32), step=0.01)
    built = predictor(choice_of(log, laws=("coulomb_viscous",)), log, 0.0)
    assert np.linalg.norm(built.force(other) - other.force) < 2 * np.linalg.norm(other.force)


def test_stretches_of_a_long_record_belong_to_its_files():
    """The first file's only run was shorter than the settling of the filter: it has a name, and no rows."""
    log = record()
    run = 1 + (np.arange(len(log)) > len(log) // 3).astype(np.int32)
    both = log.with_columns(run=run, files=("lost.csv", "a.csv", "b.csv"))
    stretches = shortened(both, len(log) // 3)
    at = [int(np.searchsorted(log.time, stretches.time[rows.start])) for rows in stretches.runs()]
    assert list(stretches.files) == ["a.csv" if i <= len(log) // 3 else "b.csv" for i in at]
    assert len(set(stretches.files)) == 2


@pytest.mark.parametrize("extra", [lambda t, y, v, a: 0.0, lambda t, y, v, a: 25.0 * y])
def test_the_prediction_of_another_motion_survives_a_file(extra):
    built = predictor(choice_of(record(13, extra=extra)), record(13, extra=extra), 0.0)
    other = record(14, extra=extra, noise=0.0)
    error = np.linalg.norm(built.force(other) - other.force) / np.linalg.norm(other.force)
    assert error < 0.03
    assert np.allclose(of_json(built.to_json()).force(other), built.force(other))


def test_creep_within_the_presliding_of_a_dwell_is_no_sliding():
    """Half of the rows creep by microns, where the force is a spring's: as sliding it made the slow level 27.7 N."""
    t, z = 2e-3 * np.arange(9000), np.zeros(9000)
    v = np.where((t / 3) % 1 < 0.5, 0.3 * np.sin(8 * np.pi * t / 3), 2e-4 * np.sin(3 * t))
    for i in range(1, len(t)):
        z[i] = np.clip(z[i - 1] + 1e-3 * (v[i] + v[i - 1]), -4e-5, 4e-5)
    y, a, noise = np.cumsum(v) * 2e-3, np.gradient(v, 2e-3), 0.05 * np.random.default_rng(2).standard_normal(len(t))
    log = Log(t, y, v, a, 2.0 * a + 2.5e5 * z + 5.0 * v + noise, np.zeros(len(t), np.int32), step=2e-3)
    fitted = judged(choice_of(log, laws=("coulomb_viscous",)))
    assert [fitted[n].value for n in ("F_c", "mass", "level slow")] == pytest.approx([10.0, 2.0, 10.0], rel=0.02)


def test_what_the_model_leaves_unexplained_may_be_a_hidden_form():
    """An axis with 18 % of systematic residual had a slow level of 13.5 [12.6, 14.4] N, for 18.8 N."""
    logs = record(3, extra=lambda t, y, v, a: 1.5 * np.sin(17 * t)), record(3, noise=1.06)
    swings, white = (judged(choice_of(log), draws=1)["F_c"].parts["H"] for log in logs)
    assert swings > 2 * white


def test_within_a_smooth_sign_a_speed_is_seen_in_part():
    """The slow level of a LuGre axis, 9.0 [7.8, 10.3] N for 11.8 N, was that of a sign that a filter had made smooth."""
    log, curve = record(1), SteadyCurve("stribeck_tanh", {"k_v": 20.0}, ())
    at = library(record_of(rows_of(log), ("offset",), {}), curve).at
    assert sliding(log, at, ()) == pytest.approx(abs(np.tanh(20 * log.velocity)))


def test_a_form_is_named_in_words():
    assert in_words("growth 3.0") == "friction that grows with the speed to the power 3"
    assert in_words("bend 0.05 square") == "a friction peak below 5 % of the top speed"
    assert in_words("clock drift of the force") == "clock drift of the force"

"""Fits by simulation on synthetic logs with known truth."""

import numpy as np
import pytest

import stribeck
from stribeck.errors import InputError
from stribeck.identify.log import Log
from stribeck.identify.methods.dynamic import fit_dynamic
from stribeck.identify.models.dynamic_problem import velocity_problem
from stribeck.identify.models.problem import Tie
from stribeck.identify.synthetic import Slider
from tests.identify import rig

RIG = {"mass": 0.0, "starts": 3}


@pytest.fixture(scope="module")
def full():
    return rig.measured([*rig.LOOPS, *rig.STROKES])


def test_every_parameter_of_lugre_is_found(full):
    fit = fit_dynamic(full, "lugre", mass=0.0)
    assert fit.unidentified == ()
    for name, truth in rig.TRUTH.items():
        assert fit.estimates[name].value == pytest.approx(truth, rel=0.02), name
        assert fit.estimates[name].low < fit.estimates[name].value < fit.estimates[name].high
    noise = 0.1 / np.sqrt(np.mean(full.force**2))
    assert fit.relative_force_error == pytest.approx(noise, rel=0.05)
    assert "best of 20 starts ended in this minimum" in fit.details["search"]
    assert int(fit.details["search"].split()[0]) >= 5


@pytest.mark.thorough
def test_sigma_0_from_presliding_with_one_percent_noise_is_within_five_percent():
    fit = fit_dynamic(rig.measured([rig.loop(size, 4.0, 3) for size in (4e-6, 8e-6, 2e-5)]), "lugre", **RIG)
    assert fit.estimates["sigma_0"].identifiable
    assert fit.estimates["sigma_0"].value == pytest.approx(1e6, rel=0.05)
    sliding = fit.estimates["sigma_2"]  # what the log does not hold is not printed as if known
    assert not sliding.identifiable
    assert "constant speeds" in sliding.experiment


def test_a_log_without_presliding_leaves_the_bristles_open():
    fit = fit_dynamic(rig.held_at(0.05), "lugre", fixed={"offset": 0.0}, **RIG)
    for name in ("sigma_0", "sigma_1"):
        assert not fit.estimates[name].identifiable
        assert "no presliding" in fit.estimates[name].why
        assert "reversals" in fit.estimates[name].experiment
    assert fit.estimates["sigma_2"].value == pytest.approx(30.0, rel=0.05)
    assert "sigma_0" not in fit.values
    with pytest.raises(InputError, match=r"sigma_0: not identifiable: .*reversals"):
        fit.law()


def test_a_reversal_between_two_samples_is_no_presliding(full):
    rare = full.rows(slice(None, None, 40)).with_columns(step=0.04)
    fit = fit_dynamic(rare, "lugre", **RIG)
    assert not fit.estimates["sigma_0"].identifiable


def test_mass_spring_and_offset_are_told_apart():
    log = rig.measured([*rig.LOOPS, *rig.STROKES], body=Slider(mass=2.0, stiffness=500.0, offset=3.0))
    fit = fit_dynamic(log, "lugre", body=("offset", "stiffness"), starts=3)
    for name, truth in (("mass", 2.0), ("stiffness", 500.0), ("offset", 3.0)):
        assert fit.body[name].value == pytest.approx(truth, rel=0.03), name
        assert fit.body[name].low < truth < fit.body[name].high
    assert fit.estimates["F_c"].value == pytest.approx(10.0, rel=0.01)


def test_friction_that_grows_with_load():
    log = rig.measured([*rig.LOOPS, *rig.STROKES])
    heavier = rig.measured([*rig.LOOPS, *rig.STROKES], F_c=12.0, F_s=16.0, seed=2)
    both = log.with_columns(
        **{n: np.concatenate([log.columns()[n], heavier.columns()[n]]) for n in log.columns() if n != "run"},
        run=np.repeat(np.array([0, 1], np.int32), len(log)),
        load=np.repeat([0.0, 10.0], len(log)),
    )
    fit = fit_dynamic(both, "lugre", body=("offset", "F_c_by_load"), **RIG)
    assert fit.body["F_c_by_load"].value == pytest.approx(0.2, rel=0.02)
    assert fit.estimates["F_c"].value == pytest.approx(10.0, rel=0.01)


def test_given_and_tied_constants_stay(full):
    fit = fit_dynamic(full, "lugre", fixed={"sigma_2": 30.0}, tied={"F_s": Tie("F_c", 1.4)}, **RIG)
    assert "sigma_2" not in fit.estimates
    assert "F_s" not in fit.estimates
    assert fit.used["F_s"] == pytest.approx(1.4 * fit.used["F_c"])
    assert fit.estimates["F_c"].value == pytest.approx(10.0, rel=0.01)


@pytest.mark.thorough
def test_a_law_constant_is_fitted_when_it_is_freed():
    log = rig.measured([*rig.LOOPS, *rig.STROKES], "elastoplastic_majorant", k_v=1e5, z_ba=5e-6)
    free = [*rig.TRUTH, "z_ba"]
    fit = fit_dynamic(log, "elastoplastic_majorant", fixed={"k_v": 1e5}, free=free, **RIG)
    assert fit.estimates["z_ba"].value == pytest.approx(5e-6, rel=0.05)


def test_the_same_seed_gives_the_same_fit(full):
    first, second = (fit_dynamic(full, "lugre", mass=0.0, starts=3, seed=5, profiles=False) for _ in range(2))
    assert first.to_json() == second.to_json()


def test_derivatives_are_those_of_the_residuals(full):
    problem, u, _, _ = velocity_problem(full, "lugre", body=("offset", "stiffness"))
    slopes = problem.sensitivities(u)
    for k in range(len(u)):
        up, down = u.copy(), u.copy()
        up[k] += 1e-3
        down[k] -= 1e-3
        secant = (problem.misfit(up) - problem.misfit(down)) / 2e-3
        assert slopes[:, k] == pytest.approx(secant, abs=0.02 * np.max(abs(secant))), problem.coordinates[k].name


def test_the_law_s_relations_hold_wherever_the_search_looks(full):
    problem, u, _, _ = velocity_problem(full, "lugre", mass=0.0)
    beyond = problem.point({**problem.values(u), "F_c": 14.0, "F_s": 9.0})
    inside = problem.values(problem.nearest(beyond))
    assert inside["F_s"] >= inside["F_c"]
    assert np.isfinite(problem.residual(beyond)).all()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"law": "lugre_sobczyk"}, "k_v: missing: give its value"),
        ({"fixed": {"F_q": 1.0}}, r"F_q: law 'lugre' has no such constant"),
        ({"tied": {"F_s": Tie("F_x")}}, r"tied.F_s: 'F_x': must be free or fixed"),
        ({"fixed": rig.TRUTH}, "there is nothing to fit"),
        ({"body": ("F_c_by_load",)}, "needs a column: (--)?load"),
        ({"fixed": {"F_c": 10.0, "F_s": 9.0}}, "no values near the data's are allowed"),
    ],
)
def test_what_cannot_be_fitted_is_refused(full, options, message):
    law = options.pop("law", "lugre")
    with pytest.raises(InputError, match=message):
        fit_dynamic(full, law, mass=0.0, **options)


def test_a_log_too_long_for_a_simulation_is_refused(full, monkeypatch):
    monkeypatch.setattr("stribeck.identify.models.dynamic_problem._MOST_ROWS", 1000)
    with pytest.raises(InputError, match=r"rows: a simulation takes at most 1000; .*method static"):
        fit_dynamic(full, "lugre", mass=0.0)


def test_a_log_without_motion_or_force_is_refused(full):
    for column in ("velocity", "force"):
        with pytest.raises(InputError, match=f"{column}: 0 throughout"):
            fit_dynamic(full.with_columns(**{column: np.zeros(len(full))}), "lugre", mass=0.0)


def test_friction_and_offset_in_one_direction_are_not_told_apart():
    """A body pulled by a spring, stick and slip: the force is friction and offset together."""
    machine = stribeck.library().sets["canudas1995"].values
    scenario = stribeck.Scenario(
        law={"name": "lugre", "parameters": machine},
        plant={"mass": 1.0},
        drive={"kind": "spring", "stiffness": 2.0, "signal": {"kind": "ramp", "rate": 0.1}},
        solve={"t_end": 12.0},
        output={"step": 1e-3},
    )
    solution = stribeck.simulate(scenario)
    noise = 0.01 * np.random.default_rng(0).standard_normal(len(solution.t))
    log = Log(
        time=solution.t, position=solution["y"], velocity=solution["v"], acceleration=solution["u"] - solution["F"],
        force=solution["u"] + noise, run=np.zeros(len(noise), np.int32), step=1e-3,
    )  # fmt: skip
    fit = fit_dynamic(log, "lugre", starts=4)
    assert not fit.estimates["F_c"].identifiable
    assert not fit.body["offset"].identifiable
    assert "offset" in fit.estimates["F_c"].why
    known = fit_dynamic(log, "lugre", fixed={"offset": 0.0}, starts=4)
    for name in ("F_c", "F_s"):
        assert known.estimates[name].low < machine[name] < known.estimates[name].high, name

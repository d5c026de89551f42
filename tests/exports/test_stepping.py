"""The step for learning simulators: against the exported C and ``run``, held loads, any step, and its derivatives."""

import numpy as np
import pytest

import stribeck
from tests.exports.harness import program
from tests.exports.stepped import LAWS, Stepped, law, problems
from tests.simulation.rig import law_table, rig, solved

STEPS = np.array([2e-3, 5e-3, 1e-2, 2e-2])


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("stepping")


@pytest.mark.share(4)
@pytest.mark.parametrize("name", LAWS)
def test_the_step_is_that_of_the_exported_c(name, folder):
    step = Stepped(law(name))
    z, v, effort, inertia, dt = given = problems(step.law, 200, 0)
    status, F, z_after, w, _ = program(name, folder)("b", z, v, dt, effort, inertia, 0.0)
    assert not status.any()
    x, friction = step(*given)
    terms = abs(F) + abs(effort) + inertia / dt * (abs(v) + abs(w))
    assert np.all(abs(friction - F) <= 4e-15 * terms)
    assert np.all(abs(x - z_after) <= 1e-13 * (abs(z) + dt * abs(w)))
    assert np.all(abs(v + dt * (effort - friction) / inertia - w) <= 1e-14 * dt / inertia * terms)


@pytest.mark.share(4)
@pytest.mark.parametrize("name", LAWS)
def test_each_world_is_as_if_alone(name):
    step = Stepped(law(name))
    given = problems(step.law, 30, 1)
    together = step(*given)
    for i in range(30):
        assert [x[i] for x in together] == [x[0] for x in step(*(x[i : i + 1] for x in given))]


@pytest.mark.share(4)
@pytest.mark.parametrize("name", LAWS)
def test_derivatives_are_those_of_differences(name):
    """By everything given and by every constant."""
    step = Stepped(law(name))
    scales, count = step.law.scales(step.law.p), 30
    values = dict(zip(("z", "v", "effort", "inertia", "dt"), problems(step.law, count, 2, wide=False), strict=True))
    values |= {n: np.full(count, x) for n, x in step.constants.items()}
    names = list(values)

    def at(changed):
        return step.solve(*(changed[n] for n in names[:5]), **{n: changed[n] for n in names[5:]})

    p, given, (x, _, w, jump) = at(values)
    slopes = step.slopes(p, given, (x, w, jump))
    for k, name_ in enumerate(names):
        size = {"z": scales.length, "v": scales.speed, "effort": scales.force}.get(name_, values[name_])
        h = 1e-6 * size
        above, below = (at({**values, name_: values[name_] + sign * h})[2][:2] for sign in (1, -1))
        for out, unit in enumerate((scales.length, scales.force)):
            slope = (above[out] - below[out]) / (2 * h)
            assert np.max(abs(slopes[k if k < 5 else name_][out] - slope) * size / unit) < 1e-6, name_


@pytest.mark.parametrize("name", [*LAWS, "delta"])
def test_derivatives_are_finite_at_rest(name):
    step = Stepped(law("lugre", delta=1.5) if name == "delta" else law(name))
    nothing = np.zeros(4)
    p, given, (x, _, w, jump) = step.solve(nothing, nothing, nothing, np.ones(4), STEPS)
    slopes = step.slopes(p, given, (x, w, jump))
    assert all(np.all(np.isfinite(slope)) for pair in slopes.values() for slope in pair)


def hold(step, load, seconds=0.8):
    """A body of 1 kg, held at 0.97 of a load that rises slowly to all of it, at each of STEPS: z and velocities."""
    z, v = np.full(4, 0.97 * load / step.law.p.sigma_0), np.zeros(4)
    for k in range(1, round(seconds / STEPS[0])):
        effort = load * np.minimum(0.97 + 0.15 * k * STEPS, 1.0)
        z, friction = step(z, v, effort, 1.0, STEPS)
        v = v + STEPS * (effort - friction)
    return z, v


# Above this speed dz/dt > 0 under a load r F_s < F_s, and z grows until the force holds it (docs/evidence/learning.md).
CREEP = {
    "lugre": lambda p, r: 0.0,
    "lugre_majorant": lambda p, r: r / (1 - r) * 2 / (np.pi * p.k_v),
    "lugre_sobczyk": lambda p, r: np.tan(np.pi / 2 * r) / p.k_v,
    "elastoplastic": lambda p, r: 0.0,
    "elastoplastic_majorant": lambda p, r: r / (1 - r) * 2 / (np.pi * p.k_v),
}


@pytest.mark.share(2)
@pytest.mark.parametrize("name", CREEP)
def test_a_held_joint_creeps_no_more_than_its_bound(name):
    """0.9 F_s for 100 s at 2 to 20 ms. What rounding adds: z that no longer changes hides up to eps z/2 a step."""
    step = Stepped(law(name))
    r = 0.9
    z, v = hold(step, r * step.law.p.F_s)
    again, friction = step(z, v, r * step.law.p.F_s, 1.0, STEPS)
    after = v + STEPS * (r * step.law.p.F_s - friction)
    # and the engine's v + dt (effort - F) is rounded
    rounding = np.finfo(float).eps * (abs(z) / STEPS / (1 - r) + 4 * STEPS * r * step.law.p.F_s)
    assert np.all(abs(again - z) <= 1e-9 * abs(z))  # steady: it goes on as it is
    assert np.all(abs(after) * 100 <= 100 * (1.001 * CREEP[name](step.law.p, r) + rounding))
    assert 100 * CREEP[name](step.law.p, r) < 1e-4


@pytest.mark.share(4)
@pytest.mark.parametrize("name", LAWS)
def test_any_step_is_stable(name):
    """From 1e-5 to 1e5 kg at 2 to 20 ms: the kinetic energy never grows without a load, and the body comes to rest."""
    step = Stepped(law(name, **({"g2": 10.0, "g3": 1.0, "g5": 10.0} if name == "makkar" else {})))
    inertia, dt = (x.ravel() for x in np.meshgrid(10.0 ** np.arange(-5, 6, 2), STEPS))
    z, v = np.zeros(inertia.shape), np.full(inertia.shape, 10 * step.law.scales(step.law.p).speed)
    fastest = v.copy()
    for _ in range(30):
        z, friction = step(z, v, 0.0, inertia, dt)
        v = v - dt * friction / inertia
        assert np.all(np.isfinite(v))
        assert np.all(abs(v) <= fastest * (1 + 1e-12))
    assert np.all(abs(v[inertia < 1e-2]) < 1e-3 * fastest[inertia < 1e-2])


def test_small_steps_are_run():
    own = law_table("lugre_majorant", k_v=1e6)
    reference = solved(rig(own, "force", {"kind": "ramp", "rate": 5.0}, 0.4, rows=4))["v"][-1]
    step, errors = Stepped(stribeck.law("lugre_majorant", "canudas1995", k_v=1e6)), []
    for dt in (1e-3, 5e-4):
        z = v = np.zeros(1)
        for k in range(1, round(0.4 / dt) + 1):
            z, friction = step(z, v, 5 * k * dt, 1.0, dt)
            v = v + dt * (5 * k * dt - friction)
        errors.append(abs(v[0] - reference))
    assert errors[1] < 1e-2 * abs(reference)
    assert errors[0] / errors[1] == pytest.approx(2, rel=0.3)


def test_what_is_not_finite_gives_nan_there_alone():
    z, friction = Stepped(law("lugre"))(np.zeros(3), [1e-3, np.nan, 1e-3], [0.0, 0.0, np.inf], 1.0, 1e-3)
    assert np.isfinite(friction[0])
    assert np.all(np.isnan(friction[1:]))
    assert np.all(np.isnan(z[1:]))

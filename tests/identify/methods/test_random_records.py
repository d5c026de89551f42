"""Random records through every static law: any unit, any motion, dirt; no traceback, no warning, no number that is none."""

import math
import warnings

import numpy as np
import pytest

import stribeck
from stribeck.errors import InputError
from stribeck.laws import builtin

STATIC = sorted(name for name, law in builtin().items() if not law.has_z)
MOTIONS = ("mixed", "one way", "steps", "with rest", "slow", "one speed")


def record(draw, kind):
    """Columns of a record of a body with a Stribeck effect, its units anywhere between um and km, uN and GN."""
    step, n = 10 ** draw.uniform(-4, -1.5), int(draw.integers(300, 700))
    t = np.arange(n) * step
    first, second = draw.uniform(1, 8, 2) / (n * step)
    v = np.sin(2 * np.pi * first * t + draw.uniform(0, 6)) + 0.5 * np.sin(2 * np.pi * second * t + 1)
    v = {
        "one way": 1.2 + 0.6 * v, "steps": np.repeat(draw.uniform(-1, 1, 20), n // 20 + 1)[:n],
        "with rest": np.where((6 * np.arange(n) / n) % 2 < 1, 0.0, v), "slow": v**3, "one speed": 0.5 * np.sign(v),
    }.get(kind, v)  # fmt: skip
    a = np.gradient(v, step)
    level = 1 + draw.uniform(0, 0.8) * np.exp(-((v / draw.uniform(0.02, 0.5)) ** 2))
    force = level * np.tanh(v / draw.uniform(0.001, 0.2)) + draw.uniform(0, 1) * v
    force = force + draw.uniform(0, 1) * a / np.abs(a).max() + 0.3 * draw.integers(0, 2)
    force = force + draw.choice([0.0, 0.01, 0.1, 1.0]) * draw.standard_normal(n)
    v = v + draw.choice([0.0, 0.001, 0.03]) * draw.standard_normal(n)
    return {"t": t, "v": v * 10 ** draw.uniform(-6, 4), "F": force * 10 ** draw.uniform(-8, 8)}


def spoilt(draw, columns):
    """Outliers, rows without a force, rows twice, or a clock that changes its rate."""
    n, dirt = len(columns["t"]), draw.integers(0, 6)
    if dirt == 0:
        columns["F"][draw.integers(0, n, 5)] *= 1e3
    elif dirt == 1:
        columns["F"][draw.integers(0, n, 9)] = np.nan
    elif dirt == 2:
        twice = np.sort(np.concatenate([np.arange(n), draw.integers(0, n, 20)]))
        return {name: x[twice] for name, x in columns.items()}
    elif dirt == 3:
        t = columns["t"]
        columns["t"] = np.where(np.arange(n) < n // 2, t, 1.5 * t - 0.5 * t[n // 2])
    return columns


def check(fit):
    assert math.isfinite(fit.relative_force_error)
    assert fit.cross_validated_error is None or math.isfinite(fit.cross_validated_error)
    fit.to_dict()
    for name, e in fit.parameters.items():
        assert all(math.isfinite(x) for x in (e.value, e.low, e.high) if x is not None), name
        assert e.range[0] <= e.interval[0] <= e.value <= e.interval[1] <= e.range[1], name


@pytest.mark.share(4)
@pytest.mark.parametrize("seed", range(16))
def test_a_random_record_is_fitted_or_refused_in_words(seed):
    draw = np.random.default_rng(seed)
    columns = spoilt(draw, record(draw, MOTIONS[seed % len(MOTIONS)]))
    law = STATIC[seed % len(STATIC)]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            result = stribeck.fit(columns, law, time="t", velocity="v", force="F")
        except InputError as error:
            result = str(error)
    if isinstance(result, str):
        assert "must be at least F_c" not in result  # nobody has given F_s
    else:
        check(result)


@pytest.mark.share(2)
@pytest.mark.parametrize("law", ["coulomb_viscous", "stribeck", "stribeck_tanh"])
def test_units_do_not_change_what_a_fit_comes_to(law):
    """The same record in m and N, and as if it were in other units by 1e-6 and 1e5."""
    rng = np.random.default_rng(3)
    t = np.arange(800) * 2e-3
    v = np.sin(2 * np.pi * 1.1 * t) + 0.5 * np.sin(2 * np.pi * 2.7 * t + 1)
    force = (1 + 0.5 * np.exp(-((v / 0.1) ** 2))) * np.tanh(v / 0.02) + 0.4 * v + 0.02 * rng.standard_normal(len(t))
    usual, other = (
        stribeck.fit(
            {"t": t, "v": s * v, "F": f * force}, law, time="t", velocity="v", force="F", forms=False, mass=0.0,
            cutoff=0,
        )
        for s, f in ((1.0, 1.0), (1e-6, 1e5))
    )  # fmt: skip
    assert other.relative_force_error == pytest.approx(usual.relative_force_error, rel=0.02)


def test_viscous_friction_is_seen_at_any_speed():
    """Of an arm at hundreds of rad/s, a small number times a large one."""
    rng = np.random.default_rng(4)
    t = np.arange(800) * 2e-3
    v = 1e3 * np.sin(2 * np.pi * 1.1 * t)
    force = np.sign(v) + 1e-3 * v + 0.02 * rng.standard_normal(len(t))
    columns = {"t": t, "v": v, "F": force}
    words = {"time": "t", "velocity": "v", "force": "F", "mass": 0.0, "cutoff": 0}
    fit = stribeck.fit(columns, "coulomb_viscous", **words)
    assert fit.estimates["sigma_2"].value == pytest.approx(1e-3, rel=0.02)
    assert fit.estimates["F_c"].value == pytest.approx(1.0, rel=0.02)
    columns["F"] = force - 1.1 * np.sign(v)
    least = stribeck.fit(columns, "coulomb_viscous", **words).values["F_c"]  # a level > 0, for a simulation
    assert least == pytest.approx(1e-9 * np.max(abs(columns["F"])))

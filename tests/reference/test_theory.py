"""The numbers of theory.md, sections 2 and 4: Table 1 of the paper, each to the digits printed there."""

import numpy as np
import pytest

from tests.simulation.rig import law_table, rig, solved

LAWS = {
    "lugre": law_table("lugre"),
    **{f"sobczyk_{k_v}": law_table("lugre_sobczyk", k_v=float(k_v)) for k_v in ("1e6", "1e7", "1e8")},
}
LIMIT_CYCLE = {"kind": "pid", "K_p": 3.0, "K_i": 4.0, "K_d": 6.0}


@pytest.mark.parametrize(
    ("law", "expected"),
    [
        ("lugre", [44.86, 45.31, -9.564, -10.02]),
        ("sobczyk_1e6", [69.27, 133.0, 45.19, -18.55]),
        ("sobczyk_1e7", [47.47, 54.25, -4.292, -11.07]),
        ("sobczyk_1e8", [45.12, 46.21, -9.040, -10.13]),
    ],
)
def test_presliding(law, expected):
    force = {"kind": "points", "t": [0, 10, 15, 35, 40, 50], "value": [0, 1.425, 1.425, -1.425, -1.425, 0]}
    solution = solved(rig(LAWS[law], "force", force, 50.0, rows=1000))
    result = 1e6 * solution["y"][[200, 300, 700, 800]]
    assert [f"{y:.4g}" for y in result] == [f"{y:.4g}" for y in expected]


RATES = [1, 5, 10, 20, 30, 40, 50]


def break_away(law):
    """The first local maximum of F for each rate, refined by a parabola through the highest rows."""
    peaks = []
    for rate in RATES:
        data = rig(LAWS[law], "force", {"kind": "ramp", "rate": float(rate)}, 2 / rate + 0.1, rows=4000)
        F = solved(data)["F"]
        i = np.flatnonzero((F[1:-1] > F[:-2]) & (F[1:-1] >= F[2:]))[0] + 1
        a, b, c = F[i - 1 : i + 2]
        peaks.append(b + (a - c) ** 2 / (16 * b - 8 * a - 8 * c))
    return np.array(peaks)


def test_break_away_force():
    lugre = break_away("lugre")
    expected = [1.43242, 1.31321, 1.21995, 1.09861, 1.02449, 1.00425, 1.00747]
    np.testing.assert_allclose(lugre, expected, rtol=0, atol=6e-6)
    assert 0.0003 < np.max(lugre - break_away("sobczyk_1e7")) <= 0.0005
    slow = break_away("sobczyk_1e6")
    assert slow[0] == pytest.approx(1.428343, abs=1e-6)
    assert 0.003 < np.max(lugre - slow) <= 0.0041


@pytest.mark.parametrize(("law", "amplitude", "period"), [("lugre", 0.063902, 24.44), ("sobczyk_1e6", 0.063093, 24.64)])
def test_limit_cycle(law, amplitude, period):
    step = {"kind": "step", "value": 1.0, "time": 10.0}
    solution = solved(rig(LAWS[law], LIMIT_CYCLE, step, 250.0, rows=25000))
    t, y = solution.t, solution["y"]
    assert np.max(y) == pytest.approx(1.50047, abs=6e-6)
    late, e = t > 150, y - 1.0
    assert (np.max(y[late]) - np.min(y[late])) / 2 == pytest.approx(amplitude, abs=1.1e-6)
    up = np.flatnonzero((e[:-1] < 0) & (e[1:] >= 0) & late[:-1])
    crossings = t[up] - e[up] * (t[up + 1] - t[up]) / (e[up + 1] - e[up])
    assert len(crossings) >= 4
    np.testing.assert_allclose(np.diff(crossings), period, rtol=0, atol=0.0055)


@pytest.mark.parametrize(
    ("law", "y"),
    [("lugre", 3.306801), ("sobczyk_1e6", 3.373043), ("sobczyk_1e7", 3.313143), ("sobczyk_1e8", 3.307430)],
)
def test_stick_slip(law, y):
    pull = {"kind": "ramp", "rate": 0.1}
    solution = solved(rig(LAWS[law], {"kind": "spring", "stiffness": 2.0}, pull, 40.0, rows=400))
    assert solution["y"][-1] == pytest.approx(y, abs=6e-7)


def test_the_smooth_elastoplastic_law_drifts():
    """A 1 Hz sawtooth that stays below sigma_0 z_ba."""
    t = np.repeat(np.arange(9.0), 2)[1:-1]
    sawtooth = {"kind": "points", "t": t.tolist(), "value": [0.0, 0.55] * 8}
    law = law_table("elastoplastic_sobczyk", k_v=1e6, z_ba=0.7e-5)
    y = solved(rig(law, "force", sawtooth, 8.0, rows=8))["y"]
    np.testing.assert_allclose(np.diff(y[3:]), 1.12e-6, rtol=0.05)


@pytest.mark.parametrize(("law", "error"), [("sobczyk_1e7", 6.5e-3), ("majorant", 7.0e-10)])
def test_deviation_from_lugre_in_stick_slip(law, error):
    pull, spring = {"kind": "ramp", "rate": 0.1}, {"kind": "spring", "stiffness": 2.0}
    table = LAWS.get(law) or law_table("lugre_majorant", k_v=1e7)
    y, lugre = (solved(rig(one, spring, pull, 40.0, rows=4000, rtol=1e-11))["y"] for one in (table, "lugre"))
    assert np.max(np.abs(y - lugre)) == pytest.approx(error, rel=0.15)

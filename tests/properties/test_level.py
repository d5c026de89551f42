"""Verdicts on laws whose level varies: both sides of the bound, replays, and histories made to draw energy."""

import math
from fractions import Fraction

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import stribeck
from stribeck.properties import check, replay
from stribeck.properties.checked import CheckedAlways, check_varied, largest_v_d
from stribeck.properties.damped import excess as rounded_up
from stribeck.properties.damped import suffices
from stribeck.properties.worst import Varied
from stribeck_verify import verify

CLOSE = 1e-9
TABLE = {"sigma_0": 1e5, "sigma_1": 316.2, "F_c": 1.0, "F_s": 1.5, "v_s": 1e-3}
OWN = {"lugre": {}, "lugre_majorant": {"k_v": 1e6}, "elastoplastic": {"z_ba": 5e-6},
       "elastoplastic_majorant": {"k_v": 1e6, "z_ba": 5e-6}}  # fmt: skip


def needed(table, low, high):
    """The sigma_2 of the condition sigma_1 (F_s+ - F_c-) <= sigma_2 F_c-."""
    return table["sigma_1"] * (high * table["F_s"] - low * table["F_c"]) / (low * table["F_c"])


def at(name, share, low=1.0, high=2.0, **changes):
    table = {**TABLE, **changes}
    return stribeck.law(name, {**table, "sigma_2": share * needed(table, low, high)}, **OWN[name])


def with_(law, **changes):
    return type(law)({**law.values, **law.choices, **changes})


def passive_only(law, low, high, v_max=None):
    return CheckedAlways(Varied.by_level(law, low, high), v_max, 2400.0).passive()


@pytest.mark.share(3)
@pytest.mark.parametrize("name", OWN)
def test_both_sides_of_the_bound(name):
    above = passive_only(at(name, 1 + CLOSE), 1.0, 2.0)
    assert above.holds
    assert above.evidence["coq"] == f"{name}_level_passive"
    below = passive_only(at(name, 1 - CLOSE), 1.0, 2.0)
    assert below.holds is False
    assert below.evidence["enclosed"]["c"] > 0


def test_all_properties():
    law = at("lugre_majorant", 0.9)
    verdicts = check(law, level=(1.0, 2.0))
    assert [verdicts[n].holds for n in stribeck.properties.NAMES] == [True, True, True, False, False]
    assert verdicts["bounded"].evidence["Z"] == pytest.approx(3e-5)
    assert verdicts.verify()
    assert verdicts["passive"].verified
    assert stribeck.check(law)["passive"].holds  # while the level is held


def test_a_proof_about_other_ranges_is_not_taken():
    verdicts = check(at("lugre", 1.1), level=(1.0, 2.0))
    assert verdicts.verify()
    verdicts.varied = Varied.by_level(verdicts.law, 1.0, 2.5)
    assert not verdicts.verify()


@pytest.mark.share(5)
@pytest.mark.parametrize("table", [
    {"sigma_0": 1.67e6, "sigma_1": 6e3, "F_c": 2.5, "F_s": 3.0, "v_s": 1.6e-8},
    {"sigma_0": 1.038e9, "sigma_1": 2.442e5, "F_c": 669.9, "F_s": 942.1, "v_s": 3.22e-3},
    {"sigma_0": 1e-6, "sigma_1": 1e9, "F_c": 1e-9, "F_s": 1e3, "v_s": 1e6},
])  # fmt: skip
@pytest.mark.parametrize(("low", "high"), [(1.0, 1.0), (1e-3, 7.0)])
def test_extreme_constants(table, low, high):
    law = at("lugre", 1 + CLOSE, low, high, **table)
    assert passive_only(law, low, high).holds
    assert passive_only(at("lugre", 1 - CLOSE, low, high, **table), low, high).holds is not True


def test_the_counterexample_replays_and_an_other_solver_agrees():
    law = at("lugre", 0.5)
    verdict = passive_only(law, 1.0, 2.0)
    assert verdict.holds is False
    assert replay.repeats(verdict.scenario, verdict.evidence["replay"])
    assert verdict.evidence["replay"]["E_in"] < 0
    z, energy, p = 0.0, 0.0, law.p
    belt = verdict.scenario["bodies"]["belt"]["velocity"]["signal"]
    level = verdict.scenario["contacts"]["contact"]["factors"]["F_c"]["signal"]["value"]
    for begin, end, v, factor in zip(belt["t"][::2], belt["t"][1::2], belt["value"][::2], level[::2], strict=True):

        def rates(t, x, v=v, factor=factor):
            g = factor * (p.F_c + (p.F_s - p.F_c) * math.exp(-((v / p.v_s) ** 2))) / p.sigma_0
            dz = v - abs(v) / g * x[0]
            return [dz, (p.sigma_0 * x[0] + p.sigma_1 * dz + p.sigma_2 * v) * v]

        solution = solve_ivp(rates, (0, end - begin), [z, energy], method="Radau", rtol=1e-10, atol=[1e-16, 1e-14])
        z, energy = solution.y[:, -1]
    assert energy == pytest.approx(verdict.evidence["replay"]["E_in"], rel=1e-5)
    drawn = verdict.evidence["enclosed"]["energy_drawn_per_cycle"]
    assert 0 < drawn[0] <= verdict.evidence["energy_drawn_per_cycle"] <= drawn[1]


def most_drawn(law, low, high, rng, steps=300, lanes=100):
    """The largest share of what flowed that histories drew, chosen greedily: each step takes, of 48 speeds, levels and
    times, the one that loses least. z and the energy of a step are closed forms (dz/dt is linear in z)."""
    p = law.p
    z, drawn, flowed, worst = np.zeros(lanes), np.zeros(lanes), np.full(lanes, 1e-300), 0.0
    z[: lanes // 2] = rng.uniform(-1, 1, lanes // 2) * high * p.F_s / p.sigma_0
    start = z.copy()
    for _ in range(steps):
        v = rng.choice([-1, 1], (48, lanes)) * p.v_s * 10 ** rng.uniform(-3, 5, (48, lanes))
        factor = rng.choice([low, high], (48, lanes))
        g = factor * (p.F_c + (p.F_s - p.F_c) * np.exp(-((v / p.v_s) ** 2))) / p.sigma_0
        m = abs(v) if law.name == "lugre" else v * (2 / np.pi) * np.arctan(p.k_v * v) + 2 / (np.pi * p.k_v)
        a, end = m / g, v * g / m
        t = 10 ** rng.uniform(-3, 1.3, (48, lanes)) / a
        gap, decay = z - end, -np.expm1(-a * t)
        # F v = v (sigma_0 z + sigma_1 dz/dt + sigma_2 v), integrated; less what the bristles gain
        put_in = v * (p.sigma_0 * (end * t + gap * decay / a) - p.sigma_1 * gap * decay + p.sigma_2 * v * t)
        new = end + gap * (1 - decay)
        lost = put_in - p.sigma_0 * (new**2 - z**2) / 2
        size = abs(put_in) + p.sigma_0 * (new**2 + z**2)
        # now and then at random, and for half the lanes the cheapest way there is to drain them
        chosen = np.where(rng.random(lanes) < 0.2, rng.integers(0, 48, lanes), np.argmin(lost / size, axis=0))
        pick = (chosen, np.arange(lanes))
        drawn, flowed, z = drawn - put_in[pick], flowed + size[pick], new[pick]
        stored = p.sigma_0 * (start**2 - z**2) / 2
        worst = max(worst, float(np.max((drawn - stored) / flowed)))
    return worst


@pytest.mark.parametrize("name", ["lugre", "lugre_majorant"])
def test_no_history_draws_energy_where_the_proof_says_so_and_some_do_where_it_does_not(name):
    rng = np.random.default_rng(3)
    for _ in range(2):
        low, high = 10 ** rng.uniform(-0.5, 0), 10 ** rng.uniform(0, 0.7)
        table = {"sigma_1": 10 ** rng.uniform(0, 4), "F_s": rng.uniform(1, 3)}
        assert passive_only(at(name, 1 + CLOSE, low, high, **table), low, high).holds
        assert most_drawn(at(name, 1 + CLOSE, low, high, **table), low, high, rng) < 1e-12
        assert most_drawn(at(name, 0.5, low, high, **table), low, high, rng) > 1e-6


@pytest.mark.thorough
@pytest.mark.parametrize("name", ["lugre", "elastoplastic_majorant"])
def test_damping_that_falls_with_speed_is_passive_whatever_the_level_does(name):
    law = stribeck.law(name, {**TABLE, "sigma_2": 0.4}, **OWN[name])
    ranges = {"F_c": (Fraction(1), None), "F_s": (Fraction(3, 2), None)}
    largest = largest_v_d(Varied(law, ranges))
    excess = 2 / (math.pi * 1e6) if "majorant" in name else 0.0
    assert largest == pytest.approx(math.sqrt(2 * math.e) * (4 / 316.2 - excess), rel=1e-14)
    assert rounded_up(law) >= Fraction(excess)
    inside, outside = (with_(law, v_d=largest * x) for x in (1 - CLOSE, 1 + CLOSE))
    assert CheckedAlways(Varied(inside, ranges), None, 2400.0).passive().holds
    assert not suffices(Varied(outside, ranges).worst(any_z=True))
    refuted = CheckedAlways(Varied(with_(law, v_d=4 * largest), ranges), None, 2400.0).passive()
    assert refuted.holds is False
    assert refuted.evidence["replay"]["E_in"] < 0


def test_a_level_without_end():
    law = stribeck.law("lugre", {**TABLE, "sigma_2": 0.4}, v_d=0.02)
    result = check_varied(Varied(law, {"F_c": (Fraction(1), None), "F_s": (Fraction(3, 2), None)}), None, 2400.0)
    assert result["passive"].holds
    assert result["bounded"].holds is None
    assert result.verify()


def test_other_laws():
    dahl = check(stribeck.law("dahl", sigma_0=1e5, F_c=1.0), level=(0.1, 10.0))
    assert dahl["passive"].holds
    assert dahl["bounded"].evidence["Z"] == pytest.approx(1e-4)
    assert dahl.verify()
    sobczyk = stribeck.law("lugre_sobczyk", {**TABLE, "sigma_2": 1e5}, k_v=1e6)
    assert passive_only(sobczyk, 1.0, 1.2).holds is False
    arctan = stribeck.law("lugre_arctan", {**TABLE, "sigma_2": 1e5}, k_v=1e6)
    assert passive_only(arctan, 1.0, 1.2).holds is False
    assert passive_only(with_(arctan, v_d=0.01), 1.0, 1.2).holds
    static = check(stribeck.law("stribeck", {**TABLE, "sigma_2": 1.0}, delta=2.0), level=(1.0, 2.0))
    assert static["passive"].holds


def test_up_to_a_speed():
    assert passive_only(at("lugre", 0.01), 1.0, 2.0, 1e-5).holds
    fast = passive_only(at("lugre", 0.01), 1.0, 2.0, 1.0)
    assert fast.holds is False
    assert all(abs(row["v"]) <= 1.0 for row in fast.evidence["program"])


def test_a_law_of_a_users_own_is_never_proved_but_may_be_refuted():
    class Mine(type(at("lugre", 1.0))):
        """A copy."""

        name = "mine"

    law = at("lugre", 2.0)
    mine = Mine(law.values)
    verdicts = check(mine, level=(1.0, 2.0))
    assert verdicts["passive"].holds is None
    assert verdicts["unique"].holds is None
    assert passive_only(Mine(at("lugre", 0.3).values), 1.0, 2.0).holds is False


MESH = {"sigma_0": 2.5e3, "sigma_1": 30.0, "sigma_2": 0.5, "F_c": 0.6, "F_s": 0.75, "v_s": 0.02}
VISCOUS = {"sigma_0": 1e4, "sigma_1": 10.0, "sigma_2": 60.0, "F_c": 1.0, "F_s": 1.5, "v_s": 0.01}


def limit_of_v_d(table, k_v=None):
    """The largest v_d with D >= 0 for all z and v at g = F_c/sigma_0, by brute force."""
    x = np.linspace(0.0, 4.0, 20001)

    def loses(v_d):
        v, a = v_d * x, table["sigma_1"] * np.exp(-(x**2))
        m = v if k_v is None else v * (2 / np.pi) * np.arctan(k_v * v) + 2 / (np.pi * k_v)
        return np.all(a**2 * m <= 4 * table["F_c"] * (a + table["sigma_2"]))

    low, high = 1e-6, 1e3
    while high > low * (1 + 1e-7):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if loses(middle) else (low, middle)
    return low


@pytest.mark.share(3)
@pytest.mark.parametrize(("name", "table", "own", "gain"), [
    ("lugre_majorant", MESH, {"k_v": 1e5}, 1.0274), ("lugre", VISCOUS, {}, 9.579),
])  # fmt: skip
def test_the_limit_of_the_damping_that_falls_with_speed(name, table, own, gain):
    """Proved below it, beyond what the formula shows; above it a run draws energy."""
    limit = limit_of_v_d(table, own.get("k_v"))
    by_formula = largest_v_d(Varied.by_level(stribeck.law(name, table, **own), 1.0, 3.0))
    assert limit / by_formula == pytest.approx(gain, rel=1e-3)
    ranges = {n: (Fraction(table[n]), None) for n in ("F_c", "F_s")}
    inside, outside = (Varied(stribeck.law(name, table, **own, v_d=x * limit), ranges) for x in (0.999, 1.1))
    proof = CheckedAlways(inside, None, 2400.0).passive()
    assert proof.holds
    assert "coq" not in proof.evidence  # whose theorem is about the formula
    refuted = CheckedAlways(outside, None, 2400.0).passive()
    assert refuted.holds is False
    assert replay.repeats(refuted.scenario, refuted.evidence["replay"])
    assert refuted.evidence["replay"]["E_in"] < 0


def extraction(law, low, v_d):
    """The least power lost, over v, at the z where it is least, as a share of v^2: from the equations as printed."""
    p = law.p
    v = np.geomspace(1e-5, 10, 40001) * v_d
    a = p.sigma_1 * np.exp(-((v / v_d) ** 2))
    newtons = low * (p.F_c + (p.F_s - p.F_c) * np.exp(-((v / p.v_s) ** 2)))
    m = v * (2 / np.pi) * np.arctan(p.k_v * v) if "arctan" in law.name else v
    return np.min(a + p.sigma_2 - a * a * m / (4 * newtons))


@pytest.mark.share(3)
@pytest.mark.parametrize(("name", "table", "own", "gain"), [
    ("lugre", {**VISCOUS, "sigma_2": 0.1, "F_s": 2.5, "v_s": 10.0}, {}, 2.5),  # v_d far below v_s: F_s counts, not F_c
    ("lugre", {**VISCOUS, "sigma_2": 0.1, "F_s": 2.5, "v_s": 1.0}, {}, 1.8),
    ("lugre_arctan", {**VISCOUS, "sigma_2": 0.1}, {"k_v": 1.0}, 1.5),  # v S_0 is less than |v|
])  # fmt: skip
def test_the_limit_of_v_d_is_that_of_the_lowest_stribeck_curve(name, table, own, gain):
    """The limit is far beyond the formula's, which takes F_c at every speed."""
    law = stribeck.law(name, table, **own)
    by_formula = largest_v_d(Varied.by_level(law, 0.5, 1e3))
    limit = brentq(lambda v_d: extraction(law, 0.5, v_d), by_formula, 1e3 * by_formula)
    assert limit > gain * by_formula
    proof = passive_only(with_(law, v_d=0.8 * limit), 0.5, 1e3)
    assert proof.holds
    assert verify(proof.certificate) == []
    refuted = passive_only(with_(law, v_d=2 * limit), 0.5, 1e3)
    assert refuted.holds is False
    assert refuted.evidence["replay"]["E_in"] < 0


def test_the_lowest_stribeck_curve_is_that_of_the_smallest_v_s():
    """At 10 m/s the curve is F_s where the damping acts, and enough; at 1 mm/s it is F_c."""
    law = stribeck.law("lugre", {**VISCOUS, "sigma_2": 0.1, "F_s": 2.5, "v_s": 10.0})
    law = with_(law, v_d=1.5 * largest_v_d(Varied.by_level(law, 1.0, 1.0)))
    for least, holds in ((Fraction(10), True), (Fraction(1, 1000), None)):
        assert CheckedAlways(Varied(law, {"v_s": (least, Fraction(10))}), None, 2400.0).passive().holds is holds


def test_a_level_that_does_not_vary_is_that_of_a_law():
    """Also where another storage function than the elastic energy is needed: here beyond 0.0143 m/s, up to 0.038."""
    verdict = passive_only(stribeck.law("lugre", {**TABLE, "sigma_2": 0.4}), 2.0, 2.0, 0.07)
    assert verdict.holds
    assert verify(verdict.certificate) == []


def test_a_proof_that_the_checker_refuses_gives_way_to_another():
    """The first proof's leaves are beyond what the checker's arithmetic shows; the remedy's line is enough."""
    law = stribeck.law("elastoplastic_majorant", MESH, k_v=1e5, z_ba=1e-4, v_d=0.05)
    assert passive_only(law, 0.7, 1.3).holds


def test_the_checker_takes_no_other_numbers_for_the_limit():
    law = stribeck.law("lugre", VISCOUS, v_d=8.9)
    ranges = {n: (Fraction(VISCOUS[n]), None) for n in ("F_c", "F_s")}
    certificate = CheckedAlways(Varied(law, ranges), None, 2400.0).passive().certificate
    assert certificate["theorem"] == "damped"
    assert verify(certificate) == []
    knots = certificate["data"]["knots"]
    thinned = [x for x in knots if not 0.6 < Fraction(x) < 0.8]
    for change in ({"d": "9"}, {"s": "11"}, {"c": "59"}, {"N": "99/100"}, {"knots": knots[1:]}, {"knots": thinned},
                   {"knots": ["0", knots[-1]]}, {"knots": [*knots, "1"]}, {"knots": []}):  # fmt: skip
        assert verify({**certificate, "data": {**certificate["data"], **change}}) != [], change


def test_the_shape_of_the_stribeck_curve_is_the_worst_that_there_is():
    """delta falls to 1, where exp(-|v/v_s|) has no derivative at 0; the largest delta was looked at."""
    varied = Varied(
        stribeck.law("lugre_majorant", TABLE | {"sigma_2": 0.4}, k_v=1e5, delta=2.0),
        {"delta": (Fraction(1), Fraction(2))},
    )
    assert varied.extreme(-1).p.delta == 1.0

"""Verdicts on cases with known answers, counterexamples replayed by other means, and laws that are wrong on purpose."""

import math
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

import stribeck
from stribeck import Scenario
from stribeck.expressions.graph import symbol
from stribeck.laws.base import PARAMETERS
from stribeck.properties import NAMES, WORK, check
from stribeck.properties.checked import Checked
from stribeck.properties.cycles import _longest
from stribeck.properties.model import Unreadable, finite
from stribeck.properties.storage import Storage, largest_speed
from tests.properties import broken_laws
from tests.reference.apart_parts import bristles

TABLE_1 = {"sigma_0": 1e5, "sigma_1": 1e5**0.5, "sigma_2": 0.4, "F_c": 1.0, "F_s": 1.5, "v_s": 1e-3}
NEEDS = {"lugre_arctan": ("k_v",), "lugre_sobczyk": ("k_v",), "lugre_majorant": ("k_v",), "elastoplastic": ("z_ba",),
         "elastoplastic_sobczyk": ("k_v", "z_ba"), "elastoplastic_majorant": ("k_v", "z_ba")}  # fmt: skip
# theory, sections 2 and 3: unique, bounded, smooth, drift-free; passive where LuGre's condition holds
KNOWN = {
    "lugre": "yyn.n", "lugre_arctan": "yny.n", "lugre_sobczyk": "yyynn", "lugre_majorant": "yyy.n",
    "elastoplastic": "yyn.y", "elastoplastic_sobczyk": "yyynn", "elastoplastic_majorant": "yyy.y", "dahl": "yynyn",
}  # fmt: skip


def law_with(name, values=TABLE_1, **changes):
    values = {**values, **changes}
    own = {"k_v": 1e4 / values["v_s"], "z_ba": 0.7 * values["F_c"] / values["sigma_0"]}
    own = {n: own[n] for n in NEEDS.get(name, ()) if n not in changes}
    names = {"dahl": ("sigma_0", "F_c")}.get(name, tuple(PARAMETERS))
    return stribeck.law(name, {n: x for n, x in values.items() if n in names or n not in PARAMETERS}, **own)


def decided(law, name, v_max=None):
    return getattr(Checked(law, v_max, WORK), name)()


def own_energy_serves(law, v_max=None):
    verdict = decided(law, "passive", v_max)
    return verdict.holds is True and "fitted" not in verdict.method


def word(holds):
    return {True: "y", False: "n", None: "?"}[holds]


@pytest.mark.share(7)
@pytest.mark.parametrize("damping", [0.3, 1.5], ids=["not passive", "passive"])
@pytest.mark.parametrize("name", KNOWN)
def test_verdicts_with_known_answers(name, damping):
    threshold = 3e4 * (3.1 - 1.9) / 1.9
    values = {"sigma_0": 1e9, "sigma_1": 3e4, "sigma_2": damping * threshold, "F_c": 1.9, "F_s": 3.1, "v_s": 1e-8}
    law = law_with(name, values)
    passive_now = "y" if damping > 1 and name != "lugre_arctan" else "n"
    if damping > 1:  # sigma_2 is not in dz/dt, and linear in F
        verdict = decided(law, "passive")
        assert word(verdict.holds) == KNOWN[name].replace(".", passive_now)[3]
        assert verdict.verify(law, "passive") is not False
        return
    verdicts = check(law)
    assert "".join(word(verdicts[n].holds) for n in NAMES) == KNOWN[name].replace(".", passive_now)
    assert verdicts.verify()
    for verdict in verdicts.properties.values():
        assert verdict.method
        assert verdict.evidence


@pytest.mark.share(7)
@pytest.mark.parametrize("smooth_abs", ["sqrt", "compact"])
@pytest.mark.parametrize("name", ["lugre_majorant", "elastoplastic_majorant"])
def test_every_majorant_keeps_the_verdicts(name, smooth_abs):
    verdicts = check(law_with(name, sigma_2=200.0, smooth_abs=smooth_abs))
    assert "".join(word(verdicts[n].holds) for n in NAMES) == KNOWN[name].replace(".", "y")


positive = st.floats(-3, 3).map(lambda x: 10.0**x)


@given(positive, positive, positive, st.floats(1.05, 5), st.floats(-8, 0), st.sampled_from([1, -1]))
@settings(max_examples=10, deadline=None)
def test_lugre_is_passive_exactly_above_its_condition(sigma_0, sigma_1, F_c, ratio, distance, side):
    condition = sigma_1 * (ratio * F_c - F_c) / F_c
    sigma_2 = condition * (1 + side * 10.0**distance) + 1e-300
    levels = {"F_c": F_c, "F_s": ratio * F_c, "v_s": 1e-3}
    law = law_with("lugre", {"sigma_0": 1e4 * sigma_0, "sigma_1": sigma_1, "sigma_2": max(sigma_2, 0.0), **levels})
    assert own_energy_serves(law) == (side > 0)
    assert Storage(law, None, law.z_bound(law.p)).exists == (side > 0)


def test_up_to_which_speed_table_1_is_passive():
    law = law_with("lugre")
    assert largest_speed(law, 1.5e-5) == pytest.approx(0.0382, abs=1e-4)
    assert [decided(law, "passive", v).holds for v in (0.014, 0.03, 0.0385)] == [True, True, False]
    assert own_energy_serves(law, 0.0142)  # sigma_0 z^2/2 serves up to 0.0143 m/s,
    assert not own_energy_serves(law, 0.0144)  # and no further
    assert decided(law, "passive", 0.037).holds


def test_the_storage_interval_holds_the_elastic_energy_where_lugre_is_passive():
    z = np.linspace(-1.4e-5, 1.4e-5, 29)
    low, high = Storage(law_with("lugre", sigma_2=200.0), reach=1.5e-5).interval(z)
    assert np.all(low <= 1e5 * z + 1e-6)
    assert np.all(1e5 * z <= high + 1e-6)
    low, high = Storage(law_with("lugre_sobczyk"), reach=1.5e-5).interval(np.array([5e-6]))
    assert low > high


# -- counterexamples, replayed with SciPy on equations written apart ---------------------------------------------------


@pytest.mark.parametrize(
    ("name", "v_max"), [("lugre", None), ("lugre", 0.04), ("lugre_sobczyk", 1e-5), ("lugre_arctan", None)]
)
def test_a_cycle_draws_the_energy_that_it_states(name, v_max):
    verdicts = decided(law_with(name), "passive", v_max)
    assert verdicts.holds is False
    z, energy, p = verdicts.evidence["z_start"], 0.0, TABLE_1
    for piece in verdicts.evidence["program"]:
        v = piece["v"]
        assert v_max is None or abs(v) <= v_max

        def of(t, x, v=v):
            dz, _ = bristles(name, {**p, "k_v": 1e7}, v, x[0])
            return [dz, (p["sigma_0"] * x[0] + p["sigma_1"] * dz + p["sigma_2"] * v) * v]

        end = solve_ivp(of, (0, piece["duration"]), [z, energy], method="DOP853", rtol=1e-12, atol=[1e-20, 1e-20]).y[
            :, -1
        ]
        z, energy = float(end[0]), float(end[1])
    assert -energy == pytest.approx(verdicts.evidence["energy_drawn"], rel=1e-6)
    assert z == pytest.approx(verdicts.evidence["z_start"], rel=1e-6)
    assert verdicts.evidence["energy_drawn"] > 0
    assert verdicts.evidence["time"] < 60


def test_the_longest_stretch_that_is_kept():
    assert _longest(np.array([True, True, False, True, True, True, False]), 10) == (13, 15)


def test_numbers_that_are_none_are_not_treated():
    for number in (math.inf, math.nan):
        with pytest.raises(Unreadable, match=f"the equations hold the number {number}"):
            finite(symbol("v") * number)


def test_z_of_arctan_passes_every_level():
    verdicts = decided(law_with("lugre_arctan"), "bounded")
    assert verdicts.evidence["passes_any_level"]
    for level in verdicts.evidence["levels"]:
        steady = 1.5e-5 * np.pi / (2 * np.arctan(1e7 * level["v"]))  # g is F_s/sigma_0 at these speeds
        assert steady > level["z"] * (1 - 1e-6)
    replayed = stribeck.simulate(Scenario(verdicts.scenario))
    assert replayed.final["z"] == pytest.approx(verdicts.evidence["replay"]["z"], rel=1e-9)
    assert replayed.final["z"] == pytest.approx(1.5e-4, rel=1e-6)


@pytest.mark.parametrize(
    "name", ["lugre", "lugre_arctan", "lugre_sobczyk", "lugre_majorant", "elastoplastic_sobczyk", "dahl"]
)
def test_a_load_below_break_away_moves_what_drifts(name):
    verdicts = decided(law_with(name), "drift_free")
    assert verdicts.holds is False
    assert verdicts.evidence["largest_load"] == pytest.approx(0.5 * verdicts.evidence["F_s"], rel=0.2)
    solution = stribeck.simulate(Scenario(verdicts.scenario))
    assert solution["u"][-1] == 0
    assert solution.final["y"] == pytest.approx(verdicts.evidence["distance"], rel=1e-6)
    assert abs(solution.final["y"]) > 0.01 * verdicts.evidence["elastic_displacement"]


def test_one_sided_derivatives_of_lugre():
    evidence = decided(law_with("lugre"), "smooth").evidence
    share = evidence["z"] / 1.5e-5
    assert evidence["v"] == 0.0
    assert [evidence[n] for n in ("from_below", "from_above")] == pytest.approx([1 + share, 1 - share])


# -- what is wrong on purpose -----------------------------------------------------------------------------------------

CAUGHT = {
    "NegativeDamping": {"passive"}, "WrongSign": {"bounded", "passive"}, "ReversedSpring": {"passive"},
    "Below": {"bounded"}, "BelowByAShare": {"bounded"}, "Jumps": {"smooth"}, "Escapes": {"unique", "bounded"}, "Root": set(),
}  # fmt: skip


@pytest.mark.share(7)
@pytest.mark.parametrize("name", CAUGHT)
def test_laws_that_are_wrong_are_caught(name):
    file = Path(broken_laws.__file__)
    own = {"k_v": 1e7} if name in ("Below", "Root") else {}
    law = stribeck.law(f"{file}:{name}", parameters=TABLE_1, sigma_2=200.0, **own)
    verdicts = check(law)
    false = {n for n in NAMES if verdicts[n].holds is False} - {"drift_free"}
    assert false >= CAUGHT[name]
    if name == "Root":
        assert [verdicts[n].holds for n in NAMES] == [True, True, True, True, False]
    if name == "Jumps":
        assert verdicts["unique"].holds is None
    assert verdicts.verify()


def test_a_larger_bound_than_the_claimed_one_is_found():
    law = stribeck.law(f"{broken_laws.__file__}:BelowByAShare", parameters=TABLE_1)
    evidence = decided(law, "bounded").evidence
    assert not evidence["passes_any_level"]
    assert evidence["levels"][-1]["z"] == pytest.approx(1.5e-5 / 0.9, rel=1e-3)


def test_a_law_that_no_file_holds_is_judged_all_the_same():
    law = type("Anonymous", (broken_laws.Root,), {"__module__": "nowhere"})({**TABLE_1, "k_v": 1e7, "sigma_2": 200.0})
    assert "nowhere" not in sys.modules
    assert decided(law, "passive").holds is True


# -- the rest -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "pushes", ["20.0 * (1 - tanh((v + 0.09) / 0.034)**2)", "where(abs(v + 0.0128) < 0.0025, 4.57, 0.0)"]
)
def test_sliding_that_draws_energy_in_a_narrow_range_of_speeds_is_not_passive(pushes, tmp_path):
    """Held at -0.09 or -0.0128 m/s the friction of -10 or -2.4 N has the added force of 20 or 4.57 N against it; no cycle of
    held speeds is found."""
    (tmp_path / "own.py").write_text(
        "from stribeck.expressions.ops import tanh, where\nfrom stribeck.laws import BristleLaw\n"
        "from stribeck.laws.terms import g\n\n\nclass Pushes(BristleLaw):\n    v_d = None\n\n    @staticmethod\n"
        "    def dz_dt(p, v, z):\n        return v - abs(v) * z / g(p, v)\n\n"
        "    @staticmethod\n    def friction(p, v, z, dz_dt):\n"
        f"        return p.sigma_0 * z + p.sigma_1 * dz_dt + p.sigma_2 * v + {pushes}\n"
    )
    constants = {"sigma_0": 1e5, "sigma_1": 100.0, "sigma_2": 100.0, "F_c": 1.0, "F_s": 1.5, "v_s": 1e-3}
    verdicts = check(stribeck.law(f"{tmp_path / 'own.py'}:Pushes", constants))["passive"]
    assert verdicts.holds is False
    assert verdicts.method.startswith("at a constant speed")

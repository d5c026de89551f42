"""What a machine file allows its contacts, and what follows for the whole."""

from fractions import Fraction

import numpy as np
import pytest

import stribeck
from stribeck import Scenario
from stribeck.errors import InputError
from stribeck.expressions.ops import where
from stribeck.laws.base import Scales, StaticLaw
from stribeck.machine.signal import SignalTable
from stribeck.properties import ports, replay, stateless
from stribeck.properties.checked import CheckedAlways
from stribeck.properties.ranges import of_contact, of_force, of_signal
from stribeck.properties.verdicts import refusals
from stribeck.properties.worst import Varied
from tests.machine.test_servo import MACHINE

PASSIVE = {"sigma_0": 1e4, "sigma_1": 10.0, "sigma_2": 60.0, "F_c": 1.0, "F_s": 1.5, "v_s": 0.01}
DAMPED = {"name": "lugre_majorant", "k_v": 1e5, "v_d": 0.5, "parameters": {**PASSIVE, "sigma_2": 0.1}}


def machine(law=None, **contact):
    return {
        "schema": 2, "name": "two", "bodies": {"rotor": {"mass": 1.0}, "arm": {"mass": 2.0}},
        "links": {"gear": {"from": "rotor", "to": "arm", "stiffness": 100.0, "damping": 1.0, "gap": 1e-3}},
        "contacts": {"mesh": {"from": "arm", "law": law or {"name": "lugre", "parameters": PASSIVE}, **contact}},
        "loads": {"gravity": {"on": "arm", "kind": "pendulum", "amplitude": 3.0},
                  "push": {"on": "rotor", "kind": "signal",
                           "signal": {"kind": "sine", "amplitude": 2.0, "frequency": 1.0, "offset": -5.0}},
                  "teeth": {"on": "rotor", "kind": "ripple", "amplitude": [0.5, -0.25], "waves": [3, 5],
                            "phase": [0.0, 0.0]}},
        "solve": {"t_end": 2.0}, "output": {"step": 0.01},
    }  # fmt: skip


def ranges(**contact):
    scenario = Scenario(machine(**contact)).elements
    return of_contact(scenario, scenario.system.contacts[0], 2.0, {}).to_dict()


@pytest.mark.parametrize(("kind", "given"), [
    ("points", {"t": [0.0, 1.0, 1.0, 1.6, 9.0], "value": [1.0, 0.4, 2.0, -1.0, 7.0]}),
    ("step", {"value": -2.0, "time": 0.7}), ("ramp", {"rate": -0.3}),
    ("sine", {"amplitude": -2.0, "frequency": 3.0, "offset": 0.5, "phase": 0.2}),
    ("point_to_point", {"t": [0.2, 1.0, 1.5], "value": [1.0, 3.0, 2.0]}),
    ("spline", {"t": [0.0, 0.5, 1.0, 3.0], "value": [1.0, 3.0, -2.0, 1.0]}),
])  # fmt: skip
def test_signals_stay_within_their_range(kind, given):
    table = {**machine(), "loads": {"push": {"on": "rotor", "kind": "signal", "signal": {"kind": kind, **given}}}}
    (signal,) = Scenario(table).elements.signals.values()
    low, high = (float(x) for x in of_signal(signal, 2.0))
    values = signal.at(np.linspace(0, 2.0, 20001))
    assert low <= values.min() + 1e-12
    assert high >= values.max() - 1e-12
    assert low == pytest.approx(values.min(), abs=1e-3)
    assert high == pytest.approx(values.max(), abs=1e-3)
    assert kind in SignalTable.kinds


@pytest.mark.parametrize(("kind", "given", "t_end"), [
    *(("sine", {"amplitude": a, "frequency": 0.5, "phase": p}, t) for a in (1.0, -3.0) for p in (0.0, 2.0, -9.0)
      for t in (0.1, 0.9, 1.6, 2.0)),
    ("spline", {"t": [0.0, 0.1, 2.0], "value": [0.0, 5.0, 5.0]}, 2.0),  # overshoots a hundredfold between its points
    ("spline", {"t": [0.0, 0.1, 2.0], "value": [0.0, 5.0, 5.0]}, 0.5),
])  # fmt: skip
def test_a_range_is_that_of_the_run_and_hardly_more(kind, given, t_end):
    """A counterexample at a level that the signal does not reach in the run would not be one."""
    table = {**machine(), "loads": {"push": {"on": "rotor", "kind": "signal", "signal": {"kind": kind, **given}}}}
    (signal,) = Scenario(table).elements.signals.values()
    values = signal.at(np.linspace(0, t_end, 20001))
    size = np.ptp(values)
    assert [float(x) for x in of_signal(signal, t_end)] == pytest.approx([values.min(), values.max()], abs=1e-5 * size)


def test_forces():
    scenario = Scenario(machine()).elements
    for name, expected in {"gravity": (-3, 3), "push": (-7, -3), "teeth": (-0.75, 0.75), "gear": (None, None)}.items():
        assert of_force(scenario, name, 2.0, {}) == expected
    assert of_force(scenario, "gear", 2.0, {"gear": 40.0}) == (-40, 40)


def test_ranges_of_constants():
    assert ranges() == {}
    assert ranges(loads=[{"force": "push", "F_c": 0.1, "F_s": 0.2}]) == {
        "F_c": [pytest.approx(1.3), pytest.approx(1.7)], "F_s": [pytest.approx(2.1), pytest.approx(2.9)]}  # fmt: skip
    assert ranges(loads=[{"force": "gear", "F_s": 0.2}]) == {"F_s": [1.5, None]}
    weights = {"push": 0.5, "gravity": -1.0}  # -3.5 ... -1.5 and -3 ... 3: from 0 to 6.5
    assert ranges(loads=[{"force": weights, "F_c": 0.1}]) == {"F_c": [1.0, pytest.approx(1.65)]}
    squared = ranges(loads=[{"force": weights, "against": "gravity", "F_c": 0.1}])
    assert squared == {"F_c": [1.0, pytest.approx(1.0 + 0.1 * 6.5**2)]}
    waves = {"amplitude": [0.25, -0.25], "waves": [80, 3], "phase": [0.0, 1.0]}
    warm = {"signal": {"kind": "points", "t": [0, 600], "value": [1.0, 0.4]}}
    result = ranges(factors={"level": waves, "sigma_2": warm}, loads=[{"force": "gravity", "F_c": 1.0, "F_s": 1.0}])
    assert result["F_c"] == [0.5, 6.0]
    assert result["F_s"] == [0.75, 6.75]
    assert result["sigma_2"] == [pytest.approx(60 * (1 - 0.6 * 2 / 600)), 60.0]


def test_a_passive_machine():
    result = stribeck.check(machine(DAMPED, loads=[{"force": "gear", "F_c": 0.1, "F_s": 0.2}]))
    assert result.passive is True
    assert "machine_passive" in result.why
    assert result["mesh"].level == {"F_c": [1.0, None], "F_s": [1.5, None]}
    assert set(result.ports) == {"loads.push", "loads.teeth"}
    assert result.verify()
    assert result.to_dict()["machine"]["passive"] is True


@pytest.mark.parametrize(("sigma_2", "holds"), [(8.3, False), (8.4, True)])
def test_a_load_that_is_held_raises_the_level(sigma_2, holds):
    """10 N make F_c 1.2 N and F_s 2.2 N of 1 and 1.5: sigma_2 >= 10 (2.2 - 1.2)/1.2 = 8.33, not 10 (1.5 - 1)/1 = 5."""
    law = {"name": "lugre", "parameters": {**PASSIVE, "sigma_2": sigma_2}}
    held = {"push": {"on": "rotor", "kind": "signal", "signal": {"kind": "points", "t": [0.0], "value": [10.0]}}}
    table = {**machine(law, loads=[{"force": "push", "F_c": 0.02, "F_s": 0.07}]), "loads": held}
    result = stribeck.check(table)
    assert result["mesh"]["passive"].holds is holds
    assert result["mesh"].level == {"F_c": [pytest.approx(1.2)] * 2, "F_s": [pytest.approx(2.2)] * 2}
    assert result["mesh"]["unique"].holds
    assert result.verify()


def test_a_level_without_end_is_swung_above_its_lowest():
    scenario = Scenario(
        machine(loads=[{"force": "push", "F_c": 100.0, "F_s": 200.0}, {"force": "gear", "F_c": 0.1, "F_s": 0.1}])
    ).elements
    varied = of_contact(scenario, scenario.system.contacts[0], 2.0, {})
    assert varied.range("F_c") == (301, None)
    assert varied.extreme(1, Fraction(3)).p.F_c > varied.extreme(-1).p.F_c == 301


def test_a_contact_spoils_it_and_the_run_shows_how():
    result = stribeck.check(machine(loads=[{"force": "gear", "F_c": 0.1, "F_s": 0.2}]))
    assert result.passive is None
    assert result.spoiled_by == ["mesh"]
    verdict = result["mesh"]["passive"]
    assert verdict.holds is False
    assert replay.repeats(verdict.scenario, verdict.evidence["replay"])
    assert verdict.evidence["replay"]["E_in"] < 0
    # F_s+ may be (1 + sigma_2/sigma_1) F_c- = 7: the gear may carry (7 - 1.5)/0.2 = 27.5
    for most, holds in ((27.4, True), (27.6, False)):
        again = stribeck.check(machine(loads=[{"force": "gear", "F_c": 0.1, "F_s": 0.2}]), force={"gear": most})
        assert again["mesh"]["passive"].holds is holds


def test_other_constants_that_vary():
    """sigma_2 falls to a tenth: the constants are passive at the start, and no longer at the end."""
    signal = {"kind": "points", "t": [0, 2], "value": [1.0, 0.05]}
    result = stribeck.check(machine(factors={"sigma_2": {"signal": signal}}))
    verdict = result["mesh"]["passive"]
    assert verdict.holds is False
    assert replay.repeats(verdict.scenario, verdict.evidence["replay"])


def test_laws_without_z():
    table = {**PASSIVE, "sigma_2": 1.0}
    law = {"name": "stribeck_tanh", "k_v": 100.0, "parameters": table}
    result = stribeck.check(machine(law, loads=[{"force": "push", "F_c": 0.1, "F_s": 0.2}]))
    assert result["mesh"]["passive"].holds
    assert result.passive


def test_a_single_body():
    law = {"name": "lugre", "parameters": {**PASSIVE, "sigma_2": 1.0}}
    given = {"law": law, "plant": {"mass": 1.0}, "drive": {"kind": "force", "signal": {"kind": "ramp", "rate": 1.0}},
             "solve": {"t_end": 1.0}, "output": {"step": 0.1}}  # fmt: skip
    result = stribeck.check(given)
    assert result.passive is False
    assert result.spoiled_by == [ports.ONLY]
    better = stribeck.check({**given, "law": {"name": "lugre", "parameters": PASSIVE}})
    assert better.passive


def varying(law, **factors):
    points = {n: {"signal": {"kind": "points", "t": [0, 2], "value": list(x)}} for n, x in factors.items()}
    return machine(law, factors=points)


def test_the_elastic_range_is_the_smallest_that_there_is():
    law = {"name": "elastoplastic_majorant", "k_v": 1e5, "z_ba": 8e-5, "parameters": PASSIVE}
    scenario = Scenario(varying(law, z_ba=(1.0, 0.5))).elements
    varied = of_contact(scenario, scenario.system.contacts[0], 2.0, {})
    result = CheckedAlways(varied, None, 2400.0).decided("drift_free")
    assert result.holds
    assert result.evidence["z_0"] == pytest.approx(4e-5)
    assert refusals(result.certificate, result.law, "drift_free") == []


def by_signal(kind, last):
    return {"signal": {"kind": kind, "t": [0, 2], "value": [1.0, last]}}


SINE = {"signal": {"kind": "sine", "amplitude": -0.5, "offset": 1.0, "frequency": 1.0}}
CASES = [
    ("F_c", by_signal("points", 0.5), "8e-05.*to 5e-05"), ("F_s", by_signal("points", 0.5), "8e-05.*to 7.5e-05"),
    *(("level", x, "8e-05.*to 5e-05") for x in (by_signal("point_to_point", 0.5), SINE)),
    *(("z_ba", by_signal(kind, 1.5), "0.00012.*to 0.0001") for kind in ("points", "point_to_point")),
    *(("z_ba", x, "0.00012.*to 0.0001") for x in (SINE, {"amplitude": [-0.5], "waves": [3]})),
]  # fmt: skip


@pytest.mark.parametrize(("name", "factor", "ends"), CASES)
def test_a_level_below_the_elastic_range_is_refused(name, factor, ends):
    """With g below z_ba no z is plastic, and it grows without end: it was said to be bounded where F_s fell."""
    law = {"name": "elastoplastic_majorant", "k_v": 1e5, "z_ba": 8e-5, "parameters": PASSIVE}
    with pytest.raises(InputError, match=rf"factors\.{name}: z_ba .up to {ends}$") as reported:
        stribeck.check(machine(law, factors={name: factor}))
    assert len(reported.value.problems) == 1


@pytest.mark.parametrize("name", ["coulomb_viscous", "stribeck", "stribeck_tanh"])
def test_laws_without_z_are_passive_whatever_a_gear_carries(name):
    law = {"name": name, "k_v": 100.0, "parameters": {**PASSIVE, "sigma_2": 1.0}}
    rises = {"F_c": 0.1} if name == "coulomb_viscous" else {"F_c": 0.3, "F_s": 0.1}
    contact = {"loads": [{"force": "gear", **rises}], "factors": {"sigma_2": {"amplitude": [0.5], "waves": [3]}}}
    assert stribeck.check(machine(law, **contact)).passive


class Dips(StaticLaw):
    """It drives between the ends of F_c's range, and loses nothing at both."""

    name = "dips"
    uses = ("F_c",)

    @staticmethod
    def friction(p, v, z, dz_dt):
        return (p.F_c - 1) * (p.F_c - 3) * v

    @staticmethod
    def scales(p):
        return Scales(1e-3, 1.0, 1.0)


class Jumps(Dips):
    """The same by a condition."""

    name = "jumps"

    @staticmethod
    def friction(p, v, z, dz_dt):
        return where(p.F_c < 2, 1.0, -1.0) * v


@pytest.mark.parametrize("kind", [Dips, Jumps])
def test_a_law_of_a_users_own_is_not_judged_by_the_ends_of_its_ranges(kind):
    varied = Varied(kind({"F_c": 1.0}), {"F_c": (Fraction(1), Fraction(3))})
    assert stateless.static_passive(varied).holds is None


@pytest.mark.parametrize("kind", [Dips, Jumps])
def test_nor_by_its_own_value_where_a_load_holds_another(kind):
    """F v < 0 at F_c = 2.5, which a load that never changes may make of 1; it was said to be passive."""
    varied = Varied(kind({"F_c": 1.0}), {"F_c": (Fraction(5, 2), Fraction(5, 2))})
    assert stateless.static_passive(varied).holds is None


class Turns(Dips):
    """F v = F_c v^2 (1 - v^2): it drives above 1 m/s."""

    name = "turns"

    @staticmethod
    def friction(p, v, z, dz_dt):
        return p.F_c * v * (1 - v * v)


@pytest.mark.parametrize(("v_max", "holds"), [(None, False), (0.5, True), (2.0, False)])
def test_a_law_that_drives_beyond_v_max_is_passive_below(v_max, holds):
    """The whole machine was refuted by a speed that was excluded."""
    parts = stribeck.Body("b", mass=1.0), stribeck.Contact("c", "b", Turns({"F_c": 1.0}))
    result = stribeck.check(stribeck.Machine(*parts).scenario(1.0), v_max=v_max)
    (verdicts,) = result.contacts.values()
    assert verdicts["passive"].holds is holds
    if holds:
        assert "|v| <= v_max" in verdicts["passive"].reason
    else:
        assert 1 < verdicts["passive"].evidence["v"] <= (v_max or np.inf)


def test_a_cylinder_is_a_port():
    """It was said to be passive without any port, its gas and its valve left out."""
    law = {"name": "lugre_majorant", "k_v": 1e6, "parameters": {**PASSIVE, "sigma_2": 400.0}}
    result = stribeck.check({**MACHINE, "contacts": {"seal": {"from": "piston", "law": law}}})
    assert result.passive
    assert set(result.ports) == {"bodies.piston", "controllers.axis"}

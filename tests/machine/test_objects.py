"""Machines as Python objects: the same tables as a file, the same validation, the same numbers."""

import tomllib
from pathlib import Path

import numpy as np
import pytest

import stribeck as st
from stribeck import examples
from stribeck.exports.fmu.description import dimensions
from stribeck.laws import BristleLaw, builtin
from stribeck.machine.table import ConstantField, FileTable


def rig():
    return st.Machine(
        st.Body("rotor", inertia=3.1e-5), st.Body("arm", inertia=0.35),
        st.Link("gear", "rotor", "arm", ratio=0.01, stiffness=9e3, damping=2.0, gap=2e-4),
        st.Contact("mesh", "arm", st.law("lugre_majorant", parameters="canudas1995", k_v=1e6)),
        st.Controller.cascade("axis", on="rotor", signal=st.signals.Step(1.0, at=0.1), K_p=30, K_v=0.05),
    )  # fmt: skip


def test_a_file_as_objects():
    """Part by part, the example of an arm."""
    bearing = {"sigma_0": 3.0, "sigma_1": 4e-3, "sigma_2": 3e-5, "F_c": 8e-3, "F_s": 0.012, "v_s": 1.5}
    seal = {"sigma_0": 1.2e3, "sigma_1": 4.0, "sigma_2": 0.05, "F_c": 0.3, "F_s": 0.42, "v_s": 0.03}
    machine = st.Machine(
        st.Body("rotor", inertia=6e-5, initial={"y": 0.0, "v": 0.0}), st.Body("arm", inertia=0.12),
        st.Link("gear", "rotor", "arm", ratio=0.02, stiffness=4e3, damping=5.0),
        st.Contact("bearing", "rotor", {"name": "lugre_majorant", "k_v": 2e3, "parameters": bearing}),
        st.Contact(
            "seal", "arm", {"name": "lugre_majorant", "k_v": 1e5, "parameters": seal},
            factors={"level": {"amplitude": [0.15], "waves": [6], "phase": [0.0]}},
        ),
        st.Load.pendulum("gravity", "arm", amplitude=4.0),
        st.Load.ripple("cogging", "rotor", np.array([2e-3]), [14], [0.0]),
        st.Motor("drive", "rotor", K=0.07, R=0.4, L=2e-4, voltage=24.0),
        st.Controller.cascade(
            "axis", on="drive", measures="rotor", signal=st.signals.PointToPoint([0.1, 0.7], [0.0, 50.0]), K_p=20.0, K_v=0.02,
            T_i=0.04, limit=1.0, sampling={"period": 1e-3, "delay": 4e-4, "resolution": 1.5339807878856412e-3},
        ),
        name="arm",
    )  # fmt: skip
    expected = tomllib.loads(examples.path("arm").read_text())
    assert machine.scenario(1.5, 2e-3, energy=True).data == expected


def test_the_example_of_the_documentation():
    solution = st.simulate(rig(), t_end=4.0, step=1e-3)
    assert solution.status == "done"
    assert solution["arm.y"].shape == (4001,)
    assert set(solution.events) == {"mesh", "gear"}
    assert len(solution.plot().axes) > 3
    assert list(solution.to_pandas())[:3] == ["t", "rotor.y", "rotor.v"]
    ensemble = st.simulate(rig(), {"contacts.mesh.law.parameters.F_c": [0.9, 1.0]}, t_end=4.0, step=1e-3)
    np.testing.assert_allclose(ensemble["arm.y"][1], solution["arm.y"], rtol=0, atol=1e-7 * solution.peaks["arm.y"])


def test_a_machine_does_not_change():
    first = rig()
    other = first.replace({"bodies.arm.inertia": 0.4})
    assert first == rig()
    assert other != first
    assert other.to_dict()["bodies"]["arm"]["inertia"] == 0.4
    first.to_dict()["bodies"].clear()
    assert first == rig()


LAW = {"name": "lugre", "parameters": "canudas1995"}


def test_an_element_is_its_equations():
    """Numbers give numbers, arrays arrays; the table is what a file would hold."""
    gear = rig()["gear"]
    assert gear.to_table() == {
        "from": "rotor", "to": "arm", "ratio": 0.01, "stiffness": 9e3, "damping": 2.0, "gap": 2e-4,
    }  # fmt: skip
    assert gear.force(3e-4, 0.0) == pytest.approx(9e3 * 2e-4)
    np.testing.assert_allclose(gear.stored_energy(np.array([0.0, 1e-4, 3e-4])), [0.0, 0.0, 9e3 * (2e-4) ** 2 / 2])
    assert gear == st.Link("gear", "rotor", "arm", ratio=0.01, stiffness=9e3, damping=2.0, gap=2e-4)
    assert st.signals.File(Path("run.csv"), "t", "F").path == "run.csv"
    with pytest.raises(Exception, match="frozen"):
        gear.gap = 1.0


def test_a_body_whose_velocity_is_given_may_turn():
    machine = st.Machine(st.Body("a", velocity=st.signals.Sine(1.0, 1.0), rotary=True), st.Contact("c", "a", LAW))
    units = {c.name: c.unit for c in machine.scenario(1.0).system.columns}
    assert (units["a.v"], units["c.F"]) == ("rad/s", "N m")


def test_the_bristles_of_a_contact_may_begin_deflected():
    start = 3e-6
    machine = st.Machine(st.Body("a", mass=1.0), st.Contact("c", "a", LAW, initial={"z": start}))
    s = st.simulate(machine, t_end=1e-3, step=1e-4)
    assert s["c.z"][0] == start
    assert s["c.F"][0] == pytest.approx(1e5 * start)


def test_a_law_of_ones_own_in_a_contact():
    class Own(BristleLaw):
        """A law without a file."""

        @staticmethod
        def dz_dt(p, v, z):
            return v - abs(v) * p.sigma_0 / p.F_c * z

    p = {"sigma_0": 1e4, "sigma_1": 10.0, "sigma_2": 0.1, "F_c": 1.0, "F_s": 1.0, "v_s": 0.01}
    machine = st.Machine(
        st.Body("a", mass=1.0), st.Contact("c", "a", Own(p)), st.Load.follow("p", "a", st.signals.Sine(2.0, 1.0))
    )
    assert machine.scenario(1.0).law.values["F_c"] == 1.0
    assert "mass 1 kg" in machine.show()
    contacts = {"c": machine["c"], "d": machine["c"].to_table()}
    scenario = st.Scenario(
        schema=2, bodies={"a": {"mass": 1.0}}, contacts=contacts, solve={"t_end": 1.0}, output={"step": 0.1}
    )
    assert scenario.elements.contacts["c"] is machine["c"], "a later class of the same name took its place"


def test_a_law_does_not_change():
    """An attribute that nobody reads would be taken for a change."""
    law = st.law("lugre", parameters="canudas1995")
    with pytest.raises(AttributeError, match=r"F_s: a law does not change; replace\(F_s=VALUE\) makes another"):
        law.F_s = 2.0
    assert law.replace(F_s=2.0).p.F_s == 2.0


def test_every_number_of_a_file_or_law_has_a_unit():
    """A constant is declared by its unit and its meaning, which are both text."""

    def kinds(kind):
        return [kind, *(each for below in kind.__subclasses__() for each in kinds(below))]

    st.load(examples.path("arm"))  # which reads all kinds of elements
    fields = [f for kind in kinds(FileTable) for f in kind.model_fields.values()]
    declared = [x.constant for f in fields for x in f.metadata if isinstance(x, ConstantField)]
    assert len(declared) > 50
    declared += [constant for kind in builtin().values() for constant in kind.constants().values()]
    assert dimensions("N s/m^2") == {"kg": 1, "m": -1, "s": -1}
    for unit in {x for constant in declared for x in (constant.unit, constant.rotary_unit or "")}:
        for word in unit.replace("signal", "1").split(" or "):
            assert dimensions(word) is not None, unit


def test_a_link_leads_to_the_ground_unless_it_says_where():
    """As a contact does."""
    link = {"from": "slide", "stiffness": 100.0}
    data = {
        "schema": 2, "bodies": {"slide": {"mass": 1.0, "initial": {"y": 0.1}}}, "links": {"spring": link},
        "solve": {"t_end": 1.0}, "output": {"step": 0.1},
    }  # fmt: skip
    text = {**data, "links": {"spring": {**link, "to": "ground"}}}
    np.testing.assert_array_equal(st.simulate(data)["slide.y"], st.simulate(text)["slide.y"])

"""Machines as Python objects: the same tables as a file, the same validation, the same numbers."""

import tomllib

import numpy as np
import pytest

import stribeck as st
from stribeck import examples
from stribeck.errors import StribeckNote
from stribeck.exports.fmu.description import dimensions
from stribeck.laws import builtin
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
    made = st.Machine(
        st.Body("rotor", inertia=6e-5, y=0.0, v=0.0), st.Body("arm", inertia=0.12),
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
    assert made.scenario(1.5, 2e-3, energy=True).data == expected


def test_the_example_of_the_documentation():
    solution = st.simulate(rig(), t_end=4.0, step=1e-3)
    assert solution.status == "done"
    assert solution["arm.y"].shape == (4001,)
    assert set(solution.events) == {"mesh", "gear"}
    assert len(solution.plot().axes) > 3
    assert list(solution.to_pandas())[:3] == ["t", "rotor.y", "rotor.v"]
    ensemble = st.simulate(rig().vary({"contacts.mesh.law.parameters.F_c": [0.9, 1.0]}), t_end=4.0, step=1e-3)
    np.testing.assert_allclose(ensemble["arm.y"][1], solution["arm.y"], rtol=0, atol=1e-7 * solution.peaks["arm.y"])


def test_a_machine_does_not_change():
    first = rig()
    other = first.replace({"bodies.arm.inertia": 0.4})
    assert first == rig()
    assert other != first
    assert other.to_dict()["bodies"]["arm"]["inertia"] == 0.4
    first.to_dict()["bodies"].clear()
    assert first == rig()


def test_mistakes():
    with pytest.raises(st.InputError, match="must be made of bodies"):
        st.Machine("rotor")
    with pytest.raises(st.InputError, match=r"links\.a: 'a': must be another name: it is that of bodies\.a already"):
        st.Machine(st.Body("a", mass=1.0), st.Link("a", "a", stiffness=1.0))
    with pytest.raises(st.InputError, match=r"bodies\.a: 'a': must be another name: it is that of bodies\.a already"):
        st.Machine(st.Body("a", mass=1.0), st.Body("a", mass=2.0))
    with pytest.raises(st.InputError, match="t_end: missing: must be given for a Machine"):
        st.simulate(rig())
    with pytest.raises(st.InputError, match=r"links\.gear\.ratio: 0: must be"):
        rig().replace({"links.gear.ratio": 0})
    with pytest.raises(st.InputError, match=r"links\.gaer\.gap: links has no 'gaer'.*'gear'"):
        rig().vary({"links.gaer.gap": [0.0, 1e-4]})
    with pytest.raises(st.InputError, match=r"bodies\.armm\.inertia: bodies has no 'armm'.*'arm'"):
        rig().replace({"bodies.armm.inertia": 0.4})
    added = rig().replace({"bodies.armm": {"inertia": 0.1}, "bodies.armm.inertia": 0.4})
    assert "armm" in repr(added)


def body(**values):
    return st.Body("a", **({"inertia": 1.0} | values))


LAW = {"name": "lugre", "parameters": "canudas1995"}
WRITTEN = {  # refused where it is written, with the path that it would have in a file
    "text": (lambda: body(inertia="x"), ["bodies.a.inertia: 'x': must be a finite number > 0, not text"]),
    "nan": (lambda: body(inertia=np.nan), ["bodies.a.inertia: nan: must be a finite number > 0"]),
    "array": (lambda: body(inertia=[1.0, 2.0]), ["bodies.a.inertia: [1.0, 2.0]: must be a finite number > 0"]),
    "gain": (lambda: st.Controller.pid("u", on="a", signal=st.signals.Step(1.0, at=0.1), K_p="3"),
             ["controllers.u.K_p: '3': must be a finite number, not text"]),
    "signal": (lambda: st.signals.Sine("x", 1.0), ["amplitude: 'x': must be a finite number, not text"]),
    "two": (lambda: st.Link("k", "a", stiffness="x", dampin=1.0),
            ["links.k.stiffness: 'x': must be", "links.k.dampin: 1.0: unknown key (did you mean 'damping'?)"]),
    "too many": (lambda: st.signals.Ramp(1.0, 2.0), ["ramp: takes 1 value by position (rate)"]),
}  # fmt: skip
TOGETHER = {  # refused when the machine is made
    "nobody": ([body(), st.Contact("c", "b", LAW)], ["contacts.c.from: 'b': there is no such body (there is a)"]),
    "name": ([st.Body("a.b", inertia=1.0)], ["bodies.a.b: 'a.b': a name must be letters, digits and underscores"]),
    "nothing": ([], ["bodies: missing: a machine must have at least one body"]),
}


@pytest.mark.parametrize("name", WRITTEN)
def test_mistakes_are_told_where_they_are_written(name):
    make, expected = WRITTEN[name]
    with pytest.raises(st.InputError) as told:
        make()
    assert [text[: len(start)] for text, start in zip(told.value.problems, expected, strict=True)] == expected


@pytest.mark.parametrize("name", TOGETHER)
def test_mistakes_are_told_when_a_machine_is_made(name):
    given, expected = TOGETHER[name]
    with pytest.raises(st.InputError) as told:
        st.Machine(*given)
    assert [text[: len(start)] for text, start in zip(told.value.problems, expected, strict=True)] == expected


def test_an_element_is_its_equations():
    """Numbers give numbers, arrays arrays; the table is what a file would hold."""
    gear = rig()["gear"]
    assert gear.to_table() == {
        "from": "rotor", "to": "arm", "ratio": 0.01, "stiffness": 9e3, "damping": 2.0, "gap": 2e-4,
    }  # fmt: skip
    assert gear.force(3e-4, 0.0) == pytest.approx(9e3 * 2e-4)
    np.testing.assert_allclose(gear.stored_energy(np.array([0.0, 1e-4, 3e-4])), [0.0, 0.0, 9e3 * (2e-4) ** 2 / 2])
    assert gear == st.Link("gear", "rotor", "arm", ratio=0.01, stiffness=9e3, damping=2.0, gap=2e-4)
    with pytest.raises(Exception, match="frozen"):
        gear.gap = 1.0


def test_a_body_whose_velocity_is_given_may_turn():
    made = st.Machine(st.Body("a", velocity=st.signals.Sine(1.0, 1.0), rotary=True), st.Contact("c", "a", LAW))
    units = {c.name: c.unit for c in made.scenario(1.0).system.columns}
    assert (units["a.v"], units["c.F"]) == ("rad/s", "N m")
    with pytest.raises(st.InputError, match=r"bodies\.a\.rotary: true: must be left out: mass \(kg\) or inertia"):
        st.Body("a", mass=1.0, rotary=True)


def test_the_bristles_of_a_contact_may_begin_deflected():
    start = 3e-6
    made = st.Machine(st.Body("a", mass=1.0), st.Contact("c", "a", LAW, initial={"z": start}))
    s = st.simulate(made, t_end=1e-3, step=1e-4)
    assert s["c.z"][0] == start
    assert s["c.F"][0] == pytest.approx(1e5 * start)
    with pytest.raises(st.InputError, match=r"contacts\.c\.initial\.z: 1.0: law 'coulomb_viscous' has no z"):
        st.Contact(
            "c", "a", {"name": "coulomb_viscous", "parameters": {"F_c": 1.0, "sigma_2": 0.0}}, initial={"z": 1.0}
        )


def test_a_law_of_ones_own_in_a_contact():
    from stribeck.laws import BristleLaw

    class Own(BristleLaw):
        """A law without a file."""

        @staticmethod
        def dz_dt(p, v, z):
            return v - abs(v) * p.sigma_0 / p.F_c * z

    p = {"sigma_0": 1e4, "sigma_1": 10.0, "sigma_2": 0.1, "F_c": 1.0, "F_s": 1.0, "v_s": 0.01}
    made = st.Machine(
        st.Body("a", mass=1.0), st.Contact("c", "a", Own(p)), st.Load.follow("p", "a", st.signals.Sine(2.0, 1.0))
    )
    assert made.scenario(1.0).law.values["F_c"] == 1.0
    assert "mass 1 kg" in made.show()


def test_a_law_does_not_change():
    """An attribute that nobody reads would be taken for a change."""
    made = st.law("lugre", parameters="canudas1995")
    with pytest.raises(AttributeError, match=r"F_s: a law does not change; replace\(F_s=VALUE\) makes another"):
        made.F_s = 2.0
    assert made.replace(F_s=2.0).p.F_s == 2.0


def test_what_is_hardly_meant_is_said():
    constants = {"sigma_0": 1e5, "sigma_1": 300.0, "sigma_2": 0.4, "F_c": 1.0, "F_s": 1.5, "v_s": 1e-3}
    push = {"on": "a", "kind": "signal", "signal": {"kind": "ramp", "rate": 1.0}}
    contact = {
        "from": "a",
        "law": {"name": "lugre", "parameters": constants},
        "loads": [{"force": "p", "F_c": 0.5, "F_s": 0.1}],
    }
    data = {"schema": 2, "bodies": {"a": {"mass": 1.0}}, "contacts": {"c": contact}, "loads": {"p": push},
            "solve": {"t_end": 1.0}, "output": {"step": 2.0}}  # fmt: skip
    with pytest.warns(StribeckNote) as said:
        assert len(st.simulate(data).t) == 1
    assert [str(each.message) for each in said] == [
        "output.step: 2: is longer than solve.t_end = 1: the output is one row, t = 0",
        "contacts.c.loads.0: F_c grows more than F_s: from |force| = 1.25 on friction is less at rest than in motion",
    ]


def test_every_number_of_a_file_or_law_has_a_unit():
    """A constant is declared by its unit and its meaning, which are both text."""

    def kinds(kind):
        return [kind, *(each for below in kind.__subclasses__() for each in kinds(below))]

    st.load(examples.path("arm"))  # which reads all kinds of elements
    fields = [f for kind in kinds(FileTable) for f in kind.model_fields.values()]
    declared = [x.constant for f in fields for x in f.metadata if isinstance(x, ConstantField)]
    assert len(declared) > 50
    declared += [constant for kind in builtin().values() for constant in kind.constants().values()]
    for unit in {x for constant in declared for x in (constant.unit, constant.rotary_unit or "")}:
        for word in unit.replace("signal", "1").split(" or "):
            assert dimensions(word) is not None, unit

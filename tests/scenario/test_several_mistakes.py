"""What depends on several values, and several mistakes in one file: all are reported at once."""

from __future__ import annotations

import pytest

from stribeck import InputError, Scenario
from tests.scenario.valid_scenarios import CANUDAS, MAKKAR, POINTS, VALID, edited, write


def problems(data, **options) -> list[str]:
    with pytest.raises(InputError) as error:
        Scenario(data, **options)
    return error.value.problems


def with_values(name: str, **values):
    data = VALID[name]
    for path, value in values.items():
        data = edited(data, path.replace("__", "."), value=value)
    return data


@pytest.mark.parametrize(
    ("changes", "line"),
    [
        ({"law__parameters__F_s": 0.5}, "law.parameters.F_s: 0.5: must be at least F_c (F_c = 1.0)"),
        ({"law__parameters__F_c": 2}, "law.parameters.F_s: 1.5: must be at least F_c (F_c = 2)"),
        ({"law__z_ba": 1e-5}, "law.z_ba: 1e-05: must be less than F_c/sigma_0 (F_c = 1.0, sigma_0 = 100000.0)"),
        ({"law__z_ba": 1.0}, "law.z_ba: 1.0: must be less than F_c/sigma_0 (F_c = 1.0, sigma_0 = 100000.0)"),
    ],
)
def test_unphysical_together(changes, line):
    assert problems(with_values("spring_ramp", **changes)) == [line]


def test_equal_friction_forces_are_allowed():
    assert Scenario(with_values("spring_ramp", law__parameters__F_s=1.0)).law.p.F_s == 1.0


@pytest.mark.parametrize(
    ("t", "value", "said"),
    [
        ([0.0, 1.0, 0.5], [0.0, 1.0, 2.0], "drive.signal.t[2]: 0.5: times must not decrease (the one before is 1.0)"),
        ([0.0, 1.0], [0.0], "drive.signal.value: a list of 1: must be as long as t (2)"),
        ([0.0], [0.0, 1.0], "drive.signal.value: a list of 2: must be as long as t (1)"),
        ([], [1.0], "drive.signal.t: []: must hold at least one number"),
        (["a"] * 1000, [1.0], "drive.signal.t[0]: 'a': must be a finite number, not text"),
    ],
)
def test_points(t, value, said):
    assert problems(with_values("force_points", drive__signal={"kind": "points", "t": t, "value": value})) == [said]


def test_constants_of_another_law_and_in_the_wrong_place():
    base = VALID["force_points"]
    assert problems(edited(base, "law.name", value="lugre")) == [
        "law.k_v: 1000000.0: law 'lugre' has no such constant (it has v_d, delta)"
    ]
    assert problems(edited(base, "law", value={"name": "lugre", "F_s": 1.5, "parameters": CANUDAS})) == [
        "law.F_s: 1.5: belongs in law.parameters"
    ]
    both = {"name": "lugre_sobczyk", "k_v": 1e6, "parameters": {**CANUDAS, "k_v": 1e6}}
    assert problems(edited(base, "law", value=both)) == ["law.k_v: 1000000.0: stands in law.parameters too"]
    inside = {"name": "lugre_sobczyk", "parameters": {**CANUDAS, "k_v": 1e7}}
    assert Scenario(edited(base, "law", value=inside)).law.p.k_v == 1e7
    inside["parameters"]["k_v"] = -1.0
    assert problems(edited(base, "law", value=inside)) == ["law.parameters.k_v: -1.0: must be a finite number > 0"]


def test_what_the_law_does_not_use_is_allowed_and_checked():
    data = edited(VALID["velocity_sine"], "law", value={"name": "coulomb_viscous", "parameters": CANUDAS})
    assert Scenario(data).elements.contacts[""].level() == CANUDAS["v_s"]
    data["law"]["parameters"] = {**CANUDAS, "v_s": 0.0}
    assert problems(data) == ["law.parameters.v_s: 0.0: must be a finite number > 0"]


def test_states_that_are_not_there():
    line = "solve.atol.q: 1.0: there is no such state (the states are y, v, z, E_in, E_dissipated)"
    assert problems(edited(VALID["force_points"], "solve.atol", value={"q": 1.0})) == [line]
    line = "solve.atol.v: 1.0: there is no such state (the states are y)"
    assert problems(edited(VALID["velocity_sine"], "solve", value={"t_end": 1.0, "atol": {"v": 1.0}})) == [line]
    data = edited(VALID["velocity_sine"], "plant.initial", value={"v": 0.5})
    assert problems(data) == ["plant.initial.v: 0.5: must be left out: the velocity of this body is given"]
    data = edited(VALID["velocity_sine"], "plant.initial", value={"z": 1e-6})
    assert problems(data) == ["plant.initial.z: 1e-06: law 'stribeck' has no z; leave it out"]


def test_a_force_that_jumps_at_rest():
    data = edited(VALID["velocity_sine"], "law", value={"name": "stribeck", "parameters": CANUDAS})
    Scenario(data)  # a moved body needs no rest
    data = edited(edited(data, "drive", value={"kind": "force", "signal": POINTS}), "plant", value={"mass": 1.0})
    (line,) = problems(data)
    assert line.startswith("law.k_v: missing: the force of law 'stribeck' jumps at v = 0")


def test_every_mistake_is_reported(tmp_path):
    data = {
        "law": {"name": "lugre_sobczyk", "kv": 1e6, "parameters": {**CANUDAS, "F_s": "much", "v_s": 0, "mu": 0.3}},
        "plant": {"mass": -1.0, "initial": {"x": 0.0}},
        "drive": {"kind": "spring", "signal": {"kind": "sine", "amplitude": True}},
        "solve": {"t_end": 0.0, "rtol": 1.0, "atol": {"y": -1.0}},
        "output": {"steps": 0.1},
        "extra": 1,
    }
    with pytest.raises(InputError) as error:
        Scenario.load(write(data, tmp_path))
    keys = [line.split(": ")[0] for line in error.value.problems]
    assert sorted(keys) == sorted(
        [
            "schema", "extra", "law.kv", "law.k_v", "law.parameters.F_s", "law.parameters.v_s", "law.parameters.mu",
            "plant.mass", "plant.initial.x", "drive.stiffness", "drive.signal.amplitude", "drive.signal.frequency",
            "solve.t_end", "solve.rtol", "solve.atol.y", "output.steps", "output.step",
        ]
    )  # fmt: skip


def test_mistakes_behind_an_unknown_law_or_kind():
    """What can be judged without knowing the law or the kind is judged."""
    data = {
        "schema": 1,
        "law": {"name": "lugree", "q": 1.0, "k_v": 1e6, "parameters": {**CANUDAS, "F_s": 0.5, "sigma_0": True}},
        "plant": {"mass": -1.0, "q": 1.0},
        "drive": {"kind": "forse", "stifness": 1.0, "signal": {"kind": "ram", "rates": 1.0}},
        "solve": {"t_end": 1e9},
        "output": {"step": 1e-9},
    }
    keys = [line.split(": ")[0] for line in problems(data)]
    assert sorted(keys) == sorted(
        [
            "law.name", "law.q", "law.parameters.sigma_0", "law.parameters.F_s", "plant.mass", "plant.q",
            "drive.kind", "drive.stifness", "drive.signal.kind", "drive.signal.rates", "output.step",
        ]
    )  # fmt: skip
    data["drive"] = {"kind": "velocity", "signal": {"kind": "ramp", "rate": 0.1}}
    data["law"] = {"name": "makkar", **MAKKAR}
    data["plant"] = {"mass": 0, "initial": {"z": 1.0}}
    keys = [line.split(": ")[0] for line in problems(data)]
    assert sorted(keys) == ["output.step", "plant.initial.z", "plant.mass"]


def test_a_missing_plant_is_no_mistake_where_the_drive_is_unknown():
    data = edited(edited(VALID["force_points"], "plant"), "drive.kind", value="forse")
    assert [line.split(": ")[0] for line in problems(data)] == ["drive.kind"]

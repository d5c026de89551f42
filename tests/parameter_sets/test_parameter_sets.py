"""The built-in parameter sets: their numbers, units and sources; and sets in files."""

from __future__ import annotations

import pytest

import stribeck
from stribeck import InputError, law
from stribeck.parameter_sets import load, parameters


def test_changing_a_set_changes_no_other():
    parameters()["canudas1995"].values["F_s"] = 99.0
    load("canudas1995").values["F_s"] = 99.0
    assert stribeck.library().sets["canudas1995"].values["F_s"] == 1.5
    assert law("lugre", "canudas1995").p.F_s == 1.5


def test_a_file(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(
        "title = 'Mine'\nsource = 'measured'\nmotion = 'rotary'\n[parameters]\nF_c = 1\nF_s = {value = 2.0, low = 1.9}\n"
    )
    found = load("mine.toml", tmp_path)
    assert (found.name, found.title, found.source, found.motion) == ("mine", "Mine", "measured", "rotary")
    assert found.values == {"F_c": 1, "F_s": 2.0}
    assert load(str(path)).values == found.values
    path.write_text("F_c = 1.0\nF_s = 2.0\nname = 'mine'\nschema = 1\n")
    found = load(str(path))
    assert (found.values, found.title, found.motion) == ({"F_c": 1.0, "F_s": 2.0}, "", "linear")


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("F_c = {value = 1.0, determined = 0}", "F_c.determined: 0: must be true or false"),
        ("F_c = {value = 1.0, determined = 'false'}", "F_c.determined: 'false': must be true or false"),
        ("F_c = {value = 1.0, unit = 3}", "F_c.unit: 3: must be text"),
        ("F_c = {value = 1.0, unit = 'kN'}", "F_c.unit: 'kN': must be N or N m"),
        ("F_c = {value = 1.0, low = 'x'}", "F_c.low: 'x': must be a number"),
        ("F_c = {value = 1.0, high = true}", "F_c.high: true: must be a number"),
        ("F_c = {low = 1.0}", "F_c: a table with low: must be a number, or a table with its value"),
        ("F_c = {value = 1.0, low = 2.0, high = 0.5}", "F_c: low = 2.0 must not be above high = 0.5"),
        ("F_c = {value = 3.0, low = 0.5, high = 2.0}", "F_c.value: 3.0: must lie in its interval, 0.5 to 2.0"),
        ("F_c = {value = 3.0, high = 2.0}", "F_c.value: 3.0: must lie in its interval, -inf to 2.0"),
        (
            "F_c = {value = 1.0, unit = 'N m'}\nF_s = {value = 2.0, unit = 'N'}",
            "F_c in N m, F_s in N: must be units of one kind of motion, straight or turning",
        ),
        ("F_c = 1.0\nsmooth_ab = 'sqrt'", "smooth_ab = 'sqrt': no law has such a constant"),
        ("F_c = 1.0\n[other]\n[more]\n", None),
    ],
)  # fmt: skip
def test_what_stands_beside_a_number_is_looked_at(content, said, tmp_path):
    """``determined = 0`` let a number pass that the data do not determine, and 5 kN was taken as 5 N."""
    path = tmp_path / "mine.toml"
    path.write_text("[parameters]\n" + content)
    if said is None:
        assert law("coulomb_viscous", path, sigma_2=0.0).p.F_c == 1.0
        return
    with pytest.raises(InputError) as error:
        law("coulomb_viscous", path, sigma_2=0.0)
    assert len(error.value.problems) == 1
    assert said in str(error.value)


def test_sets_are_told_apart_by_their_hash():
    assert len({*parameters().values()}) == len(parameters())


def test_a_motion_is_linear_or_rotary(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text("motion = 'rotating'\nF_c = 1.0\nmaker = 'words beside the numbers'\n")
    with pytest.raises(InputError, match="motion: 'rotating': must be linear or rotary"):
        law("coulomb_viscous", path, sigma_2=0.0)
    path.write_text(path.read_text().replace("rotating", "rotary"))
    assert law("coulomb_viscous", path, sigma_2=0.0).rotary

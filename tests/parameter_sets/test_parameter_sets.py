"""The built-in parameter sets: their numbers, units and sources; and sets in files."""

from __future__ import annotations

import pytest

import stribeck
from stribeck import InputError, law
from stribeck.parameter_sets import load, parameters

NAMES = ("sigma_0", "sigma_1", "sigma_2", "F_c", "F_s", "v_s")
KNOWN = {  # theory.md, section 7; sigma_1 of the first is sqrt(1e5)
    "canudas1995": (1e5, 1e5**0.5, 0.4, 1.0, 1.5, 1e-3),
    "olsson1998": (260.0, 0.6, 0.0176, 0.28, 0.33, 0.01),
    "direct_drive2016": (2750.0, 45.2, 1.819, 6.975, 8.558, 0.06109),
    "liu2015": (1.67e6, 6e3, 2.6e4, 2.5, 3.0, 1.6e-8),
    "valve_graphite": (1.038e9, 2.442e5, 7.048e4, 669.9, 942.1, 3.22e-3),
    "valve_teflon": (3.084e5, 650.0, 6.817, 0.415, 0.5148, 3.43e-4),
}


def test_every_known_machine_is_there():
    assert set(parameters()) == set(KNOWN)


@pytest.mark.parametrize("name", KNOWN)
def test_numbers(name):
    found = parameters()[name]
    assert found.name == name
    assert found.values == pytest.approx(dict(zip(NAMES, KNOWN[name], strict=True)), rel=1e-15)
    assert tuple(found.values) == NAMES
    assert all(type(x) is float for x in found.values.values())
    assert found.motion == ("rotary" if name in ("olsson1998", "direct_drive2016") else "linear")
    assert len(found.title) > 5
    assert len(found.source) > 10
    assert {n: x for n, x in law("lugre", name).values.items() if x is not None} == found.values


def test_changing_a_set_changes_no_other():
    parameters()["canudas1995"].values["F_s"] = 99.0
    load("canudas1995").values["F_s"] = 99.0
    assert stribeck.library().sets["canudas1995"].values["F_s"] == 1.5
    assert law("lugre", "canudas1995").p.F_s == 1.5


def test_an_unknown_set():
    with pytest.raises(InputError, match=r"^'canudas1996': no such parameter set \(did you mean 'canudas1995'\?\)$"):
        load("canudas1996")
    with pytest.raises(
        InputError, match=r"^'zzz': no such parameter set \(known: canudas1995, .*; or a file NAME.toml\)$"
    ):
        law("lugre", "zzz")


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
        (None, "cannot be read: No such file or directory"),
        (b"F_c = \n", "is not TOML"),
        (b"\xff", "is not text in UTF-8"),
        (b"x = " + b"9" * 5000, "cannot be read: the path or a number in it"),
        (b"x = " + b"[" * 100_000, "cannot be read: its lists or tables are nested too deeply"),
        (b"parameters = [1.0]\n", "parameters must be a table of numbers"),
    ],
    ids=range(6),
)
def test_a_file_with_a_mistake(content, said, tmp_path):
    path = tmp_path / "mine.toml"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(InputError) as error:
        load(str(path))
    (line,) = error.value.problems
    assert line.startswith(f"{path}: {said}")
    assert line.isprintable()


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

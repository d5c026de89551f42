"""A scenario from a stranger: the laws in files that it names are programs, and which of them are executed."""

import pytest
import tomli_w

import stribeck
from stribeck import InputError, Scenario, examples
from stribeck.cli import _status
from tests.machine.machines import edited, machine
from tests.scenario.valid_scenarios import CANUDAS, VALID
from tests.shared import LINKS, needs_links

LAW = """
from pathlib import Path
from stribeck.laws import BristleLaw
from stribeck.laws.lugre import LuGre
from stribeck.machine.elements.links import Link

Path(__file__).resolve().with_name("executed").touch()

class Mine(LuGre):
    "LuGre."


class Own(Link):
    "A link."
"""


@pytest.fixture
def place(tmp_path):
    """A folder for scenarios with a law in it, in a folder below it and in one beside it."""
    home = tmp_path / "home"
    for folder in (home, home / "below", tmp_path / "beside"):
        folder.mkdir()
        (folder / "mine.py").write_text(LAW)
    if LINKS:
        (home / "link.py").symlink_to(tmp_path / "beside" / "mine.py")
    return home


def write(place, law, **changes):
    path = place / "rig.toml"
    data = edited(VALID["force_points"], {"law": {"name": law, "parameters": CANUDAS}})
    path.write_text(tomli_w.dumps({**data, **changes}))
    return path


def executed(place):
    return sorted(str(p.parent.name) for p in place.parent.rglob("executed"))


LINK = pytest.param("link.py:Mine", marks=needs_links)
STRANGE = ("../beside/mine.py:Mine", LINK, "below/../../beside/mine.py:Mine")


@pytest.mark.parametrize("law", ["mine.py:Mine", "below/mine.py:Mine", "./below/../mine.py:Mine"])
def test_laws_of_the_folder_are_executed(law, place):
    assert Scenario.load(write(place, law)).law.name == "Mine"
    assert len(executed(place)) == 1


@pytest.mark.parametrize("law", STRANGE)
def test_others_are_not_unless_trusted(law, place):
    path = write(place, law)
    with pytest.raises(InputError) as refused:
        Scenario.load(path)
    (line,) = refused.value.problems
    assert line.startswith(f"law.name: {law!r}: lies outside the scenario's folder")
    assert "--trust" in line
    (place / "log.csv").write_text("t,y\n0,0\n1,0\n")
    with pytest.raises(InputError, match="lies outside"):
        stribeck.predict(place / "log.csv", machine=path, time="t", position="y")
    assert executed(place) == []
    assert Scenario.load(path, trust=True).as_machine().law.name == "Mine"
    assert executed(place) == ["beside"]


def test_an_absolute_path(place):
    with pytest.raises(InputError, match="lies outside"):
        Scenario.load(write(place, f"{place.parent}/beside/mine.py:Mine"))
    assert Scenario.load(write(place, f"{place}/mine.py:Mine")).law.name == "Mine"


def test_nothing_is_executed_where_anything_else_is_wrong(place):
    for changes in ({"solve": {"t_end": -1.0}}, {"nonsense": 1}, {"drive": {"kind": "force"}}):
        with pytest.raises(InputError):
            Scenario.load(write(place, "mine.py:Mine", **changes))
        with pytest.raises(InputError):
            Scenario.load(write(place, "mine.py:Mine", **changes), {"law.parameters.F_s": 2.0})
    assert executed(place) == []


def test_what_the_user_names_himself_is_trusted(place):
    path = write(place, "lugre")
    assert Scenario.load(path, {"law.name": "../beside/mine.py:Mine"}).law.name == "Mine"
    assert Scenario.load(path).with_changes({"law.name": "../beside/mine.py:Mine"}).law.name == "Mine"
    own = place / "link.py" if LINKS else place.parent / "beside" / "mine.py"
    assert Scenario(Scenario.load(path).data | {"law": {"name": f"{own}:Mine", "parameters": CANUDAS}})
    # but not what stands beside it in the file
    with pytest.raises(InputError, match="lies outside"):
        Scenario.load(write(place, STRANGE[0]), {"law.parameters.F_s": 2.0})
    assert Scenario.load(path, trust=[STRANGE[0]]).law.name == "Mine"


def test_a_set_is_unfolded_only_by_a_law_that_may_be_executed(place):
    (place / "set.toml").write_text("".join(f"{n} = {x}\n" for n, x in CANUDAS.items()))
    data = edited(VALID["force_points"], {"law": {"name": STRANGE[0], "parameters": "set.toml"}})
    path = place / "rig.toml"
    path.write_text(tomli_w.dumps(data))
    with pytest.raises(InputError, match="lies outside"):
        Scenario.load(path, {"law.parameters.F_s": 2.0})
    assert executed(place) == []
    assert Scenario.load(path, {"law.parameters.F_s": 2.0}, trust=True).law.p.F_s == 2.0


def test_observers_too(place):
    text = examples.path("servo").read_text()
    path = place / "servo.toml"
    assert 'name = "lugre_sobczyk"' in text.partition("[drive.observer]")[2]
    head, mark, rest = text.partition("[drive.observer]")
    path.write_text(head + mark + rest.replace('"lugre_sobczyk"', '"../beside/mine.py:Mine"', 1))
    with pytest.raises(InputError) as refused:
        Scenario.load(path)
    assert [line.split(":")[0] for line in refused.value.problems] == ["drive.observer.name"]
    assert executed(place) == []
    with pytest.raises(InputError, match=r"has no such constant|cannot be an observer"):
        Scenario.load(path, trust=True)
    assert executed(place) == ["beside"]


@pytest.mark.parametrize(
    "words",
    [
        ("run", "@"),
        ("run", "@", "--law", "lugre"),
        ("sweep", "@", "--vary", "law.parameters.F_s=1.5:2:2", "--out", "out"),
        ("design", "@"),
        ("export", "--scenario", "@", "--target", "c", "--out", "out"),
    ],
    ids=lambda words: words[0],
)
def test_every_command(words, place, capsys, monkeypatch):
    monkeypatch.chdir(place)
    path = write(place, STRANGE[0])
    words = [str(path) if word == "@" else word for word in words]
    assert _status(words) == 2
    captured = capsys.readouterr()
    assert captured.err.startswith("law.name: '../beside/mine.py:Mine': lies outside the scenario's folder")
    assert captured.out == ""
    assert executed(place) == []
    assert not (place / "out").exists()
    _status([*words, "--trust"])
    assert executed(place) == ["beside"]


@pytest.mark.parametrize("outside", [False, True])
@pytest.mark.parametrize("key", ["law", "link"])
def test_a_machine_may_name_laws_and_elements(key, outside, place):
    file = "../beside/mine.py" if outside else "mine.py"
    law = {"name": f"{file}:Mine" if key == "law" else "lugre", "parameters": CANUDAS}
    link = {"from": "a", "stiffness": 1.0, "kind": f"{file}:Own" if key == "link" else "link"}
    data = machine({"a": {"mass": 1.0}}, links={"k": link}, contacts={"c": {"from": "a", "law": law}})
    path = place / "machine.toml"
    for wrong, text in (({"solve": {"t_end": -1.0}}, "t_end"), ({}, "lies outside")):
        if wrong or outside:
            path.write_text(tomli_w.dumps(data | wrong))
            with pytest.raises(InputError, match=text):
                Scenario.load(path)
    assert executed(place) == []
    path.write_text(tomli_w.dumps(data))
    assert Scenario.load(path, trust=outside).elements is not None
    assert executed(place) == ["beside" if outside else "home"]


def test_an_observer_s_file_keeps_its_name_in_a_message(tmp_path):
    """Of a file drive.py:X, `controllers.controller.py:X` was refused: a path of the machine's was looked for in it."""
    text = examples.path("servo").read_text()
    head, mark, rest = text.partition("[drive.observer]")
    path = tmp_path / "servo.toml"
    path.write_text(head + mark + rest.replace('"lugre_sobczyk"', '"drive.py:X"', 1))
    with pytest.raises(InputError) as refused:
        Scenario.load(path)
    (line,) = [line for line in refused.value.problems if line.startswith("drive.observer.name")]
    assert "drive.py" in line
    assert "controller" not in line

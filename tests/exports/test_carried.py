"""An export carries what the file says, or says by name what it does not: every key of a machine, every target."""

import copy
import json
import re
import tomllib
import warnings
import zipfile
from pathlib import Path

import pytest

import stribeck
from stribeck import InputError, Scenario
from stribeck.exports import TARGETS
from stribeck.exports.fmu import binaries
from stribeck.scenario import schema
from tests.machine.machines import law

WAVE = {"kind": "sine", "amplitude": 0.5, "frequency": 2.0}
EVERY = tomllib.loads(Path(__file__).with_name("every_key.toml").read_text(encoding="utf-8"))


def only(**names):
    """The machine with these elements alone: a scenario of few is made in a third of the time."""
    sections = {section: {n: EVERY[section][n] for n in chosen} for section, chosen in names.items()}
    return {n: EVERY[n] for n in ("schema", "name", "solve", "output")} | sections


TURNING = {"bodies": ("rotor", "arm"), "links": ("gear",)}
FRICTION = only(**TURNING, contacts=("mesh",), loads=("weight",))
AXIS = only(**TURNING, motors=("drive",), controllers=("axis",))
OTHER = {"sine": "square", "measured": "reference", "ground": "rotor"}


@pytest.fixture(autouse=True)
def _sources_only(monkeypatch):
    """FMUs as they are written without a compiler: what counts here is their text."""
    monkeypatch.setattr(binaries.compiler, "find", lambda: None)


def leaves(node, *path):
    """The keys whose value is no table; lists of numbers are values."""
    if isinstance(node, dict):
        return [leaf for key, inner in node.items() for leaf in leaves(inner, *path, key)]
    if isinstance(node, list) and isinstance(node[0], dict):
        return [leaf for i, inner in enumerate(node) for leaf in leaves(inner, *path, i)]
    return [path]


def at(data, path):
    for key in path:
        data = data[key]
    return data


def with_value(data, path, value):
    data = copy.deepcopy(data)
    at(data, path[:-1])[path[-1]] = value
    return data


def without(data, *path):
    data = copy.deepcopy(data)
    del at(data, path[:-1])[path[-1]]
    return data


def moved(value):
    """Another value of the same kind."""
    if isinstance(value, list):
        return [*value[:-1], moved(value[-1])]
    return value + 1 if isinstance(value, int) and not isinstance(value, bool) else value * 1.125


def exported(data, target, part, folder):
    """The files by name with their bytes, FMUs unpacked, and every line that was said or refused."""
    words = {"contact": "mesh"} if part in ("law", "observer") else {"controller": "axis"} if part != "machine" else {}
    with warnings.catch_warnings(record=True) as message:
        warnings.simplefilter("always")
        try:
            files = stribeck.export(Scenario(data), target, folder, part=part, **words)
        except InputError as error:
            return {}, "\n".join(error.problems)
    content = {file.name if TARGETS[target].folder else "": file.read_bytes() for file in files}
    if target == "fmu":
        (file,) = files
        with zipfile.ZipFile(file) as archive:
            content = {n: archive.read(n) for n in archive.namelist() if not n.startswith("binaries")}
    return content, "\n".join(str(each.message) for each in message)


def keys(node, apart):
    """The keys of every table that a node of the JSON Schema describes, but for tables with such words in them."""
    if isinstance(node, list):
        return set().union(*(keys(each, apart) for each in node))
    if not isinstance(node, dict) or any(word in json.dumps(node.get("properties", {}).get("kind")) for word in apart):
        return set()
    own = set(node["properties"]) if isinstance(node.get("properties"), dict) else set()
    return own.union(*(keys(inner, apart) for inner in node.values()))


def test_every_key_of_a_machine_is_in_the_one_that_is_tried():
    """Those of a contact in the one that is exported."""
    tables = schema.json_schema()["$defs"]["machine"]["properties"]
    tried = dict.fromkeys(("bodies", "links", "loads", "motors", "controllers", "solve"), EVERY)
    for section, where in {**tried, "contacts": EVERY["contacts"]["mesh"]}.items():
        used = {key for path in leaves(where) for key in path}
        assert keys(tables[section], apart=["pneumatic", "pressure"]) <= used, section


# What a value is changed to is another structure, which the tests of machines have.
STRUCTURE = {"schema", "name", "kind", "on", "from", "tied_to", "measures", "force", "against", "contact", "energy"}


def not_carried(target, part, folder, inside, data=EVERY):
    """The keys below ``inside`` whose other value changes neither a file nor what is said of it by name."""
    untouched, _ = exported(data, target, part, folder / "as-it-is")
    assert untouched
    lost = []
    for path in leaves(data):
        value, name = at(data, path), ".".join(map(str, path))
        if not name.startswith(inside) or path[-1] in STRUCTURE or (isinstance(value, str) and value not in OTHER):
            continue
        new = OTHER[value] if isinstance(value, str) else moved(value)
        files, message = exported(with_value(data, path, new), target, part, folder / "changed")
        if files == untouched and not any(name.startswith(word) for word in re.findall(r"[\w.]+\.\w+", message)):
            lost.append(name)
    return lost


@pytest.mark.thorough
@pytest.mark.parametrize("target", ["c", "fmu"])
def test_a_machine_carries_every_key(target, tmp_path):
    """By other bytes for every other value."""
    assert not_carried(target, "machine", tmp_path, "") == []


@pytest.mark.share(5)
@pytest.mark.parametrize("target", [n for n, each in TARGETS.items() if "law" in each.parts and each.loads])
def test_the_friction_of_a_contact_carries_every_key_or_names_it(target, tmp_path):
    data = FRICTION if TARGETS[target].started else without(FRICTION, "contacts", "mesh", "initial")
    lost = not_carried(target, "law", tmp_path, "contacts.mesh.", data)
    apart = ("contacts.mesh.to", "contacts.mesh.factors.sigma_2.signal.")  # where it is; what is an input
    assert [name for name in lost if not name.startswith(apart)] == []


@pytest.mark.share(2)
@pytest.mark.parametrize("target", [n for n, each in TARGETS.items() if "controller" in each.parts])
def test_a_controller_carries_every_key_or_names_it(target, tmp_path):
    lost = not_carried(target, "controller", tmp_path, "controllers.axis.", AXIS)
    if target == "fmu":  # whose reference is an input
        lost = [name for name in lost if not name.startswith("controllers.axis.signal.")]
    assert lost == []


@pytest.mark.share(2)
@pytest.mark.parametrize("target", [n for n, each in TARGETS.items() if "compensator" in each.parts])
def test_a_compensator_carries_every_key_or_names_it(target, tmp_path):
    data = AXIS if target != "table" else without(AXIS, "controllers", "axis", "compensation", "lead")
    lost = not_carried(target, "compensator", tmp_path, "controllers.axis.compensation.", data)
    if target == "table":  # the steady friction does not depend on the bristles' damping
        lost = [name for name in lost if not name.endswith(("law.v_d", "parameters.sigma_1"))]
    assert lost == []


ONE_BODY = {
    "schema": 1, "name": "rig", "law": law(), "plant": {"mass": 1.0, "initial": {"z": 1.25e-6}},
    "drive": {"kind": "force", "signal": WAVE}, "solve": {"t_end": 0.1}, "output": {"step": 0.01},
}  # fmt: skip
PLAIN = without(without(FRICTION, "contacts", "mesh", "loads"), "contacts", "mesh", "factors")


@pytest.mark.parametrize(
    ("data", "key", "z"), [(PLAIN, "contacts.mesh.initial.z", 2e-6), (ONE_BODY, "plant.initial.z", 1.25e-6)]
)
@pytest.mark.parametrize(
    ("target", "part"),
    [(n, part) for n, each in TARGETS.items() for part in ("law", "body", "observer") if part in each.parts],
)
def test_a_deflection_at_the_start_is_carried_or_refused_by_name(target, part, data, key, z, tmp_path):
    if part == "body" and data is PLAIN:
        pytest.skip("a machine has no one body")
    options = {"part": part, "contact": "mesh" if data is PLAIN else None}

    def written(value):
        table = with_value(data, key.split("."), value)
        files = stribeck.export(Scenario(table), target, tmp_path / f"{value}", **options)
        return b"".join(file.read_bytes() for file in files)

    if TARGETS[target].started:
        assert repr(z).encode() in written(z) or target in ("fmu", "table")
        assert (written(z) == written(0.0)) is (target == "table")
    else:
        with pytest.raises(InputError, match=f"^{re.escape(key)}: {z:g}.*must be 0 for target '{target}'"):
            written(z)
        written(0.0)


@pytest.mark.parametrize("target", [n for n, each in TARGETS.items() if "body" in each.parts])
def test_a_body_keeps_its_start_or_refuses_it_by_name(target, tmp_path):
    data = with_value(ONE_BODY, ("plant", "initial"), {"y": 0.125, "v": -0.375})
    if TARGETS[target].started:
        files = stribeck.export(Scenario(data), target, tmp_path / "out", part="body")
        text = b"".join(
            x.read_bytes() if target != "fmu" else zipfile.ZipFile(x).read("modelDescription.xml") for x in files
        )
        assert b"0.125" in text
        assert b"-0.375" in text
    else:
        with pytest.raises(InputError, match=r"plant.initial.y: 0.125: must be 0.*\n.*initial.v: -0.375: must"):
            stribeck.export(Scenario(data), target, tmp_path / "out", part="body")


def test_what_a_table_cannot_have_is_refused_by_name(tmp_path):
    files, message = exported(EVERY, "table", "compensator", tmp_path / "out")
    assert not files
    assert message.startswith("controllers.axis.compensation.lead: must be left out")

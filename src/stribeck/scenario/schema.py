"""The JSON Schema of a scenario file, made from the declarations that validate it; editors complete and check with it.

``stribeck new --schema`` writes it.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from pydantic import BaseModel

from stribeck import laws, parameter_sets
from stribeck.constants import Constant
from stribeck.laws.base import PARAMETERS, Law
from stribeck.machine.element import SECTIONS
from stribeck.machine.elements.bodies.cylinder import Piston
from stribeck.machine.elements.contacts import Deflected
from stribeck.machine.elements.controllers import Pid
from stribeck.machine.elements.controllers.pressure_cascade import NONE, PressureCascade
from stribeck.machine.elements.links import Link
from stribeck.machine.law import LAW
from stribeck.machine.pneumatic.observer import ETA, SCALES, Z_HAT
from stribeck.machine.reading import family_of
from stribeck.machine.signal import SignalTable
from stribeck.machine.table import FileTable
from stribeck.scenario import schema1
from stribeck.scenario.tables import Output, Solve

Node = dict[str, Any]

FILE = "scenario.schema.json"
_MACHINE: Node = {name: {"$ref": f"#/$defs/{name}"} for name in PARAMETERS}
_INSTEAD: Mapping[str, Node] = {n: {"$ref": f"#/$defs/{name}"} for n, name in (("SignalTable", "signal"), (LAW, "law"),
                                                                          ("observer", "observer"))}  # fmt: skip
_TOML_FILE: Node = {"type": "string", "pattern": "\\.toml$", "description": "a file, relative to the scenario file"}


def json_schema() -> Node:
    """The schema, as JSON Schema draft 2020-12."""
    is_machine = {"properties": {"schema": {"const": 2}}, "required": ["schema"]}
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "A scenario of Stribeck: a friction law on a body, or a machine of many bodies (SI units)",
        "if": is_machine,
        "then": {"$ref": "#/$defs/machine"},
        "else": {"$ref": "#/$defs/body"},
        "$defs": {
            "body": _body(),
            "machine": machine_schema(),
            "law": {"oneOf": [*map(_law, laws.builtin().values()), _own_law()], "description": "the friction law"},
            "signal": _family(SignalTable),
            "set": {"anyOf": [_set(), _TOML_FILE]},
            "observer": _observers(),
            **_numbers(PARAMETERS),
        },
    }


def text() -> str:
    """The schema as a file."""
    return json.dumps(json_schema(), indent=1, ensure_ascii=False) + "\n"


def _common(version: int) -> Node:
    """Common top-level keys of a scenario and a machine."""
    return {
        "schema": {"const": version, "description": "the version of the file format"},
        "name": {"type": "string", "description": "the scenario's name; the file's unless given"},
    }


def _body() -> Node:
    """A law on a single body: schema = 1."""
    return {
        **_object(
            {
                **_common(1),
                "rotary": {"type": "boolean", "description": "the machine turns: N m for N, rad for m, kg m^2 for kg"},
                "law": {"$ref": "#/$defs/law"},
                "plant": {"description": "what friction acts on"},
                "drive": {"oneOf": [_drive(kind) for kind in schema1.SIGNALS], "description": "what moves it"},
                "solve": _solve(),
                "output": _model(Output),
            },
            ["schema", "law", "drive", "solve", "output"],
        ),
        **_plants(),
    }


def _plants() -> Node:
    """[plant], which depends on the drive."""

    def driven_by(kind: str) -> Node:
        return {"properties": {"drive": {"properties": {"kind": {"const": kind}}, "required": ["kind"]}}}

    plant_in_file = {
        "type": "object",
        "properties": {"kind": {"type": "string", "pattern": "\\.py:."}},
        "required": ["kind"],
    }
    body, *others = _model(family_of("bodies"))["anyOf"]
    piston = next(x for x in others if x["properties"]["kind"].get("const") == "pneumatic")
    numbers = body["properties"]["initial"]["properties"]
    z = {"z": _model(Deflected)["properties"]["z"]}
    start = _object({**numbers, **z}, [])
    kind = {"const": schema1.MASS, "description": "a single body"}
    mass = _object({"kind": kind, "mass": body["properties"]["mass"], "initial": start}, [])
    velocity_is_set = {"properties": {"plant": {"properties": {"initial": {"properties": {"v": False}}}}}}
    other_kind = {"required": ["kind"], "properties": {"kind": {"not": {"const": schema1.MASS}}}}
    mass_is_needed = {"properties": {"plant": {"anyOf": [{"required": ["mass"]}, other_kind]}}, "required": ["plant"]}
    filled = piston["properties"]["initial"]
    filled = {**filled, "properties": {**filled["properties"], **z}}
    gas = {n: x for n, x in piston["properties"].items() if n not in schema1.NOT_OF_A_PISTON}
    cylinder = {**piston, "properties": {**gas, "initial": filled}}
    pushed: Node = {
        "properties": {"plant": {"anyOf": [mass, plant_in_file]}},
        "if": driven_by("velocity"), "then": velocity_is_set, "else": mass_is_needed,
    }  # fmt: skip
    then = {"properties": {"plant": cylinder}, "required": ["plant"]}
    return {"if": driven_by("cascade"), "then": then, "else": pushed}


def machine_schema() -> Node:
    """A machine: schema = 2; each section has what its family of elements declares."""
    sections: Node = {}
    for section in SECTIONS:
        node = _family(family_of(section))
        names = {"type": "object", "propertyNames": {"pattern": "^[A-Za-z0-9_]+$"}}
        sections[section] = {**names, "additionalProperties": node}
    solve = _model(Solve)
    return _object(
        {**_common(2), **sections, "solve": solve, "output": _model(Output)}, ["schema", "bodies", "solve", "output"]
    )


def _family(family: type[FileTable]) -> Node:
    """The tables of a family: one of its kinds; signals and laws are those of the whole schema."""
    return _model(family, _INSTEAD)


def _object(properties: Node, required: list[str], others: bool | Node = False) -> Node:
    return {"type": "object", "properties": properties, "required": required, "additionalProperties": others}


def _number(constant: Constant) -> Node:
    unit = f", {constant.unit}" if constant.unit else ""
    default = constant.choices[0] if constant.choices else constant.default
    given = {} if default is None else {"default": default}
    return {**constant.allowed_node, "description": f"{constant.meaning}{unit}", **given}


def _numbers(constants: dict[str, Constant]) -> Node:
    return {name: _number(constant) for name, constant in constants.items()}


# -- the law ---------------------------------------------------------------------------------------------------------


def _law(law: type[Law], observes: bool = False) -> Node:
    """A law; one that ``observes`` takes from the plant what it is not given."""
    constants, constants_of_law = law.constants(), law.own_constants()
    needed = [name for name in law.uses if constants[name].required and not observes]
    table = _object({**_MACHINE, **_numbers(constants_of_law)}, needed)
    about = (law.__doc__ or "").strip().partition("\n")[0]
    node = _object(
        {
            "name": {"const": law.name, "description": about},
            **_numbers(constants_of_law),
            "parameters": _parameters(table),
        },
        ["name", *(["parameters"] if needed else [])],
    )
    places = [_somewhere(name) for name, constant in constants_of_law.items() if constant.required]
    return {**node, **({"allOf": places} if places else {})}


def _observers() -> Node:
    """The friction that a controller assumes."""
    without = _object({"name": {"const": NONE, "description": "no compensation"}}, ["name"])
    observers = [_law(law, observes=True) for law in laws.builtin().values() if law.claims.smooth is not False]
    about = f'the law of the friction observer, as in [law]; name = "{NONE}" compensates no friction'
    return {"oneOf": [without, *observers, _own_law()], "description": about}


def _own_law() -> Node:
    """A law in a file of the user's: its constants are not known here."""
    name = {"type": "string", "pattern": "\\.py:.", "description": "FILE.py:NAME, a law of your own"}
    table = _object(_MACHINE, [], {"type": "number"})
    return _object({"name": name, "parameters": _parameters(table)}, ["name"], {"type": "number"})


def _parameters(table: Node) -> Node:
    return {"anyOf": [table, {"$ref": "#/$defs/set"}], "description": "the machine's parameters"}


def _set() -> Node:
    titles = {name: each.title for name, each in parameter_sets.parameters().items()}
    return {"enum": list(titles), "description": "; ".join(f"{name}: {title}" for name, title in titles.items())}


def _somewhere(name: str) -> Node:
    """A constant of the law stands in [law] or among the parameters, in the file or in one that it names."""
    inside: Node = {"anyOf": [{"type": "object", "required": [name]}, _TOML_FILE]}
    return {"anyOf": [{"required": [name]}, {"properties": {"parameters": inside}, "required": ["parameters"]}]}


# -- tables that pydantic declares -----------------------------------------------------------------------------------


def _drive(kind: str) -> Node:
    about = schema1.SIGNALS[kind]
    signal = {"$ref": "#/$defs/signal", "description": about}
    tables: dict[str, type[FileTable]] = {"spring": Link, "pid": Pid, "cascade": PressureCascade}
    names = schema1.constants_of(kind)
    own_table = _family(tables[kind]) if names else {"properties": {}}
    numbers = own_table.get("anyOf", [own_table])[0]["properties"]  # of a family, those of its plain kind
    required = [info.alias or n for n, info in tables[kind].model_fields.items() if info.is_required()] if names else []
    named = {"kind": {"const": kind, "description": f"the signal is the {about}"}}
    properties = {**named, **{n: numbers[n] for n in names}, "signal": signal}
    return _object(properties, ["kind", *(n for n in names if n in required), "signal"])


def _solve() -> Node:
    node = _model(Solve)
    names = [s.name for each in (Pid, Piston) for s in each.states] + [s.name for s in (Z_HAT, ETA, *SCALES)]
    node["properties"]["atol"]["propertyNames"] = {"enum": sorted(["y", "v", "z", *names, "E_in", "E_dissipated"])}
    return node


def _model(model: type[BaseModel], instead: Mapping[str, Node] = MappingProxyType({})) -> Node:
    schema = model.model_json_schema()
    definitions = schema.pop("$defs", {})

    def plain(node: object) -> Any:
        """Without titles, which repeat the names, and without nulls, which TOML does not have. A reference is replaced by its
        definition, or by the node that stands ``instead`` of it."""
        if isinstance(node, list):
            return [plain(inner) for inner in node]
        if not isinstance(node, dict):
            return node
        if "$ref" in node:
            name = node["$ref"].rpartition("/")[2]
            definition = dict(instead[name]) if name in instead else plain(definitions[name])
            return {**definition, **{key: x for key, x in node.items() if key == "description"}}
        if node.get("title") in instead:
            return dict(instead[node["title"]])
        kept = {key: x for key, x in node.items() if key != "title" or not isinstance(x, str)}
        if "anyOf" in kept:
            some = [each for each in kept.pop("anyOf") if each != {"type": "null"}]
            kept = {**some[0], **kept} if len(some) == 1 else {"anyOf": some, **kept}
            return (
                plain(kept)
                if "$ref" in kept or "title" in kept
                else {key: plain(x) for key, x in kept.items() if x is not None}
            )
        return {key: plain(x) for key, x in kept.items() if key != "default" or x is not None}

    result: Node = plain(schema)
    return result

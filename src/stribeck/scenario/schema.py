"""The JSON Schema of a scenario file, made from the declarations that validate it; editors complete and check with it.

``stribeck new --schema`` writes it.
"""

from __future__ import annotations

import json
from typing import Any

from stribeck import drives, laws, parameter_sets, plants
from stribeck.constants import Constant
from stribeck.drives.base import FORCE
from stribeck.laws.base import PARAMETERS, Law
from stribeck.laws.form import USUAL
from stribeck.machine import controllers as machine_controllers
from stribeck.machine import loads as machine_loads
from stribeck.machine.links import LinkElement
from stribeck.scenario import tables
from stribeck.scenario.cascade import NONE
from stribeck.scenario.drives import DRIVES, drive_table, plants_of, settings
from stribeck.scenario.machine import tables as machine_tables
from stribeck.scenario.single import one_body

Node = dict[str, Any]

FILE = "scenario.schema.json"
_MACHINE: Node = {name: {"$ref": f"#/$defs/{name}"} for name in PARAMETERS}
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
            "signal": {"oneOf": [_model(tables.signal_table(kind)) for kind in tables.SIGNALS]},
            "set": {"anyOf": [_set(), _TOML_FILE]},
            **_numbers(PARAMETERS),
        },
    }


def text() -> str:
    """The schema as a file."""
    return json.dumps(json_schema(), indent=1, ensure_ascii=False) + "\n"


def _common(version: int) -> Node:
    """What a scenario and a machine have alike at the top."""
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
                "drive": {"oneOf": [_drive(kind) for kind in DRIVES], "description": "what moves it"},
                "solve": _solve(),
                "output": _model(tables.Output),
            },
            ["schema", "law", "drive", "solve", "output"],
        ),
        **_plants(),
    }


def _plants() -> Node:
    """[plant], which depends on the drive."""

    def driven_by(kind: str) -> Node:
        return {"properties": {"drive": {"properties": {"kind": {"const": kind}}, "required": ["kind"]}}}

    own = {"type": "object", "properties": {"kind": {"type": "string", "pattern": "\\.py:."}}, "required": ["kind"]}
    others = [plant for plant in plants.KINDS.values() if plant.takes == FORCE and plant is not plants.Mass]
    pushed = [*(_model(tables.plant_table(plant, False)) for plant in others), own]
    mass = {**_model(tables.plant_table(plants.Mass, False)), "required": []}
    velocity_is_set = {"properties": {"plant": {"properties": {"initial": {"properties": {"v": False}}}}}}
    other_kind = {"required": ["kind"], "properties": {"kind": {"not": {"const": plants.Mass.kind}}}}
    mass_is_needed = {"properties": {"plant": {"anyOf": [{"required": ["mass"]}, other_kind]}}, "required": ["plant"]}
    found: Node = {
        "properties": {"plant": {"anyOf": [mass, *pushed]}},
        "if": driven_by(_moving()),
        "then": velocity_is_set,
        "else": mass_is_needed,
    }
    for kind, drive in DRIVES.items():
        if drive.gives != FORCE:
            nodes = [_model(tables.plant_table(plant, False)) for plant in plants_of(drive).values()]
            then = {"properties": {"plant": {"anyOf": [*nodes, own]}}, "required": ["plant"]}
            found = {"if": driven_by(kind), "then": then, "else": found}
    return found


def machine_schema() -> Node:
    """A machine: schema = 2."""

    def named(node: Node) -> Node:
        return {"type": "object", "propertyNames": {"pattern": "^[A-Za-z0-9_]+$"}, "additionalProperties": node}

    links = _with_signal(_model(machine_tables.link_table(LinkElement)), "from")
    links["properties"]["from"] = {
        "anyOf": [{"type": "string"}, _object({"signal": {"$ref": "#/$defs/signal"}}, ["signal"])],
        "description": links["properties"]["from"]["description"],
    }
    loads = [_load(kind, load) for kind, load in machine_loads.KINDS.items()]
    controllers = [_controller(kind, each) for kind, each in machine_controllers.KINDS.items()]
    own = {"type": "object", "properties": {"kind": {"type": "string", "pattern": "\\.py:."}}, "required": ["kind"]}
    tables_: Node = {
        "bodies": named(_bodies()),
        "links": named({"anyOf": [links, own]}),
        "contacts": named(_contact()),
        "loads": named({"oneOf": [*loads, own]}),
        "motors": named(_with_signal(_model(machine_tables.motor_table()))),
        "controllers": named({"oneOf": [*controllers, own]}),
    }
    solve = _model(tables.Solve)
    return _object(
        {**_common(2), **tables_, "solve": solve, "output": _model(tables.Output)},
        ["schema", "bodies", "solve", "output"],
    )


def _with_signal(node: Node, *skip: str) -> Node:
    """The table with its signal as a signal, and no nulls, which TOML does not have."""
    for name, inner in node["properties"].items():
        if name == "signal":
            node["properties"][name] = {"$ref": "#/$defs/signal", "description": inner["description"]}
        elif "anyOf" in inner and name not in skip:
            kept = [each for each in inner["anyOf"] if each.get("type") != "null"]
            rest = {key: x for key, x in inner.items() if key not in ("anyOf", "default")}
            node["properties"][name] = {**kept[0], **rest} if len(kept) == 1 else {"anyOf": kept, **rest}
    return node


def _bodies() -> Node:
    node = _with_signal(_model(machine_tables.BodyTable))
    _with_signal(node["properties"]["velocity"])
    driven = {"required": ["velocity"], "properties": {"mass": False, "inertia": False, "tied_to": False}}
    moved = {"oneOf": [{"required": ["mass"]}, {"required": ["inertia"]}]}
    return {**node, "anyOf": [driven, moved]}


def _contact() -> Node:
    node = _model(machine_tables.contact_table())
    node["properties"]["ratio"] = {"type": "number", "description": machine_tables.RATIO}
    node["properties"]["law"] = {"$ref": "#/$defs/law"}
    levels = [_model(machine_tables.level_table(weighted)) for weighted in (False, True)]
    node["properties"]["loads"] = {"type": "array", "items": {"oneOf": levels}, "description": "what raises the level"}
    factors = [_with_signal(_model(machine_tables.factor_table(signal))) for signal in (True, False)]
    about = {"propertyNames": {"not": {"const": "sigma_0"}}, "description": "what parameters are multiplied by"}
    node["properties"]["factors"] = {"type": "object", "additionalProperties": {"oneOf": factors}, **about}
    node["required"] = [*node["required"], "law"]
    return node


def _plain(kind: object) -> object:
    return kind


def _load(kind: str, load: type[machine_loads.LoadElement]) -> Node:
    node = _with_signal(_model(machine_tables.load_table(_plain(load))))
    node["properties"]["kind"] = {"const": kind, "description": (load.__doc__ or "").strip().partition("\n")[0]}
    return node


def _controller(kind: str, each: type[machine_controllers.ControllerElement]) -> Node:
    node = _with_signal(_model(machine_tables.controller_table(_plain(each))))
    node["properties"]["kind"] = {"const": kind, "description": (each.__doc__ or "").strip().partition("\n")[0]}
    _with_signal(node["properties"]["sampling"])
    compensation = _with_signal(_model(machine_tables.CompensationTable))
    compensation["properties"]["law"] = {"$ref": "#/$defs/law"}
    node["properties"]["compensation"] = compensation
    return node


def _moving() -> str:
    """The kind of drive that sets the velocity."""
    (kind,) = (kind for kind, drive in drives.KINDS.items() if drive.sets_velocity)
    return kind


def _object(properties: Node, required: list[str], others: bool | Node = False) -> Node:
    return {"type": "object", "properties": properties, "required": required, "additionalProperties": others}


def _number(constant: Constant) -> Node:
    if constant.choices:
        return {"enum": list(constant.choices), "default": constant.choices[0], "description": constant.meaning}
    unit = f", {constant.unit}" if constant.unit else ""
    optional = {"exclusiveMinimum": constant.above, "minimum": constant.at_least, "default": constant.default}
    given = {key: value for key, value in optional.items() if value is not None}
    return {"type": "number", "description": f"{constant.meaning}{unit}", **given}


def _numbers(constants: dict[str, Constant]) -> Node:
    return {name: _number(constant) for name, constant in constants.items()}


# -- the law ---------------------------------------------------------------------------------------------------------


def _law(law: type[Law]) -> Node:
    constants, own = law.constants(), law.own_constants()
    needed = [name for name in law.uses if constants[name].required]
    table = _object({**_MACHINE, **_numbers(own)}, needed)
    about = (law.__doc__ or "").strip().partition("\n")[0]
    node = _object(
        {"name": {"const": law.name, "description": about}, **_numbers(own), "parameters": _parameters(table)},
        ["name", *(["parameters"] if needed else [])],
    )
    places = [_somewhere(name) for name, constant in own.items() if constant.required]
    return {**node, **({"allOf": places} if places else {})}


def _observer(law: type[Law]) -> Node:
    """A law as an observer: what it is not given it takes from the plant."""
    own = law.own_constants()
    name = {"const": law.name, "description": (law.__doc__ or "").strip().partition("\n")[0]}
    table = _object({**_MACHINE, **_numbers(own)}, [])
    node = _object({"name": name, **_numbers(own), "parameters": _parameters(table)}, ["name"])
    places = [_somewhere(n) for n, constant in own.items() if constant.required]
    return {**node, **({"allOf": places} if places else {})}


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
    drive = DRIVES[kind]
    node = _model(drive_table(kind))
    for key in settings(drive).laws:
        without = _object({"name": {"const": NONE, "description": "no compensation"}}, ["name"])
        observers = [_observer(law) for law in laws.builtin().values() if law.claims.smooth is not False]
        node["properties"][key] = {"oneOf": [without, *observers, _own_law()]}
    about = f"{drive.signal.meaning}, {drive.signal.unit}"
    node["properties"]["signal"] = {"$ref": "#/$defs/signal", "description": about}
    return node


def _solve() -> Node:
    node = _model(tables.Solve)
    states: dict[str, None] = {}
    for drive in DRIVES.values():
        fullest = settings(drive).fullest(drive)
        for plant in plants_of(drive).values():
            system = one_body(laws.BristleLaw, USUAL, fullest, None, not drive.no_energy, plant)
            states |= dict.fromkeys(state.name for state in system.states)
    node["properties"]["atol"]["propertyNames"] = {"enum": sorted(states)}
    return node


def _model(model: type[tables.StrictTable]) -> Node:
    schema = model.model_json_schema()
    definitions = schema.pop("$defs", {})

    def plain(node: object) -> Any:
        """Without titles, which only repeat the names, and with references replaced by what they mean."""
        if isinstance(node, list):
            return [plain(inner) for inner in node]
        if not isinstance(node, dict):
            return node
        if "$ref" in node:
            return plain(definitions[node["$ref"].rpartition("/")[2]])
        return {key: plain(value) for key, value in node.items() if key != "title" or not isinstance(value, str)}

    result: Node = plain(schema)
    return result

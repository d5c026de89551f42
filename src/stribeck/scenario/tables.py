"""The tables of a scenario file that are no elements."""

from __future__ import annotations

import math
from typing import Annotated, Any, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError, create_model
from pydantic_core import ErrorDetails

from stribeck.constants import Constant, kind_of, show
from stribeck.errors import nearest

Problem = tuple[str, str]  # path, message
Fields = dict[str, tuple[object, object]]  # the type of each key and its pydantic field
Table = TypeVar("Table", bound="StrictTable")

RTOL_SMALLEST, RTOL_LARGEST = 1e-13, 0.1


class StrictTable(BaseModel):
    """A table of the file: no unknown keys, no conversions, no inf or nan."""

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False, frozen=True, defer_build=True)


class Solve(StrictTable):
    """How to solve."""

    t_end: float = Field(gt=0, description="end of the simulation, s")
    rtol: float = Field(1e-8, ge=RTOL_SMALLEST, le=RTOL_LARGEST, description="relative tolerance")
    atol: dict[str, Annotated[float, Field(gt=0)]] = Field(
        default_factory=dict, description="absolute tolerance by state; the default scales with F_s/sigma_0 and v_s"
    )
    max_steps: int = Field(
        1_000_000_000, gt=0, le=10**18, description="attempted steps after which the run is given up"
    )


class Output(StrictTable):
    """What to keep."""

    step: float = Field(gt=0, description="time between rows, s: row i is at i * step")
    energy: bool = Field(False, description="add the columns E_in, E_stored and E_dissipated, J")


def made(
    name: str, fields: Fields, about: str | None = None, base: type[StrictTable] = StrictTable
) -> type[StrictTable]:
    """A model made at run time; ``about``: its docstring."""
    given: dict[str, Any] = dict(fields)
    model: type[StrictTable] = create_model(name, __base__=base, __doc__=about, **given)
    return model


def number(constant: Constant, left_out: bool = False) -> tuple[object, object]:
    """A constant's declaration as a pydantic field; ``left_out``: None where it is not given."""
    unit = f", {constant.unit}" if constant.unit else ""
    field = Field(
        ... if constant.required and not left_out else constant.default,
        gt=constant.above, ge=constant.at_least, description=f"{constant.meaning}{unit}",
    )  # fmt: skip
    return (float | None if left_out or constant.optional else float, field)


def given_table(name: str, about: str, constants: dict[str, Constant], all_optional: bool) -> tuple[object, object]:
    """A table of constants that may be left out."""
    fields: Fields = {n: number(c, left_out=all_optional) for n, c in constants.items()}
    model = made(name, fields, about)
    return (model, Field(default_factory=model, description=about))


def validate(model: type[Table], data: object, path: str) -> tuple[Table | None, list[Problem]]:
    """The validated table, or None and what is wrong with it."""
    if not isinstance(data, dict):
        return None, [(path, f"{show(data)}: must be a table, not {kind_of(data)}")]
    try:
        return model.model_validate({key: _up_to_first_wrong(x) for key, x in data.items()}), []
    except ValidationError as error:
        found: dict[str, Problem] = {}  # of a list, the first wrong value
        for details in error.errors(include_url=False):
            problem = _problem(details, model, path)
            found.setdefault(problem[0].partition("[")[0], problem)
        return None, list(found.values())


def _up_to_first_wrong(value: object) -> object:
    """A list of numbers as far as the first that is none: only that is said, and 50 000 problems take a minute."""
    if not isinstance(value, list) or any(isinstance(x, dict | list) for x in value):
        return value
    for i, x in enumerate(value):
        number = x if type(x) is float else float("nan") if type(x) is not int or abs(x) >= 2**1024 else 0.0
        if not math.isfinite(number):
            return value[: i + 1]
    return value


def _problem(details: ErrorDetails, model: type[StrictTable], path: str) -> Problem:
    where, value, kind = details["loc"], details["input"], details["type"]
    name = ".".join(str(part) for part in where if not isinstance(part, int))
    full = f"{path}.{name}" + "".join(f"[{part}]" for part in where if isinstance(part, int))
    if kind == "extra_forbidden":
        known = list(_declared(model, where[:-1])["properties"])
        guess = nearest(str(where[-1]), known) or f" (known here: {', '.join(known)})"
        return full, f"{show(value)}: unknown key{guess}"
    declared = _declared(model, where)
    if kind == "missing":
        meaning = declared.get("description")  # ends of a link have none
        return full, f"missing: must be given{f' ({meaning})' if meaning else ''}"
    text = f"{show(value)}: must be {_allowed(declared)}"
    is_number = kind_of(value) == "a number" and declared.get("type") in ("number", "integer")
    return full, f"{text}, not {kind_of(value)}" if kind.endswith("_type") and not is_number else text


def _declared(model: type[StrictTable], where: tuple[int | str, ...]) -> dict[str, Any]:
    """The JSON Schema of a key."""
    node = schema = model.model_json_schema()
    for part in where:
        inner = "items" if isinstance(part, int) else "additionalProperties"
        node = node.get("properties", {}).get(part) or node[inner]
        if "anyOf" in node:  # the other one is the None of what may be left out
            node = {**node["anyOf"][0], **({"description": node["description"]} if "description" in node else {})}
        if "$ref" in node:
            node = schema["$defs"][node["$ref"].rpartition("/")[2]]
    return node


def _allowed(declared: dict[str, Any]) -> str:
    if "const" in declared:
        return repr(declared["const"])
    if "enum" in declared:
        return f"one of {', '.join(map(str, declared['enum']))}"
    words = {
        "number": "a finite number", "integer": "a whole number", "string": "text", "boolean": "true or false",
        "array": "a list", "object": "a table",
    }  # fmt: skip
    signs = {"exclusiveMinimum": ">", "minimum": ">=", "maximum": "<="}
    bounds = " and ".join(f"{sign} {declared[key]:g}" for key, sign in signs.items() if key in declared)
    empty = "that is not empty" if {"minLength", "minProperties"} & declared.keys() else ""
    return f"{words[declared['type']]} {bounds}{empty}".rstrip()

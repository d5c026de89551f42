"""The tables of a scenario file as pydantic models; those of drives and signals are made from their declarations."""

from __future__ import annotations

from functools import cache
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, create_model

from stribeck import drives, signals
from stribeck.constants import Constant, kind_of, show
from stribeck.errors import nearest
from stribeck.plants.mass import Mass

Problem = tuple[str, str]  # path, message

RTOL_SMALLEST, RTOL_LARGEST = 1e-13, 0.1


class Table(BaseModel):
    """A table of the file: no unknown keys, no conversions, no inf or nan."""

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False, frozen=True)


class Solve(Table):
    """How to solve."""

    t_end: float = Field(gt=0, description="end of the simulation, s")
    rtol: float = Field(1e-8, ge=RTOL_SMALLEST, le=RTOL_LARGEST, description="relative tolerance")
    atol: dict[str, Annotated[float, Field(gt=0)]] = Field(
        default_factory=dict, description="absolute tolerance by state; the default scales with F_s/sigma_0 and v_s"
    )
    max_steps: int = Field(1_000_000_000, gt=0, description="attempted steps after which the run is given up")


class Output(Table):
    """What to keep."""

    step: float = Field(gt=0, description="time between rows, s: row i is at i * step")
    energy: bool = Field(False, description="add the columns E_in, E_stored and E_dissipated, J")


class Initial(Table):
    """The state at t = 0."""

    y: float = Field(0.0, description="position, m")
    v: float = Field(0.0, description="velocity, m/s")
    z: float = Field(0.0, description="bristle deflection, m")


class InitialAtVelocity(Table):
    """The state at t = 0 where the drive sets the velocity."""

    y: float = Field(0.0, description="position, m")
    z: float = Field(0.0, description="bristle deflection, m")


def number(constant: Constant) -> tuple[Any, Any]:
    """A constant's declaration as a pydantic field."""
    unit = f", {constant.unit}" if constant.unit else ""
    field = Field(
        ... if constant.required else constant.default,
        gt=constant.above, ge=constant.at_least, description=f"{constant.meaning}{unit}",
    )  # fmt: skip
    return (float, field)


@cache
def plant_table(mass_needed: bool) -> type[Table]:
    """The model of [plant]."""
    mass: Any = number(Mass.constants["mass"])
    if not mass_needed:
        mass = (float | None, Field(None, gt=0, description=f"{Mass.constants['mass'].meaning}, kg (not used)"))
    initial: Any = Initial if mass_needed else InitialAtVelocity
    fields: dict[str, Any] = {
        "kind": (Literal["mass"], Field("mass", description="a single body")),
        "mass": mass,
        "initial": (initial, Field(default_factory=initial)),
    }
    return create_model("Plant", __base__=Table, **fields)


@cache
def drive_table(kind: str) -> type[Table]:
    """The model of [drive] for a kind of drive; its signal is a table of its own."""
    drive = drives.KINDS[kind]
    fields: dict[str, Any] = {"kind": (Literal[kind], Field(description=drive.meaning))}
    fields |= {name: number(constant) for name, constant in drive.constants.items()}
    fields["signal"] = (dict[str, Any], Field(description=f"{drive.signal.meaning}, {drive.signal.unit}"))
    return create_model(f"{kind.capitalize()}Drive", __base__=Table, __doc__=drive.meaning, **fields)


@cache
def signal_table(kind: str) -> type[Table]:
    """The model of [drive.signal] for a kind of signal."""
    signal = signals.KINDS[kind]
    fields: dict[str, Any] = {"kind": (Literal[kind], Field(description=signal.meaning))}
    fields |= {name: number(constant) for name, constant in signal.constants.items()}
    if signal is signals.Points:
        fields["t"] = (list[float], Field(description="times, s; must not decrease, two equal times make a jump"))
        fields["value"] = (list[float], Field(description="the signal at these times"))
    if signal is signals.File:
        fields["path"] = (str, Field(min_length=1, description="CSV or Parquet file, relative to the scenario file"))
        fields["time"] = (str, Field(description="name of the column of times, s"))
        fields["value"] = (str, Field(description="name of the column of values"))
    return create_model(f"{kind.capitalize()}Signal", __base__=Table, __doc__=signal.meaning, **fields)


def validate(model: type[Table], data: Any, path: str) -> tuple[Any, list[Problem]]:
    """The validated table, or None and what is wrong with it."""
    if not isinstance(data, dict):
        return None, [(path, f"{show(data)}: must be a table, not {kind_of(data)}")]
    try:
        return model.model_validate(data), []
    except ValidationError as error:
        return None, [_problem(details, model, path) for details in error.errors(include_url=False)]


def _problem(details: Any, model: type[Table], path: str) -> Problem:
    where, value, context = details["loc"], details["input"], details.get("ctx", {})
    name = ".".join(str(part) for part in where if not isinstance(part, int))
    full = f"{path}.{name}" if path else name
    full += "".join(f"[{part}]" for part in where if isinstance(part, int))
    kind = details["type"]
    if kind == "missing":
        field = model.model_fields.get(str(where[0]))
        meaning = f" ({field.description})" if field and field.description and len(where) == 1 else ""
        return full, f"missing: must be given{meaning}"
    if kind == "extra_forbidden":
        known = _known_keys(model, where[:-1])
        guess = nearest(str(where[-1]), known) or f" (known here: {', '.join(known)})"
        return full, f"{show(value)}: unknown key{guess}"
    return full, f"{show(value)}: must be {_allowed(kind, context, value)}"


def _known_keys(model: type[BaseModel], where: tuple[Any, ...]) -> list[str]:
    for part in where:
        annotation = model.model_fields[str(part)].annotation
        if isinstance(annotation, type) and issubclass(annotation, BaseModel):
            model = annotation
    return list(model.model_fields)


def _allowed(kind: str, context: dict[str, Any], value: Any) -> str:
    plain = {
        "finite_number": "a finite number", "int_type": f"a whole number, not {kind_of(value)}",
        "float_type": "a finite number" if type(value) is int else f"a number, not {kind_of(value)}",
        "string_type": f"text, not {kind_of(value)}",
        "bool_type": f"true or false, not {kind_of(value)}", "list_type": f"a list, not {kind_of(value)}",
        "dict_type": f"a table, not {kind_of(value)}", "model_type": f"a table, not {kind_of(value)}",
        "string_too_short": "text that is not empty",
    }  # fmt: skip
    bounds = {"greater_than": (">", "gt"), "greater_than_equal": (">=", "ge"), "less_than_equal": ("<=", "le")}
    if kind in bounds:
        sign, key = bounds[kind]
        return f"a number {sign} {context[key]:g}"
    if kind == "literal_error":
        return str(context["expected"])
    return plain.get(kind, kind.replace("_", " "))

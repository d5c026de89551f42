"""The tables of a machine file (schema = 2) as pydantic models; those of elements are made from their declarations."""

from __future__ import annotations

from functools import cache
from typing import Literal

from pydantic import ConfigDict, Field
from pydantic.config import JsonDict

from stribeck.constants import Constant
from stribeck.control.sampled import SAMPLING
from stribeck.machine import controllers, loads
from stribeck.machine.dither import DITHER
from stribeck.machine.element import Element
from stribeck.machine.links import LinkElement
from stribeck.machine.motors import MotorElement
from stribeck.machine.system import FACTOR, FEEDFORWARD, GAIN, LEAD, SHARE
from stribeck.scenario.tables import Fields, StrictTable, made, number

GROUND = "ground"
RATIO = "how far `from` counts: d = ratio y_from - y_to; 1 unless given"
_SIGNAL = (dict[str, object], Field(description="the signal: a table with kind and its constants"))
_SOME_SIGNAL = (dict[str, object] | None, Field(None, description="the signal: a table with kind and its constants"))


class _Aliased(StrictTable):
    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False, frozen=True, populate_by_name=False)


class Initial(StrictTable):
    """Where a body starts."""

    y: float = Field(0.0, description="position at t = 0, m or rad")
    v: float = Field(0.0, description="velocity at t = 0, m/s or rad/s")


class VelocityTable(StrictTable):
    """A velocity that is given."""

    signal: dict[str, object] = Field(description="the velocity: a table with kind and its constants, m/s or rad/s")


class BodyTable(StrictTable):
    """A body."""

    mass: float | None = Field(None, gt=0, description="mass of a body that moves straight, kg")
    inertia: float | None = Field(None, gt=0, description="moment of inertia of a body that turns, kg m^2")
    initial: Initial | None = Field(None, description="the state at t = 0")
    tied_to: str | None = Field(None, description="the body to which it is tied rigidly")
    ratio: float | None = Field(None, description="how far it moves by the body it is tied to; 1 unless given")
    velocity: VelocityTable | None = Field(None, description="the velocity, where it is given: nothing acts back on it")


class Feedforward(StrictTable):
    """What is added to a controller's output."""

    inertia: float = Field(description=f"{FEEDFORWARD.meaning}, kg or kg m^2")


class CompensationTable(StrictTable):
    """What a controller does against friction."""

    contact: str | None = Field(None, description="the contact whose friction it is")
    speed: Literal["reference", "measured"] = Field(
        description="reference or measured: the speed that the law is given"
    )
    law: dict[str, object] | None = Field(None, description="the law, if it is not the contact's")
    share: float | None = Field(None, ge=0, description=f"{SHARE.meaning}; 1 unless given")
    lead: float | None = Field(None, gt=0, description=LEAD.meaning)


class DitherTable(StrictTable):
    """A fast oscillation that a controller adds to its output."""

    kind: Literal["sine", "square"] = Field("sine", description="sine, or square if it is sampled; sine unless given")
    amplitude: float = Field(ge=0, description=f"{DITHER['amplitude'].meaning}, N or N m")
    frequency: float = Field(gt=0, description=f"{DITHER['frequency'].meaning}, Hz")


def _numbers(constants: dict[str, Constant]) -> Fields:
    return {name: number(constant) for name, constant in constants.items()}


@cache
def sampling_table() -> type[StrictTable]:
    """The model of [controllers.NAME.sampling]."""
    fields: Fields = _numbers(SAMPLING)
    fields["resolution"] = (float, Field(0.0, ge=0, description=f"{SAMPLING['resolution'].meaning}, m or rad; 0: none"))
    fields["seed"] = (int, Field(0, ge=0, le=2**32 - 1, description="of the noise: the same seed gives the same noise"))
    return made("Sampling", fields)


@cache
def factor_table(signal: bool) -> type[StrictTable]:
    """The model of a factor: a signal, or waves of the position."""
    fields: Fields = {"signal": _SIGNAL} if signal else {n: _list(c, n) for n, c in FACTOR.items()}
    return made("SignalFactor" if signal else "WavesFactor", fields)


def _list(constant: Constant, name: str) -> tuple[object, object]:
    """A list of numbers; phases may be left out."""
    unit = f", {constant.unit}" if constant.unit else ""
    if name == "phase":
        return (list[float] | None, Field(None, description=f"{constant.meaning}{unit}; 0 unless given"))
    return (list[float], Field(description=f"{constant.meaning}{unit}"))


_AGAINST = "a link, motor or load: counts only while that force is of the other sign and larger, and then by the square"


@cache
def level_table(weighted: bool) -> type[StrictTable]:
    """The model of an entry of a contact's loads; ``weighted``: several forces count."""
    gain = (float, Field(0.0, ge=0, description=GAIN.meaning))
    fields: Fields = {
        "force": (str, Field(description="a link, motor or load, or a table of weights of these")),
        "F_c": gain, "F_s": gain,
        "against": (str | None, Field(None, description=_AGAINST)),
    }  # fmt: skip
    if weighted:
        weights = Field(min_length=1, description="the weight of each link, motor or load")
        fields["force"] = (dict[str, float], weights)
    return made("Level", fields)


_TEXT_OR_TABLE: JsonDict = {"anyOf": [{"type": "string"}, {"type": "object"}]}


def _ends(signal: bool) -> Fields:
    start: object = object if signal else str  # a union would tell of each of its kinds
    what = "a body, or { signal = ... }, the position of a far end" if signal else "a body"
    to = Field(description="a body, or 'ground'") if signal else Field(GROUND, description="a body, or 'ground'")
    return {
        "from_": (start, Field(alias="from", description=what, json_schema_extra=_TEXT_OR_TABLE if signal else None)),
        "to": (str, to),
        "ratio": (float | None, Field(None, description=RATIO)),
    }


@cache
def link_table(kind: object) -> type[StrictTable]:
    """The model of [links.NAME]."""
    assert isinstance(kind, type)
    assert issubclass(kind, LinkElement)
    fields: Fields = {"kind": (str, Field(kind.kind, description="'link', or FILE.py:NAME"))}
    return made("LinkTable", fields | _ends(True) | _element(kind), base=_Aliased)


def _element(kind: type[Element]) -> Fields:
    return _numbers(kind.constants()) | {name: _list(many.constant, name) for name, many in kind.lists().items()}


@cache
def contact_table() -> type[StrictTable]:
    """The model of [contacts.NAME]; its law, loads and factors are tables of their own."""
    fields: Fields = {
        **_ends(False),
        "law": (object, Field(None, description="the friction law")),
        "loads": (list[object], Field(default_factory=list, description="forces that raise the level")),
        "factors": (dict[str, object], Field(default_factory=dict, description="what parameters are multiplied by")),
    }
    return made("ContactTable", fields, base=_Aliased)


@cache
def load_table(kind: object) -> type[StrictTable]:
    """The model of [loads.NAME]."""
    assert isinstance(kind, type)
    assert issubclass(kind, loads.LoadElement)
    fields: Fields = {
        "on": (str, Field(description="the body")),
        "kind": (str, Field(description=f"one of {', '.join(loads.KINDS)}, or FILE.py:NAME")),
        **_element(kind),
    }
    fields |= {"signal": _SIGNAL} if kind.follows_signal else {}
    return made("LoadTable", fields)


@cache
def motor_table() -> type[StrictTable]:
    """The model of [motors.NAME]."""
    fields: Fields = {
        "on": (str, Field(description="the body")),
        **_element(MotorElement),
        "signal": _SOME_SIGNAL,
    }
    return made("MotorTable", fields)


@cache
def controller_table(kind: object) -> type[StrictTable]:
    """The model of [controllers.NAME]."""
    assert isinstance(kind, type)
    assert issubclass(kind, controllers.ControllerElement)
    fields: Fields = {
        "kind": (str, Field(description=f"one of {', '.join(controllers.KINDS)}, or FILE.py:NAME")),
        "on": (str, Field(description="a motor or a body")),
        "measures": (str | None, Field(None, description="the body that carries the encoder")),
        "signal": _SIGNAL,
        **_element(kind),
        "feedforward": (Feedforward | None, Field(None, description="added to the output")),
        "compensation": (dict[str, object] | None, Field(None, description="what is done against friction")),
        "sampling": (sampling_table() | None, Field(None, description="when it computes; continuous without it")),
        "dither": (DitherTable | None, Field(None, description="a fast oscillation, added to the output")),
    }
    return made("ControllerTable", fields)

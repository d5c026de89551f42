"""A table of a file: one frozen pydantic class, which users write in Python too.

The same object carries numbers (a file's), symbols (the structure, from which code is made) or arrays (one value for each
lane). Its equations are ordinary methods, and do not care which.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar, Self, get_args

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, GetJsonSchemaHandler, ValidationError, model_validator
from pydantic.fields import FieldInfo
from pydantic_core import InitErrorDetails, PydanticCustomError, core_schema

from stribeck.constants import Constant, kind_of, show
from stribeck.errors import InputError, corrected, nearest
from stribeck.expressions.graph import symbol
from stribeck.expressions.ops import Value
from stribeck.waveforms import Signal

Problem = tuple[str, str]  # path, message
Key = tuple[str, str]  # the table and the name of a run-time constant
Loc = tuple[int | str, ...]
Held = Any  # what a field holds: a number, a symbol or an array of one for each lane, text, a table, or many of these


def joined(name: str, word: str, by: str = ".") -> str:
    """The name of an element's quantity: ``arm.y``; ``y`` of an element without a name, the only one of its kind."""
    return f"{name}{by}{word}" if name else word


def table_path(section: str, name: str) -> str:
    """The path of an element's table: ``bodies.arm``; ``bodies`` of an element without a name."""
    return f"{section}.{name}" if name else section


@dataclass(frozen=True)
class Reading:
    """The context of reading a table: the base of relative paths, and whether files of code are executed."""

    folder: Path = Path()
    executes: bool = True
    of_file: bool = False  # False: an object that is made in Python, whose folder is not known yet
    place: str = ""  # the path of the element
    unnamed: bool = False  # whether elements have no names: each is the only one of its section
    to_file: Callable[[str], str] = str  # a path as the file has it, for what a message says of other keys
    others: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)  # valid elements read before, by section


# -- what a key may hold ---------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class ConstantField:
    """An annotation: the field is a run-time constant (or a list of them) with a unit and a range."""

    constant: Constant
    many: bool = False
    off_at_zero: bool = False  # 0 is the same as not given: the equations take the shorter form
    in_code: bool = True  # False: a number of the file that compiled code does not take, such as where a state starts

    def on(self, value: Held) -> bool:
        """Whether the constant takes part in the equations."""
        return value is not None and not (self.off_at_zero and isinstance(value, float | int) and value == 0)

    def _read(self, value: Held) -> Held:
        if value is None and (self.constant.optional or (self.many and self.constant.default is not None)):
            return None
        if not self.many:
            if text := self.constant.problem(value):
                raise refused(text, value)
            return float(value)
        if isinstance(value, np.ndarray):
            value = value.tolist()
        if not isinstance(value, list | tuple):
            raise refused(f"must be a list, not {kind_of(value)}", value)
        if not value:
            raise refused("must hold at least one number", value)
        if self._all_finite(value):
            return tuple(value)
        for i, x in enumerate(value):  # of a list the first wrong value is reported
            if text := self.constant.problem(x):
                raise problems_at([((i,), f"{show(x)}: {text}")])
        return tuple(map(float, value))

    def _all_finite(self, value: Sequence[Held]) -> bool:
        """Whether a list of floats needs no look at each: a recording has a hundred thousand."""
        bounded = any(x is not None for x in (self.constant.above, self.constant.at_least, self.constant.largest))
        return not bounded and set(map(type, value)) == {float} and bool(np.isfinite(value).all())

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> Any:
        return core_schema.no_info_plain_validator_function(self._read)

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        node = self.constant.allowed_node
        return {"type": "array", "items": node, "minItems": 1} if self.many else node


def quantity(
    unit: str, meaning: str, *, above: float | None = None, at_least: float | None = None, default: float | None = None,
    optional: bool = False, rotary_unit: str | None = None, many: bool = False, off_at_zero: bool = False,
    largest: float | None = None,
) -> Held:  # fmt: skip
    """A field that is a run-time constant. One with a ``default`` may be left out; an ``optional`` one is off then."""
    declared = Constant(unit, meaning, above, at_least, default, optional or off_at_zero, rotary_unit, largest=largest)
    return given_as(declared, many=many, off_at_zero=off_at_zero)


def given_as(
    declared: Constant, *, many: bool = False, off_at_zero: bool = False, in_code: bool = True, alias: str | None = None
) -> Held:
    """A field that is a constant declared elsewhere."""
    about = f"{declared.meaning}{f', {declared.unit}' if declared.unit else ''}"
    info: Held
    if many and declared.default is not None:  # as long as the list before it
        info = Field(
            default_factory=lambda data: (
                (declared.default,) * next((len(x) for x in data.values() if isinstance(x, tuple)), 0)
            ),
            description=f"{about}; 0 unless given",
        )
    else:
        info = Field(... if declared.required else declared.default, description=about, alias=alias)
    info.metadata.append(ConstantField(declared, many, off_at_zero, in_code))
    return info


@dataclass(frozen=True)
class Refers:
    """An annotation: the field is the name of an element of one of these sections."""

    sections: tuple[str, ...]
    also: tuple[str, ...] = ()


@dataclass(frozen=True)
class Aside:
    """An annotation: the field is no part of the structure, such as where a state starts."""

    instead: object = None  # what a structure has in its place


def annotation(info: FieldInfo, kind: type[Held]) -> Held:
    """The annotation of that kind of a field, or None."""
    return next((x for x in info.metadata if isinstance(x, kind)), None)


# -- problems --------------------------------------------------------------------------------------------------------


def refused(text: str, value: object) -> PydanticCustomError:
    """A problem of the value in hand, for a validator to raise."""
    return PydanticCustomError("stribeck", "{text}", {"text": f"{show(value)}: {text}"})


def problems_at(problems: list[tuple[Loc, str]]) -> ValidationError:
    """Several problems at places below the one in hand, for a validator to raise."""
    lines = [
        InitErrorDetails(type=PydanticCustomError("stribeck", "{text}", {"text": text}), loc=loc, input=None)
        for loc, text in problems
    ]
    return ValidationError.from_exception_data("problems", lines)


def below(path: str, loc: Loc) -> str:
    """A place below a table as a path of the file: ``contacts.mesh.loads[0].F_c``."""
    for part in loc:
        path += f"[{part}]" if isinstance(part, int) else f".{part}" if path else str(part)
    return path


def problems_of(error: ValidationError, path: str = "") -> list[Problem]:
    """Every problem by its path in the file."""
    return [(below(path, each["loc"]), str(each["msg"])) for each in error.errors(include_url=False)]


def unknown_key(key: str, value: object, known: list[str]) -> str:
    """The message about a key that a table does not have."""
    guess = nearest(key, known) or f" (known here: {', '.join(known)})"
    return f"{show(value)}: unknown key{guess}"


def refuse(problems: Iterable[Problem]) -> None:
    """Raise an InputError with a line for each problem, if there is one."""
    if lines := [f"{path}: {text}" for path, text in problems]:
        raise InputError(lines)


def no_table(value: object) -> str:
    """A message about a value that should be a table."""
    return f"{show(value)}: must be a table, not {kind_of(value)}"


_TYPES = {
    "string_type": "text", "bool_type": "true or false", "int_type": "a whole number", "tuple_type": "a list",
    "list_type": "a list", "dict_type": "a table", "float_type": "a finite number", "int_from_float": "a whole number",
}  # fmt: skip
_SIGNS = {"gt": ">", "ge": ">=", "le": "<="}
_BOUNDS = ("greater_than", "greater_than_equal", "less_than_equal")


def _choices(annotation: object) -> list[str]:
    """The words of a Literal, alone or in a union."""
    return [word for x in get_args(annotation) for word in ([x] if isinstance(x, str) else _choices(x))]


def plain_words(info: FieldInfo | None, error: Any) -> str:
    """A message of pydantic's in the words of this project."""
    value, kind, about = error["input"], error["type"], error.get("ctx", {})
    if kind == "literal_error":
        return f"{show(value)}: must be one of {', '.join(_choices(info.annotation)) if info else about['expected']}"
    limits = [
        (sign, getattr(each, name, None)) for each in (info.metadata if info else ()) for name, sign in _SIGNS.items()
    ]
    bounds = [f"{sign} {x if isinstance(x, int) else f'{x:g}'}" for sign, x in limits if x is not None]
    if kind in _TYPES:
        is_number = kind_of(value) == "a number" and "number" in _TYPES[kind]
        allowed = " ".join([_TYPES[kind], *([" and ".join(bounds)] if bounds else [])])
        return f"{show(value)}: must be {allowed}{'' if is_number else f', not {kind_of(value)}'}"
    if kind in _BOUNDS:
        whole = "a whole number" if info is not None and info.annotation is int else "a finite number"
        return f"{show(value)}: must be {whole} {' and '.join(bounds)}"
    if kind == "string_too_short":
        return f"{show(value)}: must be text that is not empty"
    return f"{show(value)}: {error['msg']}"


# -- a table ---------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class ConstantLeaf:
    """A run-time constant of a machine: where it stands in the file, its key, its declaration and its value."""

    path: str
    key: Key
    constant: Constant
    value: Held


@dataclass(frozen=True)
class Carrier:
    """Replacements of run-time constants, and of signals by their paths.

    Symbols, other numbers, or arrays with one number for each lane replace the constants. With ``structure``, no other value
    of the file stays either."""

    put: Callable[[str, str], Value]
    structure: bool = False
    name: str = ""  # of the element that is carried
    signals: Mapping[str, Signal] = field(default_factory=dict)
    open: bool = False  # whether an input is added to each signal but factors, which must stay positive


SYMBOLS = Carrier(lambda owner, name: symbol(f"{owner}.{name}"), structure=True)


class FileTable(BaseModel):
    """A table of a file: no unknown keys, no conversions; it does not change."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, arbitrary_types_allowed=True, defer_build=True)
    positional: ClassVar[tuple[str, ...]] = ()  # the keys that Python takes by position

    def __init__(self, *values: object, **named: object) -> None:
        fields, place = type(self).model_fields, type(self)._place(values, named)
        if (most := len(self.positional)) < len(values):
            text = f"takes {most} value{'' if most == 1 else 's'} by position ({', '.join(self.positional)})"
            raise InputError(f"{place or type(self).__name__.lower()}: {text}")
        named |= dict(zip(self.positional, values, strict=False))
        given = {n: x for n, x in named.items() if x is not None or n not in fields}
        data = {fields[n].alias or n if n in fields else n: x for n, x in given.items()}
        try:  # as BaseModel.__init__ does, but for the context
            self.__pydantic_validator__.validate_python(data, self_instance=self, context=Reading(place=place))
        except ValidationError as error:
            raise InputError([f"{p}: {text}" for p, text in problems_of(error, place)]) from None

    __init__.__pydantic_base_init__ = True  # type: ignore[attr-defined]  # a file's tables do not pass through it

    @classmethod
    def _place(cls, values: tuple[object, ...], named: Mapping[str, object]) -> str:
        """Where a table that is written in Python would stand in a file."""
        return ""

    @classmethod
    def file_keys(cls) -> list[str]:
        """The keys that the table may have, as a file writes them."""
        return [info.alias or name for name, info in cls.model_fields.items() if not info.exclude]

    @model_validator(mode="wrap")
    @classmethod
    def _read(cls, data: Any, handler: Callable[[Any], Self], info: Any) -> Self:
        """Check, and say in plain words what is wrong."""
        if isinstance(data, cls):
            return data
        if not isinstance(data, Mapping):
            raise refused(f"must be a table, not {kind_of(data)}", data)
        kind = cls.kind_for(dict(data), info.context or Reading())
        if kind is not cls:
            return kind.model_validate(data, context=info.context)  # its errors become ours, at our place
        try:
            table = handler(cls.completed(dict(data), info.context or Reading()))
        except ValidationError as error:
            meant = corrected(data, cls.file_keys())
            every = [
                e for e in error.errors(include_url=False)
                if e["type"] != "default_factory_not_called" and not (e["type"] == "missing" and e["loc"][0] in meant)
            ]  # fmt: skip
            raise problems_at([(e["loc"], cls._word(e)) for e in every]) from None
        if problems := table.wrong():
            raise problems_at([(_loc(key), text) for key, text in problems])
        return table

    @classmethod
    def kind_for(cls, data: dict[str, Held], reading: Reading) -> type[Self]:
        """The class that reads this table: another one where the family has kinds."""
        return cls

    @classmethod
    def completed(cls, data: dict[str, Held], reading: Reading) -> dict[str, Held]:
        """The table with what the file does not hold."""
        return data

    @classmethod
    def _word(cls, error: Any) -> str:
        """One of the errors below this table: those of tables within it are in plain words already."""
        if error["type"] == "stribeck":
            return str(error["msg"])
        key = error["loc"][0]
        if error["type"] == "extra_forbidden":
            return unknown_key(str(key), error["input"], cls.file_keys())
        info = next((f for n, f in cls.model_fields.items() if key in (n, f.alias)), None)
        if error["type"] == "missing":
            return f"missing: must be given{f' ({info.description})' if info and info.description else ''}"
        return plain_words(info, error)

    def wrong(self) -> list[Problem]:
        """Contradictions in a table whose keys are valid one by one: key, message."""
        return []

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: Any, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        """The keys of a file alone."""
        node = handler.resolve_ref_schema(handler(schema))
        for name, info in cls.model_fields.items():
            if info.exclude:
                node["properties"].pop(info.alias or name, None)
        return node

    # -- numbers, symbols, arrays --------------------------------------------------------------------------------------

    def leaves(self, path: str) -> Iterator[ConstantLeaf]:
        """Every run-time constant that is on, in the order in which compiled code takes them."""
        inner: list[tuple[str, Held]] = []
        for name, info in type(self).model_fields.items():
            value, quantity = getattr(self, name), annotation(info, ConstantField)
            if annotation(info, Aside) is not None:
                continue
            if quantity is None:
                inner += _inner(value, joined(path, info.alias or name))
            elif not quantity.in_code:
                continue
            elif quantity.on(value) and quantity.many:
                for i, x in enumerate(value):
                    yield ConstantLeaf(f"{path}.{name}.{i}", (path, f"{name}_{i}"), quantity.constant, x)
            elif quantity.on(value):
                key = info.alias or name
                yield ConstantLeaf(f"{path}.{key}", (path, key), quantity.constant, value)
        for inner_path, table in inner:
            yield from table.leaves(inner_path)

    def carrying(self, path: str, carrier: Carrier) -> Held:
        """The same table with what the carrier puts in the place of each run-time constant; None for one that is off."""
        new: dict[str, Held] = {}
        for name, info in type(self).model_fields.items():
            value, quantity = getattr(self, name), annotation(info, ConstantField)
            aside = annotation(info, Aside)
            if aside is not None:
                new[name] = aside.instead if carrier.structure else value
            elif quantity is None:
                new[name] = _carried(value, joined(path, info.alias or name), carrier)
            elif not quantity.in_code:
                new[name] = 0.0 if carrier.structure else value
            elif not quantity.on(value):
                new[name] = None
            elif quantity.many:
                new[name] = tuple(carrier.put(path, f"{name}_{i}") for i in range(len(value)))
            else:
                new[name] = carrier.put(path, info.alias or name)
        return self.model_copy(update=new)

    def to_table(self) -> dict[str, Held]:
        """The value as in a file."""
        table: dict[str, Held] = {}
        for name, info in type(self).model_fields.items():
            if name in self.model_fields_set and not info.exclude and (value := getattr(self, name)) is not None:
                table[info.alias or name] = _written(value)
        return table


class Frozen(dict[str, Held]):
    """A dict that does not change, and has a hash."""

    def __hash__(self) -> int:  # type: ignore[override]
        return hash(tuple(self.items()))


def _loc(key: str) -> Loc:
    """``t[3]`` and ``initial.v`` as places below a table."""
    keys: list[int | str] = []
    for word in key.split(".") if key else ():
        name, _, number = word.partition("[")
        keys += [name, *([int(number[:-1])] if number else [])]
    return tuple(keys)


def _written(value: Held) -> Held:
    """A field's value as a file has it."""
    if hasattr(value, "to_table"):
        return value.to_table()
    if isinstance(value, tuple):
        return [_written(x) for x in value]
    if isinstance(value, dict):
        return {n: _written(x) for n, x in value.items()}
    return str(value) if isinstance(value, Path) else value


def within(value: Held, path: str) -> Iterator[tuple[str, Held]]:
    """Whatever stands in a table, a list or a dict, by its path as messages have it."""
    if isinstance(value, FileTable):
        for name, info in type(value).model_fields.items():
            yield joined(path, info.alias or name), getattr(value, name)
    elif isinstance(value, dict):
        yield from ((f"{path}.{name}", x) for name, x in value.items())
    elif isinstance(value, tuple) and set(map(type, value)) != {float}:  # samples hold nothing
        yield from ((f"{path}[{i}]", x) for i, x in enumerate(value))


def _inner(value: Held, path: str) -> list[tuple[str, Held]]:
    """The tables within a field, by the paths of their keys."""
    if hasattr(value, "leaves"):
        return [(path, value)]
    if isinstance(value, tuple):
        return [table for i, each in enumerate(value) for table in _inner(each, f"{path}.{i}")]
    if isinstance(value, dict):
        return [table for name, each in value.items() for table in _inner(each, f"{path}.{name}")]
    return []


def _carried(value: Held, path: str, carrier: Carrier) -> Held:
    if hasattr(value, "carrying"):
        return value.carrying(path, carrier)
    if isinstance(value, tuple):
        return tuple(_carried(x, f"{path}.{i}", carrier) for i, x in enumerate(value))
    if isinstance(value, dict):
        return Frozen({n: _carried(x, f"{path}.{n}", carrier) for n, x in value.items()})
    return value

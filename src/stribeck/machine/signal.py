"""Signals as tables: what users write, what a file holds, and how the equations refer to one."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path, PurePath
from types import SimpleNamespace
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import BeforeValidator, Field, PlainValidator, ValidationError, ValidationInfo, WithJsonSchema

from stribeck import waveforms
from stribeck.constants import Constant, kind_of
from stribeck.errors import InputError, naming
from stribeck.expressions.graph import Expr, symbol
from stribeck.machine.family import Family
from stribeck.machine.table import (
    Carrier,
    ConstantLeaf,
    Held,
    Problem,
    Reading,
    given_as,
    joined,
    problems_at,
    refused,
    unknown_key,
)
from stribeck.waveforms.pieces import DIRECTION, Reference, constants, fields, reference

INPUT = "input"  # what an exported machine adds to a signal
_INPUT = Constant("", "added to the signal", default=0.0)
_TIMES, _VALUES = Constant("s", "times of the points"), Constant("", "the signal at these times")


@dataclass(frozen=True)
class SignalUse:
    """A signal in the equations.

    Attributes:
        name: of its numbers in the code.
        path: of its table.
        kind: its class; None: straight pieces.
        turns: whether it is cut where it turns.
        open: whether an input of an export is added to it.
    """

    name: str
    path: str
    kind: type[waveforms.Signal] | None
    turns: bool = False
    open: bool = False

    @property
    def fields(self) -> tuple[str, ...]:
        """The numbers of a piece."""
        return fields(self.kind, self.turns)

    def constants(self) -> dict[str, Constant]:
        """The constants of a run."""
        declared = {n: self.kind.constants[n] for n in constants(self.kind)} if self.kind else {}
        return {**declared, INPUT: _INPUT} if self.open else declared

    def reference(self, t: Expr) -> Reference:
        """The signal and its derivatives at the time t."""
        values = {n: symbol(f"segment.{joined(self.name, n, '_')}") for n in self.fields}
        values |= {n: symbol(f"{self.path}.{n}") for n in self.constants()}
        course = reference(self.kind, SimpleNamespace(**values), t, values.get(DIRECTION, 0.0))
        return replace(course, value=course.value + values[INPUT]) if self.open else course


class SignalTable(Family, family=True):
    """A signal of time: a table with ``kind`` and its constants."""

    made_by: ClassVar[type[Any]]  # the class that has the equation

    @cached_property
    def built(self) -> waveforms.Signal:
        """The signal itself."""
        keys = {info.alias or name: name for name, info in type(self).model_fields.items()}
        signal: waveforms.Signal = self.made_by({n: getattr(self, keys[n]) for n in self.made_by.constants})
        return signal

    def leaves(self, path: str) -> Iterator[ConstantLeaf]:
        """Its constants, if the equation takes them; others make pieces."""
        return super().leaves(path) if self._in_code() else iter(())

    @property
    def _form(self) -> type[waveforms.Signal] | None:
        """The class of its equation; None for straight pieces."""
        return self.made_by if self.made_by.smooth else None

    def _in_code(self) -> bool:
        return bool(constants(self._form))

    def carrying(self, path: str, carrier: Carrier) -> Held:
        """In the structure, how equations refer to it: by a name for its pieces and a path for its constants."""
        if path in carrier.signals:
            table = self.model_copy()
            vars(table)["built"] = carrier.signals[path]
            return table
        if not carrier.structure:
            return super().carrying(path, carrier) if self._in_code() else self
        *_, inside, factor, _ = ("", "", *path.split("."))
        name = f"{carrier.name}_{factor}" if inside == "factors" else carrier.name
        return SignalUse(name, path, self._form, open=carrier.open and inside != "factors")


class _Through(SignalTable):
    """A signal through points."""

    positional = ("t", "value")
    kind: str = ""
    t: tuple[float, ...] = given_as(_TIMES, many=True, in_code=False)
    value: tuple[float, ...] = given_as(_VALUES, many=True, in_code=False)

    @cached_property
    def built(self) -> waveforms.Signal:
        """See :class:`SignalTable`."""
        signal: waveforms.Signal = self.made_by(np.array(self.t), np.array(self.value))
        return signal

    def wrong(self) -> list[Problem]:
        """Times that do not increase, lists of two lengths and the like."""
        return list(self.made_by.problems(np.array(self.t), np.array(self.value)))


class Points(_Through):
    """Straight lines between points, constant outside; two equal times make a jump."""

    made_by = waveforms.PointsSignal
    kind: Literal["points"] = "points"


class Ramp(SignalTable):
    """rate * t."""

    made_by, positional = waveforms.RampSignal, ("rate",)
    kind: Literal["ramp"] = "ramp"
    rate: float = given_as(waveforms.RampSignal.constants["rate"])


class Sine(SignalTable):
    """offset + amplitude sin(2 pi frequency t + phase); frequency in Hz, phase in rad."""

    made_by, positional = waveforms.SineSignal, ("amplitude", "frequency", "offset", "phase")
    kind: Literal["sine"] = "sine"
    amplitude: float = given_as(waveforms.SineSignal.constants["amplitude"])
    frequency: float = given_as(waveforms.SineSignal.constants["frequency"])
    offset: float = given_as(waveforms.SineSignal.constants["offset"])
    phase: float = given_as(waveforms.SineSignal.constants["phase"])


class Step(SignalTable):
    """0 before ``time`` (s; ``at`` in Python), ``value`` from then on."""

    made_by = waveforms.StepSignal
    kind: Literal["step"] = "step"
    value: float = given_as(waveforms.StepSignal.constants["value"])
    at: float = given_as(waveforms.StepSignal.constants["time"], alias="time")

    def __init__(self, value: float, at: float = 0.0) -> None:
        super().__init__(value=value, at=at)  # type: ignore[call-arg]

    __init__.__pydantic_base_init__ = True  # type: ignore[attr-defined]  # of Python alone, as in FileTable


class File(SignalTable):
    """Two columns of a CSV, Parquet, MAT or NPZ file, read as points."""

    made_by, positional = waveforms.FileSignal, ("path", "time", "value")
    kind: Literal["file"] = "file"
    scale: float = given_as(waveforms.FileSignal.constants["scale"], in_code=False)
    path: Annotated[str, BeforeValidator(lambda x: str(x) if isinstance(x, PurePath) else x)] = Field(
        min_length=1, description="CSV, Parquet, MAT or NPZ file, relative to the scenario file"
    )
    time: str = Field(description="name of the column of times")
    time_unit: str | None = Field(None, description="unit of that column, such as ms; the file's, or s, unless given")
    value: str = Field(description="name of the column of values")
    unit: str | None = Field(None, description="unit of that column, such as mm; the file's, or SI, unless given")
    folder: Path | None = Field(None, exclude=True)  # None: written in Python, and read when its machine is made

    @classmethod
    def completed(cls, data: dict[str, Any], reading: Reading) -> dict[str, Any]:
        """Relative paths begin in the scenario's folder."""
        if "folder" in data:
            raise problems_at([(("folder",), unknown_key("folder", data["folder"], cls.file_keys()))])
        return {**data, "folder": reading.folder} if reading.of_file else data

    @cached_property
    def built(self) -> waveforms.Signal:
        """See :class:`SignalTable`."""
        columns = ((self.folder or Path()) / self.path, self.time, self.value)
        return waveforms.FileSignal.read(*columns, self.unit, self.time_unit, self.scale)

    def wrong(self) -> list[Problem]:
        """Problems of the recording and its columns."""
        if self.folder is None:
            return []
        try:
            with naming(str):  # the keys of a table are called as the arguments
                self.built  # noqa: B018
        except InputError as error:
            keyed = (text.partition(": ") for text in error.problems)
            return [("path" if key == "data" else key, text) for key, _, text in keyed]
        return []


class PointToPoint(_Through):
    """Moves from point to point, each with zero speed, acceleration and jerk at both ends."""

    made_by = waveforms.PointToPointSignal
    kind: Literal["point_to_point"] = "point_to_point"


class Spline(_Through):
    """A spline of order seven through points, at rest at the first and the last."""

    made_by = waveforms.SplineSignal
    kind: Literal["spline"] = "spline"


class Square(SignalTable):
    """offset + amplitude for half a period, offset - amplitude for the other half, ``cycles`` times; then offset."""

    made_by, positional = waveforms.SquareSignal, ("amplitude", "frequency", "cycles", "offset")
    kind: Literal["square"] = "square"
    amplitude: float = given_as(waveforms.SquareSignal.constants["amplitude"])
    frequency: float = given_as(waveforms.SquareSignal.constants["frequency"])
    cycles: int = Field(ge=1, le=100_000, description="number of periods")
    offset: float = given_as(waveforms.SquareSignal.constants["offset"])


class Staircase(SignalTable):
    """Each of ``levels`` is held for ``hold`` s. The way to the next one takes ``ramp`` s. The last one stays."""

    made_by, positional = waveforms.StaircaseSignal, ("levels", "hold", "ramp")
    kind: Literal["staircase"] = "staircase"
    levels: tuple[float, ...] = given_as(
        Constant("", "the signal's levels, one after the other"), many=True, in_code=False
    )
    hold: float = given_as(Constant("s", "how long each level is held", above=0), in_code=False)
    ramp: float = given_as(
        Constant("s", "how long the way to the next level takes; 0 jumps", at_least=0, default=0.0), in_code=False
    )

    @cached_property
    def built(self) -> waveforms.Signal:
        """See :class:`SignalTable`."""
        return waveforms.StaircaseSignal.through(np.array(self.levels), self.hold, self.ramp)


def _signals(value: object, info: ValidationInfo) -> tuple[SignalTable, ...]:
    """The signals of a sum, each read by its kind."""
    if not isinstance(value, list | tuple):
        raise refused(f"must be a list of signals, not {kind_of(value)}", value)
    signals, wrong = [], []
    for i, each in enumerate(value):
        try:
            signals.append(SignalTable.model_validate(each, context=info.context))
        except ValidationError as error:
            wrong += [((i, *e["loc"]), str(e["msg"])) for e in error.errors(include_url=False)]
    if wrong:
        raise problems_at(wrong)
    return tuple(signals)


class Sum(SignalTable):
    """The sum of several signals of any kinds."""

    made_by, positional = waveforms.SumSignal, ("of",)
    kind: Literal["sum"] = "sum"
    of: Annotated[
        Held, PlainValidator(_signals), WithJsonSchema({"type": "array", "items": {"title": "SignalTable"}})
    ] = Field(description="a list of signals: tables with kind and their constants")

    @cached_property
    def built(self) -> waveforms.Signal:
        """See :class:`SignalTable`."""
        return waveforms.SumSignal.flattened([each.built for each in self.of])

    @property
    def _form(self) -> type[waveforms.Signal]:
        return type(self.built)

    def wrong(self) -> list[Problem]:
        """Nothing to add up."""
        return [] if self.of else [("of", "[]: must hold at least one signal")]

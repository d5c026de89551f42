"""fit.json: a fit as a file, of a log or of a machine, written and read back."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Literal, TypeVar

from pydantic import Field, PlainValidator, ValidationError

from stribeck import laws
from stribeck.constants import path_of, show
from stribeck.errors import InputError, StribeckError, arg
from stribeck.files import finite, json_of, seen_from
from stribeck.identify.actuator.result import LogResult, MachineFit
from stribeck.identify.core.predictor import Predictor, of_json
from stribeck.identify.core.states import Estimate, Kept
from stribeck.identify.data.quality import LARGEST
from stribeck.identify.models.terms import TERMS
from stribeck.identify.models.terms import problem as term_problem
from stribeck.identify.result import Fit, LogFit, RecordReading
from stribeck.laws.base import Law
from stribeck.machine.table import FileTable, problems_of, refused
from stribeck.parameter_sets import read_toml
from stribeck.scenario.trust import astray

FILE, MACHINE = "fit.json", "machine.toml"
_FORMAT = 6  # counts the layouts of fit.json
_LOG, _MACHINE = "log", "machine"
# -- writing ---------------------------------------------------------------------------------------------------------


def text_of(fit: Fit, folder: Path) -> str:
    """A fit as the text of a fit.json that lies in a folder: every number with both uncertainties and its state."""
    common = {
        "format": _FORMAT, "kind": _LOG if isinstance(fit, LogFit) else _MACHINE, "status": fit.status,
        "estimates": {n: e.to_dict() for n, e in fit.parameters.items()}, "notes": list(fit.notes),
    }  # fmt: skip
    if isinstance(fit, LogFit):
        details = _of_log(fit, folder)
    else:
        assert isinstance(fit, MachineFit)
        details = _of_machine(fit, folder)
    return json.dumps(finite({**common, **details}), indent=1, allow_nan=False)


def _of_log(fit: LogFit, folder: Path) -> dict[str, object]:
    """The model, the ranges that it has seen, and how its record was read."""
    return {
        "law": fit.law_name, "method": fit.method, "values": fit.values, "given": list(fit.given), "levels": fit.speeds,
        "predictor": fit.predictor.to_json() if fit.predictor else None,
        "candidates": [dict(c) for c in fit.candidates], "fit": fit.known, "seen": fit.seen,
        "data_sha256": fit.data_hash, **asdict(fit.reading),
        "files": [seen_from(folder, Path(name)) for name in fit.reading.files],
    }  # fmt: skip


def _of_machine(fit: MachineFit, folder: Path) -> dict[str, object]:
    """The recordings, what is left of each, and what else was fitted to them."""
    return {
        "reason": fit.reason, "name": fit.name, "levels": fit.speeds, "correlated": fit.correlated,
        "logs": [log.to_dict() for log in fit.logs], "noise": fit.noise, "baselines": fit.baselines, "laws": fit.laws,
        "source": None if fit.source is None else seen_from(folder, fit.source),
    }  # fmt: skip


# -- reading -----------------------------------------------------------------------------------------------------------

Number = Annotated[float, Field(ge=-LARGEST, le=LARGEST)]
Some = TypeVar("Some")


def _made_by(make: Callable[[Kept], Some], what: str) -> PlainValidator:
    """A part of the file that is made by a function, or refused in a word."""

    def read(x: Kept) -> Some:
        try:
            return make(x)
        except (KeyError, TypeError, ValueError, OverflowError, AttributeError, StribeckError):
            raise refused(f"must be {what}", x) from None

    return PlainValidator(read)


def _recording_of(x: Kept) -> LogResult:
    errors = {str(n): dict(e) for n, e in x["errors"].items()}
    if not all(abs(float(e[key])) <= LARGEST for e in errors.values() for key in ("rms", "relative")):
        raise ValueError
    return LogResult(str(x["file"]), bool(x["held_out"]), [], errors)  # type: ignore[arg-type]


def _range_of(x: Sequence[float]) -> tuple[float, float]:
    low, high = x
    if not -LARGEST <= low <= high <= LARGEST:
        raise ValueError
    return low, high


def _gain_of(x: object) -> object:
    if not (x is None or isinstance(x, str) or (isinstance(x, int | float) and abs(x) <= LARGEST)):
        raise ValueError
    return x


class SavedErrors(FileTable):
    """The errors of a fit of a log."""

    relative_force_error: float | None = Field(ge=0, le=LARGEST)
    cross_validated_error: float | None = Field(ge=0, le=LARGEST)
    friction_error: float | None = Field(ge=0, le=LARGEST)
    missed: float | None = Field(ge=0, le=LARGEST)


class SavedFit(FileTable):
    """What fit.json has of every fit."""

    format: int
    kind: str
    status: str
    estimates: dict[str, Annotated[Estimate, _made_by(Estimate.of_dict, "an estimate")]]
    levels: dict[str, Number]
    notes: list[str]

    def parts(self, *names: str) -> Kept:
        """Parts of every fit, and those that are named, as arguments: the estimates, the levels apart, and their speeds."""
        levels = {n: self.estimates[n] for n in self.levels if n in self.estimates}
        estimates = {n: e for n, e in self.estimates.items() if n not in levels}
        apart = {"estimates": estimates, "levels": levels, "speeds": self.levels}
        return {**apart, **{n: getattr(self, n) for n in ("notes", "status", *names)}}


class SavedLogFit(SavedFit):
    """fit.json of a log."""

    law: str
    method: Literal["static", "dynamic"]
    values: dict[str, object]
    given: list[str]
    predictor: Annotated[Predictor, _made_by(of_json, "the model of a static fit")] | None
    candidates: list[dict[str, object]]
    fit: SavedErrors
    seen: dict[str, Annotated[tuple[float, float], _made_by(_range_of, "a range, [low, high]")]]
    data_sha256: str
    files: list[str]
    columns: dict[str, str]
    units: dict[str, str]
    force_gain: Annotated[float | str | None, _made_by(_gain_of, "a number, or a name")]
    cutoff: float | None = Field(ge=0, le=LARGEST)
    output: Literal["force", "position", "velocity"]
    published: bool
    simulated: bool


class SavedMachineFit(SavedFit):
    """fit.json of a machine."""

    reason: str
    name: str
    correlated: list[dict[str, object]]
    logs: list[Annotated[LogResult, _made_by(_recording_of, "a recording")]]
    noise: dict[str, Number]
    baselines: dict[str, dict[str, object]]
    laws: dict[str, object] | None
    source: str | None


def load(folder: Path | str, trust: bool = False) -> Fit:
    """The fit in a folder; as :meth:`stribeck.Fit.load` says."""
    path = path_of(folder, "fit")
    place = f"{arg('fit')}: '{path}'"
    try:
        if path.is_dir():
            path, place = path / FILE, f"{arg('fit')}: '{path / FILE}'"
        data = json_of(path)
    except OSError as error:
        raise InputError(f"{place}: cannot be read: {error.strerror} ('stribeck fit' writes it)") from None
    except ValueError:
        raise InputError(f"{place}: is not JSON") from None
    if not isinstance(data, dict) or type(data.get("format")) is not int or data["format"] != _FORMAT:
        raise InputError(f"{place}: is no model of a fit (of format {_FORMAT}): must be fitted again")
    try:
        if data.get("kind") == _MACHINE:
            return _machine_fit(SavedMachineFit.model_validate(data), path.parent, trust)
        saved = SavedLogFit.model_validate(data)
    except ValidationError as error:
        raise InputError([f"{place}: {part}: {text}" for part, text in problems_of(error)]) from None
    return _log_fit(saved, path, trust)


def _log_fit(saved: SavedLogFit, path: Path, trust: bool) -> LogFit:
    """The fit of a log, after a look at its law and its numbers."""
    place = f"{arg('fit')}: '{path}'"
    if not trust and astray([saved.law], Path(), Path(), path.parent):
        text = "lies elsewhere, and a law is a program that would be executed"
        remedy = "must be in the current folder, in the fit's or below them, or allowed with trust=True (--trust)"
        raise InputError(f"{place}: {show(saved.law)}: {text}: {remedy}")
    law, values = laws.find(saved.law), saved.values
    needed = [n for n, c in law.constants().items() if c.required and n not in values]
    if texts := [*_wrong(law, values), *(f"{n}: missing: law '{law.name}' needs it" for n in needed)]:
        raise InputError([f"{place}: values.{text}" for text in texts])
    known = saved.fit.relative_force_error
    return LogFit(
        **saved.parts("method", "values", "given", "candidates", "predictor", "seen"),
        law_name=law.name if ".py:" not in saved.law else saved.law, data_hash=saved.data_sha256,
        relative_force_error=float("nan") if known is None else known,
        cross_validated_error=saved.fit.cross_validated_error, friction_error=saved.fit.friction_error,
        missed=saved.fit.missed,
        reading=RecordReading(
            tuple(str(path.parent / name) for name in saved.files), saved.columns, saved.units, saved.force_gain,
            saved.cutoff, saved.output, saved.published, saved.simulated,
        ),
    )  # fmt: skip


def _machine_fit(saved: SavedMachineFit, folder: Path, trust: bool) -> MachineFit:
    """The fit of a machine; the machine itself is the file beside it."""
    machine = folder / MACHINE
    tables = read_toml(machine) if machine.is_file() and saved.status == "done" else {}
    return MachineFit(
        **saved.parts("reason", "correlated", "logs", "noise", "baselines", "laws", "name"), data=tables, folder=folder,
        source=None if saved.source is None else folder / saved.source, trust=trust,
    )  # fmt: skip


def _wrong(law: type[Law], values: Mapping[str, object]) -> list[str]:
    """What is wrong with the values of a model."""
    problems, known = [], law.constants()
    for name, value in values.items():
        if name in known:
            text = known[name].problem(value)
        elif name in TERMS:
            text = term_problem(name, value)
        else:
            text = f"neither a constant of {law.name} nor a term"
        if not text and isinstance(value, int | float) and not abs(value) <= LARGEST:
            text = f"{value:.4g}: must be at most {LARGEST:g}"
        problems += [f"{name}: {text}"] if text else []
    constants = {n: x for n, x in values.items() if n in known and isinstance(x, float | int | str)}
    return problems or [f"{name}: {text}" for name, text in law.broken(constants)]

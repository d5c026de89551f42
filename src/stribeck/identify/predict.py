"""A fitted model on another record: what force it predicts, and how far off that is."""

from __future__ import annotations

import json
from collections.abc import Callable, Container, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import SimpleNamespace
from typing import TypedDict, TypeGuard, cast

import numpy as np
from numpy.typing import NDArray

from stribeck import laws
from stribeck.arrays import Array
from stribeck.constants import Constant, show
from stribeck.errors import InputError, StribeckError, arg, nearest
from stribeck.files import finite, json_of
from stribeck.identify import api
from stribeck.identify.beyond import Beyond, beyond
from stribeck.identify.core.predictor import EXPECTED, Predictor, of_json
from stribeck.identify.data.prepare import Preparation
from stribeck.identify.data.quality import LARGEST
from stribeck.identify.data.read import ColumnNames
from stribeck.identify.features.rest import at_rest
from stribeck.identify.log import Log
from stribeck.identify.models import terms
from stribeck.identify.models.terms import TERMS
from stribeck.identify.onebody import beside_friction, parts
from stribeck.identify.options import METHODS, OUTPUTS
from stribeck.identify.result import Fit, Prediction
from stribeck.scenario.trust import astray

FILE = "fit.json"
_FORMAT = 4
_LIKE = {
    "spring": "stiffness",
    "weight": "gravity_sin",
    "level by position": "F_c_by_position",
}  # forms that act like terms


def _text(x: object) -> bool:
    return isinstance(x, str)


def _number(x: object) -> TypeGuard[float]:
    return isinstance(x, int | float) and not isinstance(x, bool) and abs(x) <= LARGEST


def _share(x: object) -> bool:
    return x is None or (_number(x) and x >= 0)


def _range(x: object) -> bool:
    return isinstance(x, list | tuple) and len(x) == 2 and all(map(_number, x)) and x[0] <= x[1]


def _table_of(known: Callable[[object], bool]) -> Callable[[object], bool]:
    return lambda x: isinstance(x, dict) and all(map(known, x.values()))


def _one_of(*words: str) -> tuple[Callable[[object], bool], str]:
    return lambda x: isinstance(x, str) and x in words, f"one of {', '.join(words)}"


def _predictor(x: object) -> bool:
    """Whether it is nothing, or what a static fit wrote."""
    try:
        return x is None or (isinstance(x, dict) and of_json(x) is not None)
    except (KeyError, TypeError, ValueError, AttributeError, StribeckError):
        return False


# What each part of the file must be, and that in words.
_PARTS: dict[str, tuple[Callable[[object], bool], str]] = {
    "law": (_text, "a name"),
    "method": _one_of(*METHODS),
    "values": (lambda x: isinstance(x, dict), "a table"),
    "estimates": (_table_of(lambda x: isinstance(x, dict)), "a table of estimates"),
    "predictor": (_predictor, "nothing or the model of a static fit"),
    "fit": (lambda x: isinstance(x, dict), "a table"),
    "columns": (_table_of(_text), "a table of names"),
    "units": (_table_of(_text), "a table of units"),
    "force_gain": (
        lambda x: x is None or _text(x) or _number(x),
        f"nothing, a name or a number of at most {LARGEST:g}",
    ),
    "cutoff": (_share, f"nothing or 0 to {LARGEST:g} Hz"),
    "files": (lambda x: isinstance(x, list) and all(map(_text, x)), "a list of names"),
    "output": _one_of(*OUTPUTS),
    "published": (lambda x: isinstance(x, bool), "true or false"),
    "data_sha256": (_text, "text"),
    "seen": (_table_of(_range), "a table of ranges, each [low, high]"),
}
_ERRORS = ("relative_force_error", "cross_validated_error", "friction_error", "missed")
_OF_FIT: dict[str, tuple[Callable[[object], bool], str]] = dict.fromkeys(
    _ERRORS, (_share, f"nothing or 0 to {LARGEST:g}")
)
# How a record was read that nobody told of.
_UNREAD: dict[str, object] = {
    "files": [], "columns": {}, "units": {}, "force_gain": None, "cutoff": None, "output": "force", "published": False,
}  # fmt: skip


@dataclass(frozen=True)
class FittedModel:
    """A fitted model: every number that its curve uses.

    Attributes:
        law: its name; ``method``: how it was fitted.
        values: constants of the law, words too, and terms of the body.
        predictor: of a static fit, the force along any record.
        known: the error of the fit itself, for comparison.
        columns, units, force_gain, cutoff: how the record was read.
        files: its files, seen from the folder of the fit.
        output: what the simulation was to meet.
        published: whether the record's last rows were kept, as in the published procedure.
        seen: the ranges of the record's rows in motion.
    """

    law: str
    method: str
    values: dict[str, float]
    predictor: Predictor | None
    known: dict[str, float | None]
    columns: dict[str, str]
    units: dict[str, str]
    force_gain: str | float | None
    cutoff: float | None
    files: tuple[str, ...] = ()
    output: str = "force"
    published: bool = False
    seen: Mapping[str, Sequence[float]] = field(default_factory=dict)

    @property
    def body(self) -> tuple[str, ...]:
        """The terms that it has."""
        return tuple(n for n in self.values if n in TERMS)

    @property
    def hangs_on(self) -> tuple[str, ...]:
        """The terms that it has, and those that its forms act like."""
        forms = self.predictor.forms if self.predictor else {}
        return (*self.body, *dict.fromkeys(t for f, t in _LIKE.items() if any(key[0] == f for key in forms)))

    @property
    def expected(self) -> float | None:
        """The error that another record of the machine is expected to have, inside the ranges that were seen."""
        return EXPECTED * self.predictor.error if self.predictor else None


@dataclass(frozen=True)
class Predicted:
    """A prediction of the force of a record.

    Attributes:
        force_error: norm(residual)/norm(force) over the rows in motion; ``friction_error``: over norm(friction), which is
            the force less the terms that are not friction; ``all_rows_error``: as the first, rows at rest too.
        constant_error: what the mean force would leave over the rows in motion: a model must leave less to be of use.
        rest: the share of the rows at rest.
        beyond: rows beyond what the fit has seen; None where it tells no ranges.
        traces: measured and predicted force against time; ``friction``: the same for friction alone.
    """

    model: FittedModel
    force_error: float
    friction_error: float
    all_rows_error: float
    constant_error: float
    rest: float
    beyond: Beyond | None
    traces: Prediction
    friction: Prediction

    def to_json(self) -> dict[str, object]:
        """What ``stribeck predict --json`` prints."""
        return {
            "law": self.model.law, "method": self.model.method, "relative_force_error": self.force_error,
            "friction_error": self.friction_error, "all_rows_error": self.all_rows_error,
            "constant_error": self.constant_error, "expected_error": self.model.expected, "rest": self.rest,
            "fit": self.model.known, "beyond": self.beyond.to_json() if self.beyond else None,
        }  # fmt: skip

    def notes(self) -> list[str]:
        """What a reader should know, a sentence each."""
        out = []
        if self.constant_error <= self.force_error:
            out.append("A constant force predicts this record better: the model says nothing about it.")
        if (self.model.known.get("missed") or 0.0) > _POOR:
            out.append("The fit itself leaves more than a quarter of its force's deviation: its model lacks something.")
        if self.beyond and (told := self.beyond.told()):
            out.append(f"{told[:1].upper()}{told[1:]}.")
        return out


_POOR = 0.25  # of the force's deviation, as the fit's own gate


def _whole(fit: Fit, reading: Mapping[str, object]) -> dict[str, object]:
    law = laws.find(fit.law_name)
    values = {**fit.fixed, **fit.used}
    known = {n: v for n, v in values.items() if n in law.constants() or n in TERMS}
    return {
        "format": _FORMAT, "law": fit.law_name, "method": fit.method, "values": known,
        "estimates": {n: e.to_json() for n, e in fit.parameters.items()},
        "predictor": fit.predictor.to_json() if fit.predictor else None,
        "fit": {
            "relative_force_error": fit.relative_force_error, "cross_validated_error": fit.cross_validated_error,
            "friction_error": fit.details.get("friction_error"), "missed": fit.details.get("missed"),
        },
        "seen": fit.details.get("seen", {}), "data_sha256": fit.data_hash, **_UNREAD, **reading,
    }  # fmt: skip


def saved(fit: Fit, reading: Mapping[str, object] | None = None) -> str:
    """The model of a fit as text for fit.json.

    Args:
        reading: the record's files, columns, units, force_gain and cutoff; whether its ends were kept; the output of its
            simulation.
    """
    return json.dumps(finite(_whole(fit, reading or {})), indent=1, allow_nan=False)


def _unlike(data: Mapping[str, object]) -> list[str]:
    """What of the file's parts is not as a fit writes it."""
    tables = [("", data, _PARTS)]
    if isinstance(data.get("fit"), dict):
        tables.append(("fit.", cast("Mapping[str, object]", data["fit"]), _OF_FIT))
    found = []
    for at, table, known in tables:
        for name, value in table.items():
            if name in known:
                holds, words = known[name]
                found += [] if holds(value) else [f"{at}{name}: {show(value)}: must be {words}"]
            elif (at, name) != ("", "format"):
                found.append(f"{at}{show(name)}: is no part of it{nearest(name, known)}")
        found += [f"{at}{name}: missing" for name in known if name not in table]
    return found


def _lacking(law: str, values: Mapping[str, object]) -> list[str]:
    lacking = (n for n, c in laws.find(law).constants().items() if c.required and n not in values)
    return [f"{n}: missing: law '{law}' needs it" for n in lacking]


def _wrong(law: str, known: Mapping[str, Constant], values: Mapping[str, object]) -> list[str]:
    """What is wrong with the values of a model."""
    found = []
    for name, value in values.items():
        if name in known:
            text = known[name].problem(value)
        elif name in TERMS:
            text = None if _number(value) else f"must be a number of at most {LARGEST:g}"
            if not text and (of := TERMS[name].of) and of not in values:
                text = f"needs {of}, which is missing"
        else:
            text = f"neither a constant of {law} nor a term"
        if not text and isinstance(value, int | float) and not abs(value) <= LARGEST:
            text = f"{value:.4g}: must be at most {LARGEST:g}"
        found += [f"{name}: {text}"] if text else []
    given = SimpleNamespace(**values)
    for relation in () if found else laws.find(law).relations:
        if all(isinstance(values.get(n), int | float) for n in (relation.key, *relation.needs)) and not relation.holds(
            given
        ):
            found.append(f"{relation.key}: {values[relation.key]:.6g}: must be {relation.allowed}")
    return found


def load(folder: Path | str, trust: bool = False) -> FittedModel:
    """The model that ``fit --out`` left in a folder.

    Args:
        trust: execute laws in files (``FILE.py:NAME``) wherever these lie, and not only in the current folder, in the
            fit's or below them.

    Raises:
        InputError: there is none, it is not whole, or it names a law elsewhere.
    """
    path = Path(folder)
    path = path / FILE if path.is_dir() else path
    try:
        data = json_of(path)
    except OSError as error:
        raise InputError(
            f"{arg('fit')}: '{path}': cannot be read: {error.strerror} (stribeck fit --out DIR writes it)"
        ) from None
    except ValueError:
        raise InputError(f"{arg('fit')}: '{path}': is not JSON") from None
    known = isinstance(data, dict) and type(data.get("format")) is int and data["format"] == _FORMAT
    if not known or not {"values", "law", "method"} <= set(data):
        raise InputError(f"{arg('fit')}: '{path}': is no model of a fit (of format {_FORMAT})")
    if wrong := _unlike(data):
        raise InputError([f"{arg('fit')}: '{path}': {text}" for text in wrong])
    if not trust and astray([data["law"]], Path(), Path(), path.parent):
        text = "lies elsewhere, and a law is a program that would be executed"
        remedy = "must be in the current folder, in the fit's or below them, or allowed with trust=True (--trust)"
        raise InputError(f"{arg('fit')}: '{path}': {show(data['law'])}: {text}: {remedy}")
    law, values = laws.find(data["law"]), data["values"]
    texts = [*_wrong(data["law"], law.constants(), values), *_lacking(data["law"], values)]
    if texts:
        raise InputError([f"{arg('fit')}: '{path}': values.{text}" for text in texts])
    return _model(data, law.name if ".py:" not in data["law"] else data["law"])


class _Saved(TypedDict):
    """The file, once it was found to be as a fit writes it."""

    law: str
    method: str
    values: dict[str, float]
    predictor: Mapping[str, object] | None
    fit: dict[str, float | None]
    columns: dict[str, str]
    units: dict[str, str]
    force_gain: str | float | None
    cutoff: float | None
    files: list[str]
    output: str
    published: bool
    seen: Mapping[str, Sequence[float]]


def _model(content: Mapping[str, object], law: str) -> FittedModel:
    """The model of a file's content."""
    data = cast("_Saved", content)
    kept = data["predictor"]
    return FittedModel(
        law, data["method"], data["values"], of_json(kept) if kept else None, data["fit"], data["columns"], data["units"],
        data["force_gain"], data["cutoff"], tuple(data["files"]), data["output"], data["published"], data["seen"],
    )  # fmt: skip


def predict(model: FittedModel, log: Log) -> Predicted:
    """The force that a fitted model predicts for a record, which its fit has not seen.

    Raises:
        InputError: the record lacks a column that a term takes.
        StribeckError: the simulation fails.
    """
    terms.check(model.body, log)
    rest, simulated = at_rest(log), model.predictor is None
    if rest.all() and not simulated:
        raise InputError(f"{arg('data')}: the body rests throughout: there is nothing to predict")
    of_model = parts(model.law, model.values, log) if model.predictor is None else model.predictor.parts(log)
    force, not_friction = of_model[0] + of_model[1], of_model[1]
    rows = np.ones(len(log), bool) if simulated else ~rest
    left = log.force - not_friction
    traces = Prediction(log.time, log.position, log.velocity, log.force, force)
    friction = Prediction(log.time, log.position, log.velocity, left, force - not_friction)
    own = float(np.linalg.norm((log.force - force)[rows])) / max(float(np.linalg.norm(left[rows])), 1e-300)
    mean = np.full(len(log), float(np.mean(log.force[rows])))
    outside = beyond(model.seen, model.hangs_on, log, rows, log.force - force) if model.seen else None
    return Predicted(
        model, _error(log.force, force, rows), own, _error(log.force, force, np.ones(len(log), bool)),
        _error(log.force, mean, rows), float(np.mean(rest)), outside, traces, friction,
    )  # fmt: skip


def predicted(fit: Fit, data: object, columns: Mapping[str, str]) -> Predicted:
    """The prediction of a fit in memory; columns as in the fit unless given."""
    model = _model(json.loads(saved(fit, fit.reading)), fit.law_name)
    names = ColumnNames({**model.columns, **columns}, model.units, model.force_gain)
    log = data if isinstance(data, Log) else api.log_of(data, names, how_to_read(model))
    return predict(model, log)


def how_to_read(model: FittedModel, cutoff: float | None = None) -> Preparation:
    """How another record is prepared for a model: as the fit's was."""
    chosen = cutoff if cutoff is not None else model.cutoff
    return Preparation(chosen, None, model.predictor is None, model.published, True)


def beside(model: FittedModel, log: Log, without: Container[str] = ()) -> Array:
    """What the fitted model says of the force that is no friction, in N at each row; ``without`` some terms."""
    if model.predictor is not None:
        mass = model.values.get("mass", 0.0) * log.acceleration if "mass" in without else 0.0
        return np.asarray(model.predictor.parts(log)[1] - mass)
    return beside_friction({n: x for n, x in model.values.items() if n not in without}, log)


def _error(measured: Array, predicted: Array, rows: NDArray[np.bool_]) -> float:
    size = float(np.linalg.norm(measured[rows]))
    return float(np.linalg.norm((measured - predicted)[rows])) / max(size, 1e-300)

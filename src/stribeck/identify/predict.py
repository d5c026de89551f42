"""A fitted model on another record: what force it predicts, and how far off that is."""

from __future__ import annotations

import json
from collections.abc import Callable, Container, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import SimpleNamespace
from typing import TypeGuard, cast

import numpy as np
from numpy.typing import NDArray

from stribeck import drives, laws
from stribeck.arrays import Array
from stribeck.constants import Constant, show
from stribeck.errors import InputError, StribeckError, arg, nearest
from stribeck.files import finite, json_of
from stribeck.identify.beyond import Beyond, beyond
from stribeck.identify.data.quality import LARGEST
from stribeck.identify.features.rest import at_rest
from stribeck.identify.features.sliding import Sliding
from stribeck.identify.log import Log
from stribeck.identify.models import terms
from stribeck.identify.models.columns import Columns
from stribeck.identify.models.dynamic_problem import VelocityProblem
from stribeck.identify.models.motion_problem import OUTPUTS
from stribeck.identify.models.separable import Separable
from stribeck.identify.models.static_problem import RATES, kept_rows, thinning
from stribeck.identify.models.terms import OF_RECORD, TERMS, column
from stribeck.identify.options import METHODS
from stribeck.identify.result import Fit, Prediction
from stribeck.scenario.trust import astray

FILE = "fit.json"
_FORMAT = 2
_FORMATS = (1, 2)  # the first may lack what it did not have yet
_SHORTEST = 30  # rows that a run keeps behind the filter


def _text(x: object) -> bool:
    return isinstance(x, str)


def _number(x: object) -> TypeGuard[float]:
    return isinstance(x, int | float) and not isinstance(x, bool) and abs(x) <= LARGEST


def _share(x: object) -> bool:
    return x is None or (_number(x) and x >= 0)


def _model(x: object) -> bool:
    return isinstance(x, dict) and x.keys() == {"law", "values"} and _text(x["law"]) and isinstance(x["values"], dict)


def _range(x: object) -> bool:
    return isinstance(x, list | tuple) and len(x) == 2 and all(map(_number, x)) and x[0] <= x[1]


def _table_of(known: Callable[[object], bool]) -> Callable[[object], bool]:
    return lambda x: isinstance(x, dict) and all(map(known, x.values()))


def _one_of(*words: str) -> tuple[Callable[[object], bool], str]:
    return lambda x: isinstance(x, str) and x in words, f"one of {', '.join(words)}"


_DRIVES = tuple(kind for kind in drives.KINDS if kind != "velocity")  # that of a measured motion is its input

# What each part of the file must be, and that in words.
_PARTS: dict[str, tuple[Callable[[object], bool], str]] = {
    "law": (_text, "a name"),
    "method": _one_of(*METHODS),
    "values": (lambda x: isinstance(x, dict), "a table"),
    "others": (_table_of(_model), "a table of models, each of law and values"),
    "fit": (lambda x: isinstance(x, dict), "a table"),
    "columns": (_table_of(_text), "a table of names"),
    "units": (_table_of(_text), "a table of units"),
    "force_gain": (
        lambda x: x is None or _text(x) or _number(x),
        f"nothing, a name or a number of at most {LARGEST:g}",
    ),
    "cutoff": (_share, f"nothing or 0 to {LARGEST:g} Hz"),
    "files": (lambda x: isinstance(x, list) and all(map(_text, x)), "a list of names"),
    "output": _one_of("force", *OUTPUTS),
    "drive": (
        lambda x: x is None or (isinstance(x, dict) and x.get("kind") in _DRIVES),
        f"nothing or a drive ({', '.join(_DRIVES)})",
    ),
    "published": (lambda x: isinstance(x, bool), "true or false"),
    "data_sha256": (_text, "text"),
    "seen": (_table_of(_range), "a table of ranges, each [low, high]"),
}
_ERRORS = ("relative_force_error", "cross_validated_error", "friction_error")
_OF_FIT = dict.fromkeys(_ERRORS, (_share, f"nothing or 0 to {LARGEST:g}")) | {
    "decimation": (
        lambda x: x is None or (type(x) is int and x in RATES),
        f"nothing or one of {', '.join(map(str, RATES))}",
    ),
}
# How a record was read that nobody told of.
_UNREAD: dict[str, object] = {
    "files": [], "columns": {}, "units": {}, "force_gain": None, "cutoff": None, "output": "force", "drive": None,
    "published": False,
}  # fmt: skip


@dataclass(frozen=True)
class FittedModel:
    """A fitted model: every number that its curve uses.

    Attributes:
        law: its name; ``method``: how it was fitted.
        values: constants of the law, words too, and terms of the body.
        known: the error of the fit itself, for comparison.
        others: plainer models of the same record, by name.
        columns, units, force_gain, cutoff: how the record was read.
        files: its files, seen from the folder of the fit; none in what older versions wrote.
        output: what the simulation was to meet; ``drive``: what moved the body then, None for the measured force.
        published: whether the record's last rows were kept, as in the published procedure.
        seen: the ranges of the record's rows in motion; none in what older versions wrote.
    """

    law: str
    method: str
    values: dict[str, float]
    known: dict[str, float | None]
    others: dict[str, tuple[str, dict[str, float]]]
    columns: dict[str, str]
    units: dict[str, str]
    force_gain: str | float | None
    cutoff: float | None
    files: tuple[str, ...] = ()
    output: str = "force"
    drive: Mapping[str, object] | None = None
    published: bool = False
    seen: Mapping[str, Sequence[float]] = field(default_factory=dict)

    @property
    def body(self) -> tuple[str, ...]:
        """The terms that it has."""
        return tuple(n for n in self.values if n in TERMS)


@dataclass(frozen=True)
class Predicted:
    """A prediction of the force of a record.

    Attributes:
        force_error: norm(residual)/norm(force) over the rows in motion; ``friction_error``: over norm(friction), which is
            the force less the terms that are not friction; ``all_rows_error``: as the first, rows at rest too; ``band_error``:
            as the first, both forces behind the filter of the fit, whose own error is told so; None without one.
        others: force errors of plainer models fitted to the same record.
        beyond: rows beyond what the fit has seen; None where it tells no ranges.
        traces: measured and predicted force against time; ``friction``: the same for friction alone.
    """

    model: FittedModel
    force_error: float
    friction_error: float
    all_rows_error: float
    band_error: float | None
    rest: float
    others: dict[str, float]
    beyond: Beyond | None
    traces: Prediction
    friction: Prediction

    def to_json(self) -> dict[str, object]:
        """What ``stribeck predict --json`` prints."""
        return {
            "law": self.model.law, "method": self.model.method, "relative_force_error": self.force_error,
            "friction_error": self.friction_error, "all_rows_error": self.all_rows_error, "band_error": self.band_error,
            "rest": self.rest, "fit": self.model.known, "others": self.others,
            "beyond": self.beyond.to_json() if self.beyond else None,
        }  # fmt: skip


def saved(fit: Fit, reading: Mapping[str, object] | None = None) -> str:
    """The model of a fit as text for fit.json.

    Args:
        reading: the record's files, columns, units, force_gain and cutoff; whether its ends were kept; the output and the
            drive of its simulation.
    """
    law = laws.find(fit.law)
    values = {**fit.fixed, **fit.used}
    others = {
        c["name"]: {"law": c["law"], "values": c["values"]}
        for c in fit.details.get("candidates", ())
        if c["name"] != "this fit"
    }
    return json.dumps(
        finite(
            {
                "format": _FORMAT, "law": fit.law, "method": fit.method,
                "values": {n: v for n, v in values.items() if n in law.constants() or n in TERMS},
                "fit": {
                    "relative_force_error": fit.relative_force_error,
                    "cross_validated_error": fit.cross_validated_error,
                    "friction_error": fit.details.get("friction_error"), "decimation": fit.details.get("decimation"),
                },
                "others": others, "seen": fit.details.get("seen", {}), "data_sha256": fit.data_hash, **_UNREAD,
                **(reading or {}),
            }
        ),
        indent=1, allow_nan=False,
    )  # fmt: skip


def _unlike(data: Mapping[str, object]) -> list[str]:
    """What of the file's parts is not as a fit writes it."""
    tables = [("", data, _PARTS)]
    if isinstance(data.get("fit"), dict):
        tables.append(("fit.", cast("Mapping[str, object]", data["fit"]), _OF_FIT))
    found = []
    for at, table, parts in tables:
        for name, value in table.items():
            if name in parts:
                holds, words = parts[name]
                found += [] if holds(value) else [f"{at}{name}: {show(value)}: must be {words}"]
            elif (at, name) != ("", "format"):
                found.append(f"{at}{show(name)}: is no part of it{nearest(name, parts)}")
        if data["format"] != 1:
            found += [f"{at}{name}: missing" for name in parts if name not in table]
    return found


def _lacking(law: str, method: object, values: Mapping[str, object]) -> list[str]:
    kind = laws.find(law)
    if kind.has_z and method == "static":  # of bristles a static fit tells nothing
        return []
    lacking = (n for n, c in kind.constants().items() if c.required and n not in values)
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
    known = isinstance(data, dict) and type(data.get("format")) is int and data["format"] in _FORMATS
    if not known or not {"values", "law", "method"} <= set(data):
        raise InputError(f"{arg('fit')}: '{path}': is no model of a fit (of format {_FORMAT})")
    if wrong := _unlike(data):
        raise InputError([f"{arg('fit')}: '{path}': {text}" for text in wrong])
    if not trust and (strange := _strange(data["law"], data.get("others", {}), path.parent)):
        text = "lies elsewhere, and a law is a program that would be executed"
        remedy = "must be in the current folder, in the fit's or below them, or allowed with trust=True (--trust)"
        raise InputError([f"{arg('fit')}: '{path}': {show(name)}: {text}: {remedy}" for name in strange])
    law = laws.find(data["law"])
    others = {n: (o["law"], o["values"]) for n, o in data.get("others", {}).items()}
    told = {"": (data["law"], data["values"]), **{f"others.{n}.": each for n, each in others.items()}}
    wrong = []
    for at, (each, values) in told.items():
        texts = [*_wrong(each, laws.find(each).constants(), values), *_lacking(each, data["method"], values)]
        wrong += [f"{at}values.{text}" for text in texts]
    if wrong:
        raise InputError([f"{arg('fit')}: '{path}': {text}" for text in wrong])
    return FittedModel(
        law.name if ".py:" not in data["law"] else data["law"], data["method"], data["values"], data.get("fit", {}),
        others, data.get("columns", {}), data.get("units", {}), data.get("force_gain"), data.get("cutoff"),
        tuple(data.get("files", ())), data.get("output", "force"), data.get("drive"),
        data.get("published", False), data.get("seen", {}),
    )  # fmt: skip


def _strange(law: str, others: Mapping[str, Mapping[str, str]], folder: Path) -> list[str]:
    """Laws in files that a fit's model may not have executed unasked: it may come from a stranger."""
    told = [law, *(other["law"] for other in others.values())]
    return astray(told, Path(), Path(), folder)


def predict(model: FittedModel, log: Log) -> Predicted:
    """The force that a fitted model predicts for a record, which its fit has not seen.

    Raises:
        InputError: the record lacks a column that a term takes.
        StribeckError: the simulation fails.
    """
    terms.check(model.body, log)
    rest = at_rest(log)
    simulated = laws.find(model.law).has_z and model.method != "static"
    if rest.all() and not simulated:
        raise InputError(f"{arg('data')}: the body rests throughout: there is nothing to predict")
    if simulated:
        force = _simulated(model, log)
    else:
        log = log.with_columns(velocity=np.where(rest, 0.0, log.velocity))
        force = _steady(model.law, model.values, log)
    rows = np.ones(len(log), bool) if simulated else ~rest
    left = log.force - beside(model, log)
    others = {n: _error(log.force, _steady(law, v, log), rows) for n, (law, v) in model.others.items()}
    traces = Prediction(log.time, log.position, log.velocity, log.force, force)
    friction = Prediction(log.time, log.position, log.velocity, left, left + force - log.force)
    size = float(np.linalg.norm(friction.measured[rows]))
    own = float(np.linalg.norm((log.force - force)[rows])) / max(size, 1e-300)
    every = np.ones(len(log), bool)
    outside = beyond(model.seen, model.body, log, rows, log.force - force) if model.seen else None
    return Predicted(
        model, _error(log.force, force, rows), own, _error(log.force, force, every), _band_error(model, log, force, rest),
        float(np.mean(rest)), others, outside, traces, friction,
    )  # fmt: skip


def _band_error(model: FittedModel, log: Log, force: Array, rest: NDArray[np.bool_]) -> float | None:
    """The error of the force where both have passed the filter that the fit used, at the rows that it would keep."""
    q = int(model.known.get("decimation") or 1)
    if q not in RATES or q < 2 or model.method != "static" or min(r.stop - r.start for r in log.runs()) < _SHORTEST * q:
        return None
    reduce = thinning(log, q)
    moving = np.convolve(rest, np.ones(2 * q + 1), mode="same")[kept_rows(log, q)] < 0.5
    return _error(reduce(log.force), reduce(force), moving) if moving.any() else None


def beside(model: FittedModel, log: Log, without: Container[str] = ()) -> Array:
    """What the fitted model says of the force that is no friction, in N at each row; ``without`` some terms."""
    found = np.zeros(len(log))
    for name in model.body:
        term = TERMS[name]
        if name not in without and term.column is not None and not (term.level or term.friction):
            found += model.values[name] * column(name, log, model.values)
    return found


def _error(measured: Array, predicted: Array, rows: NDArray[np.bool_]) -> float:
    size = float(np.linalg.norm(measured[rows]))
    return float(np.linalg.norm((measured - predicted)[rows])) / max(size, 1e-300)


def _steady(law_name: str, values: Mapping[str, float], log: Log) -> Array:
    """Friction at the speed of the moment, and the body's terms."""
    law = laws.find(law_name)
    own = {n: v for n, v in values.items() if n in law.constants()}
    columns = Columns(log, Sliding(law, own, {}), lambda x: x)
    body = {n: v for n, v in values.items() if n in TERMS and n not in OF_RECORD}
    model = Separable(columns, {**own, **body}, (), (), ())
    return model.force_at({"mass": 0.0, **own, **body})


def _simulated(model: FittedModel, log: Log) -> Array:
    """The law simulated along the measured motion, and the body's terms."""
    law = laws.find(model.law)
    values = {
        "mass": 0.0,
        **{n: v for n, v in model.values.items() if n in law.constants() or (n in TERMS and n not in OF_RECORD)},
    }
    body = tuple(n for n in values if n in TERMS)
    force = VelocityProblem(log, law, [], values, {}, body).force(np.zeros((1, 0)))
    if force is None:
        raise StribeckError(f"law '{model.law}': its simulation along this record fails")
    return np.asarray(force[0])

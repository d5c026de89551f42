"""fit.json: a fit as a file, of a log or of a machine, written and read back."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from types import SimpleNamespace
from typing import TypeGuard

from stribeck import laws
from stribeck.constants import Constant, show
from stribeck.errors import InputError, StribeckError, arg, nearest
from stribeck.files import finite, json_of, seen_from
from stribeck.identify.actuator.result import LogResult, MachineFit
from stribeck.identify.core.predictor import of_json
from stribeck.identify.core.states import Estimate, Kept
from stribeck.identify.data.quality import LARGEST
from stribeck.identify.models.terms import TERMS
from stribeck.identify.options import METHODS, OUTPUTS
from stribeck.identify.result import Fit, LogFit, RecordReading
from stribeck.parameter_sets import read_toml
from stribeck.scenario.trust import astray

FILE, MACHINE = "fit.json", "machine.toml"
_FORMAT = 6
_LOG, _MACHINE = "log", "machine"
# -- writing ---------------------------------------------------------------------------------------------------------


def text_of(fit: Fit, folder: Path) -> str:
    """A fit as the text of a fit.json that lies in a folder: every number with both uncertainties and its state."""
    common = {
        "format": _FORMAT, "kind": _LOG if isinstance(fit, LogFit) else _MACHINE, "status": fit.status,
        "estimates": {n: e.to_dict() for n, e in fit.parameters.items()}, "notes": list(fit.notes),
    }  # fmt: skip
    if isinstance(fit, LogFit):
        own = _of_log(fit, folder)
    else:
        assert isinstance(fit, MachineFit)
        own = _of_machine(fit, folder)
    return json.dumps(finite({**common, **own}), indent=1, allow_nan=False)


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


# -- what each part of the file must be, and that in words ---------------------------------------------------------------

_Part = tuple[Callable[[object], bool], str]


def _text(x: object) -> bool:
    return isinstance(x, str)


def _number(x: object) -> TypeGuard[float]:
    return isinstance(x, int | float) and not isinstance(x, bool) and abs(x) <= LARGEST


def _share(x: object) -> bool:
    return x is None or (_number(x) and x >= 0)


def _range(x: object) -> bool:
    return isinstance(x, list | tuple) and len(x) == 2 and all(map(_number, x)) and x[0] <= x[1]


def _table(x: object) -> bool:
    return isinstance(x, dict)


def _table_of(known: Callable[[object], bool]) -> Callable[[object], bool]:
    return lambda x: isinstance(x, dict) and all(map(known, x.values()))


def _list_of(known: Callable[[object], bool]) -> Callable[[object], bool]:
    return lambda x: isinstance(x, list) and all(map(known, x))


def _one_of(*words: str) -> _Part:
    return lambda x: isinstance(x, str) and x in words, f"one of {', '.join(words)}"


def _read_by(read: Callable[..., object]) -> Callable[[object], bool]:
    """Whether something can be read so."""

    def holds(x: object) -> bool:
        try:
            read(x)
        except (KeyError, TypeError, ValueError, AttributeError, StribeckError):
            return False
        return True

    return holds


def _recording(told: Kept) -> LogResult:
    errors = {str(n): dict(e) for n, e in told["errors"].items()}
    if not all(_number(e[key]) for e in errors.values() for key in ("rms", "relative")):
        raise TypeError
    return LogResult(str(told["file"]), bool(told["held_out"]), [], errors)  # type: ignore[arg-type]


_COMMON: dict[str, _Part] = {
    "kind": _one_of(_LOG, _MACHINE),
    "status": (_text, "a word"),
    "estimates": (_table_of(_read_by(Estimate.of_dict)), "a table of estimates"),
    "notes": (_list_of(_text), "a list of sentences"),
}
_PARTS: dict[str, dict[str, _Part]] = {
    _LOG: {
        **_COMMON,
        "law": (_text, "a name"),
        "method": _one_of(*METHODS),
        "values": (_table, "a table"),
        "given": (_list_of(_text), "a list of names"),
        "levels": (_table_of(_number), "a table of speeds"),
        "predictor": (
            lambda x: x is None or (_table(x) and _read_by(of_json)(x)),
            "nothing or the model of a static fit",
        ),
        "candidates": (_list_of(_table), "a list of tables"),
        "fit": (_table, "a table"),
        "columns": (_table_of(_text), "a table of names"),
        "units": (_table_of(_text), "a table of units"),
        "force_gain": (
            lambda x: x is None or _text(x) or _number(x),
            f"nothing, a name or a number of at most {LARGEST:g}",
        ),
        "cutoff": (_share, f"nothing or 0 to {LARGEST:g} Hz"),
        "files": (_list_of(_text), "a list of names"),
        "output": _one_of(*OUTPUTS),
        "published": (lambda x: isinstance(x, bool), "true or false"),
        "simulated": (lambda x: isinstance(x, bool), "true or false"),
        "data_sha256": (_text, "text"),
        "seen": (_table_of(_range), "a table of ranges, each [low, high]"),
    },
    _MACHINE: {
        **_COMMON,
        "reason": (_text, "text"),
        "name": (_text, "a name"),
        "levels": (_table_of(_number), "a table of speeds"),
        "correlated": (_list_of(_table), "a list of tables"),
        "logs": (_list_of(_read_by(_recording)), "a list of recordings"),
        "noise": (_table_of(_number), "a table of numbers"),
        "baselines": (_table_of(_table), "a table of tables"),
        "laws": (lambda x: x is None or _table(x), "nothing or a table"),
        "source": (lambda x: x is None or _text(x), "nothing or a file"),
    },
}
_ERRORS = ("relative_force_error", "cross_validated_error", "friction_error", "missed")
_OF_FIT: dict[str, _Part] = dict.fromkeys(_ERRORS, (_share, f"nothing or 0 to {LARGEST:g}"))


# -- reading -----------------------------------------------------------------------------------------------------------


def load(folder: Path | str, trust: bool = False) -> Fit:
    """The fit in a folder; as :meth:`stribeck.Fit.load` says."""
    path = Path(folder)
    path = path / FILE if path.is_dir() else path
    place = f"{arg('fit')}: '{path}'"
    try:
        data = json_of(path)
    except OSError as error:
        raise InputError(f"{place}: cannot be read: {error.strerror} ('stribeck fit' writes it)") from None
    except ValueError:
        raise InputError(f"{place}: is not JSON") from None
    if not isinstance(data, dict) or type(data.get("format")) is not int or data["format"] != _FORMAT:
        raise InputError(f"{place}: is no model of a fit (of format {_FORMAT}): must be fitted again")
    kind = str(data.get("kind"))
    if wrong := _unlike(data, _PARTS[kind] if kind in _PARTS else {"kind": _COMMON["kind"]}):
        raise InputError([f"{place}: {text}" for text in wrong])
    return _machine_fit(data, path.parent, trust) if kind == _MACHINE else _log_fit(data, path, trust)


def _log_fit(data: Kept, path: Path, trust: bool) -> LogFit:
    """The fit of a log, after a look at its law and its numbers."""
    place = f"{arg('fit')}: '{path}'"
    if not trust and astray([data["law"]], Path(), Path(), path.parent):
        text = "lies elsewhere, and a law is a program that would be executed"
        remedy = "must be in the current folder, in the fit's or below them, or allowed with trust=True (--trust)"
        raise InputError(f"{place}: {show(data['law'])}: {text}: {remedy}")
    law, values = laws.find(data["law"]), data["values"]
    texts = [*_wrong(data["law"], law.constants(), values), *_lacking(data["law"], values)]
    if texts:
        raise InputError([f"{place}: values.{text}" for text in texts])
    known = data["fit"]["relative_force_error"]
    return LogFit(
        law_name=law.name if ".py:" not in data["law"] else data["law"], method=data["method"], values=values,
        given=tuple(data["given"]), relative_force_error=float("nan") if known is None else known,
        **{n: data["fit"][n] for n in ("cross_validated_error", "friction_error", "missed")},
        data_hash=data["data_sha256"], notes=tuple(data["notes"]), status=data["status"], seen=data["seen"],
        candidates=tuple(data["candidates"]), predictor=of_json(data["predictor"]) if data["predictor"] else None,
        reading=RecordReading(
            tuple(str(path.parent / name) for name in data["files"]), data["columns"], data["units"], data["force_gain"],
            data["cutoff"], data["output"], data["published"], data["simulated"],
        ),
        **_estimates(data),
    )  # fmt: skip


def _machine_fit(data: Kept, folder: Path, trust: bool) -> MachineFit:
    """The fit of a machine; the machine itself is the file beside it."""
    machine = folder / MACHINE
    tables = read_toml(machine) if machine.is_file() and data["status"] == "done" else {}
    return MachineFit(
        status=data["status"], reason=data["reason"], correlated=data["correlated"],
        logs=[_recording(log) for log in data["logs"]], notes=data["notes"], noise=data["noise"], data=tables,
        baselines=data["baselines"], laws=data["laws"], name=data["name"], folder=folder,
        source=None if data["source"] is None else folder / data["source"], trust=trust, **_estimates(data),
    )  # fmt: skip


def _estimates(data: Kept) -> Kept:
    """The estimates, the levels among them, and their speeds."""
    estimates = {n: Estimate.of_dict(e) for n, e in data["estimates"].items()}
    levels = {n: estimates.pop(n) for n in data["levels"] if n in estimates}
    return {"estimates": estimates, "levels": levels, "speeds": data["levels"]}


def _unlike(data: Kept, parts: Mapping[str, _Part]) -> list[str]:
    """What of the file's parts is not as a fit writes it."""
    tables = [("", data, parts)]
    if "fit" in parts and isinstance(data.get("fit"), dict):
        tables.append(("fit.", data["fit"], _OF_FIT))
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
        needed: Sequence[str] = (relation.key, *relation.needs)
        if all(isinstance(values.get(n), int | float) for n in needed) and not relation.holds(given):
            found.append(f"{relation.key}: {values[relation.key]:.6g}: must be {relation.allowed}")
    return found

"""fit.json: a fit as a file, of a log or of a machine, written and read back.

The file is a result, not an input. A digest of its content shows every change. A changed file is an error.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING

from stribeck import laws
from stribeck.constants import path_of, show
from stribeck.errors import InputError, arg
from stribeck.files import finite, json_of, seen_from
from stribeck.identify.core.states import Estimate, Kept
from stribeck.identify.data.prepare import Preparation
from stribeck.identify.data.read import ColumnNames
from stribeck.identify.data.reading import RecordReading
from stribeck.identify.models.predictor import of_json
from stribeck.identify.result_parts import LogResult
from stribeck.parameter_sets import read_toml
from stribeck.scenario.trust import astray

if TYPE_CHECKING:
    from stribeck.identify.result import Fit, LogFit, MachineFit

FILE, MACHINE_FILE = "fit.json", "machine.toml"
LOG, MACHINE = "log", "machine"  # kinds of fits
_FORMAT = 8  # counts the layouts of fit.json

# -- writing ---------------------------------------------------------------------------------------------------------


def text_of_log(fit: LogFit, folder: Path) -> str:
    """The fit of a log as the text of a fit.json that lies in a folder: the model, its ranges, and how its record was read."""
    return _text(fit, LOG, {
        "law": fit.law_name, "method": fit.method, "values": fit.values, "given": list(fit.given), "levels": fit.speeds,
        "predictor": fit.predictor.to_json() if fit.predictor else None,
        "candidates": [dict(c) for c in fit.candidates], "fit": fit.known, "seen": fit.seen,
        "data_sha256": fit.data_hash, "named": asdict(fit.reading.named), "how": asdict(fit.reading.how),
        "files": [seen_from(folder, Path(name)) for name in fit.reading.files],
    })  # fmt: skip


def text_of_machine(fit: MachineFit, folder: Path) -> str:
    """The fit of a machine as the text of a fit.json: its recordings, their residuals, and what else was fitted to them."""
    return _text(fit, MACHINE, {
        "reason": fit.reason, "name": fit.name, "levels": fit.speeds, "correlated": fit.correlated,
        "logs": [log.to_dict() for log in fit.logs], "noise": fit.noise, "baselines": fit.baselines, "laws": fit.laws,
        "source": None if fit.source is None else seen_from(folder, fit.source),
    })  # fmt: skip


def _text(fit: Fit, kind: str, details: Mapping[str, object]) -> str:
    """The text of a fit.json, with every number's uncertainties and state."""
    common = {
        "format": _FORMAT, "kind": kind, "status": fit.status,
        "estimates": {n: e.to_dict() for n, e in fit.parameters.items()}, "notes": list(fit.notes),
    }  # fmt: skip
    return text_with_digest(json.loads(json.dumps(finite({**common, **details}))))


def text_with_digest(data: Kept) -> str:
    """The data of a fit.json as its text."""
    return json.dumps({"digest": _digest(data), **data}, indent=1, allow_nan=False)


def _digest(data: Kept) -> str:
    """SHA-256 of the data as JSON, whatever the order of its keys."""
    return sha256(json.dumps(data, sort_keys=True).encode()).hexdigest()


# -- reading -----------------------------------------------------------------------------------------------------------


def read(folder: Path | str) -> tuple[Kept, Path]:
    """The data of the fit.json in a folder, and its path; raises as :meth:`stribeck.Fit.load`."""
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
    if not isinstance(data, dict) or data.get("format") != _FORMAT:
        raise InputError(f"{place}: is no model of a fit (of format {_FORMAT}): must be fitted again")
    try:
        whole = data.pop("digest", None) == _digest(data)
    except RecursionError:
        whole = False
    if not whole:
        raise InputError(f"{place}: was changed after 'stribeck fit' wrote it: must be as written, or fitted again")
    return data, path


def _parts(data: Kept, *names: str) -> Kept:
    """Parts of every fit, and those that are named, as arguments: the estimates, the levels apart, and their speeds."""
    estimates = {n: Estimate.of_dict(x) for n, x in data["estimates"].items()}
    levels = {n: estimates.pop(n) for n in data["levels"] if n in estimates}
    return {"estimates": estimates, "levels": levels, "speeds": data["levels"]} | {
        n: data[n] for n in ("notes", "status", *names)
    }


def of_log(data: Kept, path: Path, trust: bool) -> Kept:
    """The fit of a log as the arguments of a LogFit, after a look at where its law lies."""
    if not trust and astray([data["law"]], Path(), Path(), path.parent):
        text = "lies elsewhere, and a law is a program that would be executed"
        remedy = "must be in the current folder, in the fit's or below them, or allowed with trust=True (--trust)"
        raise InputError(f"{arg('fit')}: '{path}': {show(data['law'])}: {text}: {remedy}")
    law, known = laws.find(data["law"]), data["fit"]
    files = tuple(str(path.parent / name) for name in data["files"])
    return dict(
        **_parts(data, "method", "values", "given", "candidates"),
        predictor=of_json(data["predictor"]) if data["predictor"] else None,
        seen={n: tuple(ends) for n, ends in data["seen"].items()},
        law_name=data["law"] if ".py:" in data["law"] else law.name, data_hash=data["data_sha256"],
        relative_force_error=float("nan") if known["relative_force_error"] is None else known["relative_force_error"],
        friction_error=known["friction_error"],
        missed=known["missed"], reading=RecordReading(files, ColumnNames(**data["named"]), Preparation(**data["how"])),
    )  # fmt: skip


def of_machine(data: Kept, folder: Path, trust: bool) -> Kept:
    """The fit of a machine as the arguments of a MachineFit; the machine itself is the file beside it."""
    machine = folder / MACHINE_FILE
    tables = read_toml(machine) if machine.is_file() and data["status"] == "done" else {}
    return dict(
        **_parts(data, "reason", "correlated", "noise", "baselines", "laws", "name"), data=tables, folder=folder,
        logs=[LogResult(x["file"], x["held_out"], [], x["errors"]) for x in data["logs"]],
        source=None if data["source"] is None else folder / data["source"], trust=trust,
    )  # fmt: skip

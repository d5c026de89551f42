"""The scenario behind the folder of a run or a fit, for an explorer beside its report."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from stribeck.constants import show
from stribeck.errors import InputError, arg, needed
from stribeck.explore.beside import Report
from stribeck.files import json_of
from stribeck.scenario import Scenario
from stribeck.scenario.trust import astray, named


def of_folder(folder: Path, changes: Mapping[str, object], trust: bool) -> Report:
    """What was run or fitted.

    Raises:
        InputError: the folder is no result of ``stribeck run`` or ``stribeck fit``, or files that it names are gone.
    """
    if (folder / "parameters.toml").exists():
        with needed("the page of a fit", "fit"):
            from stribeck.explore import fitted
        found = fitted.of_folder(folder, trust)
    else:
        found = Report(_run(folder, trust))
    return replace(found, scenario=found.scenario.with_changes(changes)) if changes else found


def _run(folder: Path, trust: bool) -> Scenario:
    try:
        found = json_of(folder / "summary.json")
        tables, beside = dict(found["tables"]), folder / found["folder"]
    except (OSError, ValueError, KeyError, TypeError):
        must = "must be a folder that 'stribeck run --out' or 'stribeck fit --out' wrote"
        raise InputError(f"{arg('report')}: {show(str(folder))}: {must}") from None
    if not trust and (strange := astray(named(tables).values(), beside, Path(), folder)):
        text = "lies elsewhere, and a law is a program that would be executed"
        remedy = "must be in the current folder, in the result's or below them, or allowed with trust=True (--trust)"
        raise InputError([f"{arg('report')}: {show(str(folder))}: {show(name)}: {text}: {remedy}" for name in strange])
    return Scenario(tables, folder=beside, trust=trust)

"""The scenario of a run's or a fit's folder, for the explorer."""

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
    """The scenario of a folder of ``stribeck run`` or ``stribeck fit``, with ``changes``; of a fit with its measured data.

    Raises:
        InputError: if the folder is no such result, or its files are missing.
    """
    if (folder / "parameters.toml").exists():
        with needed("the page of a fit", "fit"):
            from stribeck.explore import fitted
        report = fitted.of_folder(folder, trust)
    else:
        report = Report(_run(folder, trust))
    return replace(report, scenario=report.scenario.with_changes(changes)) if changes else report


def _run(folder: Path, trust: bool) -> Scenario:
    try:
        summary = json_of(folder / "summary.json")
        tables, beside = dict(summary["tables"]), folder / summary["folder"]
    except (OSError, ValueError, KeyError, TypeError):
        must = "must be a folder that 'stribeck run --out' or 'stribeck fit --out' wrote"
        raise InputError(f"{arg('report')}: {show(str(folder))}: {must}") from None
    if not trust and (strange := astray(named(tables).values(), beside, Path(), folder)):
        text = "lies elsewhere, and a law is a program that would be executed"
        remedy = "must be in the current folder, in the result's or below them, or allowed with trust=True (--trust)"
        raise InputError([f"{arg('report')}: {show(str(folder))}: {show(name)}: {text}: {remedy}" for name in strange])
    return Scenario(tables, folder=beside, trust=trust)

"""The scenario behind the folder of a run, for an explorer beside its report."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

from stribeck.constants import show
from stribeck.errors import InputError, arg
from stribeck.explore.variants import unfit
from stribeck.files import read_file
from stribeck.scenario import Scenario


def of_folder(folder: Path, changes: Mapping[str, object], trust: bool) -> Scenario:
    """What was run.

    Raises:
        InputError: the folder is not one of ``stribeck run``, or the page cannot show it.
    """
    try:
        found = json.loads(read_file(folder / "summary.json"))
        tables, beside = found["tables"], folder / found["folder"]
    except (OSError, ValueError, KeyError, TypeError):
        must = "must be a folder that 'stribeck run --out' wrote (its summary.json holds no scenario)"
        raise InputError(f"{arg('report')}: {show(str(folder))}: {must}") from None
    scenario = Scenario(tables, folder=beside, trust=trust)
    scenario = scenario.with_changes(changes) if changes else scenario
    if text := unfit(scenario):
        raise InputError(f"{scenario.name}: {text}")
    return scenario

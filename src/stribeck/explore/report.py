"""The scenario behind the folder of a run or a fit, for an explorer beside its report."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from stribeck.errors import InputError
from stribeck.explore.variants import unfit
from stribeck.scenario import Scenario


@dataclass(frozen=True)
class Report:
    """What a folder holds: the scenario, and of a fit the interval of each number by its path."""

    scenario: Scenario
    intervals: dict[str, tuple[float, float]] = field(default_factory=dict)


def of_folder(folder: Path, changes: Mapping[str, Any], trust: bool) -> Report:
    """What was run or fitted.

    Raises:
        InputError: the folder is no result of ``stribeck run`` or ``stribeck fit``, or the page cannot show it.
    """
    path = folder / "scenario.toml"
    if not path.is_file():
        raise InputError(
            f"--report: {str(folder)!r}: must be a folder that 'stribeck run --out' wrote (it has no scenario.toml)"
        )
    scenario = Scenario.load(path, changes, trust=trust)
    if text := unfit(scenario):
        raise InputError(f"{scenario.name}: {text}")
    return Report(scenario)

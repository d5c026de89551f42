"""``stribeck export``."""

from __future__ import annotations

from pathlib import Path

import stribeck.export as exports
from stribeck import laws
from stribeck.cli.show import print_json
from stribeck.errors import InputError
from stribeck.laws.base import Law
from stribeck.scenario import Scenario, parse_assignment


def export(
    law: str,
    target: str,
    out: Path,
    parameters: str | None,
    assignments: list[str],
    part: str,
    scenario: Path | None,
    step: float | None,
    self_test: bool,
    fmi: int,
    json: bool,
) -> int:
    """Write the files, and say which."""
    rig = Scenario.load(scenario) if scenario is not None else None
    chosen = _law(law, parameters, assignments, rig)
    origin = parameters if parameters is not None and parameters.endswith(".toml") else ""
    if parameters is None and rig is not None:
        origin = f"scenario {rig.name}"
    files = exports.export(
        chosen, target, out, part=part, scenario=rig, step=step, self_test=self_test, origin=origin, fmi=fmi
    )
    if json:
        print_json({
            "law": chosen.name, "target": target, "part": part, "parameters": chosen.values,
            "guarantees": chosen.guarantees(), "files": [str(file) for file in files],
        })  # fmt: skip
    else:
        for file in files:
            print(f"wrote {file}")
    return 0


def _law(name: str, parameters: str | None, assignments: list[str], rig: Scenario | None) -> Law:
    """The law with the constants of the set, else of the scenario's law, and what --set adds."""
    found = laws.find(name)
    given = dict(parse_assignment(text) for text in assignments)
    values = {}
    if parameters is not None:
        values = laws.parameters_for(found, parameters)
    elif rig is not None:
        own = found.own_constants()
        values = rig.law.machine | {n: x for n, x in rig.law.values.items() if n in own and x is not None}
    if problems := found.problems({**values, **given}):
        raise InputError([f"{key}: {text}" for key, text in problems])
    law = found({**values, **given})
    if ".py:" in name and (trouble := laws.trouble(law)):
        raise InputError(f"{name!r}: {trouble}")
    return law

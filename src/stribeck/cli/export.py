"""``stribeck export``."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from stribeck.cli.options import (
    ADVANCED,
    ControllerName,
    Json,
    Trust,
    Undetermined,
    command,
    flag,
    load_scenario,
    output_path,
    setting,
)
from stribeck.cli.output import check_file, print_json, wrote
from stribeck.cli.progress import progress
from stribeck.errors import InputError, note

if TYPE_CHECKING:
    from stribeck.laws.base import Law
    from stribeck.scenario import Scenario


@dataclass(frozen=True)
class PartOptions:
    """The part to export, and its source."""

    part: Annotated[
        str | None,
        setting(
            "--part",
            "PART",
            "law, body, observer, controller, compensator or machine; law unless given, "
            "or machine for a machine file if the target has it.",
        ),
    ] = None
    scenario: Annotated[
        Path | None,
        setting(
            "--scenario", "FILE", "Scenario that gives mass, controller, and the law unless LAW is given.", ADVANCED
        ),
    ] = None
    contact: Annotated[
        str | None, setting("--contact", "NAME", "Contact of the machine whose friction is exported.")
    ] = None
    controller: ControllerName = None


@command("export", "stribeck export lugre --parameters canudas1995 --target c --out firmware")
def export(
    target: Annotated[str, setting("--target", "NAME", "c, fmu, isaaclab, mjwarp, mujoco, newton or table.")],
    out: Annotated[
        Path, setting("--out", "PATH", "Folder for c and mujoco; a file for other targets.", parser=output_path)
    ],
    selection: PartOptions,
    step: Annotated[
        float | None, setting("--step", "S", "Time step of the target (s); the loss of accuracy is reported.", ADVANCED)
    ] = None,
    self_test: Annotated[bool, flag("--self-test", "Add a program that tests the C.", ADVANCED)] = False,
    fmi: Annotated[int, setting("--fmi", "VERSION", "FMI version of an FMU: 3 or 2.")] = 3,
    law: Annotated[
        str | None,
        typer.Argument(metavar="LAW", help="Law, FILE.py:NAME, or a machine file; the scenario's law unless given."),
    ] = None,
    parameters: Annotated[str | None, setting("--parameters", "SET", "Built-in parameter set or TOML file.")] = None,
    set_: Annotated[
        list[str] | None,
        setting("--set", "KEY=VALUE", "Set a constant, such as k_v=1e7 (of a machine: links.gear.gap=0)."),
    ] = None,
    trust: Trust = False,
    json: Json = False,
    _undetermined: Undetermined = False,
) -> int:
    """Write a law, a controller or a machine for another tool. --target names the tool."""
    from stribeck.exports import TARGETS
    from stribeck.exports import export as write

    scenario = selection.scenario
    if law is not None and law.endswith(".toml"):
        if scenario is not None:
            raise InputError(f"LAW: {law!r}: must be left out, or a law: --scenario names a scenario already")
        scenario, law = Path(law), None
    if (known := TARGETS.get(target)) is not None and not known.folder:
        named = (str(scenario or ""), (law or "").rpartition(":")[0], parameters or "")
        check_file("--out", out, *map(Path, named), parents=True)
    part, chosen, rig, origin = _chosen(
        target, law, parameters=parameters, assignments=set_ or [], scenario=scenario, selection=selection, trust=trust
    )
    with progress(f"export to {target}"):
        files = write(
            chosen, target, out, part=part, scenario=rig, origin=origin,
            controller=selection.controller, contact=selection.contact, step=step, self_test=self_test, fmi=fmi,
        )  # fmt: skip
    if json:
        names = [str(file) for file in files]
        print_json(_summary(chosen, rig) | {"target": target, "part": part, "files": names})
    else:
        wrote(files)
    return 0


def _chosen(
    target: str,
    law: str | None,
    *,
    parameters: str | None,
    assignments: list[str],
    scenario: Path | None,
    selection: PartOptions,
    trust: bool,
) -> tuple[str, Law | None, Scenario | None, str]:
    """What the options name: the part, the law or the machine that it is of, and the source of its parameters.

    Raises:
        InputError: it is not known, or the options do not go together.
    """
    from stribeck.exports import SAMPLED, usual_part
    from stribeck.parameter_sets import read_toml

    part = selection.part
    if part is None:
        whole = (
            scenario is not None
            and law is None
            and selection.contact is None
            and read_toml(scenario).get("schema") == 2
        )
        part = usual_part(target, whole)
    chosen: Law | None = None
    if part == "machine" or part in SAMPLED:
        of_a_law = {"LAW": law, "--parameters": parameters, "--contact": selection.contact}
        text = f"must be left out: part '{part}' takes all from the file"
        if wrong := [f"{n}: {x!r}: {text}" for n, x in of_a_law.items() if x]:
            raise InputError(wrong)
        rig = load_scenario(scenario, assignments, trust=trust) if scenario is not None else None
    else:
        rig = load_scenario(scenario, [], trust=trust) if scenario is not None else None
        chosen = _law(law, rig, parameters=parameters, assignments=assignments, contact=selection.contact)
    origin = parameters if parameters is not None and parameters.endswith(".toml") else ""
    if parameters is None and rig is not None:
        origin = f"scenario {rig.name}"
    return part, chosen, rig, origin


def _summary(law: Law | None, rig: Scenario | None) -> dict[str, object]:
    """The exported law, or the machine with its constants."""
    if law is not None:
        return {"law": law.name, "parameters": law.values, "guarantees": law.guarantees()}
    assert rig is not None
    return {"scenario": rig.name, "parameters": {f"{path}.{n}": x for (path, n), x in rig.elements.values.items()}}


def _law(
    name: str | None, rig: Scenario | None, *, parameters: str | None, assignments: list[str], contact: str | None
) -> Law:
    """The law with the constants of the set, else of the scenario's law (of a machine that of a contact), and what --set
    adds."""
    from stribeck import laws, parameter_sets
    from stribeck.exports import contact_law
    from stribeck.laws import sanity
    from stribeck.scenario import parse_assignments
    from stribeck.simulation.comparison import law_path

    given = parse_assignments(assignments)
    own = rig.elements.laws[rig.called.to_machine(law_path(rig, contact))] if rig is not None else None
    if parameters is None and rig is not None and own is not None:
        whole = contact_law(rig, contact)
        if name in (None, own.name):
            return whole.replace(**given)
        if whole.inputs:
            raise InputError(f"{', '.join(whole.beside)}: need the contact's own law {own.name!r}, not {name!r}")
    if name is None and own is None:
        raise InputError("LAW: missing: must be given, unless --scenario names it")
    kind: type[Law] = laws.find(name) if own is None or name is not None else type(own)
    values, rotary = {}, False
    if parameters is not None:
        values = laws.parameters_for(kind, parameters, given=given)
        rotary = parameter_sets.load(parameters, needs=()).rotary
    elif own is not None:
        constants = kind.own_constants()
        values = own.machine | {n: x for n, x in (own.p.numbers | own.choices).items() if n in constants}
        rotary = own.rotary
    law = kind({**values, **given}, rotary)
    if name is not None and ".py:" in name:
        if trouble := laws.trouble(law):
            raise InputError(f"{name!r}: {trouble}")
        for line in sanity.problems(law):
            note(f"{law.name}: {line}")
    return law

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
    load_scenario,
    output_path,
)
from stribeck.cli.output import check_file, print_json, wrote
from stribeck.cli.progress import progress
from stribeck.errors import InputError, note

if TYPE_CHECKING:
    from stribeck.laws.base import Law
    from stribeck.parameter_sets.assignments import Toml
    from stribeck.scenario import Scenario


@dataclass(frozen=True)
class PartOptions:
    """The part to export, and its source."""

    part: Annotated[
        str | None,
        typer.Option(
            "--part",
            metavar="PART",
            help="law, body, observer, controller, compensator or machine; law unless given (machine for a machine file).",
        ),
    ] = None
    scenario: Annotated[
        Path | None,
        typer.Option(
            "--scenario",
            metavar="FILE",
            rich_help_panel=ADVANCED,
            help="Scenario that gives mass, controller, and the law unless LAW is given.",
        ),
    ] = None
    contact: Annotated[
        str | None, typer.Option("--contact", metavar="NAME", help="Contact of the machine whose friction is exported.")
    ] = None
    controller: ControllerName = None


@dataclass(frozen=True)
class ToolOptions:
    """The options of the target."""

    step: Annotated[
        float | None,
        typer.Option(
            "--step",
            metavar="S",
            rich_help_panel=ADVANCED,
            help="Time step of the target (s); the loss of accuracy is reported.",
        ),
    ] = None
    self_test: Annotated[
        bool, typer.Option("--self-test", rich_help_panel=ADVANCED, help="Add a program that tests the C.")
    ] = False
    fmi: Annotated[int, typer.Option("--fmi", metavar="VERSION", help="FMI version of an FMU: 3 or 2.")] = 3
    platforms: Annotated[
        str,
        typer.Option(
            "--platforms",
            metavar="here|all",
            rich_help_panel=ADVANCED,
            help="Binaries of an FMU: here, or all for Windows and macOS too (takes minutes at first).",
        ),
    ] = "here"


@command("export", "stribeck export lugre --parameters canudas1995 --target c --out firmware")
def export(
    target: Annotated[
        str,
        typer.Option(
            "--target", metavar="NAME", help="c, fmu, isaaclab, mjwarp, mujoco, mujoco_plugin, newton or table."
        ),
    ],
    out: Annotated[
        Path,
        typer.Option(
            "--out", metavar="PATH", parser=output_path, help="Folder for c, mujoco and mujoco_plugin; a file for other targets."
        ),
    ],
    selection: PartOptions,
    tool: ToolOptions,
    law: Annotated[
        str | None,
        typer.Argument(
            metavar="LAW",
            help="Law, FILE.py:NAME, or a machine file; the scenario's law unless given.",
        ),
    ] = None,
    parameters: Annotated[
        str | None, typer.Option("--parameters", metavar="SET", help="Built-in parameter set or TOML file.")
    ] = None,
    set_: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="Set a constant, such as k_v=1e7 (of a machine: links.gear.gap=0)."),
    ] = None,
    trust: Trust = False,
    json: Json = False,
    _undetermined: Undetermined = False,
) -> int:  # fmt: skip
    """Write a law, a controller or a machine for another tool. --target names the tool."""
    from stribeck.exports import TARGETS

    scenario = selection.scenario
    if law is not None and law.endswith(".toml"):
        if scenario is not None:
            raise InputError(f"LAW: {law!r}: must be left out, or a law: --scenario names a scenario already")
        scenario, law = Path(law), None
    if (known := TARGETS.get(target)) is not None and not known.folder:
        named = (str(scenario or ""), (law or "").rpartition(":")[0], parameters or "")
        check_file("--out", out, *map(Path, named), parents=True)
    chosen = _chosen(law, parameters, set_ or [], scenario, selection, trust)
    files = _write(chosen, target, out, selection.controller, tool)
    if json:
        names = [str(file) for file in files]
        print_json(_summary(chosen.law, chosen.scenario) | {"target": target, "part": chosen.part, "files": names})
    else:
        wrote(files)
    return 0


@dataclass(frozen=True)
class _Chosen:
    """The export: a part of a law or of a machine, and the source of its parameters."""

    part: str
    law: Law | None
    scenario: Scenario | None
    origin: str
    contact: str | None


def _chosen(
    law: str | None,
    parameters: str | None,
    assignments: list[str],
    scenario: Path | None,
    selection: PartOptions,
    trust: bool,
) -> _Chosen:
    """What the options name.

    Raises:
        InputError: it is not known, or the options do not go together.
    """
    from stribeck.exports import SAMPLED
    from stribeck.parameter_sets import read_toml

    part = selection.part
    if part is None:
        whole = (
            scenario is not None
            and law is None
            and selection.contact is None
            and read_toml(scenario).get("schema") == 2
        )
        part = "machine" if whole else "law"
    chosen: Law | None = None
    if part == "machine" or part in SAMPLED:
        _refuse_of_a_law(part, {"LAW": law, "--parameters": parameters, "--contact": selection.contact})
        rig = load_scenario(scenario, assignments, trust) if scenario is not None else None
    else:
        rig = load_scenario(scenario, [], trust) if scenario is not None else None
        chosen = _law(law, parameters, assignments, rig, selection.contact)
    origin = parameters if parameters is not None and parameters.endswith(".toml") else ""
    if parameters is None and rig is not None:
        origin = f"scenario {rig.name}"
    return _Chosen(part, chosen, rig, origin, selection.contact)


def _write(chosen: _Chosen, target: str, out: Path, controller: str | None, tool: ToolOptions) -> list[Path]:
    """Write the files of the target."""
    from stribeck.exports import export as write

    with progress(f"export to {target}"):
        return write(
            chosen.law, target, out, part=chosen.part, scenario=chosen.scenario, step=tool.step, self_test=tool.self_test,
            origin=chosen.origin, fmi=tool.fmi, controller=controller, contact=chosen.contact, platforms=tool.platforms,
        )  # fmt: skip


def _summary(law: Law | None, rig: Scenario | None) -> dict[str, object]:
    """The exported law, or the machine with its constants."""
    if law is not None:
        return {"law": law.name, "parameters": law.values, "guarantees": law.guarantees()}
    assert rig is not None
    return {"scenario": rig.name, "parameters": {f"{path}.{n}": x for (path, n), x in rig.elements.values.items()}}


def _refuse_of_a_law(part: str, given: dict[str, str | None]) -> None:
    """Refuse what is ``given`` of a law where everything is taken from a machine.

    Raises:
        InputError: a line for each.
    """
    if wrong := [f"{n}: {x!r}: must be left out: part '{part}' takes all from the file" for n, x in given.items() if x]:
        raise InputError(wrong)


def _law(
    name: str | None, parameters: str | None, assignments: list[str], rig: Scenario | None, contact: str | None
) -> Law:
    """The law with the constants of the set, else of the scenario's law (of a machine that of a contact), and what --set
    adds."""
    from stribeck import laws, parameter_sets
    from stribeck.exports import contact_law
    from stribeck.scenario import parse_assignments

    own_law, rotary_body = _contact_law(rig, contact) if rig is not None else (None, False)
    if name is not None:
        kind = laws.find(name)
    elif own_law is not None:
        kind = type(own_law)
    else:
        raise InputError("LAW: missing: must be given, unless --scenario names it")
    given = parse_assignments(assignments)
    values, rotary = {}, False
    if parameters is not None:
        values = laws.parameters_for(kind, parameters, given=given)
        rotary = parameter_sets.load(parameters, needs=()).rotary
    elif rig is not None and own_law is not None:
        if (whole := contact_law(rig, contact)).inputs:
            if kind is not type(own_law):
                text = f"need the contact's own law {own_law.name!r}, not {name!r}"
                raise InputError(f"{', '.join(whole.beside)}: {text}")
            return _at_contact(whole, given)
        constants = kind.own_constants()
        values = own_law.machine | {n: x for n, x in (own_law.p.numbers | own_law.choices).items() if n in constants}
        rotary = rotary_body
    if problems := kind.problems({**values, **given}):
        raise InputError([f"{key}: {text}" for key, text in problems])
    law = kind({**values, **given}, rotary)
    if name is not None and ".py:" in name:
        if trouble := laws.trouble(law):
            raise InputError(f"{name!r}: {trouble}")
        if gap := laws.gap(law):
            note(f"law '{law.name}': {gap}")
    return law


def _at_contact(law: Law, given: dict[str, Toml]) -> Law:
    """The friction of a contact with loads or factors, with what --set adds."""
    if problems := law.problems({**law.machine, **law.p.numbers, **law.p.words, **given}):
        raise InputError([f"{key}: {text}" for key, text in problems])
    return law.replace(**given)


def _contact_law(rig: Scenario, contact: str | None) -> tuple[Law, bool]:
    """The law of a scenario, of a machine that of a contact, and whether it turns there."""
    from stribeck.simulation.comparison import law_path

    law = rig.elements.laws[rig.called.to_machine(law_path(rig, contact))]
    return law, law.rotary

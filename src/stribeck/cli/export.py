"""``stribeck export``."""

from __future__ import annotations

from pathlib import Path

import stribeck.export as exports
from stribeck import laws, parameter_sets
from stribeck.cli.show import check_file, print_json, progress
from stribeck.errors import InputError, note
from stribeck.laws.base import Law
from stribeck.parameter_sets.assignments import Toml
from stribeck.scenario import Scenario, parse_assignments
from stribeck.simulation.comparison import law_path


def export(
    law: str | None,
    target: str,
    out: Path,
    parameters: str | None,
    assignments: list[str],
    part: str | None,
    scenario: Path | None,
    contact: str | None,
    step: float | None,
    self_test: bool,
    fmi: int,
    json: bool,
    trust: bool,
    controller: str | None = None,
    platforms: str = "here",
) -> int:
    """Write the files, and say which."""
    if law is not None and law.endswith(".toml"):
        if scenario is not None:
            raise InputError(f"LAW: {law!r}: must be left out, or a law: --scenario names a scenario already")
        scenario, law = Path(law), None
    if (known := exports.TARGETS.get(target)) is not None and not known.folder:
        named = (str(scenario or ""), (law or "").rpartition(":")[0], parameters or "")
        check_file("--out", out, *map(Path, named), parents=True)
    rig = Scenario.load(scenario, trust=trust) if scenario is not None else None
    if part is None:
        whole = rig is not None and not rig.rig.single and law is None and contact is None
        part = "machine" if whole else "law"
    chosen: Law | None
    if part == "machine" or part in exports.SAMPLED:
        chosen, rig = None, _whole(part, law, parameters, contact, assignments, rig)
    else:
        chosen = _law(law, parameters, assignments, rig, contact)
    origin = parameters if parameters is not None and parameters.endswith(".toml") else ""
    if parameters is None and rig is not None:
        origin = f"scenario {rig.name}"
    with progress(f"export to {target}"):
        files = exports.export(
            chosen,
            target,
            out,
            part=part,
            scenario=rig,
            step=step,
            self_test=self_test,
            origin=origin,
            fmi=fmi,
            controller=controller,
            platforms=platforms,
        )
    if json:
        print_json(_summary(chosen, rig) | {"target": target, "part": part, "files": [str(file) for file in files]})
    else:
        for file in files:
            print(f"wrote {file}")
    return 0


def _summary(law: Law | None, rig: Scenario | None) -> dict[str, object]:
    """What was exported: the law, or the machine with its constants."""
    if law is not None:
        return {"law": law.name, "parameters": law.values, "guarantees": law.guarantees()}
    assert rig is not None
    return {"scenario": rig.name, "parameters": {f"{path}.{n}": x for (path, n), x in rig.values().items()}}


def _whole(
    part: str,
    law: str | None,
    parameters: str | None,
    contact: str | None,
    assignments: list[str],
    rig: Scenario | None,
) -> Scenario | None:
    """A machine with the changes of --set; everything is taken from it."""
    given = {"LAW": law, "--parameters": parameters, "--contact": contact}
    if wrong := [f"{n}: {x!r}: must be left out: part '{part}' takes all from the file" for n, x in given.items() if x]:
        raise InputError(wrong)
    return rig.with_changes(parse_assignments(assignments)) if rig is not None else None


def _law(
    name: str | None, parameters: str | None, assignments: list[str], rig: Scenario | None, contact: str | None
) -> Law:
    """The law with the constants of the set, else of the scenario's law (of a machine that of a contact), and what --set
    adds."""
    own_law, rotary_body = _of(rig, contact) if rig is not None else (None, False)
    if name is None:
        if own_law is None:
            raise InputError("LAW: missing: must be given, unless --scenario names it")
        name = own_law.name
    found = laws.find(name)
    given = parse_assignments(assignments)
    values, rotary = {}, False
    if parameters is not None:
        values, rotary = laws.parameters_for(found, parameters), parameter_sets.load(parameters, needs=()).rotary
    elif rig is not None and own_law is not None:
        if (whole := exports.contact_law(rig, contact)).inputs:
            return _at_contact(whole, name, given)
        own = found.own_constants()
        values = own_law.machine | {n: x for n, x in (own_law.p.numbers | own_law.choices).items() if n in own}
        rotary = rotary_body
    if problems := found.problems({**values, **given}):
        raise InputError([f"{key}: {text}" for key, text in problems])
    law = found({**values, **given}, rotary)
    if ".py:" in name:
        if trouble := laws.trouble(law):
            raise InputError(f"{name!r}: {trouble}")
        if gap := laws.gap(law):
            note(f"law '{law.name}': {gap}")
    return law


def _at_contact(law: Law, name: str, given: dict[str, Toml]) -> Law:
    """The friction of a contact with loads or factors, with what --set adds; no other law has them."""
    if name != law.name:
        raise InputError(f"{', '.join(law.beside)}: would be lost: the contact's law is {law.name!r}, not {name!r}")
    if problems := law.problems({**law.machine, **law.p.numbers, **law.p.words, **given}):
        raise InputError([f"{key}: {text}" for key, text in problems])
    return law.replace(**given)


def _of(rig: Scenario, contact: str | None) -> tuple[Law, bool]:
    """The law of a scenario, of a machine that of a contact, and whether it turns there."""
    law = rig.rig.laws[rig.called.to_machine(law_path(rig, contact))]
    return law, law.rotary

"""A law or a compensator for another tool: the registry of targets, and the one function that writes."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from stribeck import kinds
from stribeck.constants import POSITIVE, show
from stribeck.errors import InputError, arg, nearest, note
from stribeck.exports import targets
from stribeck.exports.contact import contact_law, deflection
from stribeck.exports.controller.block import Block, block_of
from stribeck.exports.machine.model import MachineModel
from stribeck.exports.request import Content, Options, Request, Target
from stribeck.files import misplaced, together, trouble, write_with
from stribeck.laws.base import Law
from stribeck.scenario import Scenario

__all__ = ["PARTS", "TARGETS", "Target", "contact_law", "export"]

PARTS = {
    "law": "the friction law",
    "body": "a body with this friction",
    "observer": "the friction observer",
    "controller": "a controller of a machine, sampled",
    "compensator": "friction compensation of a machine's controller",
    "machine": "a whole machine (schema = 2) with its controllers and its solver",
}

Given = Scenario | str | Path | Mapping[str, object]  # as Scenario.of takes it

SAMPLED = ("controller", "compensator")


def find_targets() -> dict[str, Target]:
    """Every target by its name: what the modules of :mod:`stribeck.exports.targets` declare."""
    declared: list[Target] = [module.TARGET for module in kinds.modules(targets.__name__, targets.__path__)]
    return {target.name: target for target in sorted(declared, key=lambda target: target.name)}


TARGETS = find_targets()


def export(
    law: Law | Given | None,
    target: str,
    out: str | Path,
    *,
    part: str | None = None,
    scenario: Given | None = None,
    step: float | None = None,
    self_test: bool = False,
    origin: str = "",
    fmi: int = 3,
    controller: str | None = None,
    contact: str | None = None,
) -> list[Path]:
    """Write a law, a controller or a machine for another tool.

    The loss of accuracy at the time step ``step``, if given, is reported first as a :class:`stribeck.errors.StribeckNote`.

    Args:
        law: the law with its constants; None for the scenario's own; or in its place a scenario, its file or its tables.
        target: name of the target, such as "c" or "fmu" (docs/reference/exports.md).
        out: folder of the files (``c``, ``mujoco``), or the file itself.
        part: "law", "body", "observer", "controller", "compensator" or "machine"; not every target has every part. Unless
            given, it is "machine" for a machine without a ``contact`` if the target has that part, otherwise "law".
        scenario: the scenario that gives mass and controller, or the machine; also its file or its tables.
        step: time step of the tool, s.
        self_test: also write a program that tests the result (target ``c``).
        fmi: version of FMI, 2 or 3 (target ``fmu``).
        controller: name of the machine's controller (parts ``controller`` and ``compensator``); the only one unless given.
        contact: name of the machine's contact (parts ``law`` and ``observer``); the only one unless given.
        origin: source of the parameters, for the header; built-in sets are recognized.

    Returns:
        The files written.

    Raises:
        InputError: if target or part do not exist or do not fit the law, or if something beside the contact's law would be
            lost; nothing is written.
    """
    out = Path(out)
    law, scenario = _law_and_scenario(law, scenario)
    if part is None:
        whole = law is None and contact is None and scenario is not None and not scenario.elements.unnamed
        part = usual_part(target, whole)
    problems = _problems(target, part, self_test, step, fmi, controller, contact)
    if problems:
        raise InputError(problems)
    chosen = TARGETS[target]
    if text := trouble(out, chosen.folder):
        raise InputError(f"{arg('out')}: {show(str(out))}: {text}")
    options = Options(self_test, fmi)
    what: MachineModel | Block | Request
    if part == "machine":
        what = _machine(law, scenario, step, origin, options)
    elif part in SAMPLED:
        what = _block(law, scenario, part, controller, step, origin, options)
    else:
        exported = _law(law, scenario, contact, chosen)
        z = _deflection(exported, part, scenario, contact, chosen)
        module = out.stem if out.stem.isidentifier() and out.stem.isascii() else "FILE"
        what = Request(exported, part, scenario, step, origin, options, z, module)
    return _write(out, chosen, part, what)


def usual_part(target: str, whole: bool) -> str:
    """The part that is written unless one is given: the machine, if a ``whole`` one is there and the target has that part."""
    parts = TARGETS[target].parts if isinstance(target, str) and target in TARGETS else PARTS
    return "machine" if whole and "machine" in parts else "law"


def _law_and_scenario(law: Law | Given | None, scenario: Given | None) -> tuple[Law | None, Scenario | None]:
    """The law given, and the scenario, which may be given in its place."""
    if law is not None and not isinstance(law, Law):
        if scenario is not None:
            raise InputError(f"{arg('law')}: must be left out, or a law: {arg('scenario')} gives a scenario already")
        law, scenario = None, law
    return law, None if scenario is None else Scenario.of(scenario)


def _write(out: Path, target: Target, part: str, model: MachineModel | Block | Request) -> list[Path]:
    """The files of a part, after its notes."""
    writer = target.parts[part]
    content, notes = writer.files(model), writer.notes(model)
    for text in notes:
        note(text)
    return _write_folder(out, content) if target.folder else _write_file(out, content)


def _machine(
    law: Law | None, scenario: Scenario | None, step: float | None, origin: str, options: Options
) -> MachineModel:
    """The model of a machine, from which all is taken."""
    given = {"law": law.name if law is not None else None, "step": step}
    if wrong := [f"{arg(n)}: {show(x)}: must be left out" for n, x in given.items() if x is not None]:
        raise InputError([f"{text}: part 'machine' takes all from the scenario" for text in wrong])
    return MachineModel(scenario, origin, options)


def _block(
    law: Law | None, scenario: Scenario | None, part: str, controller: str | None, step: float | None, origin: str,
    options: Options,
) -> Block:  # fmt: skip
    """A sampled controller, of which all is taken from the machine."""
    if law is not None:
        raise InputError(f"{arg('law')}: {law.name!r}: must be left out: part '{part}' takes all from the machine")
    return block_of(scenario, part, controller, step, origin, options)


def _law(law: Law | None, scenario: Scenario | None, contact: str | None, target: Target) -> Law:
    """The law given, or the friction of the scenario's contact, with all that the target must be given."""
    if law is None and scenario is None:
        raise InputError(f"{arg('law')}: missing: must be given, unless {arg('scenario')} names it")
    friction = contact_law(scenario, contact) if law is None and scenario is not None else law
    assert friction is not None
    if friction.beside and not target.loads:
        able = ", ".join(name for name, each in TARGETS.items() if each.loads)
        text = f"must be left out: target '{target.name}' has no input for them; {able} have one"
        raise InputError(f"{', '.join(friction.beside)}: {text}")
    return friction


def _deflection(law: Law, part: str, scenario: Scenario | None, contact: str | None, target: Target) -> float:
    """The deflection of the contact's bristles at t = 0; 0 where it is not known which contact is meant.

    Raises:
        InputError: the target would lose it, or a body's position or velocity at t = 0.
    """
    if scenario is None or (contact is None and len(scenario.elements.contacts) != 1):
        return 0.0
    path, z = deflection(scenario, contact)
    start = {path: z if law.has_z else 0.0}
    if part == "body":
        start |= {f"{path.removesuffix('z')}{name}": scenario.initial.get(name, 0.0) for name in "yv"}
    if not target.started and (lost := [f"{key}: {show(x)}" for key, x in start.items() if x]):
        able = ", ".join(name for name, each in TARGETS.items() if each.started and part in each.parts)
        text = f"must be 0 for target '{target.name}', which starts there; {able} take it"
        raise InputError([f"{each}: {text}" for each in lost])
    return start[path]


def _write_file(out: Path, content: Content) -> list[Path]:
    """The one file of a target."""
    out.parent.mkdir(parents=True, exist_ok=True)
    (data,) = content.values()
    write_with(out, lambda beside: beside.write_bytes(_encode(data)))
    return [out]


def _write_folder(out: Path, content: Content) -> list[Path]:
    """All files, or none."""
    if text := misplaced(out, content):
        raise InputError(f"{arg('out')}: {show(str(out))}: {text}")
    with together(out, last=next(iter(content))) as beside:
        for name, data in content.items():
            (beside / name).write_bytes(_encode(data))
    return [out / name for name in content]


def _encode(data: str | bytes) -> bytes:
    return data.encode("utf-8") if isinstance(data, str) else data


def _problems(
    target: str, part: str, self_test: bool, step: float | None, fmi: int, controller: str | None, contact: str | None,
) -> list[str]:  # fmt: skip
    if not isinstance(target, str):
        return [f"{arg('target')}: {show(target)}: must be one of {', '.join(TARGETS)}"]
    if target not in TARGETS:
        guess = nearest(target, TARGETS) or f" (known: {', '.join(TARGETS)})"
        return [f"{arg('target')}: {target!r}: no such target{guess}"]
    problems, chosen = [], TARGETS[target]
    if part not in PARTS:
        problems.append(f"{arg('part')}: {part!r}: must be one of {', '.join(PARTS)}")
    elif part not in chosen.parts:
        problems.append(
            f"{arg('part')}: {part!r}: target '{target}' has none; must be one of {', '.join(chosen.parts)}"
        )
    if self_test and not chosen.self_test:
        problems.append(
            f"{arg('self_test')}: target '{target}' has none; only {', '.join(n for n in TARGETS if TARGETS[n].self_test)}"
        )
    elif self_test and part == "machine":
        problems.append(f"{arg('self_test')}: part 'machine' has none; must be left out")
    if step is not None and (text := POSITIVE.problem(step)):
        problems.append(f"{arg('step')}: {show(step)}: {text}")
    if fmi not in (2, 3):
        problems.append(f"{arg('fmi')}: {fmi}: must be 2 or 3")
    choices = {"controller": (controller, part in SAMPLED), "contact": (contact, part not in (*SAMPLED, "machine"))}
    problems += [
        f"{arg(name)}: {show(chosen)}: must be left out: part '{part}' has no choice of {name}s"
        for name, (chosen, has) in choices.items() if chosen is not None and part in PARTS and not has
    ]  # fmt: skip
    return problems

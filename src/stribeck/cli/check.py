"""``stribeck check``."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from json import dumps
from math import inf, isfinite, nan
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from stribeck.cli.options import (
    ADVANCED,
    Json,
    Out,
    Trust,
    Undetermined,
    command,
    flag,
    load_scenario,
    output_path,
    setting,
)
from stribeck.cli.output import check_file, command_line, output_folder, tell
from stribeck.cli.progress import progress
from stribeck.errors import InputError, arg, check_all, note, read_pairs

if TYPE_CHECKING:
    from stribeck.laws.base import Law
    from stribeck.parameter_sets.assignments import Toml
    from stribeck.properties import Verdicts
    from stribeck.properties.ports import MachineVerdicts

_DEFAULT_SET = "canudas1995"
STEEPNESS = "Steepness"


@dataclass(frozen=True)
class SteepnessOptions:
    """Errors that are allowed, and what belongs to them: the smallest k_v that meets them is found."""

    creep: Annotated[
        float | None,
        setting(
            "--creep",
            "M/S",
            "Find the smallest k_v whose creep under a constant load is at most this (m/s).",
            STEEPNESS,
        ),
    ] = None
    share: Annotated[
        float | None, setting("--share", "X", "Load of --creep, as a share of F_s; 0.95 unless given.", STEEPNESS)
    ] = None
    steady_error: Annotated[
        float | None,
        setting("--steady-error", "X", "Find k_v for this relative error of the steady force at --speed.", STEEPNESS),
    ] = None
    speed: Annotated[
        float | None, setting("--speed", "M/S", "Speed at which --steady-error is evaluated (m/s).", STEEPNESS)
    ] = None

    def given(self) -> dict[str, object]:
        """Those that were given."""
        return {name: x for name, x in asdict(self).items() if x is not None}


@command("check", "stribeck check lugre_sobczyk --parameters canudas1995 --set k_v=1e7")
def check(
    what: Annotated[
        str,
        typer.Argument(metavar="LAW|FILE.toml", help="Law, FILE.py:NAME, or a machine file, whose contacts are all checked."),
    ],
    tolerances: SteepnessOptions,
    parameters: Annotated[
        str | None, setting("--parameters", "NAME or FILE", "Built-in parameter set or TOML file.")
    ] = None,
    set_: Annotated[
        list[str] | None, setting("--set", "KEY=VALUE", "Set a constant, such as k_v=1e7; may be repeated.")
    ] = None,
    v_max: Annotated[
        float | None, setting("--v-max", "V", "Check passivity for |v| <= V (m/s); every speed unless given.")
    ] = None,
    level: Annotated[
        str | None,
        setting("--level", "LOW:HIGH", "Let F_c and F_s vary in any way between LOW and HIGH times their values.", ADVANCED),
    ] = None,
    force: Annotated[
        list[str] | None,
        setting("--force", "NAME=MAX", "Bound of a link's force in a machine (N or N m); unbounded unless given.", ADVANCED),
    ] = None,
    verify: Annotated[
        bool, flag("--verify", "Check each proof by an independent program, and replay each counterexample.")
    ] = False,
    certificate: Annotated[
        Path | None, setting("--certificate", "FILE", "Write the proofs to this JSON file.", ADVANCED, parser=output_path)
    ] = None,
    out: Out = None,
    trust: Trust = False,
    json: Json = False,
    _undetermined: Undetermined = False,
) -> int:  # fmt: skip
    """Prove or refute properties of a law, or of a machine's contacts.

    They are: unique, bounded, smooth, passive, drift-free. A refuted property has a counterexample that 'run' replays.
    A property may remain undecided.
    """
    from stribeck.constants import require_positive
    from stribeck.parameter_sets.assignments import parse_assignments

    def positive() -> None:
        if v_max is not None:
            require_positive("v_max", v_max, "m/s")

    texts, of_machine = set_ or [], what.lower().endswith(".toml")
    check_all(positive, lambda: parse_assignments(texts), lambda: level_of(level), lambda: _forces(force or []))
    of_law = {"parameters": parameters, "level": level, **tolerances.given()}
    if of_machine and (wrong := [arg(name) for name, x in of_law.items() if x is not None]):
        raise InputError([f"{name}: must be left out for a file: it is about one law" for name in wrong])
    if force and not of_machine:
        text = "needs a machine's FILE.toml: it bounds a link, a load or a motor there"
        raise InputError(f"--force: {force[0]!r}: {text}")
    if of_machine:
        asked = _machine(Path(what), assignments=texts, forces=_forces(force or []), trust=trust)
    else:
        asked = _law(
            what, parameters=parameters, given=parse_assignments(texts), level=level_of(level), tolerated=tolerances.given()
        )  # fmt: skip
    _decide(asked, v_max=v_max, out=out, certificate=certificate, verify=verify, json=json)
    return 0


@dataclass(frozen=True)
class _Asked:
    """What is checked: its name, the user's files that it is from, its verdicts up to a speed, more entries of the JSON."""

    name: str
    reads: tuple[Path, ...]
    verdicts: Callable[[float | None], Verdicts | MachineVerdicts]
    json_extras: Mapping[str, object]


def _decide(
    asked: _Asked, *, v_max: float | None, out: Path | None, certificate: Path | None, verify: bool, json: bool
) -> None:
    """Decide, write the files asked for, print the verdicts."""
    with output_folder(out, writes=["report.html"]):
        if certificate is not None:
            check_file("--certificate", certificate, *asked.reads)
        with progress(f"check {asked.name}"):
            verdicts = asked.verdicts(v_max)
        if verify:
            verdicts.verify()
            if unverified := verdicts.unverified:
                note(f"--verify: {', '.join(unverified)}: not verified: there is no certificate, and no run to repeat")
        files = _write(verdicts, out=out, certificate=certificate)
    tell(verdicts.document, {**verdicts.to_dict(), **asked.json_extras} if json else None, files)


def _write(verdicts: Verdicts | MachineVerdicts, *, out: Path | None, certificate: Path | None) -> list[str]:
    """Write the counterexamples, the page, and the proofs if there are any; the paths."""
    from stribeck.files import write_text
    from stribeck.properties.written import write_check

    files = [] if out is None else write_check(verdicts, out, command_line())
    if certificate is not None:
        if verdicts.proved:
            write_text(certificate, dumps(verdicts.certificates(), indent=1) + "\n")
            files.append(str(certificate))
        else:
            note(f"--certificate: nothing was proved with a certificate: '{certificate}' is not written")
    return files


def _machine(file: Path, *, assignments: list[str], forces: dict[str, float], trust: bool) -> _Asked:
    """The contacts of a machine, under bounds of forces in it."""
    from stribeck.properties import check as decide

    scenario = load_scenario(file, assignments, trust=trust)
    return _Asked(scenario.name, (file,), lambda v_max: decide(scenario, v_max, force=forces), {"forces": forces})


def _law(
    name: str, *, parameters: str | None, given: dict[str, Toml], level: tuple[float, float] | None, tolerated: dict[str, object]
) -> _Asked:  # fmt: skip
    """A law with its constants.

    Raises:
        InputError: it is not known, or a constant is not allowed.
    """
    from stribeck import laws

    reads = Path(name.rpartition(":")[0]), Path(parameters or "")
    open_k_v = bool(tolerated) and "k_v" not in given and "k_v" in laws.find(name).constants()
    if parameters is None and _lacks_parameters(name, given):
        parameters = _DEFAULT_SET
        note(f"no parameters given: checked with the set {parameters}")
    law = laws.law(name, parameters, **{**given, **({"k_v": 1.0} if open_k_v else {})})
    if problem := laws.trouble(law):
        raise InputError(f"{name!r}: {problem}")

    def verdicts(v_max: float | None) -> Verdicts:
        found = _verdicts(law, v_max, level, tolerated, open_k_v)
        if ":" in name and found.properties:
            _note_what_makes_no_sense(found.law, found)
        return found

    return _Asked(law.name, reads, verdicts, {})


def _verdicts(
    law: Law, v_max: float | None, level: tuple[float, float] | None, tolerated: dict[str, object], open_k_v: bool
) -> Verdicts:
    """The verdicts and, if tolerances are given, the smallest k_v; no verdicts if no k_v will do.

    With ``open_k_v`` the verdicts are on the law with that k_v.
    """
    from stribeck.properties import Verdicts
    from stribeck.properties import check as decide

    if not tolerated:
        return decide(law, v_max, level=level)
    from stribeck.properties.steepness import Tolerated, smallest_steepness

    steepness = smallest_steepness(law, Tolerated.given({**tolerated, "v_max": v_max}))
    if open_k_v:
        if not (k_v := steepness[law.name].k_v):
            return Verdicts(law, {}, v_max, steepness=steepness)
        law = law.replace(k_v=k_v)
    verdicts = decide(law, v_max, level=level)
    verdicts.steepness = steepness
    return verdicts


def _note_what_makes_no_sense(law: Law, verdicts: Verdicts) -> None:
    """Equations of a user that are not finite, not odd or not differentiable, and claims that are refuted."""
    from stribeck.laws import sanity

    for line in sanity.problems(law):
        note(f"{law.name}: {line}")
    for name, claimed in law.guarantees().items():
        verdict = verdicts.properties.get(name)
        if claimed and verdict is not None and verdict.holds is False:
            note(f"{law.name}: claims: {name}: True: is refuted")


def level_of(text: str | None) -> tuple[float, float] | None:
    """LOW:HIGH as numbers."""
    if text is None:
        return None
    low, sign, high = text.partition(":")
    try:
        bounds = float(low), float(high)
    except ValueError:
        bounds = nan, nan
    if not sign or not 0 < bounds[0] <= bounds[1] < inf:
        raise InputError(f"--level: {text!r}: must be LOW:HIGH, two finite numbers with 0 < LOW <= HIGH, such as 1:2")
    return bounds


def _forces(texts: list[str]) -> dict[str, float]:
    """NAME=MAX as numbers."""
    return read_pairs(_force, texts, "--force")


def _force(text: str) -> tuple[str, float]:
    name, sign, size = text.partition("=")
    try:
        value = float(size)
    except ValueError:
        value = nan
    if not (name and sign and isfinite(value) and value >= 0):
        raise InputError(f"--force: {text!r}: must be NAME=MAX, a link, load or motor and a finite number >= 0")
    return name, value


def _lacks_parameters(name: str, given: Mapping[str, object]) -> bool:
    """Whether a law needs a machine's parameters and none of them is given."""
    from stribeck import laws
    from stribeck.laws.base import PARAMETERS

    kind = laws.find(name)
    return not set(given) & set(PARAMETERS) and any(kind.constants()[n].required for n in kind.uses)

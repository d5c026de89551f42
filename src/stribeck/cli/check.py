"""``stribeck check``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from json import dumps
from math import inf, isfinite, nan
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from stribeck.cli.options import Json, Out, Trust, Undetermined, command, flag, load_scenario, output_path, setting
from stribeck.cli.output import OutputFolder, check_file, command_line, tell
from stribeck.cli.progress import progress
from stribeck.errors import InputError, arg, check_all, note, read_pairs

if TYPE_CHECKING:
    from stribeck.laws.base import Law
    from stribeck.properties import Verdicts
    from stribeck.properties.ports import MachineVerdicts
    from stribeck.scenario import Scenario

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
        float | None,
        setting("--share", "X", "Load of --creep, as a share of F_s; 0.95 unless given.", STEEPNESS),
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
        setting("--level", "LOW:HIGH", "Let F_c and F_s vary in any way between LOW and HIGH times their values."),
    ] = None,
    force: Annotated[
        list[str] | None,
        setting("--force", "NAME=MAX", "Bound of a link's force in a machine (N or N m); unbounded unless given."),
    ] = None,
    verify: Annotated[
        bool, flag("--verify", "Check each proof by an independent program, and replay each counterexample.")
    ] = False,
    certificate: Annotated[
        Path | None, setting("--certificate", "FILE", "Write the proofs to this JSON file.", parser=output_path)
    ] = None,
    out: Out = None,
    trust: Trust = False,
    json: Json = False,
    _undetermined: Undetermined = False,
) -> int:  # fmt: skip
    """Prove or refute properties of a law, or of each contact of a machine.

    They are: unique, bounded, smooth, passive, drift-free. A refuted property has a counterexample that 'run' replays.
    A property may remain undecided.
    """
    from stribeck.constants import require_positive
    from stribeck.parameter_sets.assignments import parse_assignments

    def positive() -> None:
        if v_max is not None:
            require_positive("v_max", v_max, "m/s")

    texts = set_ or []
    check_all(positive, lambda: parse_assignments(texts), lambda: level_of(level), lambda: _forces(force or []))
    of_law = {"parameters": parameters, "level": level, **tolerances.given()}
    asked: _Machine | _Law
    if what.lower().endswith(".toml"):
        asked = _Machine.from_options(what, set_ or [], force or [], of_law, trust)
    elif force:
        text = "needs a machine's FILE.toml: it bounds a link, a load or a motor there"
        raise InputError(f"--force: {force[0]!r}: {text}")
    else:
        asked = _Law.from_options(what, parameters, set_ or [], level, tolerances.given(), trust)
    _decide(asked, v_max, out, certificate, verify=verify, json=json)
    return 0


def _decide(
    asked: _Machine | _Law, v_max: float | None, out: Path | None, certificate: Path | None, *, verify: bool, json: bool
) -> None:
    """Decide, write the files asked for, print the verdicts."""
    with OutputFolder(out, writes=["report.html"]):
        if certificate is not None:
            check_file("--certificate", certificate, *asked.reads)
        with progress(f"check {asked.name}"):
            verdicts = asked.verdicts(v_max)
        if verify:
            verdicts.verify()
        files, pages = _write(verdicts, out, certificate)
    more = asked.json_extras | {
        name: paths for name, paths in (("files", files), ("report", pages)) if paths is not None
    }
    tell(
        verdicts.document,
        {**verdicts.to_dict(), **more} if json else None,
        None if json else [*(files or ()), *(pages or ())[-1:]],
    )


def _write(
    verdicts: Verdicts | MachineVerdicts, out: Path | None, certificate: Path | None
) -> tuple[list[str] | None, list[str] | None]:
    """Write the counterexamples, the page, and the proofs if there are any; the paths of the results, and of the page."""
    from stribeck.files import write_text

    files: list[str] | None = None
    pages: list[str] | None = None
    if out is not None:
        from stribeck.properties.written import write_check

        files, pages = write_check(verdicts, out, command_line())
    if certificate is not None:
        if verdicts.proved:
            write_text(certificate, dumps(verdicts.certificates(), indent=1) + "\n")
            files = [*(files or ()), str(certificate)]
        else:
            note(f"--certificate: nothing was proved with a certificate: '{certificate}' is not written")
    return files, pages


@dataclass(frozen=True)
class _Machine:
    """A machine's file, and bounds of forces in it."""

    reads: tuple[Path, ...]
    scenario: Scenario
    forces: dict[str, float]

    @classmethod
    def from_options(
        cls, file: str, assignments: list[str], forces: list[str], of_law: Mapping[str, object], trust: bool
    ) -> _Machine:
        """The machine with its bounds.

        Raises:
            InputError: something of one law is given, or the file is no valid machine.
        """
        if wrong := [arg(name) for name, x in of_law.items() if x is not None]:
            raise InputError([f"{name}: must be left out for a machine: it is about one law" for name in wrong])
        stated = _forces(forces)
        return cls((Path(file),), load_scenario(Path(file), assignments, trust), stated)

    @property
    def name(self) -> str:
        """Its name."""
        return self.scenario.name

    @property
    def json_extras(self) -> dict[str, object]:
        """Entries of the JSON other than the verdicts."""
        return {"forces": self.forces}

    def verdicts(self, v_max: float | None) -> MachineVerdicts:
        """The verdicts on its contacts and the whole."""
        from stribeck.properties import check as decide

        return decide(self.scenario, v_max, forces=self.forces)


@dataclass(frozen=True)
class _Law:
    """A law as the command line has it, and what is asked of it."""

    reads: tuple[Path, ...]  # the user's files that it is from
    law: Law
    level: tuple[float, float] | None
    tolerated: dict[str, object]
    open_k_v: bool  # the smallest one is looked for, and the verdicts are on the law with it
    from_file: bool  # of a user

    @classmethod
    def from_options(
        cls, name: str, parameters: str | None, assignments: list[str], level: str | None, tolerated: dict[str, object],
        trust: bool,
    ) -> _Law:  # fmt: skip
        """The law with its constants.

        Raises:
            InputError: it is not known, or a constant is not allowed.
        """
        from stribeck import laws
        from stribeck.parameter_sets.assignments import parse_assignments

        reads = Path(name.rpartition(":")[0]), Path(parameters or "")
        bounds, given = level_of(level), parse_assignments(assignments)
        open_k_v = bool(tolerated) and "k_v" not in given and "k_v" in laws.find(name).constants()
        if parameters is None and _lacks_parameters(name, given):
            parameters = _DEFAULT_SET
            note(f"no parameters given: checked with the set {parameters}")
        law = laws.law(name, parameters, **{**given, **({"k_v": 1.0} if open_k_v else {})})
        if problem := laws.trouble(law):
            raise InputError(f"{name!r}: {problem}")
        return cls(reads, law, bounds, tolerated, open_k_v, ":" in name)

    @property
    def name(self) -> str:
        """Its name."""
        return self.law.name

    @property
    def json_extras(self) -> dict[str, object]:
        """Entries of the JSON other than the verdicts."""
        return {}

    def verdicts(self, v_max: float | None) -> Verdicts:
        """The verdicts and, if tolerances are given, the smallest k_v; no verdicts if no k_v will do."""
        from stribeck.properties import Verdicts
        from stribeck.properties import check as decide

        law, steepness = self.law, {}
        if self.tolerated:
            from stribeck.properties.steepness import Tolerated, smallest_steepness

            steepness = smallest_steepness(law, Tolerated.given({**self.tolerated, "v_max": v_max}))
            if self.open_k_v:
                if not (k_v := steepness[law.name].k_v):
                    return Verdicts(law, {}, v_max, steepness=steepness)
                law = law.replace(k_v=k_v)
        verdicts = decide(law, v_max, level=self.level)
        verdicts.steepness = steepness
        if self.from_file:
            _note_what_makes_no_sense(law, verdicts)
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

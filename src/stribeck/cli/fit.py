"""``stribeck fit``."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from stribeck.cli import record
from stribeck.cli.options import ADVANCED, Json, Out, command, flag, setting
from stribeck.cli.output import command_line, output_folder, tell
from stribeck.cli.progress import progress
from stribeck.errors import InputError, check_all, read_pairs

if TYPE_CHECKING:
    from stribeck.identify.result import Fit
    from stribeck.mouth.document import Document


@dataclass(frozen=True)
class How:
    """Options of a fit of a law to a log."""

    term: Annotated[
        list[str] | None,
        setting("--term", "TERM", "Further term of the force, such as stiffness, or delay; may be repeated."),
    ] = None
    mass: Annotated[float | None, setting("--mass", "M", "Mass (kg, or kg m^2); fitted unless given.", ADVANCED)] = None
    method: Annotated[
        str | None,
        setting(
            "--method",
            "METHOD",
            "static, or dynamic (by simulation, any law). Unless given: static for coulomb_viscous, stribeck and stribeck_tanh.",
            ADVANCED,
        ),
    ] = None
    set_: Annotated[
        list[str] | None,
        setting(
            "--set", "KEY=VALUE", "Give a constant instead of fitting it, such as k_v=1e6; may be repeated.", ADVANCED
        ),
    ] = None
    free: Annotated[
        list[str] | None,
        setting("--free", "KEY", "Fit a constant that has a default, such as k_v; may be repeated.", ADVANCED),
    ] = None
    no_forms: Annotated[
        bool,
        flag("--no-forms", "Fit the law alone, without forms (further terms for missing effects; static).", ADVANCED),
    ] = False
    filter_: Annotated[
        str | None,
        setting(
            "--filter",
            "published",
            "Use the published inverse-dynamics procedure: Butterworth filter, decimation, the law alone (static).",
            ADVANCED,
        ),
    ] = None
    speed: Annotated[
        list[float] | None,
        setting("--speed", "M/S", "Also estimate the friction at this speed (m/s; static).", ADVANCED),
    ] = None
    cutoff: Annotated[
        float | None,
        setting(
            "--cutoff",
            "HZ",
            "Cut-off frequency of the motion's filter (Hz); chosen from the data unless given; 0: no filter.",
            ADVANCED,
        ),
    ] = None
    starts: Annotated[int, setting("--starts", "N", "Number of starts of a fit by simulation.", ADVANCED, min=1)] = 20
    seed: Annotated[int, setting("--seed", "N", "Seed of the starts.", ADVANCED, min=0)] = 0
    output: Annotated[
        str,
        setting(
            "--output", "WHAT", "Measured signal that a simulation must match: force, velocity or position.", ADVANCED
        ),
    ] = "force"
    unknown: Annotated[
        list[str] | None,
        setting(
            "--unknown",
            "NAME=LOW:HIGH",
            "Search range of a parameter; with --logs a further unknown, by path; may be repeated.",
            ADVANCED,
        ),
    ] = None

    require: Annotated[
        list[str] | None,
        setting(
            "--require",
            "NAME=SHARE",
            "Half width of the model range that is required, such as F_c=5%. Otherwise the notes say what to measure, and the "
            "exit status is 1; may be repeated.",
            ADVANCED,
        ),
    ] = None

    def given(self) -> record.Keywords:
        """The same as arguments of :func:`stribeck.fit`."""
        return {
            "mass": self.mass, "method": self.method, "free": self.free or (), "term": self.term or (),
            "forms": not self.no_forms, "filter": self.filter_, "speed": self.speed or (),
            "cutoff": self.cutoff, "starts": self.starts, "seed": self.seed, "output": self.output,
            "unknown": sought(self.unknown or []), "require": shares(self.require or []),
        }  # fmt: skip


@command("fit", "stribeck fit log.csv --time t --position y --force F --out fit")
def fit(
    context: typer.Context,
    columns: record.ColumnsOfALog,
    how: How,
    data: record.Data = None,
    law: Annotated[
        list[str] | None,
        setting("--law", "NAME", "Law to fit; may be repeated. The best of these, or of all laws, is chosen."),
    ] = None,
    logs: Annotated[Path | None, setting("--logs", "LOGS.toml", "Recordings and unknowns of the machine DATA.")] = None,
    plan: Annotated[
        str | None,
        setting(
            "--plan",
            "stroke=M,speed=M/S,force=N[,deflection=M]",
            "Print a measurement plan within these limits of the rig. deflection: F_c/sigma_0, if known.",
        ),
    ] = None,
    simulate: Annotated[
        bool,
        flag("--simulate", "With --plan and --out: also write a synthetic log (of --law, --set, --seed).", ADVANCED),
    ] = False,
    verbose: Annotated[bool, flag("--verbose", "Print every note, not only the first five.", ADVANCED)] = False,
    out: Out = None,
    json: Json = False,
) -> int:
    """Fit a law to a log, or a machine to its recordings (--logs).

    Each parameter gets a 95 % interval, a model range and a state, such as identified.
    """
    from stribeck.scenario import parse_assignments

    laws, assignments = law or [], how.set_ or []
    if plan is not None:
        from stribeck.cli.plan import plan as planned

        return planned(
            context, plan, simulate=simulate, laws=laws, assignments=assignments, seed=how.seed, out=out, json=json
        )
    if simulate:
        raise InputError("--simulate: goes with --plan, which is not given")
    of_log = [lambda: record.constants(assignments)]
    of_machine = [lambda: parse_assignments(assignments), lambda: _by_contact(laws)]
    texts = of_log if logs is None else of_machine
    check_all(lambda: sought(how.unknown or []), lambda: shares(how.require or []), columns.given, *texts)
    recordings = _recordings(data or [], logs=logs)
    given = {**how.given(), **columns.given(), **recordings}
    return _fit(data or [], laws, assignments, given, out=out, verbose=verbose, json=json)


def _recordings(data: list[Path], *, logs: Path | None) -> record.Keywords:
    """The recordings of a machine, as arguments of :func:`stribeck.fit`; none for a log.

    Raises:
        InputError: there is no data, or what is given does not go together.
    """
    if not data:
        raise InputError("DATA: missing: a log to fit, or --plan to learn what to measure")
    if logs is not None and len(data) != 1:
        raise InputError(f"DATA: {len(data)} files: with --logs there must be one, the machine's")
    return {} if logs is None else {"logs": logs}


# -- call ------------------------------------------------------------------------------------------------------------


def _fit(
    data: list[Path], laws: list[str], assignments: list[str], given: record.Keywords, *, out: Path | None, verbose: bool,
    json: bool,
) -> int:  # fmt: skip
    """Fit, write the files asked for, print what was found."""
    from stribeck.identify.required import unmet
    from stribeck.identify.written import FILES, write_fit

    with output_folder(out, [data[0], given["logs"]] if "logs" in given else [], FILES):
        with progress("fit") as share:
            given["progress"] = share
            if "logs" in given:
                result = _of_machine(data[0], laws, assignments, given)
            else:
                result = _of_log(data, laws, assignments, given)
        written: list[str] = []
        try:
            if out is not None:
                write_fit(result, out, command_line(), written)
        finally:  # the result is printed even if drawing the page was interrupted
            _show(result, data, written, out=out, verbose=verbose, json=json)
    missed = result.status == "done" and unmet(result, given["require"])
    return 1 if missed else {"done": 0, "stopped": 130}.get(result.status, 1)


def _of_log(data: list[Path], laws: list[str], assignments: list[str], given: record.Keywords) -> Fit:
    """A law fitted to a log."""
    from stribeck.identify.api import fit as fitted

    try:
        return fitted(data, laws, set=record.constants(assignments), **given)
    except KeyboardInterrupt:
        print("stribeck: there is no estimate yet", file=sys.stderr)
        raise


def _of_machine(machine: Path, laws: list[str], assignments: list[str], given: record.Keywords) -> Fit:
    """A machine fitted to its recordings."""
    from stribeck.identify.api import fit as fitted
    from stribeck.scenario import Scenario, parse_assignments

    scenario = Scenario.load(machine, parse_assignments(assignments))
    return fitted(scenario, _by_contact(laws), **given)


def sought(texts: Sequence[str]) -> dict[str, object]:
    """``PATH=LOW:HIGH``, or ``PATH=TABLE`` as in LOGS.toml, as a mapping."""
    return read_pairs(_sought, texts, "--unknown")


def _sought(text: str) -> tuple[str, object]:
    from stribeck.parameter_sets.assignments import value_of

    path, _, given = text.partition("=")
    try:
        pair = [float(x) for x in given.split(":")]
    except ValueError:
        pair = []
    table: object = value_of(given) if "{" in given else pair
    if not path.strip() or not (isinstance(table, dict) or len(pair) == 2):
        raise InputError(f"--unknown: {text!r}: must be PATH=LOW:HIGH, or PATH={{ low = X, high = X, start = X }}")
    return path.strip(), table


def shares(texts: Sequence[str]) -> dict[str, float]:
    """``NAME=5%``, or ``NAME=0.05``, as a mapping."""
    return read_pairs(_share, texts, "--require")


def _share(text: str) -> tuple[str, float]:
    name, _, given = text.partition("=")
    number, sign, rest = given.strip().partition("%")
    try:
        half_width = float(number) / (100 if sign else 1)
    except ValueError:
        rest = text
    if rest or not name.strip():
        raise InputError(f"--require: {text!r}: must be NAME=SHARE, such as F_c=5%")
    return name.strip(), half_width


def _by_contact(texts: Sequence[str]) -> dict[str, list[str]]:
    """``CONTACT=NAME,NAME`` as a mapping."""
    return read_pairs(_laws_of, texts, "--law")


def _laws_of(text: str) -> tuple[str, list[str]]:
    contact, equals, names = text.partition("=")
    if not equals or not contact or not names:
        raise InputError(f"--law: {text!r}: must be CONTACT=NAME,NAME with --logs")
    return contact.strip(), [name.strip() for name in names.split(",")]


# -- show ------------------------------------------------------------------------------------------------------------


def _show(result: Fit, data: list[Path], written: list[str], *, out: Path | None, verbose: bool, json: bool) -> None:
    """Print the fit, and what comes next."""
    from stribeck.identify.result import LogFit

    summary = result.to_dict()
    if isinstance(result, LogFit) and (log := result.log) is not None:
        about = {"rows": len(log), "quality": list(log.quality), "sources": log.sources}
        summary["data"] = {"files": [str(p) for p in data], **about}

    def document() -> Document:
        return replace(result.document(), next=None if out is None or not written else _next(result, out))

    tell(document, summary if json else None, written, verbose)


def _next(result: Fit, out: Path) -> tuple[str, str] | None:
    """The command that comes next, and what for; None if the fit of a machine is no machine."""
    from stribeck.identify.result import MachineFit
    from stribeck.identify.saved import MACHINE_FILE

    if not isinstance(result, MachineFit):
        return f"stribeck predict other.csv --fit {shlex.quote(str(out))}", "test the fit with another recording"
    if result.status != "done":
        return None
    machine = shlex.quote(str(out / MACHINE_FILE))
    if not (contacts := [*result.machine.elements.contacts]):
        return f"stribeck run {machine} --out run", "simulate the fitted machine"
    export = f"stribeck export {machine} --contact {shlex.quote(contacts[0])} --target mujoco --out mujoco"
    return export, "the friction for MuJoCo"

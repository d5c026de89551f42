"""``stribeck run``."""

from __future__ import annotations

import re
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from stribeck.cli.options import Json, Out, ScenarioOptions, command, flag, setting
from stribeck.cli.output import command_line, failed, output_folder, print_json, tell
from stribeck.cli.progress import progress
from stribeck.errors import InputError, StribeckNote, read_pairs

if TYPE_CHECKING:
    from stribeck.scenario import Scenario

_KEY = r"\s*[^\s.,=]+(?:\.[^\s.,=]+)*\s*"
_LAW = re.compile(rf"(?P<name>(?:.*\.py:)?[^:]+)(?::(?P<constants>{_KEY}=[^,]*(?:,{_KEY}=[^,]*)*))?")


@command("run", "stribeck run my_rig.toml --law lugre --law lugre_majorant:k_v=1e7 --out first")
def run(
    source: ScenarioOptions,
    law: Annotated[
        list[str] | None,
        setting(
            "--law",
            "NAME[:KEY=VALUE,...]",
            "Use this law instead of the file's; given again, the laws are compared with the first.",
        ),
    ] = None,
    contact: Annotated[
        str | None, setting("--contact", "NAME", "Contact whose law --law replaces; needed if there are several.")
    ] = None,
    show: Annotated[bool, flag("--show", "Print the machine instead of running it.")] = False,
    out: Out = None,
    json: Json = False,
) -> int:
    """Simulate a scenario or a machine. Without --out, print the summary and write nothing."""
    laws = law or []
    given = source.load(lambda: read_pairs(_law, laws, "--law"))
    if show:
        others = {"--law": laws, "--out": out}
        if wrong := [n for n, x in others.items() if x]:
            raise InputError([f"{name}: must be left out with --show, which simulates nothing" for name in wrong])
        return _show(given, json=json)
    if contact is not None and not laws:
        raise InputError("--contact: goes with --law, which is not given")
    variants = _under_laws(given, laws, contact=contact)
    if len(laws) > 1:
        return _compare(variants, given.name, out=out, json=json)
    (given,) = variants.values() or (given,)
    return _simulate(given, out=out, json=json)


def _simulate(scenario: Scenario, *, out: Path | None, json: bool) -> int:
    """Simulate, write the files asked for, print the summary."""
    from stribeck.simulation import simulate
    from stribeck.simulation.tables import RUN, write_run

    with output_folder(out, writes=RUN):
        with progress(scenario.name) as share:
            solution = simulate(scenario, progress=share)
        summary = solution.summary()
        files = [] if out is None else write_run(solution, out, summary, command_line())
    tell(solution.document, summary if json else None, files)
    if solution.status != "done":
        failed(scenario.name, solution.reason)
    return 0 if solution.status == "done" else 1


# -- several laws ----------------------------------------------------------------------------------------------------


def _compare(variants: dict[str, Scenario], name: str, *, out: Path | None, json: bool) -> int:
    """Simulate under each law, print the deviations from the first, write an overlay."""
    from stribeck.simulation.comparison import compare_laws
    from stribeck.simulation.tables import COMPARISON, write_comparison

    with output_folder(out, writes=COMPARISON):
        with progress(name) as share:
            comparison = compare_laws(variants, share)
        summary = comparison.summary()
        files = [] if out is None else write_comparison(comparison, out, summary, command_line())
    tell(comparison.document, summary if json else None, files)
    for label, solution in comparison.solutions.items():
        if solution.status != "done":
            failed(f"{name} with {label}", solution.reason)
    return 0 if comparison.status == "done" else 1


def _under_laws(scenario: Scenario, laws: list[str], *, contact: str | None) -> dict[str, Scenario]:
    """The scenario under each law, by what the option says.

    Raises:
        InputError: a law or one of its constants is unknown, or the same text is given twice.
    """
    from stribeck.simulation.comparison import law_path

    if not laws:
        return {}
    table = law_path(scenario, contact)
    with warnings.catch_warnings():  # a law without smoothing takes no k_v: no news where laws are compared
        warnings.filterwarnings("ignore", r"(.*\.)?law\.(parameters\.)?k_v: dropped", StribeckNote)
        return read_pairs(lambda text: (text, scenario.with_changes(_changes(text, table))), laws, "--law")


def _changes(text: str, table: str) -> dict[str, object]:
    """A law with its constants as changes to a scenario."""
    from stribeck.laws.base import PARAMETERS

    _, (name, given) = _law(text)
    places = {f"{table}.parameters.{n}" if n in PARAMETERS else f"{table}.{n}": value for n, value in given.items()}
    return {f"{table}.name": name, **places}


def _law(text: str) -> tuple[str, tuple[str, dict[str, object]]]:
    """``NAME:KEY=VALUE,...``, with the name and the constants that it has."""
    from stribeck.scenario import parse_assignment

    match = _LAW.fullmatch(text)
    if match is None:
        raise InputError(f"--law: {text!r}: must be NAME or NAME:KEY=VALUE,...")
    parts = match["constants"].split(",") if match["constants"] else []
    return text, (match["name"], read_pairs(parse_assignment, parts, f"--law: {text!r}:"))


# -- the machine -----------------------------------------------------------------------------------------------------


def _show(scenario: Scenario, *, json: bool) -> int:
    """Print the machine as a schematic."""
    from stribeck.scenario import schematic

    machine = scenario.as_machine()
    if json:
        print_json({"scenario": machine.name, **schematic.describe(machine.elements), "files": []})
    else:
        print(schematic.text(machine.elements, machine.name))
    return 0

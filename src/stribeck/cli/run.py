"""``stribeck run``."""

from __future__ import annotations

import re
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from stribeck.cli import show
from stribeck.cli.shared import Backend, Json, Out, ScenarioFile, Set, Trust, Undetermined, app, place
from stribeck.errors import InputError, StribeckNote, refuse_twice
from stribeck.mouth import terminal

if TYPE_CHECKING:
    from stribeck.scenario import Scenario

_LAW = re.compile(r"(?P<name>(?:.*\.py:)?[^:]+)(?::(?P<constants>.*))?")


@app.command(epilog="Example: stribeck run my_rig.toml --law lugre --law lugre_majorant:k_v=1e7 --out first")
def run(
    scenario: ScenarioFile,
    law: Annotated[
        list[str] | None,
        typer.Option(
            "--law",
            metavar="NAME[:KEY=VALUE,...]",
            help="Use this law instead of the file's; given again, the laws are compared with the first.",
        ),
    ] = None,
    contact: Annotated[
        str | None,
        typer.Option(
            "--contact", metavar="NAME", help="Contact whose law --law replaces; needed if there are several."
        ),
    ] = None,
    out: Out = None,
    set_: Set = None,
    draw: Annotated[bool, typer.Option("--show", help="Draw the machine instead of running it.")] = False,
    keep_c: Annotated[
        Path | None,
        typer.Option("--keep-c", metavar="FILE", parser=place, help="Write the generated C to this file."),
    ] = None,
    trust: Trust = False,
    json: Json = False,
    _backend: Backend = None,
    _undetermined: Undetermined = False,
) -> int:
    """Simulate a scenario or a machine; without --out, print the summary and write nothing."""
    given = show.load(scenario, set_ or [], trust)
    laws = law or []
    if draw:
        others = {"--law": laws, "--keep-c": keep_c}
        if wrong := [
            f"{name}: must be left out with --show, which simulates nothing" for name, x in others.items() if x
        ]:
            raise InputError(wrong)
        return _show(given, out=out, json=json)
    if contact is not None and not laws:
        raise InputError("--contact: goes with --law, which is not given")
    if len(laws) > 1:
        if keep_c is not None:
            raise InputError("--keep-c: must be left out where several laws are compared")
        return _compare(given, laws, contact, out=out, json=json)
    for text in laws:
        (given,) = _under_laws(given, [text], contact).values()
    return _simulate(given, scenario, out=out, keep_c=keep_c, json=json)


def _simulate(scenario: Scenario, path: Path, *, out: Path | None, keep_c: Path | None, json: bool) -> int:
    """Simulate, write the files asked for, print the summary."""
    from stribeck.simulation import c_source, simulate

    if keep_c is not None and (out is None or keep_c.absolute().parent != out.absolute()):
        show.check_file("--keep-c", keep_c, path)
    if out is not None:
        show.check_folder(out)
    with show.progress(scenario.name) as tell:
        solution = simulate(scenario, progress=tell)
    summary, files = solution.summary(), list[str]()
    if keep_c is not None:
        from stribeck.files import write_text

        write_text(keep_c, c_source(scenario))
        files.append(str(keep_c))
    if out is not None:
        from stribeck.simulation.tables import write_run

        files += write_run(solution, out, {**summary, "files": files}, show.command_line())
    if json:
        show.print_json({**summary, "files": files})
    else:
        terminal.tell(solution.document(), files)
    if solution.status != "done":
        show.failed(scenario.name, solution.reason)
        return 1
    return 0


# -- several laws ----------------------------------------------------------------------------------------------------


def _compare(scenario: Scenario, laws: list[str], contact: str | None, *, out: Path | None, json: bool) -> int:
    """Simulate under each law, print the deviations from the first, write an overlay."""
    from stribeck.simulation.comparison import compare_laws

    variants = _under_laws(scenario, laws, contact)
    if out is not None:
        show.check_folder(out)
    with show.progress(scenario.name) as tell:
        comparison = compare_laws(variants, tell)
    summary, files = comparison.summary(), list[str]()
    if out is not None:
        from stribeck.simulation.tables import write_comparison

        files = write_comparison(comparison, out, summary, show.command_line())
    if json:
        show.print_json({**summary, "files": files})
    else:
        terminal.tell(comparison.document(), files)
    for label, solution in comparison.solutions.items():
        if solution.status != "done":
            show.failed(f"{scenario.name} with {label}", solution.reason)
    return 0 if comparison.status == "done" else 1


def _under_laws(scenario: Scenario, laws: list[str], contact: str | None) -> dict[str, Scenario]:
    """The scenario under each law, by what the option says.

    Raises:
        InputError: a law or one of its constants is unknown, or the same text is given twice.
    """
    from stribeck.simulation.comparison import law_path

    table = law_path(scenario, contact)
    with warnings.catch_warnings():  # a law without smoothing takes no k_v: no news where laws are compared
        warnings.filterwarnings("ignore", r"(.*\.)?law\.(parameters\.)?k_v: dropped", StribeckNote)
        variants = {text: scenario.with_changes(_changes(text, table)) for text in laws}
    if len(variants) < len(laws):
        raise InputError(f"--law: {max(laws, key=laws.count)!r}: given twice; must differ from the others")
    return variants


def _changes(text: str, table: str) -> dict[str, object]:
    """``NAME:KEY=VALUE,...`` as changes to a scenario."""
    from stribeck.laws.base import PARAMETERS
    from stribeck.scenario import parse_assignment

    match = _LAW.fullmatch(text)
    if match is None:
        raise InputError(f"--law: {text!r}: must be NAME or NAME:KEY=VALUE,...")
    given = []
    for part in (match["constants"] or "").split(","):
        if part.strip() or match["constants"] == "":
            if "=" not in part:
                raise InputError(f"--law: {text!r}: must be NAME or NAME:KEY=VALUE,...")
            given.append(parse_assignment(part))
    refuse_twice([key for key, _ in given], f"--law: {text!r}:")
    places = {f"{table}.parameters.{key}" if key in PARAMETERS else f"{table}.{key}": value for key, value in given}
    return {f"{table}.name": match["name"], **places}


# -- the machine as a drawing ----------------------------------------------------------------------------------------


def _show(scenario: Scenario, *, out: Path | None, json: bool) -> int:
    """Print the machine as a schematic; with --out also as DIR/machine.svg."""
    from stribeck.scenario import schematic
    from stribeck.scenario.counterpart import as_machine

    machine, files = as_machine(scenario), list[str]()
    if out is not None:
        from stribeck.files import write_text

        show.check_folder(out)
        write_text(out / "machine.svg", schematic.svg(machine.rig, machine.name))
        files.append(str(out / "machine.svg"))
    if json:
        show.print_json({"scenario": machine.name, **schematic.describe(machine.rig), "files": files})
        return 0
    print(schematic.text(machine.rig, machine.name))
    for file in files:
        print(f"wrote {file}")
    return 0

"""``stribeck compare``."""

from __future__ import annotations

import re
import warnings
from pathlib import Path

from stribeck.analysis.comparison import Comparison, compare_laws, law_path
from stribeck.cli import show
from stribeck.cli.text import say, width
from stribeck.errors import InputError, StribeckNote, refuse_twice
from stribeck.laws.base import PARAMETERS
from stribeck.report.cells import percent
from stribeck.scenario import parse_assignment

_NUMBERS = 40  # columns of a row beside the label
_LAW = re.compile(r"(?P<name>(?:.*\.py:)?[^:]+)(?::(?P<constants>.*))?")


def compare(
    path: Path, laws: list[str], out: Path | None, assignments: list[str], json: bool, trust: bool, contact: str | None
) -> int:
    """Simulate the scenario under each law, print the deviations from the first, write an overlay."""
    scenario = show.load(path, assignments, trust)
    table = law_path(scenario, contact)
    with warnings.catch_warnings():  # that a law without smoothing takes no k_v is what it is compared for
        warnings.filterwarnings("ignore", r"(.*\.)?law\.(parameters\.)?k_v: dropped", StribeckNote)
        variants = {text: scenario.with_changes(_changes(text, table)) for text in laws}
    if len(variants) < len(laws):
        raise InputError(f"--law: {max(laws, key=laws.count)!r}: given twice; must differ from the others")
    if out is not None:
        show.check_folder(out)
    with show.progress(scenario.name) as tell:
        comparison = compare_laws(variants, tell)
    summary, files = comparison.summary(), list[str]()
    if out is not None:
        from stribeck.report.compare import write_comparison

        files = write_comparison(comparison, out, summary, show.command_line())
    if json:
        show.print_json({**summary, "files": files})
    else:
        _print(comparison, files)
    for label, solution in comparison.solutions.items():
        if solution.status != "done":
            show.failed(f"{scenario.name} with {label}", solution.reason)
    return 0 if comparison.status == "done" else 1


def _changes(text: str, table: str) -> dict[str, object]:
    """``NAME:KEY=VALUE,...`` as changes to a scenario."""
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


def _print(comparison: Comparison, files: list[str]) -> None:
    reference, *others = comparison.solutions
    units = {column.name: column.unit for column in comparison.solutions[reference].columns}
    wide = max(map(len, comparison.solutions))
    beside = wide if wide <= width() - _NUMBERS else 0  # the labels' column; none where they would fold the table
    if not others:
        say(f"{comparison.name}: {reference} alone: there is nothing to compare it with; --law may be given again", 2)
    else:
        say(f"{comparison.name}: largest deviation from {reference}, and its share of the reference's peak", 2)
        print(f"  {'law' if beside else '':{beside}}{'deviation':>14}{'share':>12}  of")
    for label, deviations in comparison.deviations.items():
        if not beside:
            print(f"  {label}")
        for i, (name, d) in enumerate(deviations.items()):
            named = label if beside and not i else ""
            print(f"  {named:{beside}}{d['max']:14.4g}{percent(d['max_relative']):>12}  {name} ({units[name]})")
    for file in files:
        print(f"  wrote {file}")

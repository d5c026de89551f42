"""Chapters that several pages have, and the file of a page."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from stribeck.arrays import Array
from stribeck.constants import rotary_words
from stribeck.files import write_text
from stribeck.laws.base import Law
from stribeck.laws.render import equations
from stribeck.report.cells import digits
from stribeck.report.page import Chapter, FigureSvg, Table, html
from stribeck.scenario import Scenario
from stribeck.simulation import Solution
from stribeck.version import __version__

_EVENTS_SHOWN = 12


def write_page(
    folder: Path, title: str, introduction: Sequence[str], chapters: Sequence[Chapter], command: str = ""
) -> Path:
    """Write report.html, which stands alone; its path."""
    about = f"Stribeck {__version__}" + (f", {command}" if command else "")
    path = folder / "report.html"
    write_text(path, html(title, about, introduction, chapters, command))
    return path


def result(solution: Solution) -> Chapter:
    """What came out: peaks and final values, and when the body slipped and stuck."""
    scenario, stats, final = solution.scenario, solution.stats, solution.final
    rows = [
        [c.name, c.meaning, digits(solution.peaks[c.name]), digits(final.get(c.name)), c.unit or "1"]
        for c in solution.columns
    ]
    tables = [Table(["column", "meaning", "largest magnitude", "at the end", "unit"], rows)]
    events = _flat(solution.events)
    if events:
        words = {"slip": "|v| rises through v_s (slip)", "stick": "|v| falls through v_s (stick)"}
        lines = []
        for kind, times in events.items():
            more = f" and {len(times) - _EVENTS_SHOWN} more" if len(times) > _EVENTS_SHOWN else ""
            lines.append(
                [words.get(kind, kind), str(len(times)), ", ".join(f"{t:.6g}" for t in times[:_EVENTS_SHOWN]) + more]
            )
        tables.append(Table(["event", "times", "at (s)"], lines, prose=True))
    ended = f"It failed: {solution.reason}; the part that was reached is shown." if solution.reason else ""
    text = [
        f"{len(solution.t)} rows of {scenario.rows} up to t = {digits(final.get('t', 0.0))} s, in {stats['accepted']} steps "
        f"({stats['rejected']} rejected) of {stats['solver']}.",
        *([ended] if ended else []),
    ]
    return Chapter("result", "Result", text, tables)


def _flat(events: Mapping[str, Any]) -> dict[str, Array]:
    """What happened at all; of a machine under names such as 'mesh: slip'."""
    found: dict[str, Array] = {}
    for name, each in events.items():
        found |= {f"{name}: {kind}": times for kind, times in each.items()} if isinstance(each, dict) else {name: each}
    return {name: times for name, times in found.items() if len(times)}


def slips(solution: Solution) -> int:
    """How often anything began to slip."""
    return sum(len(times) for name, times in _flat(solution.events).items() if name.endswith("slip"))


def of_laws(scenario: Scenario) -> list[Chapter]:
    """The law, or the laws of a machine's contacts."""
    laws = scenario.rig.named_laws.items()
    return [of_law(law, f"law-{i}", f" of {name}") if name else of_law(law) for i, (name, law) in enumerate(laws)]


def of_law(law: Law, key: str = "law", of: str = "") -> Chapter:
    """A law: its equations and its constants; ``of``: words for where it acts."""
    declared = law.constants()
    values: dict[str, object] = law.p.numbers | law.p.words
    words = rotary_words if law.rotary else str
    rows = [
        [
            n,
            f"{x:g}" if isinstance(x, float) else str(x),
            declared[n].unit_for(law.rotary) or "1",
            words(declared[n].meaning),
        ]
        for n, x in values.items()
    ]
    about = " ".join((type(law).__doc__ or "").split())
    lines = "\n".join(each.text for each in equations(type(law), law.form))
    table = Table(["constant", "value", "unit", "meaning"], rows, prose=True)
    return Chapter(
        key,
        f"The law{of}: {law.name}" if of else f"The law {law.name}",
        [about, f"Source: {law.source}."],
        [table],
        code=lines,
    )


def of_scenario(scenario: Scenario) -> Chapter:
    """The scenario as a file that runs again."""
    from tomli_w import dumps

    return Chapter("scenario", "The scenario", ["As a file for 'stribeck run':"], code=dumps(_short(scenario.data)))


def _short(data: Mapping[str, object]) -> dict[str, object]:
    """The data with long lists cut, which says so."""

    def cut(value: object) -> object:
        if isinstance(value, dict):
            return {key: cut(inner) for key, inner in value.items() if inner is not None}
        if isinstance(value, list) and len(value) > 24:
            return [*value[:8], f"... {len(value) - 16} more ...", *value[-8:]]
        return value

    return {key: cut(value) for key, value in data.items()}


def plots(figures: Sequence[FigureSvg], text: Sequence[str] = ()) -> list[Chapter]:
    """A chapter of figures, where there are any."""
    return [Chapter("plots", "Plots", text, figures=figures)] if figures else []

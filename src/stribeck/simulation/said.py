"""The documents of a run and of a comparison of laws."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from stribeck.arrays import Array
from stribeck.laws import said as of_law
from stribeck.mouth.cells import human, in_prefix, percent
from stribeck.mouth.document import PAGE, Amount, Cell, Chapter, Document, Head, Share, Table
from stribeck.scenario import said as of_scenario
from stribeck.simulation import drawing

if TYPE_CHECKING:
    from stribeck.simulation.comparison import Comparison
    from stribeck.simulation.solution import Solution

_EVENTS_SHOWN = 12  # fits a line of the page
_OFTEN = 3  # slips: with more, their period is reported instead of the first time
_LATELY = 21  # last slips, over which the period is averaged
_WORDS = {"slip": "|v| rises through v_s (slip)", "stick": "|v| falls through v_s (stick)"}


def run(solution: Solution) -> Document:
    """The document of a run: summary, peaks and final values, events, plots, laws and the file."""
    scenario, stats = solution.scenario, solution.stats
    subject = (
        f"law {scenario.law.name}, drive {scenario.called.drive}" if scenario.elements.unnamed else scenario.subject
    )
    facts = [
        f"{solution.status}: {subject}; {len(solution.t)} rows of {scenario.rows}",
        f"{stats['accepted']} steps ({stats['rejected']} rejected) in {1e3 * stats['seconds']:.1f} ms, {stats['solver']}",
    ]
    if solution.reason:
        facts.insert(1, f"failed: {solution.reason}; the results end there")
    return Document(
        scenario.name,
        _headline(solution),
        facts,
        [
            Chapter("result", "Result", tables=[_numbers(solution), *_events(solution)]),
            Chapter("plots", "Plots", figures=[drawing.overview({scenario.label: solution})], on=PAGE),
            *of_scenario.laws(scenario),
            of_scenario.file(scenario),
        ],
    )


def _headline(solution: Solution) -> str:
    """A summary of the motion in one sentence."""
    if not solution.scenario.elements.unnamed:
        return "reaches " + ", ".join(
            f"|{c.name}| = {human(solution.peaks[c.name], c.unit)}" for c in solution.columns[:4]
        )
    slips = solution.events["slip"]
    peak = human(solution.peaks["y"], solution.columns[0].unit)
    moves = f"{'turns' if solution.scenario.rotary else 'moves'} up to {peak}"
    if len(slips) > _OFTEN:
        period = human(float(np.mean(np.diff(slips[-_LATELY:]))), "s")
        return f"sticks and slips {len(slips)} times, mean period {period}; {moves}"
    if len(slips):
        times = "once, at" if len(slips) == 1 else f"{len(slips)} times, first at"
        return f"slips {times} t = {human(float(slips[0]), 's')}; {moves}"
    return f"{moves}; |v| never rises through v_s"


def _numbers(solution: Solution) -> Table:
    peaks, final = solution.peaks, solution.final
    rows = [
        [c.name, *in_prefix(c.unit, peaks[c.name], final.get(c.name, float("nan"))), c.meaning]
        for c in solution.columns
    ]
    return Table(["column", Head("peak", 4), Head("at the end", 4), "unit", "meaning"], rows, prose=True)


def _events(solution: Solution) -> list[Table]:
    """A table of the events that occurred, with their times."""
    rows = []
    for name, times in _flat(solution.events):
        more = f" and {len(times) - _EVENTS_SHOWN} more" if len(times) > _EVENTS_SHOWN else ""
        instants = ", ".join(f"{t:.6g}" for t in times[:_EVENTS_SHOWN]) + more
        rows.append([_WORDS.get(name, name), str(len(times)), instants])
    return [Table(["event", "times", Head("at (s)", on=PAGE)], rows, prose=True)] if rows else []


def _flat(events: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Array]]:
    """Name and times of the events that occurred; of a machine with the element's name, such as 'mesh: slip'."""
    for name, each in events.items():
        if isinstance(each, dict):
            yield from _flat(each, f"{name}: ")
        elif len(each):
            yield f"{prefix}{name}", each


def comparison(result: Comparison) -> Document:
    """The document of a comparison: the deviation of each law from the first."""
    reference, first = next(iter(result.solutions.items()))
    names = first.scenario.system.compared
    units = {c.name: c.unit for c in first.columns}
    deviations: list[list[Cell]] = [
        [label if not i else "", n, Amount(d["max"], units[n], 4), Share(d["max_relative"])]
        for label, each in result.deviations.items()
        for i, (n, d) in enumerate(each.items())
    ]
    statistics: list[list[Cell]] = [
        [label, sum(len(times) for n, times in _flat(s.events) if n.endswith("slip")), *(s.peaks[n] for n in names),
         s.stats["accepted"]]
        for label, s in result.solutions.items()
    ]  # fmt: skip
    facts = [f"deviation: the largest over the rows that both laws reached; share: of the peak of {reference}"]
    facts += [f"{label} failed: {s.reason}" for label, s in result.solutions.items() if s.reason]
    laws = (
        [of_law.chapter(s.scenario.law, f"law-{i}") for i, s in enumerate(result.solutions.values())]
        if first.scenario.elements.unnamed
        else of_scenario.laws(first.scenario)
    )
    tables = [
        Table(["law", "column", "deviation", "share"], deviations),
        Table(["law", "slips", *(f"largest {n} ({units[n]})" for n in names), "steps"], statistics, on=PAGE),
    ]
    return Document(
        f"{result.name}, {len(result.solutions)} laws",
        _deviation_sentence(result, reference, names[0], units[names[0]]),
        facts,
        [
            Chapter("deviations", "Deviations", tables=tables),
            Chapter("plots", "Plots", figures=[drawing.comparison(result.solutions)], on=PAGE),
            *laws,
            of_scenario.file(first.scenario),
        ],
    )


def _deviation_sentence(result: Comparison, reference: str, name: str, unit: str) -> str:
    """The deviations from the reference in one sentence."""
    deviations = []
    for label, columns in result.deviations.items():
        largest, share = columns[name]["max"], columns[name]["max_relative"]
        size = "?" if largest is None else human(largest, unit)
        deviations.append(f"{label} {size} ({percent(share)} of its peak)")
    return (
        f"largest deviation of {name} from {reference}: {', '.join(deviations)}" if deviations else f"{reference} alone"
    )

"""How a run, and a comparison of laws, is told: the documents of their results."""

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

_EVENTS_SHOWN = 12
_OFTEN = 3  # slips: from there on the time between them says more than when the first was
_LATELY = 21  # slips, whose times apart are averaged
_WORDS = {"slip": "|v| rises through v_s (slip)", "stick": "|v| falls through v_s (stick)"}


def run(solution: Solution) -> Document:
    """A run: what happened, largest and last numbers, events, plots, laws and the file."""
    scenario, stats = solution.scenario, solution.stats
    about = f"law {scenario.law.name}, drive {scenario.called.drive}" if scenario.elements.unnamed else scenario.subject
    facts = [
        f"{solution.status}: {about}; {len(solution.t)} rows of {scenario.rows}",
        f"{stats['accepted']} steps ({stats['rejected']} rejected) in {1e3 * stats['seconds']:.1f} ms, {stats['solver']}",
    ]
    if solution.reason:
        facts.insert(1, f"it failed: {solution.reason}; the part that was reached is shown")
    return Document(
        scenario.name,
        _in_short(solution),
        facts,
        [
            Chapter("result", "Result", tables=[_numbers(solution), *_events(solution)]),
            Chapter("plots", "Plots", figures=[drawing.overview({scenario.label: solution})], on=PAGE),
            *of_scenario.laws(scenario),
            of_scenario.file(scenario),
        ],
    )


def _in_short(solution: Solution) -> str:
    """What happened, in one sentence and in units that a person would use."""
    if not solution.scenario.elements.unnamed:
        told = ", ".join(f"{c.name} up to {human(solution.peaks[c.name], c.unit)}" for c in solution.columns[:4])
        return f"largest magnitudes: {told}"
    slips = solution.events["slip"]
    peak = human(solution.peaks["y"], solution.columns[0].unit)
    moves = f"{'turns' if solution.scenario.rotary else 'moves'} up to {peak}"
    if len(slips) > _OFTEN:
        period = human(float(np.mean(np.diff(slips[-_LATELY:]))), "s")
        return f"sticks and slips {len(slips)} times, lately every {period}; {moves}"
    if len(slips):
        times = "once, at" if len(slips) == 1 else f"{len(slips)} times, first at"
        return f"slips {times} t = {human(float(slips[0]), 's')}; {moves}"
    return f"{moves}; |v| never passes v_s"


def _numbers(solution: Solution) -> Table:
    peaks, final = solution.peaks, solution.final
    rows = [
        [c.name, c.meaning, *in_prefix(c.unit, peaks[c.name], final.get(c.name, float("nan")))]
        for c in solution.columns
    ]
    columns: list[str | Head] = [
        "column",
        Head("meaning", on=PAGE),
        Head("peak", 8),
        Head("at the end", 8),
        "unit",
    ]
    return Table(columns, rows)


def _events(solution: Solution) -> list[Table]:
    """What happened at all, and when."""
    rows = []
    for name, times in _flat(solution.events):
        more = f" and {len(times) - _EVENTS_SHOWN} more" if len(times) > _EVENTS_SHOWN else ""
        at = ", ".join(f"{t:.6g}" for t in times[:_EVENTS_SHOWN]) + more
        rows.append([_WORDS.get(name, name), str(len(times)), at])
    return [Table(["event", "times", Head("at (s)", on=PAGE)], rows, prose=True)] if rows else []


def _flat(events: Mapping[str, Any], of: str = "") -> Iterator[tuple[str, Array]]:
    """What happened at all; of a machine under names such as 'mesh: slip'."""
    for name, each in events.items():
        if isinstance(each, dict):
            yield from _flat(each, f"{name}: ")
        elif len(each):
            yield f"{of}{name}", each


def comparison(found: Comparison) -> Document:
    """Several laws: how far each is from the first."""
    reference, first = next(iter(found.solutions.items()))
    names = first.scenario.rig.compared
    units = {c.name: c.unit for c in first.columns}
    apart: list[list[Cell]] = [
        [label if not i else "", n, Amount(d["max"], units[n], 4), Share(d["max_relative"])]
        for label, each in found.deviations.items()
        for i, (n, d) in enumerate(each.items())
    ]
    about: list[list[Cell]] = [
        [label, sum(len(times) for n, times in _flat(s.events) if n.endswith("slip")), *(s.peaks[n] for n in names),
         s.stats["accepted"]]
        for label, s in found.solutions.items()
    ]  # fmt: skip
    facts = [f"the largest deviation from {reference} over the rows that both reached, and its share of the peak there"]
    facts += [f"{label} failed: {s.reason}" for label, s in found.solutions.items() if s.reason]
    laws = (
        [of_law.chapter(s.scenario.law, f"law-{i}") for i, s in enumerate(found.solutions.values())]
        if first.scenario.elements.unnamed
        else of_scenario.laws(first.scenario)
    )
    tables = [
        Table(["law", "of", "deviation", "share"], apart),
        Table(["law", "slips", *(f"largest {n} ({units[n]})" for n in names), "steps"], about, on=PAGE),
    ]
    return Document(
        f"{found.name}, {len(found.solutions)} laws",
        _apart(found, reference, names[0], units[names[0]]),
        facts,
        [
            Chapter("deviations", "Deviations", tables=tables),
            Chapter("plots", "Plots", figures=[drawing.comparison(found.solutions)], on=PAGE),
            *laws,
            of_scenario.file(first.scenario),
        ],
    )


def _apart(found: Comparison, reference: str, name: str, unit: str) -> str:
    """How far the others are from the reference, in one sentence and in units that a person would use."""
    told = []
    for label, columns in found.deviations.items():
        largest, share = columns[name]["max"], columns[name]["max_relative"]
        size = "?" if largest is None else human(largest, unit)
        told.append(f"{label} by up to {size} ({percent(share)} of its peak)")
    return f"from {reference}, {name} differs: {', '.join(told)}" if told else f"{reference} alone"

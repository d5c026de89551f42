"""How a design is told: the document of a loop's verdict."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from stribeck.loops import figures
from stribeck.loops.boundary import Mixed, PathVerdicts
from stribeck.loops.compensation import CompensationResult
from stribeck.loops.judge import Judgement
from stribeck.loops.starts import Start, kinds
from stribeck.mouth.cells import human
from stribeck.mouth.document import PAGE, Amount, Cell, Chapter, Document, Head, Table
from stribeck.scenario import said as of_scenario

if TYPE_CHECKING:
    from stribeck.loops import Design

_MEANING = {
    "quiet": "settles and stays there",
    "creeping": "still moves in one direction when it should rest",
    "hunting": "oscillates when it should rest",
    "unstable": "oscillates with growing amplitude, up to a limit or without end",
    "failed": "could not be simulated to the end",
}
_VERDICTS = {"quiet": "QUIET", "creeping": "CREEPS", "hunting": "HUNTS", "unstable": "UNSTABLE", "failed": "FAILED"}
_DOES = {"quiet": "stays quiet", "creeping": "creeps", "unstable": "is unstable", "failed": "could not be simulated"}
_REMEDIES = {
    "none": "none", "reference": "feedforward at the signal's speed", "measured": "observer at the measured speed",
    "inner_loop": "observer with dF/dt, led by the lag", "dither": "dither",
}  # fmt: skip


def design(found: Design) -> Document:
    """Will it hunt, how well does it track, where does the verdict change, and what may be done against friction."""
    own, unit = found.judgement, position_unit(found)
    facts = []
    if found.loop.held:
        facts.append(f"held at their value at t = {found.loop.rest:g} s, to judge rest: {', '.join(found.loop.held)}")
    if own.note:
        facts.append(f"note: {own.note}")
    figure = figures.tracking(found.tracked, unit)
    chapters = [_errors(found, unit), *([_boundaries(found)] if found.lines else [])]
    if found.compensations:
        chapters.append(_compensations(found, unit))
    elif found.why_not:
        facts.append(f"compensations were not compared: {found.why_not}")
    chapters += [
        _starts(found),
        Chapter("plots", "Plots", figures=[figure], on=PAGE),
        of_scenario.file(found.loop.scenario),
    ]
    lead = f"{_headline(own, _unit(found, own.body))}  ({starts_sentence(found.starts, own, _unit(found, own.body))})"
    return Document(found.loop.scenario.name, lead, facts, chapters)


def _errors(found: Design, unit: str) -> Chapter:
    """How each move is followed."""
    rows: list[list[Cell]] = []
    for move, row in found.errors.items():
        settled = row.get("settling", -1.0)
        last: Cell = "never" if settled is None else "-" if settled < 0 else Amount(settled, "s")
        errors = [Amount(row.get(key), unit) for key in ("peak", "rms", "reversal", "standstill")]
        rows.append([move.replace("_", " "), *errors, last])
    m = found.moves
    size = f"{human(m.amplitude, unit)} to each side, at most {human(m.speed, unit + '/s')}"
    text = [
        "Errors of the body that is measured. 'file' is the file's own signal; the sine's reversals are those of a circle's "
        "quadrants for each of its axes.",
        f"The sine has a period of {human(m.period, 's')}.",
    ]
    head = ["move", "peak error", "rms", "after a reversal", "at rest", "settling"]
    facts = [f"sine, slow ramp and step move {size}"]
    return Chapter("errors", "How well it tracks", text, [Table(head, rows)], facts=facts)


def _boundaries(found: Design) -> Chapter:
    """Where the verdict changes along the numbers that were varied."""
    rows: list[list[Cell]] = [
        [b.path, b.value, b.below, b.above, b.low, b.high] for line in found.lines for b in line.boundaries
    ]
    tables = [Table(["path", "boundary", "below", "above", "lies from", "to"], rows, on=PAGE)] if rows else []
    facts = [text for line in found.lines for text in along_sentences(line)]
    drawn = [figures.line(line, i) for i, line in enumerate(found.lines)]
    return Chapter("boundaries", "Where the verdict changes", (), tables, drawn, facts=facts)


def along_sentences(line: PathVerdicts) -> list[str]:
    """What the verdict does along one number, a sentence each."""
    whole, missed = line.turned, f"stretches narrower than {100 * line.resolution:.1g} % may be missed"
    if not line.boundaries and not line.mixed:
        return [f"{line.found[0].verdict} from {whole.path} = {whole.low:g} to {whole.high:g}; {missed}"]
    told = [
        (b.low, f"{b.below} below {b.path} = {b.value:.4g}, {b.above} above (between {b.low:.4g} and {b.high:.4g})")
        for b in line.boundaries
    ]
    told += [(m.low, f"{m.path} = {mixed_sentence(m)}") for m in line.mixed]
    return [*(text for _, text in sorted(told)), missed]


def mixed_sentence(m: Mixed) -> str:
    """A stretch in which no boundary is named."""
    met = f" ({', '.join(m.verdicts)})" if m.verdicts else ""
    return f"{m.low:.4g} to {m.high:.4g}: mixed{met}; {m.below} below, {m.above} above"


def _compensations(found: Design, unit: str) -> Chapter:
    """What each remedy leaves, and how far it may be turned up."""
    rows: list[list[Cell]] = [
        [
            _REMEDIES[c.kind],
            _quiet_range(c),
            f"{c.share:.2f}",
            Amount(c.reversal_error, unit),
            Amount(c.worst_error, unit),
        ]
        for c in found.compensations
    ]
    text = [
        "Simulated, not proved: the largest share of the law that stays quiet with every sample of the friction (all low, "
        "all high, each alone at both ends of its interval, and some at random), and the error after a reversal at the "
        "share given."
    ]
    facts = [
        f"dither: {d['kind']}, {d['frequency']:.4g} Hz; its share is amplitude over friction"
        for d in (c.dither for c in found.compensations)
        if d
    ]
    if found.excess is not None:
        facts.append(_excess(found, unit))
    head = ["remedy", "quiet", "share", "after a reversal", "worst friction"]
    drawn = [
        figures.motions(found.compensations, found.moves.period, unit),
        figures.shares(found.compensations, unit),
    ]
    return Chapter("compensations", "What may be done against friction", text, [Table(head, rows)], drawn, facts=facts)


def _quiet_range(c: CompensationResult) -> str:
    """Up to which share of the friction a remedy stays quiet."""
    if c.largest_quiet_share is None:
        return "never"
    if c.kind == "none":
        return "yes"
    if c.dither is not None:
        return f"{c.dither['least_quiet_share']:.2f} to {c.largest_quiet_share:.2f}"
    return f"up to {c.largest_quiet_share:.2f}"


def _excess(found: Design, unit: str) -> str:
    """From which share on compensation at the measured speed pushes."""
    e = found.excess
    assert e is not None
    text = (
        f"over-compensation: at the measured speed friction and compensation together push from share {e.worst_share:.3g} on "
        f"with the worst friction (at {human(e.speed, unit + '/s')}), from {e.share:.3g} on with the file's"
    )
    if e.counterexample is None:
        return f"{text} (steady curves; no run shows it)"
    return f"{text}; let go there at 5 % more, the body runs up to {human(e.ends, unit + '/s')} by itself (overcompensated.toml)"


def _starts(found: Design) -> Chapter:
    """The verdict from each of many starts."""
    unit, rows = _unit(found, found.judgement.body), list[list[Cell]]()
    for s in found.starts:
        j = s.judgement
        hunting = j.verdict == "hunting"
        cycle: list[Cell] = [Amount(j.amplitude, unit), Amount(j.period, "s")] if hunting else ["", ""]
        rows.append([s.body, Amount(s.off, unit), Amount(s.speed, unit + "/s"), j.verdict, *cycle])
    text = [
        f"From its own start it {_MEANING[found.verdict]}.",
        "The loop of the file is simulated until its signals are constant, and on over at least two hundred of its slowest "
        f"time constants ({found.loop.slowest:.3g} s while all contacts slide). The end is judged.",
        "From other starts: the signals rest at their last values; the body begins so far off its target, or there at that "
        "speed. Integrals begin empty.",
    ]
    head: list[str | Head] = ["body", "off the target", "speed", "verdict", "amplitude", "period"]
    return Chapter("starts", "From many starts", text, [Table(head, rows)], on=PAGE)


def starts_sentence(starts: Sequence[Start], own: Judgement, unit: str) -> str:
    """What the loop does from the starts that were tried, where that differs from the file's own run."""
    told = []
    for kind in kinds(list(starts), own)[1:]:
        alike = [s for s in starts if len(kinds([s], kind)) == 1]
        what = f"hunts by {_cycle(kind, unit)}" if kind.verdict == "hunting" else _DOES[kind.verdict]
        told.append(f"from {len(alike)} of {len(starts)} other starts it {what}")
    return "; ".join(told) or f"the same from {len(starts)} other starts"


def _headline(j: Judgement, unit: str) -> str:
    """The verdict in a few words."""
    text = _VERDICTS[j.verdict]
    return f"{text}, {j.body} by {_cycle(j, unit)}" if j.verdict == "hunting" else text


def _cycle(j: Judgement, unit: str) -> str:
    """How large a cycle is and, where that is regular, how long it takes."""
    return human(j.amplitude, unit) + (f" every {human(j.period, 's')}" if j.period == j.period else "")


def position_unit(found: Design) -> str:
    """The unit of the measured body's position."""
    return _unit(found, next(c.body for c in found.loop.scenario.rig.machine.controllers if c.name == found.controller))


def _unit(found: Design, body: str) -> str:
    return "rad" if found.loop.scenario.rig.machine.elements.bodies[body].turns else "m"

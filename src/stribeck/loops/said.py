"""The document of a design: verdict, tracking errors, boundaries, remedies and starts, for the terminal and the page."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from stribeck.loops import figures
from stribeck.loops.boundary import Mixed, PathVerdicts
from stribeck.loops.compensation import KINDS, CompensationResult
from stribeck.loops.excess import BEYOND
from stribeck.loops.judge import SHORTEST, Judgment
from stribeck.loops.loop import controller_of
from stribeck.loops.starts import Start, distinct_judgments
from stribeck.mouth.cells import digits, human
from stribeck.mouth.document import PAGE, Amount, Cell, Chapter, Document, Head, Table
from stribeck.scenario import said as of_scenario

if TYPE_CHECKING:
    from stribeck.loops import Design
    from stribeck.loops.excess import Excess

_MEANING = {
    "quiet": "settles and stays there",
    "creeping": "still moves in one direction when it should rest",
    "hunting": "oscillates when it should rest",
    "unstable": "oscillates with growing amplitude, up to a limit or without end",
    "failed": "could not be simulated to the end",
}
_VERDICTS = {"quiet": "QUIET", "creeping": "CREEPS", "hunting": "HUNTS", "unstable": "UNSTABLE", "failed": "FAILED"}
_DOES = {"quiet": "stays quiet", "creeping": "creeps", "unstable": "is unstable", "failed": "could not be simulated"}


def design(result: Design) -> Document:
    """The document of a :class:`~stribeck.loops.Design`."""
    judgment = result.judgment
    unit = _unit(result, controller_of(result.loop.scenario, result.controller).body)
    facts = []
    if result.loop.held:
        facts.append(f"held at their value at t = {result.loop.rest:g} s, to judge rest: {', '.join(result.loop.held)}")
    if judgment.note:
        facts.append(f"note: {judgment.note}")
    figure = figures.tracking(result.tracked, unit)
    chapters = [_errors(result, unit), *([_boundaries(result)] if result.lines else [])]
    if result.compensations:
        chapters.append(_compensations(result, unit))
    elif result.why_not:
        facts.append(f"compensations were not compared: {result.why_not}")
    chapters += [
        _starts(result),
        Chapter("plots", "Plots", figures=[figure], on=PAGE),
        of_scenario.file(result.loop.scenario),
    ]
    body_unit = _unit(result, judgment.body)
    lead = f"{_headline(judgment, body_unit)}  ({starts_sentence(result.starts, judgment, body_unit)})"
    return Document(result.loop.scenario.name, lead, facts, chapters)


def _errors(result: Design, unit: str) -> Chapter:
    """A table of the tracking errors, one row for each move."""
    rows: list[list[Cell]] = []
    for move, row in result.errors.items():
        settled = row.get("settling", -1.0)
        last: Cell = "never" if settled is None else "-" if settled < 0 else Amount(settled, "s")
        errors = [Amount(row.get(key), unit) for key in ("peak", "rms", "reversal", "standstill")]
        rows.append([move.replace("_", " "), *errors, last])
    m = result.moves
    size = f"{human(m.amplitude, unit)} to each side, at most {human(m.speed, unit + '/s')}"
    text = [
        "Errors of the measured body. 'file' is the file's own signal. The sine reverses as an axis does at the quadrants of "
        "a circle.",
        f"The sine has a period of {human(m.period, 's')}.",
    ]
    head = ["move", "peak error", "rms", "after a reversal", "at rest", "settling"]
    facts = [f"added moves (sine, slow ramp, step): {size}"]
    return Chapter("errors", "How well it tracks", text, [Table(head, rows)], facts=facts)


def _boundaries(result: Design) -> Chapter:
    """Where the verdict changes along the numbers that were varied."""
    rows: list[list[Cell]] = [
        [b.path, b.value, b.below, b.above, b.low, b.high] for line in result.lines for b in line.boundaries
    ]
    tables = [Table(["path", "boundary", "below", "above", "lies from", "to"], rows, on=PAGE)] if rows else []
    facts = [text for line in result.lines for text in along_sentences(line)]
    drawn = [figures.line(line, i) for i, line in enumerate(result.lines)]
    return Chapter("boundaries", "Where the verdict changes", (), tables, drawn, facts=facts)


def along_sentences(line: PathVerdicts) -> list[str]:
    """Boundaries and mixed intervals along one varied path, one sentence each, in order."""
    varied, width = line.turned, float(f"{100 * line.resolution:.1g}")
    missed = f"stretches narrower than {width:g} % of the value may be missed"
    if not line.boundaries and not line.mixed:
        return [f"{line.judgments[0].verdict} from {varied.path} = {varied.low:g} to {varied.high:g}; {missed}"]
    sentences = [
        (b.low, f"{b.below} up to {b.path} = {digits(b.low)}, {b.above} from {digits(b.high)}") for b in line.boundaries
    ]
    sentences += [(m.low, f"{m.path} = {mixed_sentence(m)}") for m in line.mixed]
    return [*(text for _, text in sorted(sentences)), missed]


def mixed_sentence(m: Mixed) -> str:
    """An interval in which no single boundary is reported."""
    met = f" ({', '.join(m.verdicts)})" if m.verdicts else ""
    return f"{digits(m.low, 4)} to {digits(m.high, 4)}: mixed{met}; {m.below} below, {m.above} above"


def _compensations(result: Design, unit: str) -> Chapter:
    """A table of the remedies: the shares that stay quiet, and the error after a reversal."""
    rows: list[list[Cell]] = [
        [KINDS[c.kind], _quiet_range(c), f"{c.share:.2f}", Amount(c.reversal_error, unit), Amount(c.worst_error, unit)]
        for c in result.compensations
    ]
    text = [
        "Simulated, not proved. 'quiet' is the range of shares without hunting for every sample of the friction parameters: "
        "all low, all high, each alone at both ends of its interval, and some at random. The errors hold at the share shown."
    ]
    facts = [
        f"dither: {d['kind']}, {d['frequency']:.4g} Hz; its share is amplitude over friction"
        for d in (c.dither for c in result.compensations)
        if d
    ]
    if result.excess is not None:
        facts += _excess(result.excess, unit)
    head = ["remedy", "quiet", "share", "after a reversal", "worst friction"]
    drawn = [
        figures.motions(result.compensations, result.moves.period, unit),
        figures.shares(result.compensations, unit),
    ]
    return Chapter("compensations", "Remedies", text, [Table(head, rows)], drawn, facts=facts)


def _quiet_range(c: CompensationResult) -> str:
    """Up to which share of the friction a remedy stays quiet."""
    if c.largest_quiet_share is None:
        return "never"
    if c.kind == "none":
        return "yes"
    if c.dither is not None:
        return f"{c.dither['least_quiet_share']:.2f} to {c.largest_quiet_share:.2f}"
    return f"up to {c.largest_quiet_share:.2f}"


def _excess(excess: Excess, unit: str) -> list[str]:
    """The share above which compensation at the measured speed adds energy, and the run that shows it."""
    speed = human(excess.speed, unit + "/s")
    facts = [
        f"over-compensation: above a share of {excess.worst_share:.3g} the observer exceeds the worst friction (at {speed}), "
        f"above {excess.share:.3g} the file's friction"
    ]
    if excess.counterexample is None:
        return [*facts, "this follows from the steady curves; no simulation confirms it"]
    share, end = (1 + BEYOND) * excess.worst_share, human(excess.ends, unit + "/s")
    return [
        *facts,
        f"overcompensated.toml replays it: with share {share:.3g} the body accelerates from {speed} to {end}",
    ]


def _starts(result: Design) -> Chapter:
    """The verdict from each of many starts."""
    unit, rows = _unit(result, result.judgment.body), list[list[Cell]]()
    for s in result.starts:
        j = s.judgment
        hunting = j.verdict == "hunting"
        cycle: list[Cell] = [Amount(j.amplitude, unit), Amount(j.period, "s")] if hunting else ["", ""]
        rows.append([s.body, Amount(s.off, unit), Amount(s.speed, unit + "/s"), j.verdict, *cycle])
    text = [
        f"From its own start it {_MEANING[result.verdict]}.",
        f"The loop is simulated until its signals are constant, and then over at least {SHORTEST} of its slowest time constants "
        f"({human(result.loop.slowest, 's')} while all contacts slide). The second half is judged.",
        "From other starts, the signals keep their last values. The body begins at the listed distance from its target, or at "
        "the target with the listed speed. Integrals begin at 0.",
    ]
    head: list[str | Head] = ["body", "off the target", "speed", "verdict", "amplitude", "period"]
    return Chapter("starts", "From many starts", text, [Table(head, rows)], on=PAGE)


def starts_sentence(starts: Sequence[Start], judgment: Judgment, unit: str) -> str:
    """A sentence with the starts that end differently from the file's own run."""
    sentences = []
    for kind in distinct_judgments(list(starts), judgment)[1:]:
        alike = [s for s in starts if len(distinct_judgments([s], kind)) == 1]
        what = f"hunts, {_cycle(kind, unit)}" if kind.verdict == "hunting" else _DOES[kind.verdict]
        sentences.append(f"from {len(alike)} of {len(starts)} other starts it {what}")
    return "; ".join(sentences) or f"the same from {len(starts)} other starts"


def _headline(j: Judgment, unit: str) -> str:
    """The verdict in a few words."""
    text = _VERDICTS[j.verdict]
    return f"{text}: {j.body} oscillates, {_cycle(j, unit)}" if j.verdict == "hunting" else text


def _cycle(j: Judgment, unit: str) -> str:
    """The amplitude of a limit cycle and, if it is regular, its period."""
    return f"±{human(j.amplitude, unit)}" + (f", period {human(j.period, 's')}" if j.period == j.period else "")


def _unit(result: Design, body: str) -> str:
    return "rad" if result.loop.scenario.system.elements.bodies[body].turns else "m"

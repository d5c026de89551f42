"""The files of ``stribeck design --out``: a page, and the machine with the compensation that is best."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import tomli_w

from stribeck.errors import left_out
from stribeck.files import together, write_summary, write_text
from stribeck.loops import Design
from stribeck.loops import figures as drawings
from stribeck.loops.boundary import Mixed, PathVerdicts
from stribeck.loops.compensation import CompensationResult, with_compensation
from stribeck.loops.judge import Judgement
from stribeck.loops.starts import Start, kinds
from stribeck.machine.elements.controllers import Controller
from stribeck.mouth import page
from stribeck.mouth.cells import digits, human
from stribeck.mouth.document import Chapter, Document, FigureSvg, Table
from stribeck.scenario import Scenario
from stribeck.scenario import said as of_scenario
from stribeck.scenario.moved import moved

_MEANING = {
    "quiet": "settles and stays there",
    "creeping": "still moves in one direction when it should rest",
    "hunting": "oscillates when it should rest",
    "unstable": "oscillates with growing amplitude, up to a limit or without end",
    "failed": "could not be simulated to the end",
}
_VERDICTS = {"quiet": "QUIET", "creeping": "CREEPS", "hunting": "HUNTS", "unstable": "UNSTABLE", "failed": "FAILED"}
_DOES = {"quiet": "stays quiet", "creeping": "creeps", "unstable": "is unstable", "failed": "could not be simulated"}
REMEDIES = {
    "none": "none", "reference": "feedforward at the signal's speed", "measured": "observer at the measured speed",
    "inner_loop": "observer with dF/dt, led by the lag", "dither": "dither",
}  # fmt: skip
MACHINES = ("machine.toml", "overcompensated.toml")  # among what is written


def write_design(found: Design, summary: dict[str, object], folder: Path, command: str = "") -> list[str]:
    """Write machine.toml (with the best compensation, ready to run), the figures and the page, and, last,
    summary.json; the paths."""
    with together(folder) as place:
        paths = [_machine(found, place, folder)]
        if found.excess is not None and found.excess.counterexample is not None:
            paths.append(_excess(found.excess.counterexample, place, folder))
        with left_out("the plots and the page"):
            figures = [drawings.tracking(found.tracked, position_unit(found))]
            figures += [drawings.line(line, i) for i, line in enumerate(found.lines)]
            if found.compensations:
                figures.append(drawings.motions(found.compensations, found.moves.period, position_unit(found)))
                figures.append(drawings.shares(found.compensations, _unit(found, found.judgement.body)))
            paths += page.write(_page(found, figures), place, command)
        return write_summary(paths, place, folder, summary)


def best(found: Design) -> CompensationResult | None:
    """The compensation with the least worst error of those that stay quiet."""
    quiet = [c for c in found.compensations if c.largest_quiet_share is not None]
    return min(quiet, key=lambda c: c.worst_error) if quiet else None


def _machine(found: Design, place: Path, folder: Path) -> Path:
    """The machine as a file that will stand in ``folder``: with what is best of what was compared."""
    from stribeck.loops.compensation import contact_of

    scenario, chosen = found.loop.scenario, best(found)
    if chosen is not None:
        contact = contact_of(found.loop.scenario, found.controller)
        scenario = with_compensation(scenario, found.controller, contact, chosen.kind, chosen.share)
    head = "# Written by 'stribeck design': the machine with the compensation that was best.\n"
    write_text(place / MACHINES[0], head + tomli_w.dumps(moved(scenario.data, scenario.folder, folder)))
    return place / MACHINES[0]


def _excess(machine: Scenario, place: Path, folder: Path) -> Path:
    """The run in which the compensation pushes, for ``stribeck run``."""
    path = place / MACHINES[1]
    head = (
        "# Written by 'stribeck design': nothing but friction and its compensation, 5 % beyond what friction can take. Run it:\n"
        "# let go, the body runs ever faster.\n"
    )
    write_text(path, head + tomli_w.dumps(moved(machine.data, machine.folder, folder)))
    return path


def excess_sentence(found: Design) -> str:
    """From which share on compensation at the measured speed pushes."""
    e = found.excess
    assert e is not None
    unit = position_unit(found)
    text = (
        f"over-compensation: at the measured speed friction and compensation together push from share {e.worst_share:.3g} on "
        f"with the worst friction (at {human(e.speed, unit + '/s')}), from {e.share:.3g} on with the file's"
    )
    if e.counterexample is None:
        return f"{text} (steady curves; no run shows it)"
    return f"{text}; let go there at 5 % more, the body runs up to {human(e.ends, unit + '/s')} by itself (overcompensated.toml)"


def _controllers(found: Design) -> tuple[Controller, ...]:
    rig = found.loop.scenario.rig
    return rig.machine.controllers


def _page(found: Design, figures: Sequence[FigureSvg]) -> Document:
    scenario = found.loop.scenario
    made = [_verdict(found), _starts(found), _errors(found)]
    if found.lines:
        rows = [
            [b.path, f"{b.value:.6g}", b.below, b.above, f"{b.low:.6g} to {b.high:.6g}"]
            for line in found.lines for b in line.boundaries
        ]  # fmt: skip
        text = [_along(line) for line in found.lines]
        tables = [Table(["path", "boundary", "below", "above", "lies within"], rows)] if rows else []
        made.append(Chapter("boundaries", "Where the verdict changes", text, tables))
    if found.compensations:
        made.append(_compensations(found))
    made.append(Chapter("plots", "Plots", figures=figures))
    made.append(of_scenario.file(scenario))
    lead = [sentence(found)]
    if len(kinds(found.starts, found.judgement)) > 1:
        lead.append(
            f"{starts_sentence(found.starts, found.judgement, _unit(found, found.judgement.body)).capitalize()}."
        )
    return Document(f"{scenario.name}: will it hunt?", lead[0], lead[1:], made)


def _verdict(found: Design) -> Chapter:
    j = found.judgement
    text = [
        "The loop of the file is simulated until its signals are constant, and on over at least two hundred of its slowest "
        f"time constants ({found.loop.slowest:.3g} s while all contacts slide). The end is judged.",
    ]
    if j.note:
        text.append(f"Note: {j.note}.")
    return Chapter("verdict", "Verdict", text)


def _along(line: PathVerdicts) -> str:
    """What the verdict does along one number, where it has no boundary."""
    t = line.turned
    told = [f"{m.path} = {mixed_sentence(m)}" for m in line.mixed]
    if not told and not line.boundaries:
        told = [f"{line.found[0].verdict} from {t.low:g} to {t.high:g}"]
    told += ["5 % beside each boundary named the verdicts are the same"] if line.boundaries else []
    told.append(f"stretches narrower than {100 * line.resolution:.1g} % may be missed")
    return f"{t.path}, {len(line.values)} values simulated: {'; '.join(told)}."


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


def quiet_range(c: CompensationResult) -> str:
    """Up to which share of the friction a remedy stays quiet."""
    if c.largest_quiet_share is None:
        return "never"
    if c.kind == "none":
        return "yes"
    if c.dither is not None:
        return f"{c.dither['least_quiet_share']:.2f} to {c.largest_quiet_share:.2f}"
    return f"up to {c.largest_quiet_share:.2f}"


def mixed_sentence(m: Mixed) -> str:
    """A stretch in which no boundary is named."""
    met = f" ({', '.join(m.verdicts)})" if m.verdicts else ""
    return f"{m.low:.4g} to {m.high:.4g}: mixed{met}; {m.below} below, {m.above} above"


def _starts(found: Design) -> Chapter:
    unit = _unit(found, found.judgement.body)
    rows = []
    for s in found.starts:
        j = s.judgement
        cycle = [human(j.amplitude, unit), _period(j)] if j.verdict == "hunting" else ["", ""]
        rows.append([s.body, human(s.off, unit), human(s.speed, unit + "/s"), j.verdict, *cycle])
    text = [
        f"{starts_sentence(found.starts, found.judgement, unit).capitalize()}.",
        "The signals rest at their last values; the body begins so far off its target, or there at that speed. Integrals begin "
        "empty.",
    ]
    head = ["body", "off the target", "speed", "verdict", "amplitude", "period"]
    return Chapter("starts", "From many starts", text, [Table(head, rows)])


def starts_sentence(starts: Sequence[Start], own: Judgement, unit: str) -> str:
    """What the loop does from the starts that were tried, where that differs from the file's own run."""
    told = []
    for kind in kinds(list(starts), own)[1:]:
        alike = [s for s in starts if len(kinds([s], kind)) == 1]
        what = f"hunts by {_cycle(kind, unit)}" if kind.verdict == "hunting" else _DOES[kind.verdict]
        told.append(f"from {len(alike)} of {len(starts)} other starts it {what}")
    return "; ".join(told) or f"the same from {len(starts)} other starts"


def _errors(found: Design) -> Chapter:
    keys = ("peak", "rms", "reversal", "standstill", "settling")
    unit = _unit(found, found.judgement.body)
    rows = [
        [move, *(_shown(row.get(k), "s" if k == "settling" else unit) for k in keys)]
        for move, row in found.errors.items()
    ]
    text = [
        "Errors of the body that is measured. 'file' is the file's own signal; the sine's reversals are those of a circle's "
        "quadrants for each of its axes."
    ]
    m = found.moves
    text.append(
        f"Sine, slow ramp and step go {human(m.amplitude, unit)} to each side, at most at {human(m.speed, unit + '/s')}: "
        f"the sine has a period of {human(m.period, 's')}."
    )
    return Chapter("errors", "How well it tracks", text, [Table(["move", *keys], rows)])


def _shown(x: float | None, unit: str) -> str:
    return "-" if x is None or x != x else human(x, unit)


def _compensations(found: Design) -> Chapter:
    unit = _unit(found, found.judgement.body)
    rows = [
        [
            c.kind, digits(c.largest_quiet_share, count=4), digits(c.share, count=4),
            _shown(c.reversal_error, unit), _shown(c.worst_error, unit),
        ]
        for c in found.compensations
    ]  # fmt: skip
    text = [
        "Simulated, not proved: the largest share of the law that stays quiet with every sample of the friction (all low, "
        "all high, each alone at both ends of its interval, and some at random), and the error after a reversal at the "
        "share given."
    ]
    text += [
        _dither(found, c) for c in found.compensations if c.dither is not None and c.largest_quiet_share is not None
    ]
    if found.excess is not None:
        text.append(f"{excess_sentence(found).capitalize()}.")
    head = ["against friction", "quiet up to share", "share", "error after a reversal", "the worst"]
    return Chapter("compensations", "What may be done against friction", text, [Table(head, rows)])


def _dither(found: Design, c: CompensationResult) -> str:
    d, unit = c.dither or {}, "N m" if _unit(found, found.judgement.body) == "rad" else "N"
    return (
        f"Dither: a {d['kind']} of {d['frequency']:.4g} Hz, {d['amplitude']:.4g} {unit}; its shares are amplitudes over the "
        f"largest friction below v_s, and it is quiet from {d['least_quiet_share']:.3g} on. What it moves the body "
        "by itself counts as rest."
    )


def headline(j: Judgement, unit: str) -> str:
    """The verdict in a few words."""
    text = _VERDICTS[j.verdict]
    return f"{text}, {j.body} by {_cycle(j, unit)}" if j.verdict == "hunting" else text


def sentence(found: Design) -> str:
    """The verdict in one sentence."""
    j = found.judgement
    return sentence_of(j, _unit(found, j.body))


def sentence_of(j: Judgement, unit: str) -> str:
    """A judgement in one sentence."""
    text = f"{j.verdict}: it {_MEANING[j.verdict]}"
    if j.verdict == "hunting":
        text += f", {j.body} by {_cycle(j, unit)}"
    return text


def _cycle(j: Judgement, unit: str) -> str:
    """How large a cycle is and, where that is regular, how long it takes."""
    period = _period(j)
    return human(j.amplitude, unit) + (f" every {period}" if period else "")


def _period(j: Judgement) -> str:
    return human(j.period, "s") if j.period == j.period else ""


def position_unit(found: Design) -> str:
    """The unit of the measured body's position."""
    return _unit(found, next(c.body for c in _controllers(found) if c.name == found.controller))


def _unit(found: Design, body: str) -> str:
    rig = found.loop.scenario.rig
    return "rad" if rig.machine.elements.bodies[body].turns else "m"

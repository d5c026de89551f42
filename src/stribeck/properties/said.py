"""The pages of ``stribeck check --out``: verdicts on a law or a machine's contacts, and the counterexamples replayed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from stribeck.constants import DECIDED, SHOWN
from stribeck.errors import StribeckError
from stribeck.laws import said as of_law
from stribeck.laws.base import Law
from stribeck.mouth import page, plots
from stribeck.mouth.document import Chapter, Document, Figure, FigureSvg, Table
from stribeck.mouth.quantities import Quantity, scale
from stribeck.properties import Verdict, Verdicts
from stribeck.properties.ports import MachineVerdicts
from stribeck.properties.steepness_figure import steepness_figure
from stribeck.properties.verdicts import ranges_in_words
from stribeck.scenario import Scenario
from stribeck.scenario import said as of_scenario
from stribeck.simulation import simulate
from stribeck.simulation.drawing import overview

_MEANING = {
    "unique": "one z(t) for every v(t)",
    "bounded": "z stays within a bound, whatever v(t)",
    "smooth": "dF/dt exists wherever dv/dt does",
    "passive": "no motion draws energy from friction",
    "drift_free": "below some load the contact is elastic: no creep",
}


def write_check(verdicts: Verdicts, folder: Path, command: str = "") -> list[Path]:
    """Write report.html, the friction curve and the replays into the folder; the paths."""
    law = verdicts.law
    curve = _curve(law)
    replays = [
        figure for name, verdict in verdicts.properties.items() if (figure := replay_figure(name, verdict)) is not None
    ]
    found = [verdicts_chapter(verdicts), evidence(verdicts)]
    needed: list[FigureSvg] = []
    if verdicts.steepness:
        needed = [steepness_figure(verdicts.steepness, "steepness", "Each error against k_v; grey: tolerated.")]
        text = [f"{name}: k_v = {each.k_v!r}" for name, each in verdicts.steepness.items()]
        found.insert(0, Chapter("steepness", "The smallest k_v", text, figures=needed))
    found.append(Chapter("curve", "Friction at held speeds", figures=[curve]))
    found += [*replays_chapter(replays, "replays", "The counterexamples"), of_law.chapter(law)]
    limit = f" for |v| up to {verdicts.v_max:g} {'rad/s' if law.rotary else 'm/s'}" if verdicts.v_max else ""
    named = {
        holds: ", ".join(name.replace("_", "-") for name, v in verdicts.properties.items() if v.holds is holds)
        for holds in (True, False, None)
    }
    others = [f"{word}: {named[x]}." for word, x in (("Refuted", False), ("Undecided", None)) if named[x]]
    introduction = [" ".join([f"Proved{limit}: {named[True] or 'none of the five properties'}.", *others])]
    return page.write(Document(f"What {law.name} guarantees", introduction[0].rstrip("."), (), found), folder, command)


def write_machine_check(found: MachineVerdicts, scenario: Scenario, folder: Path, command: str = "") -> list[Path]:
    """Write report.html and the replays into the folder; the paths."""
    made = [_whole(found)]
    for name, verdicts in found.contacts.items():
        made.append(verdicts_chapter(verdicts, f"contact-{name}", f"Contact {name}: {verdicts.law.name}"))
        made.append(evidence(verdicts, f"evidence-{name}", f"Evidence for {name}"))
        own = [f for n, v in verdicts.properties.items() if (f := replay_figure(n, v, name)) is not None]
        made += replays_chapter(own, f"replays-{name}", f"Counterexamples of {name}")
    made += of_scenario.laws(scenario)
    lead = f"Passive at its ports: {SHOWN[found.passive]}: {found.why}"
    return page.write(Document(f"What {found.name} guarantees", lead, (), made), folder, command)


def _whole(found: MachineVerdicts) -> Chapter:
    rows = [
        [name, v.law.name, ranges_in_words(found.ranges[name]) or "nothing", DECIDED[v["passive"].holds]]
        for name, v in found.contacts.items()
    ]
    tables = [Table(["contact", "law", "what varies", "passive"], rows, prose=True)]
    if found.ports:
        tables.append(Table(["port", "what acts there"], [list(row) for row in found.ports.items()], prose=True))
    text = [
        "A machine of passive contacts, links and pendulums is passive from its ports to the velocities there: no motion "
        "draws more energy from it than was put in. What varies is bounded by the file: signals over the whole run, positions "
        "and speeds without limit."
    ]
    return Chapter("machine", "The machine", text, tables)


def verdicts_chapter(verdicts: Verdicts, key: str = "verdicts", title: str = "Verdicts") -> Chapter:
    """A table of the five properties, how each was decided, and for which histories it holds."""
    rows = []
    for name, v in verdicts.properties.items():
        again = {True: "confirmed", False: "NOT CONFIRMED", None: "-"}[v.verified]
        rows.append([name.replace("_", "-"), _MEANING[name], DECIDED[v.holds], v.reason, again])
    head = ["property", "meaning", "holds", "how it was decided", "second run"]
    text = ["yes is proved; for no there is a counterexample. The constants are taken as exact."]
    if verdicts.level:
        text.append(f"Each verdict holds for every history of {ranges_in_words(verdicts.level)}.")
    return Chapter(key, title, text, [Table(head, rows, prose=True)])


def replays_chapter(figures: Sequence[Figure], key: str, title: str) -> list[Chapter]:
    """A chapter of counterexamples, where there are any."""
    text = ["Each counterexample as a motion: 'stribeck run' on its file gives the same numbers."]
    return [Chapter(key, title, text, figures=figures)] if figures else []


def evidence(verdicts: Verdicts, key: str = "evidence", title: str = "Evidence") -> Chapter:
    """The numbers that belong to each verdict."""
    tables = []
    for name, v in verdicts.properties.items():
        plain = {n: x for n, x in v.evidence.items() if isinstance(x, int | float | str) and n != "reason"}
        if plain:
            rows = [[n, f"{x:.9g}" if isinstance(x, float) else str(x)] for n, x in plain.items()]
            tables.append(Table([name.replace("_", "-"), "evidence (SI)"], rows, prose=True))
        for listed in ("programme", "levels"):
            steps: Sequence[Mapping[str, float]] = v.evidence.get(listed, ())
            if steps:
                tables.append(Table([*steps[0]], [[f"{x:.6g}" for x in step.values()] for step in steps[:40]]))
    return Chapter(key, title, (), tables)


def _curve(law: Law) -> FigureSvg:
    """Steady friction, and near rest."""
    slow = float(law.scales(law.p).speed)
    wide, near = 20 * slow * np.linspace(-1, 1, 801), 10.0 ** np.linspace(-6, 3, 400) * slow
    units = ("rad/s", "N m") if law.rotary else ("m/s", "N")
    with plots.style():
        made, axes = plots.figure([["wide", "near"]], 2.8)
        for name, v in (("wide", wide), ("near", near)):
            force = np.asarray(law.steady_force(v))
            of_v = scale([Quantity("v", units[0], "", v)], plain=name == "near")
            of_F = scale([Quantity("F", units[1], "", np.append(force, 0.0))])
            axes[name].plot(of_v.of(v), of_F.of(force), color=plots.COLOURS[2])
            axes[name].set(xlabel=of_v.label, ylabel=of_F.label)
        plots.logarithmic(axes["near"], y=False)
        axes["wide"].set_title("held speeds")
        axes["near"].set_title("near rest, and far")
        return plots.finish(made, "curve", "The friction force when a speed is held.", pdf=True)


def replay_figure(name: str, verdict: Verdict, of: str = "") -> Figure | None:
    """The motion of a counterexample; None where there is none that can be shown."""
    if verdict.holds is not False or verdict.scenario is None:
        return None
    try:
        solution = simulate(Scenario(verdict.scenario))
    except StribeckError:
        return None
    stated = ", ".join(f"{n} = {x:.6g}" for n, x in verdict.evidence.get("replay", {}).items())
    words = name.replace("_", "-")
    key = f"{of}_not_{name}" if of else f"not_{name}"
    return overview({f"not {words}": solution}, key, f"Not {words}: {verdict.method}. At the end: {stated}.")

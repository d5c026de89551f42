"""The page of ``stribeck check --scenario --out``: the contacts of a machine, and what follows for the whole."""

from __future__ import annotations

from pathlib import Path

from stribeck.constants import DECIDED, SHOWN
from stribeck.properties.ports import MachineVerdicts
from stribeck.properties.verdicts import ranges_in_words
from stribeck.report import chapters
from stribeck.report.check import evidence, replay_figure, replays_chapter, verdicts_chapter
from stribeck.report.files import write_figure
from stribeck.report.page import Chapter, Table
from stribeck.scenario import Scenario


def write_machine_check(found: MachineVerdicts, scenario: Scenario, folder: Path, command: str = "") -> list[Path]:
    """Write report.html and the replays into the folder; the paths."""
    made, figures = [_whole(found)], []
    for name, verdicts in found.contacts.items():
        made.append(verdicts_chapter(verdicts, f"contact-{name}", f"Contact {name}: {verdicts.law.name}"))
        made.append(evidence(verdicts, f"evidence-{name}", f"Evidence for {name}"))
        own = [f for n, v in verdicts.properties.items() if (f := replay_figure(n, v, name)) is not None]
        made += replays_chapter(own, f"replays-{name}", f"Counterexamples of {name}")
        figures += own
    made += chapters.of_laws(scenario)
    paths = [path for figure in figures for path in write_figure(figure, folder)]
    introduction = [f"Passive at its ports: {SHOWN[found.passive]}: {found.why}."]
    return [*paths, chapters.write_page(folder, f"What {found.name} guarantees", introduction, made, command)]


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

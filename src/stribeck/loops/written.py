"""The files of ``stribeck design --out``: a page, and the machine with the compensation that is best."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import tomli_w

from stribeck.errors import left_out
from stribeck.files import together, write_summary, write_text
from stribeck.loops import Design, ServoDesign
from stribeck.loops.compensation import CompensationResult, contact_of, with_compensation
from stribeck.mouth import page
from stribeck.scenario import Scenario
from stribeck.scenario.moved import moved

MACHINES = ("machine.toml", "overcompensated.toml")  # the machine files among those written
FILES = (*MACHINES, "report.html", "summary.json")
_HEADS = (
    "# Written by 'stribeck design': the machine with the compensation that was best.\n",
    "# Written by 'stribeck design': nothing but friction and its compensation, 5 % beyond what friction can take. Run it:\n"
    "# let go, the body runs ever faster.\n",
)


def write_design(
    result: Design | ServoDesign, summary: Mapping[str, object], folder: Path, command: str = ""
) -> list[str]:
    """Write the files of a design and return their paths.

    They are machine.toml (with the best compensation), overcompensated.toml (if over-compensation was found), the figures,
    the page and, last, summary.json.
    """
    paths: list[Path] = []
    with together(folder) as place:
        if isinstance(result, Design):
            machines = [compensated(result)]
            if result.excess is not None and result.excess.counterexample is not None:
                machines.append(result.excess.counterexample)
            for name, head, machine in zip(MACHINES, _HEADS, machines, strict=False):
                paths.append(place / name)
                write_text(paths[-1], head + tomli_w.dumps(moved(machine.data, machine.folder, folder)))
        with left_out("the plots and the page"):
            paths += page.write(result.document(), place, command)
        return write_summary(paths, place, folder, summary)


def best(design: Design) -> CompensationResult | None:
    """The compensation with the least worst error among those that stay quiet; None if none does."""
    quiet = [c for c in design.compensations if c.largest_quiet_share is not None]
    return min(quiet, key=lambda c: c.worst_error) if quiet else None


def compensated(design: Design) -> Scenario:
    """The machine with the best compensation; unchanged if there is none."""
    scenario, chosen = design.loop.scenario, best(design)
    if chosen is None:
        return scenario
    return with_compensation(
        scenario, design.controller, contact_of(scenario, design.controller), chosen.kind, chosen.share
    )

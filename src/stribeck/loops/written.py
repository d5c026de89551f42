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

MACHINES = ("machine.toml", "overcompensated.toml")  # among what is written
_HEADS = (
    "# Written by 'stribeck design': the machine with the compensation that was best.\n",
    "# Written by 'stribeck design': nothing but friction and its compensation, 5 % beyond what friction can take. Run it:\n"
    "# let go, the body runs ever faster.\n",
)


def write_design(
    found: Design | ServoDesign, summary: Mapping[str, object], folder: Path, command: str = ""
) -> list[str]:
    """Write machine.toml (with the best compensation, ready to run), the run in which a compensation pushes, the figures
    and the page, and, last, summary.json; the paths."""
    paths: list[Path] = []
    with together(folder) as place:
        if isinstance(found, Design):
            machines = [compensated(found)]
            if found.excess is not None and found.excess.counterexample is not None:
                machines.append(found.excess.counterexample)
            for name, head, machine in zip(MACHINES, _HEADS, machines, strict=False):
                paths.append(place / name)
                write_text(paths[-1], head + tomli_w.dumps(moved(machine.data, machine.folder, folder)))
        with left_out("the plots and the page"):
            paths += page.write(found.document(), place, command)
        return write_summary(paths, place, folder, summary)


def best(found: Design) -> CompensationResult | None:
    """The compensation with the least worst error of those that stay quiet."""
    quiet = [c for c in found.compensations if c.largest_quiet_share is not None]
    return min(quiet, key=lambda c: c.worst_error) if quiet else None


def compensated(found: Design) -> Scenario:
    """The machine with what is best of what was compared."""
    scenario, chosen = found.loop.scenario, best(found)
    if chosen is None:
        return scenario
    return with_compensation(
        scenario, found.controller, contact_of(scenario, found.controller), chosen.kind, chosen.share
    )

"""``stribeck advise``."""

from __future__ import annotations

from math import ceil, floor, log10
from pathlib import Path
from typing import Any

from stribeck.cli import show
from stribeck.cli.text import say
from stribeck.errors import InputError
from stribeck.scenario import Scenario, parse_assignment
from stribeck.steepness import Advice
from stribeck.steepness import advise as find


def advise(
    law: str,
    parameters: str | None,
    assignments: list[str],
    tolerated: dict[str, Any],
    out: Path | None,
    json: bool,
    trust: bool,
) -> int:
    """Print the smallest k_v that meets what is tolerated; with ``out``, write the curves."""
    constants = dict(parse_assignment(text) for text in assignments)
    if taken := [name for name in constants if name in tolerated or name in ("law", "parameters")]:
        raise InputError([f"--set: '{name}': must be a constant of the law" for name in taken])
    if tolerated["scenario"] is not None:
        tolerated["scenario"] = Scenario.load(tolerated["scenario"], trust=trust)
    advices = find(law, parameters, **tolerated, **constants)
    summary: dict[str, Any] = {"laws": {name: each.summary() for name, each in advices.items()}, "files": []}
    if out is not None:
        from stribeck.report.advise import write

        show.check_folder(out)
        summary["files"] = write(advices, out, summary)
    if json:
        show.print_json(summary)
    else:
        for advice in advices.values():
            _print(advice)
        for file in summary["files"]:
            print(f"  wrote {file}")
    return 0


def up(x: float) -> str:
    """Four digits, rounded up: a smaller k_v would miss the tolerance."""
    if not x:
        return "0"
    unit = 10.0 ** (floor(log10(x)) - 3)
    return f"{ceil(x / unit * (1 - 1e-12)) * unit:.4g}"


def k_v_in_words(k_v: float | None) -> str:
    """A required k_v: a number, any, or none."""
    return "none will do" if k_v is None else f"{up(k_v)} s/m" if k_v else "any will do"


def _print(advice: Advice) -> None:
    print(f"{advice.law}: k_v = {k_v_in_words(advice.k_v)}")
    for each in advice.requirements:
        tolerated = f"{100 * each.tolerance:.4g} %" if not each.unit else f"{each.tolerance:.4g} {each.unit}"
        say(f"{each.name}, {tolerated}: {k_v_in_words(each.k_v)}", 6, "  ")
        say(f"by {each.method}: {each.detail}", 8, "      ")
    if advice.cost is not None:
        c = advice.cost
        say(
            f"up to {c.v_max:.4g} m/s: stiffness {c.stiffness:.4g} 1/s, explicit steps below {c.largest_step:.4g} s",
            4,
            "  ",
        )
        if c.body_stiffness is not None:
            print(f"  with the body: eigenvalues up to {c.body_stiffness:.4g} 1/s")
        bent = f"dF/dv changes by up to {c.force_bend:.4g} N s/m per m/s there"
        say(f"|v| is bent within {c.bend:.4g} m/s; {bent}", 4, "  ")

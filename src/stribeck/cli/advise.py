"""``stribeck advise``."""

from __future__ import annotations

from collections.abc import Callable
from math import ceil, floor, log10
from pathlib import Path
from typing import Any

from stribeck.cli import show
from stribeck.cli.check import level_of
from stribeck.cli.text import say
from stribeck.constants import rotary_unit
from stribeck.errors import InputError
from stribeck.scenario import Scenario, parse_assignments
from stribeck.steepness import Advice, LevelAdvice
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
    tolerated["level"] = level_of(tolerated["level"])
    constants = parse_assignments(assignments)
    if taken := [name for name in constants if name in tolerated or name in ("law", "parameters")]:
        raise InputError([f"--set: '{name}': must be a constant of the law" for name in taken])
    if tolerated["scenario"] is not None:
        tolerated["scenario"] = Scenario.load(tolerated["scenario"], trust=trust)
    if out is not None:
        show.check_folder(out)
    advices = find(law, parameters, **tolerated, **constants)
    summary: dict[str, object] = {"laws": {name: each.summary() for name, each in advices.items()}}
    files: list[str] = []
    if out is not None:
        from stribeck.report.advise import write_advice

        files = write_advice(advices, out, summary)
    if json:
        show.print_json({**summary, "files": files})
    else:
        for advice in advices.values():
            _print(advice)
        for file in files:
            print(f"  wrote {file}")
    return 0


def up(x: float) -> str:
    """Four digits, rounded up: a smaller k_v would miss the tolerance."""
    if not x:
        return "0"
    unit = 10.0 ** (floor(log10(x)) - 3)
    return f"{ceil(x / unit * (1 - 1e-12)) * unit:.4g}"


def below(x: float) -> str:
    """Six digits, rounded down: a larger v_d is not proved."""
    unit = 10.0 ** (floor(log10(x)) - 5)
    return f"{floor(x / unit) * unit:.6g}"


def k_v_in_words(k_v: float | None, unit: str) -> str:
    """A required k_v: a number, any, or none."""
    return "none will do" if k_v is None else f"{up(k_v)} {unit}" if k_v else "any will do"


def _print(advice: Advice) -> None:
    def unit(linear: str) -> str:
        return rotary_unit(linear) if advice.rotary else linear

    speed, steepness = unit("m/s"), unit("s/m")
    if advice.requirements:
        print(f"{advice.law}: k_v = {k_v_in_words(advice.k_v, steepness)}")
    else:
        print(f"{advice.law}:")
    for each in advice.requirements:
        tolerated = f"{100 * each.tolerance:.4g} %" if not each.unit else f"{each.tolerance:.4g} {each.unit}"
        say(f"{each.name}, {tolerated}: {k_v_in_words(each.k_v, steepness)}", 6, "  ")
        say(f"by {each.method}: {each.detail}", 8, "      ")
    if advice.cost is not None:
        c = advice.cost
        say(
            f"up to {c.v_max:.4g} {speed}: stiffness {c.stiffness:.4g} 1/s, explicit steps below {c.largest_step:.4g} s",
            4,
            "  ",
        )
        if c.body_stiffness is not None:
            print(f"  with the body: eigenvalues up to {c.body_stiffness:.4g} 1/s")
        bent = f"dF/dv changes by up to {c.force_bend:.4g} {unit('N s/m')} per {speed} there"
        say(f"|v| is bent within {c.bend:.4g} {speed}; {bent}", 4, "  ")
    if advice.level is not None:
        _print_level(advice.level, unit)


def _print_level(found: LevelAdvice, unit: Callable[[str], str]) -> None:
    speed = unit("m/s")
    say(
        f"level {found.low:g} to {found.high:g}: {'passive' if found.passive_now else 'not shown passive'} as it is",
        4,
        "  ",
    )
    if found.v_d is None and found.v_d_limit is None and not found.passive_now:
        enough = f"with k_v = {up(found.k_v_above)} {unit('s/m')} or more there is one"
        say(f"no v_d is known to make it passive at this k_v: {enough}", 6, "    ")
    if found.v_d is not None:
        left = f"{100 * (found.damping_at_v_s or 0.0):.3g} % of sigma_1 is left at v_s"
        say(f"v_d = {below(found.v_d)} {speed} or less keeps it passive whatever the load does ({left})", 6, "    ")
        say(f"cost in the steady curve up to {found.v_max:.4g} {speed}: {100 * found.steady_change:.3g} %", 6, "    ")
    if found.v_d_limit is not None:
        what = "with a larger one a load that rises high enough and falls draws energy"
        say(f"the limit of v_d is {below(found.v_d_limit)} {speed}: {what}", 6, "    ")
    if found.steady_change_by_sigma_2 is not None:
        cost = f"{100 * found.steady_change_by_sigma_2:.3g} %"
        say(
            f"without v_d: sigma_2 = {found.sigma_2:.6g} {unit('N s/m')} or more; cost in the steady curve: {cost}",
            6,
            "    ",
        )
